//! Chooses between two tables in one text: the longer one is read if the other is much shorter.

use super::decoded::Text;
use super::encoding;
use crate::number;
use crate::source::Source;
use vibro_record::{Finding, Result};

/// Least ratio of the row counts of the longer and the shorter table. A summary of the rows is at least
/// this much shorter.
pub(crate) const LONGER: usize = 10;

/// Number of lines that begin with a number.
fn count(text: &str) -> usize {
    let begins =
        |line: &&str| number::prefix(line.trim_start_matches([' ', '\t', '"']).as_bytes(), b'.').is_some();
    text.lines().filter(begins).count()
}

/// Number of lines that begin with a number, in a text of any encoding.
pub(crate) fn rows(bytes: &[u8]) -> usize {
    count(&encoding::decode(bytes))
}

/// The text with only the longer of two tables, the second of which begins at `line`, and a finding on the
/// other. `None` if neither is [`LONGER`] times as long. Lines keep their numbers.
///
/// # Errors
/// If the file cannot be read.
pub fn longest(text: &Text, line: u64) -> Result<Option<(Source, Finding)>> {
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let above = line as usize - 1;
    let (upper, lower) = whole.split_at(whole.split_inclusive('\n').take(above).map(str::len).sum());
    let [first, second] = [upper, lower].map(count);
    let (kept, left) = if first >= LONGER * second {
        (upper.to_owned(), second)
    } else if second >= LONGER * first {
        ("\n".repeat(above) + lower, first)
    } else {
        return Ok(None);
    };
    let found = match left {
        0 => Finding::caution("lines-left-out").count("line", line as usize),
        left => Finding::caution("table-left-out").count("n", left),
    };
    Ok(Some((text.source.with_bytes(kept)?, found)))
}
