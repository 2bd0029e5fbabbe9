//! Joins times that are printed in two columns, whole seconds and a fraction, as C and ROS do.
//!
//! ```text
//! tv_sec,tv_usec,acc
//! 1714556000,301000,2.25        1714556000.301000 s
//! ```

use super::decoded::Text;
use super::dialect::Dialect;
use super::encoding;
use super::lines::{Lines, Separator, fields};
use super::names::Name;
use crate::source::Source;
use vibro_record::Result;

/// Last words of the names of both columns, and number of digits of the fraction of a second.
const PAIRS: [(&str, &str, usize); 5] = [
    ("sec", "usec", 6),
    ("sec", "nsec", 9),
    ("secs", "nsecs", 9),
    ("sec", "nanosec", 9),
    ("secs", "usecs", 6),
];

/// The text with both columns joined to one, `time (s)`. `None` if there is no such pair of columns, or if
/// a cell is not a whole number.
///
/// # Errors
/// If the text cannot be read.
pub fn joined(text: &Text, dialect: &Dialect) -> Result<Option<Source>> {
    let names = dialect.names.as_deref().unwrap_or_default();
    let words: Vec<String> = names.iter().map(Name::last_word).collect();
    let pair = |w: &[String]| PAIRS.iter().find(|(sec, part, _)| w[0] == *sec && w[1] == *part);
    let found = words.windows(2).enumerate().find_map(|(at, w)| Some((at, pair(w)?.2)));
    let plain = dialect.skipped == 0 && dialect.clock.is_none();
    let (Some((at, digits)), Separator::Char(mark)) = (found.filter(|_| plain), dialect.separator) else {
        return Ok(None);
    };
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let mut kept = String::with_capacity(whole.len());
    for line in Lines::new(&whole, 0, 1, dialect.remarks) {
        let cells = fields(line.text, dialect.separator).unwrap_or_default();
        let is_names =
            line.number < dialect.first_line && cells.get(at).is_some_and(|(_, c)| names[at].name == *c);
        if line.remark.is_some()
            || cells.len() != names.len()
            || line.number < dialect.first_line && !is_names
        {
            kept = kept + line.text + "\n";
            continue;
        }
        let (sec, part) = (cells[at].1.as_ref(), cells[at + 1].1.as_ref());
        let is_whole = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let joined = match is_names {
            true => "time (s)".to_owned(),
            false if is_whole(sec) && is_whole(part) && part.len() <= digits => {
                format!("{sec}{}{part:0>digits$}", char::from(dialect.decimal))
            }
            false => return Ok(None),
        };
        // Decimal commas and commas as separators do not occur together.
        let behind = cells.get(at + 2).map_or("", |(from, _)| &line.text[*from..]);
        let ends = if behind.is_empty() { String::new() } else { char::from(mark).to_string() };
        kept = kept + &line.text[..cells[at].0] + &joined + &ends + behind + "\n";
    }
    text.source.with_bytes(kept).map(Some)
}
