//! LabVIEW measurement files (`.lvm`), versions 1 and 2.
//!
//! ```text
//! LabVIEW Measurement                          tags and values, one per line, between separators
//! Separator       Tab
//! X_Columns       No                           one X column for all channels, one for each (Multi), or
//! none
//! ***End_of_Header***
//!
//! Channels        2                            the header of a segment, one value per channel
//! Y_Unit_Label    N         m/s^2
//! Delta_X         3.9E-5    3.9E-5
//! ***End_of_Header***
//! X_Value         Force     Response   Comment
//!                 0.914018  1.204792
//! ```
//! Source: National Instruments, "Specification for the LabVIEW Measurement File". A later segment begins
//! with its own header after a blank line; its channels become separate records. Text between
//! `***Start_Special***` and `***End_Special***` is skipped.

use super::missing::{self, Missing};
use super::text::decoded::in_line;
use super::text::encoding;
use super::text::names::Name;
use crate::assemble::{self, Abscissa, JudgedAxis, Spectral, from_values, to_si};
use crate::held::Contents;
use crate::number;
use crate::options::Options;
use crate::source::Source;
use std::collections::HashMap;
use vibro_record::units::Unit;
use vibro_record::{AxisKind, Error, Finding, Meta, Place, Record, Result, Values};

const BEGIN: &str = "LabVIEW Measurement";
const END_OF_HEADER: &str = "***End_of_Header***";
const SPECIAL: [&str; 2] = ["***Start_Special***", "***End_Special***"];
/// Largest number of comments kept of a segment; each of its records stores all of them as notes.
const MOST_COMMENTS: usize = 100;

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).starts_with(BEGIN.as_bytes())
}

pub(super) fn read(source: &Source, options: &Options, _: bool) -> Result<Contents> {
    let bytes = source.all()?;
    let bytes = encoding::with_lf(bytes.into_owned());
    let text = encoding::decode(&bytes);
    let mut lines = NumberedLines { rest: text.lines(), number: 0 };
    let general = Head::of(&mut lines);
    let separator = match general.tag_value("separator").map(str::to_lowercase).as_deref() {
        Some("comma") => ',',
        Some("semicolon") => ';',
        _ => '\t',
    };
    let columns = general.tag_value("x_columns").unwrap_or("One").to_lowercase();
    let (mut records, mut findings, mut missed) = (Vec::new(), Vec::new(), Missing::default());
    let mut segments = 0;
    loop {
        let mut behind = lines.clone();
        let more = behind.next().is_some();
        let head = Head::of(&mut lines);
        if !head.ended && more && segments > 0 {
            let place = in_line(behind.number);
            return Err(Error::input(place, "a line behind a segment that begins no head", END_OF_HEADER)
                .hint("take out the blank line above it, or this line and all behind it"));
        }
        if !head.ended {
            break;
        }
        segments += 1;
        let segment = Segment::read(&mut lines, &general, &head, separator, &columns)?;
        let number = (segments > 1).then_some(segments);
        records.extend(segment.records(source, number, options, &mut findings, &mut missed)?);
    }
    if records.is_empty() {
        return Err(Error::usage("a LabVIEW measurement without values", "at least one segment with values"));
    }
    findings.extend(missing::kept(missed.check("missing value", "at", options.allow_missing)?));
    Ok(Contents::of(records, findings))
}

/// Lines with their numbers.
#[derive(Clone)]
struct NumberedLines<'a> {
    rest: std::str::Lines<'a>,
    number: u64,
}

impl<'a> Iterator for NumberedLines<'a> {
    type Item = &'a str;

    /// The next line outside special blocks.
    fn next(&mut self) -> Option<&'a str> {
        let mut special = false;
        loop {
            self.number += 1;
            let line = self.rest.next()?;
            let mark = |mark: &str| line.trim_start().starts_with(mark);
            if !special && !mark(SPECIAL[0]) {
                return Some(line);
            }
            special = !mark(SPECIAL[1]);
        }
    }
}

/// Whether a line is a row of values: its first cell with text is a number or marks a missing value, or all
/// its cells are blank.
fn is_row(line: &str, separator: char) -> bool {
    let cell = line.split(separator).map(str::trim).find(|cell| !cell.is_empty()).unwrap_or_default();
    number::either(cell.as_bytes()).is_some() || number::is_missing(cell.as_bytes())
}

/// A header: tags in lower case, each with its values, indexed by the column of the rows below.
#[derive(Debug, Default)]
struct Head<'a> {
    tags: HashMap<String, Vec<&'a str>>,
    /// Tags as written in the file, for notes.
    notes: Vec<(String, String)>,
    /// Whether `***End_of_Header***` was found: after the last segment there is no header.
    ended: bool,
}

