//! Removes quoted row names below a line of names that is one cell shorter, as `write.table` of R writes
//! them.
//!
//! ```text
//! "time" "force.N"
//! "1" 0 0.443711
//! "2" 0.001 1.05775
//! ```

use super::decoded::Text;
use super::encoding;
use super::lines::{Fields, Lines, Separator, fields};
use crate::number;
use crate::source::Source;
use vibro_record::Result;

/// Most rows below the line of names that are checked.
const ENOUGH: usize = 3;

/// The text with tabs between its cells and without the row names; `None` for any other text.
///
/// # Errors
/// If the text cannot be read.
pub fn without(text: &Text) -> Result<Option<Source>> {
    if !text.head.starts_with('"') {
        return Ok(None);
    }
    let Some(separator) =
        [b' ', b'\t', b';', b','].map(Separator::Char).into_iter().find(|mark| named(text, *mark))
    else {
        return Ok(None);
    };
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let mut kept = String::with_capacity(whole.len());
    for line in Lines::new(&whole, 0, 1, &[]) {
        let Ok(cells) = fields(line.text, separator) else { return Ok(None) };
        let names = usize::from(line.number > 1 && !line.is_blank());
        let cells: Vec<&str> = cells.iter().skip(names).map(|(_, cell)| cell.as_ref()).collect();
        kept += &(cells.join("\t") + "\n");
    }
    text.source.with_bytes(kept).map(Some)
}

/// Whether the first line has one name fewer than the rows have cells, and all rows begin with a quoted
/// cell.
fn named(text: &Text, separator: Separator) -> bool {
    let mut lines = Lines::new(&text.head, 0, 1, &[]).take(ENOUGH + 1);
    let Some(names) = lines.next().and_then(|line| fields(line.text, separator).ok()) else { return false };
    let is_number = |cell: &str| number::either(cell.as_bytes()).is_some();
    let values = |row: &Fields| {
        row.iter().skip(1).all(|(_, cell)| is_number(cell) || number::is_missing(cell.as_bytes()))
    };
    let rows: Vec<bool> = lines
        .map(|line| (line, fields(line.text, separator).unwrap_or_default()))
        .map(|(line, row)| line.text.starts_with('"') && row.len() == names.len() + 1 && values(&row))
        .collect();
    rows.len() > 1 && !rows.contains(&false) && !names.iter().any(|(_, name)| is_number(name))
}
