//! Universal File Format: data sets between lines with `-1`.
//!
//! ```text
//!     -1
//!    151            number of the data set, here the file header
//! …
//!     -1
//!     -1
//!     58            a function: see `uff58`
//! …
//!     -1
//! ```
//! Data sets 58 and 58b become records, data set 164 gives the unit system of those behind it, and every other set is
//! passed over by name.

pub mod delimiter;
pub mod stream;
pub mod system;

use super::format::{Format, Survey};
use super::reader::{Options, Recording};
use super::uff58::{self, Counted, Kept, Set, Sink, codes};
use super::{Header, Source};
use delimiter::{Number, is_delimiter, set_number};
use stream::Stream;
use system::System;
use vibro_record::{Error, Finding, Place, Record, Result};

/// Endings under which text may stand before the first data set.
const ENDINGS: [&str; 6] = ["uff", "unv", "ufb", "bunv", "uf", "58"];

/// A delimiter with the number of a data set behind it. These must be the first lines that are not blank and stand in
/// their very columns, for `-1` and `58` may also be two values; under a usual ending any two lines will do.
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

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let mut records: Vec<Record> = Vec::new();
    let findings = walk(source, options, |set: Set<Kept>| {
        records.push(set.plan.record(set.sink)?);
        Ok(())
    })?;
    tell_apart(records.iter_mut().map(|r| &mut r.meta_mut().name).collect());
    Ok(Recording { path: source.path().to_owned(), format: Format::Uff, records, findings })
}

/// Goes through the file once, in memory that does not grow with it.
pub(super) fn survey(source: &Source, options: &Options) -> Result<Survey> {
    let mut headers: Vec<Header> = Vec::new();
    let findings = walk(source, options, |set: Set<Counted>| {
        headers.push(set.plan.header(&set.sink)?);
        Ok(())
    })?;
    tell_apart(headers.iter_mut().map(|h| &mut h.name).collect());
    Ok((headers, findings))
}

/// Two channels of one name are told apart by number, so that each can be asked for.
fn tell_apart(mut names: Vec<&mut String>) {
    let mut seen: Vec<(String, usize)> = Vec::new();
    for name in names.iter_mut().filter(|n| !n.is_empty()) {
        match seen.iter_mut().find(|(first, _)| first == *name) {
            Some((first, count)) => {
                *count += 1;
                **name = format!("{first} #{count}");
            }
            None => seen.push((name.clone(), 1)),
        }
    }
}

/// Hands every data set 58 to `each`; gives the findings about the file as a whole.
fn walk<S: Sink>(
    source: &Source,
    options: &Options,
    mut each: impl FnMut(Set<S>) -> Result<()>,
) -> Result<Vec<Finding>> {
    let mut stream = Stream::open(source)?;
    let file = source.name();
    let mut around = Around::default();
    let mut system = System::default();
    let mut functions = 0;
    let mut delimited = false;
    while stream.next_line()? {
        let line = stream.text();
        if line.trim_ascii().is_empty() {
            continue;
        }
        if is_delimiter(line) {
            delimited = true;
            continue;
        }
        let Some(Number { number, binary }) = set_number(line).filter(|_| delimited) else {
            around.outside(&stream.place());
            continue;
        };
        let place = stream.place();
        // The delimiter that closes this set may open the next one, where a file has lost one of the two.
        delimited = true;
        if number == 58 {
            match uff58::read(&mut stream, binary, &system, options, &file)? {
                Ok(set) => {
                    functions += 1;
                    each(set).map_err(|e| e.in_file(source.path()))?;
                    continue;
                }
                Err(lines) => around.cut_short(place, lines),
            }
        } else {
            around.passed_over(number);
            if number == 164 {
                if let Some(stated) = System::read(&mut stream)? {
                    system = stated;
                } else {
                    around.findings.push(Finding::caution("no-unit-factors"));
                }
            }
        }
        delimited = stream.pass_set()?.closed;
    }
    around.finish(functions)
}

/// What stands around the data sets that are read.
#[derive(Default)]
struct Around {
    findings: Vec<Finding>,
    /// Other data sets with their counts, in the order of their first appearance.
    others: Vec<(u32, usize)>,
    /// Lines outside any data set, and where the first stands.
    lines: usize,
    first: Option<Place>,
    cut: Option<(Place, usize)>,
}

impl Around {
    fn outside(&mut self, place: &Place) {
        self.lines += 1;
        self.first.get_or_insert_with(|| place.clone());
    }

    fn passed_over(&mut self, number: u32) {
        match self.others.iter_mut().find(|(n, _)| *n == number) {
            Some((_, count)) => *count += 1,
            None => self.others.push((number, 1)),
        }
    }

    fn cut_short(&mut self, place: Place, lines: usize) {
        self.findings
            .push(Finding::caution("header-cut-short").count("lines", lines).count("of", uff58::LINES));
        self.cut = Some((place, lines));
    }

    /// All findings; an error where there is nothing but a header cut short.
    fn finish(self, functions: usize) -> Result<Vec<Finding>> {
        if let (0, Some((place, lines))) = (functions, self.cut) {
            return Err(Error::input(
                place,
                format!("data set 58 ends after {lines} of its {} header lines", uff58::LINES),
                "eleven header lines and values behind them",
            )
            .hint("the file is cut short: copy or export it again"));
        }
        let mut findings = self.findings;
        if !self.others.is_empty() {
            let names: Vec<String> = self
                .others
                .iter()
                .map(|(number, count)| {
                    let name = codes::set_name(*number);
                    let used = if *number == 164 { " (factors used)" } else { "" };
                    if *count > 1 { format!("{count} × {name}{used}") } else { format!("{name}{used}") }
                })
                .collect();
            findings.push(Finding::note("sets-passed-over").name("sets", names.join(", ")));
        }
        if self.lines > 0 {
            let place = self.first.map_or_else(String::new, |p| Place { path: None, ..p }.to_string());
            findings.push(Finding::caution("lines-outside").count("n", self.lines).name("place", place));
        }
        if functions == 0 {
            findings.push(Finding::caution("no-function"));
        }
        Ok(findings)
    }
}