impl<'a> Head<'a> {
    fn of(lines: &mut NumberedLines<'a>) -> Head<'a> {
        let mut head = Head::default();
        for line in lines {
            if line.starts_with(END_OF_HEADER) {
                head.ended = true;
                break;
            }
            // A tag states the separator, so it is not known yet. No tag's name contains one of these
            // characters.
            let mark = line.find(['\t', ',', ';']).unwrap_or(line.len());
            let (tag, values) = line.split_at(mark);
            let separator = values.chars().next().unwrap_or('\t');
            let values: Vec<&str> = values.split(separator).map(str::trim).collect();
            let said: Vec<&str> = values.iter().copied().filter(|value| !value.is_empty()).collect();
            if !said.is_empty() {
                head.notes.push((tag.to_owned(), said.join(" ")));
                head.tags.insert(tag.trim().to_lowercase(), values);
            }
        }
        head
    }

    /// The first non-blank value of a tag.
    fn tag_value(&self, tag: &str) -> Option<&'a str> {
        self.tags.get(tag)?.iter().copied().find(|value| !value.is_empty())
    }

    /// The value of a tag in one column; `None` if it is blank.
    fn above(&self, tag: &str, column: usize) -> Option<&'a str> {
        self.tags.get(tag)?.get(column).copied().filter(|value| !value.is_empty())
    }
}

/// A column of a segment.
#[derive(Debug, Default)]
struct SegmentColumn {
    name: String,
    values: Vec<f64>,
    /// Printed digits of the values; they give the resolution.
    digits: super::text::Digits,
}

/// General header, own header and columns of a segment.
struct Segment<'h, 'a> {
    general: &'h Head<'a>,
    head: &'h Head<'a>,
    /// Columns of the rows: channels, and X columns before them.
    columns: Vec<SegmentColumn>,
    /// Index of each channel's column, and of its X column if it has one.
    channels: Vec<(usize, Option<usize>)>,
    comments: Vec<String>,
}

impl<'h, 'a> Segment<'h, 'a> {
    /// Reads the names and the rows after a header, up to blank lines that no row follows.
    fn read(
        lines: &mut NumberedLines<'a>,
        general: &'h Head<'a>,
        head: &'h Head<'a>,
        separator: char,
        x_columns: &str,
    ) -> Result<Segment<'h, 'a>> {
        let names: Vec<&str> = lines.next().unwrap_or_default().split(separator).map(str::trim).collect();
        let comment = names.iter().position(|name| *name == "Comment").unwrap_or(names.len());
        let there = |column: &usize| *column < comment && !names[*column].is_empty();
        let channels: Vec<(usize, Option<usize>)> = match x_columns {
            "multi" => (1..comment).step_by(2).filter(there).map(|c| (c, Some(c - 1))).collect(),
            "one" => (1..comment).filter(there).map(|c| (c, Some(0))).collect(),
            _ => (1..comment).filter(there).map(|c| (c, None)).collect(),
        };
        if channels.is_empty() {
            let expected = "a line X_Value, then one name a channel";
            return Err(Error::input(in_line(lines.number), "no names of channels", expected));
        }
        let column = |name: &&str| SegmentColumn { name: (*name).to_owned(), ..SegmentColumn::default() };
        let mut columns: Vec<SegmentColumn> = names[..comment].iter().map(column).collect();
        let mut comments = Vec::new();
        let mut decimal = general.tag_value("decimal_separator").and_then(|mark| mark.bytes().next());
        let (mut row, mut blank, mut ahead) = (0, 0, lines.clone());
        while let Some(line) = ahead.next() {
            if line.trim().is_empty() {
                // A blank line between rows is a row of missing values.
                (blank, *lines) = (blank + 1, ahead.clone());
                continue;
            }
            if blank > 0 && !is_row(line, separator) {
                break;
            }
            (row, blank, *lines) = (row + blank, 0, ahead.clone());
            let decimal =
                *decimal.get_or_insert(if line.contains('.') || separator == ',' { b'.' } else { b',' });
            for (i, field) in line.split(separator).map(str::trim).enumerate() {
                let Some(column) = columns.get_mut(i) else {
                    if !field.is_empty() && comments.len() < MOST_COMMENTS {
                        comments.push(format!("row {}: {field}", row + 1));
                    }
                    continue;
                };
                let value = match number::parse_with(field.as_bytes(), decimal) {
                    Some(value) => value,
                    None if field.is_empty() => continue,
                    None if number::is_missing(field.as_bytes()) => f64::NAN,
                    None => {
                        let found = format!("{field:?} in the column {:?}", column.name);
                        return Err(Error::input(in_line(lines.number), found, "a number"));
                    }
                };
                // A blank cell between values is a missing value; blank cells after the last value do not
                // count.
                column.values.resize(row, f64::NAN);
                column.values.push(value);
                column.digits.take(field.as_bytes(), decimal, value);
            }
            row += 1;
        }
        Ok(Segment { general, head, columns, channels, comments })
    }

