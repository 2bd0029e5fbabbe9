//! Splits the runs of a measurement that are side by side, each with its own times.
//!
//! ```text
//! Time (s) Run #1,Force (N) Run #1,Time (s) Run #2,Force (N) Run #2
//! 0.00,1.5,0.00,2.5
//! 0.01,1.0,,                           a run may end before another
//! ```

use super::decoded::Text;
use super::dialect::Dialect;
use super::encoding;
use super::lines::{Lines, fields};
use super::word_columns::without;
use crate::source::Source;
use vibro_record::{AxisKind, Result};

/// For each run, which columns belong to other runs; empty for a text without runs side by side.
pub fn others_of(dialect: &Dialect) -> Vec<Vec<bool>> {
    let names = dialect.names.as_deref().unwrap_or_default();
    let labels: Option<Vec<&str>> = names.iter().map(|name| Some(name.run()?.1)).collect();
    let Some(labels) = labels.filter(|_| dialect.skipped == 0 && dialect.clock.is_none()) else {
        return Vec::new();
    };
    let is_time = |i: &usize| names[*i].axis(true) == Some(AxisKind::Time) && names[*i].axis(false).is_some();
    let times: Vec<&str> = (0..names.len()).filter(is_time).map(|i| labels[i]).collect();
    let once = |label: &&str| times.iter().filter(|time| *time == label).count() == 1;
    if times.len() < 2 || !labels.iter().all(once) {
        return Vec::new();
    }
    times.iter().map(|run| labels.iter().map(|label| label != run).collect()).collect()
}

/// The text of one run: without the columns marked in `others`, and without the rows after the run's end.
///
/// # Errors
/// If the text cannot be read.
pub fn alone(text: &Text, dialect: &Dialect, others: &[bool]) -> Result<Source> {
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let (mut kept, mut ended) = (String::with_capacity(whole.len()), 1);
    for line in Lines::new(&whole, 0, 1, dialect.remarks).filter(|line| !line.is_blank()) {
        // Blank lines keep the line numbers as in the file.
        kept.extend((ended..line.number).map(|_| '\n'));
        ended = line.number;
        let cells = fields(line.text, dialect.separator).unwrap_or_default();
        let mut own = cells.iter().zip(others).filter(|(_, other)| !**other);
        if cells.len() != others.len() || line.remark.is_some() {
            kept += line.text;
        } else if own.any(|((_, cell), _)| !cell.is_empty()) {
            without(&mut kept, &line, &cells, dialect.separator, others);
        }
    }
    kept.push('\n');
    text.source.with_bytes(kept)
}
