//! Universal File Format: data sets between lines with `-1`.
//!
//! ```text
//!     -1
//!    151            number of the data set, here the file header
//! …
//!     -1
//!     -1
//!     58            a function: see [`set58`]
//! …
//!     -1
//! ```
//! Data sets 58 and 58b become records. Data set 164 gives the unit system of the sets after it. Every
//! other set is skipped with a note.

pub mod set58;
pub mod stream;

use crate::held::Contents;
use crate::options::Options;
use crate::source::Source;
use set58::{UnitSystem, codes};
use stream::{Stream, is_delimiter, set_number};
use vibro_record::{Finding, Place, Record, Result};

/// File endings for which text may precede the first data set.
pub(super) const ENDINGS: &[&str] = &["uff", "unv", "ufb", "bunv", "uf", "58"];

/// Whether the lines of a delimiter and of a data set's number follow each other. They must be the first
/// lines that are not blank, in their exact columns, since `-1` and `58` may also be two values. With a
/// usual file ending, any two consecutive lines are accepted.
pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    let known = ENDINGS.contains(&source.extension().as_str());
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let mut lines = head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii_end).filter(|l| !l.is_empty());
    if !known {
        let first = lines.next() == Some(b"    -1");
        let number = |l: &[u8]| l.get(5).is_some_and(u8::is_ascii_digit) && set_number(l).is_some();
        return first && lines.next().is_some_and(number);
    }
    let mut delimited = false;
    lines.any(|line| {
        let opens = delimited && set_number(line).is_some();
        delimited = is_delimiter(line);
        opens
    })
}

pub(super) fn read(source: &Source, options: &Options, _: bool) -> Result<Contents> {
    let bytes = source.all()?;
    let mut stream = Stream::new(&bytes);
    let (mut records, mut findings): (Vec<Record>, Vec<Finding>) = (Vec::new(), Vec::new());
    // Other data sets with their counts, and lines outside any set, with the place of the first.
    let mut others: Vec<(u32, usize)> = Vec::new();
    let mut outside: Option<(Place, usize)> = None;
    let (mut system, mut delimited, mut cut) = (UnitSystem::default(), false, None);
    while let Some(line) = stream.next_line() {
        if line.trim_ascii().is_empty() {
            continue;
        }
        if is_delimiter(line) {
            delimited = true;
            continue;
        }
        let Some((number, binary)) = set_number(line).filter(|_| delimited) else {
            outside.get_or_insert_with(|| (stream.place(), 0)).1 += 1;
            continue;
        };
        // The delimiter that closes this set may also open the next one, in a file that lacks one of the
        // two.
        delimited = true;
        if number == 58 {
            match set58::read(&mut stream, (line, binary), &system, options, &source.name())? {
                Ok(record) => {
                    records.push(record);
                    continue;
                }
                Err((lines, error)) => {
                    let short = Finding::caution("header-cut-short").count("lines", lines);
                    findings.push(short.count("of", set58::LINES));
                    cut = Some(error);
                }
            }
        } else {
            count(&mut others, number);
            if number == 164 {
                match UnitSystem::read(&mut stream) {
                    Some(stated) => system = stated,
                    None => findings.push(Finding::caution("no-unit-factors")),
                }
            }
        }
        delimited = stream.pass_set().1;
    }
    if let Some(error) = cut.filter(|_| records.is_empty()) {
        return Err(error);
    }
    if !others.is_empty() {
        let names: Vec<String> = others.into_iter().map(codes::set_names).collect();
        findings.push(Finding::note("sets-passed-over").name("sets", names.join(", ")));
    }
    if let Some((place, lines)) = outside {
        findings.push(Finding::caution("lines-outside").count("n", lines).name("place", place.to_string()));
    }
    if records.is_empty() {
        findings.push(Finding::caution("no-function"));
    }
    tell_apart(&mut records);
    Ok(Contents::of(records, findings))
}

/// Adds a number to repeated names (`name #2`), so that the user can name each channel.
fn tell_apart(records: &mut [Record]) {
    let mut seen: Vec<(String, usize)> = Vec::new();
    for name in records.iter_mut().map(|r| &mut r.meta_mut().name).filter(|n| !n.is_empty()) {
        let n = count(&mut seen, name.clone());
        if n > 1 {
            *name = format!("{name} #{n}");
        }
    }
}

/// Counts `item` in a list and returns its count so far.
fn count<T: PartialEq>(list: &mut Vec<(T, usize)>, item: T) -> usize {
    let at = list.iter().position(|(known, _)| *known == item).unwrap_or_else(|| {
        list.push((item, 0));
        list.len() - 1
    });
    list[at].1 += 1;
    list[at].1
}