    /// One record for each channel with values. From the second segment on, names end with its number, as
    /// `a (2)`.
    fn records(
        self,
        source: &Source,
        number: Option<usize>,
        options: &Options,
        findings: &mut Vec<Finding>,
        missed: &mut Missing,
    ) -> Result<Vec<Record>> {
        let mut records = Vec::new();
        for (c, x) in &self.channels {
            let column = &self.columns[*c];
            let said = |tag: &str| self.head.above(tag, *c);
            if column.values.is_empty() {
                findings.push(Finding::note("variable-empty").name("variable", column.name.as_str()));
                continue;
            }
            let Name { name, unit } = Name::parse(&column.name);
            let name = number.map_or(name.clone(), |n| format!("{name} ({n})"));
            let mut meta = Meta::new(name, Unit::opaque(""));
            meta.notes = [&self.general.notes[..], &self.head.notes].concat();
            meta.notes.extend(self.comments.iter().map(|text| ("Comment".to_owned(), text.clone())));
            meta.step("read", &[("file", &source.name()), ("format", &"lvm")]);
            let mut values = Values::Real(column.values.clone());
            for i in missing::mark(&mut values) {
                missed.take(&Place::default(), format!("{} of {:?}", i + 1, column.name));
            }
            let n = values.len();
            let declared = said("samples").and_then(|text| text.parse::<usize>().ok()).filter(|d| *d > n);
            meta.declared_n = declared;
            meta.findings.extend(declared.map(|declared| assemble::fewer(declared, n)));
            let factor = options.adopt(&mut meta, said("y_unit_label").or(unit.as_deref()));
            to_si(&mut values, factor)?;
            let (x, resampled) = (x.map(|x| &self.columns[x]), options.resample.is_some());
            let axis = self.abscissa(*c, x, n, resampled, &mut meta).axis(n, options, &mut meta);
            records.push(assemble::record(meta, axis, values, Spectral::default())?);
        }
        Ok(records)
    }

    /// The abscissa of a channel. `X0` and `Delta_X` of the header have more digits than an X column: they
    /// are used if they agree with it or there is none. Otherwise the X column is used.
    fn abscissa(
        &self,
        channel: usize,
        x: Option<&SegmentColumn>,
        n: usize,
        resampled: bool,
        meta: &mut Meta,
    ) -> Abscissa {
        let frequency =
            self.head.above("x_dimension", channel).is_some_and(|d| d.eq_ignore_ascii_case("frequency"));
        let kind = if frequency { AxisKind::Frequency } else { AxisKind::Time };
        let number = |tag: &str| number::either(self.head.above(tag, channel)?.as_bytes());
        let (start, step) = (number("x0").unwrap_or(0.0), number("delta_x"));
        let stated = step.map(|step| (start, step));
        let x = x.filter(|x| n > 1 && x.values.len() >= n && x.values.iter().all(|v| v.is_finite()));
        let Some(x) = x else { return Abscissa::even(kind, stated) };
        let (values, resolution) = (&x.values[..n], x.digits.resolution());
        let agrees = |(start, step): &(f64, f64)| {
            let last = start + step * (n - 1) as f64;
            (start - values[0]).abs() <= resolution && (last - values[n - 1]).abs() <= 2.0 * resolution
        };
        let label = format!("column {:?}", x.name);
        let JudgedAxis { axis, step_relative_std, found } =
            from_values(kind.clone(), values.to_vec(), resolution, &label, resampled);
        if let (Some(stated), Some(step)) = (stated, axis.step()) {
            if agrees(&stated) {
                return Abscissa::even(kind, Some(stated));
            }
            if (step / stated.1 - 1.0).abs() > 1e-3 {
                let found = Finding::caution("header-step-differs").name("column", label.as_str());
                meta.found(found.number("header", stated.1).number("step", step));
            }
        }
        // For an uneven column, `Abscissa::axis` adds the finding later.
        meta.findings.extend(found.filter(|_| axis.step().is_some()));
        meta.clock = step_relative_std;
        Abscissa::of(axis)
    }
}

#[cfg(test)]
mod tests;
