//! Text of analysers, loggers and spreadsheets: dialect → rows → records.
//!
//! A [`dialect`] says, as data, where names, units and abscissa stand and how a row is cut. It is found out from the first
//! bytes: [`table`] knows tables with names above their columns, [`numbers`] plain columns of numbers. The dialect of another
//! instrument is one more function in the list of [`dialect`]. Clean rows are read in parallel ([`fast`]), all others one by
//! one ([`rows`]), so that a complaint names line and column. Columns become records in [`records`].

mod axis;
mod dialect;
pub(crate) mod encoding;
mod fast;
mod fixed;
mod footer;
mod gaps;
mod header;
mod lines;
mod names;
mod numbers;
mod records;
mod rows;
mod table;
mod tail;

use crate::format::Survey;
use crate::reader::{Options, Recording};
use crate::{Header, Source, Summary, SweepList, missing};
use dialect::{Abscissa, Cell, Dialect, Head};
use fast::Shape;
use rows::Rows;
use std::path::Path;
use vibro_record::{Error, Finding, Place, Result, Values};

/// A text and what is known of it before its rows are read.
pub(crate) struct Text {
    /// UTF-8 or Latin-1, with LF or CR LF.
    source: Source,
    head: Head,
    tail: Vec<u8>,
    /// Its encoding, where that is not UTF-8.
    encoding: Option<&'static str>,
}

impl Text {
    /// Turns UTF-16 and lone CRs in the head into UTF-8 with LF; everything else stays on disk.
    fn of(source: &Source) -> Result<Text> {
        let bytes = source.head()?;
        let encoding = encoding::name(&bytes);
        let converted = if encoding::is_utf16(&bytes) {
            Some(encoding::decode(&source.all()?).into_owned().into_bytes())
        } else if encoding::lone_cr(&bytes, source.len() > bytes.len() as u64) {
            Some(source.all()?)
        } else {
            None
        };
        let source = match converted {
            Some(bytes) => Source::memory(source.path(), encoding::with_lf(bytes))?,
            None => source.clone(),
        };
        Ok(Text { head: Head::of(&source)?, tail: tail::of(&source)?, source, encoding })
    }

    fn path(&self) -> &Path {
        self.source.path()
    }

    /// The dialect of a table with names, which must be there.
    fn table(&self, options: &Options) -> Result<Dialect> {
        dialect::of_table(&self.head, options)?.ok_or_else(|| {
            Error::input(
                Place::file(self.path()),
                "no row of numbers with names of columns right above it",
                "e.g. `time [s],velocity [mm/s]`, then rows of numbers",
            )
            .hint("read numbers without names as the format ascii")
            .setting("format")
        })
    }
}

/// Whether a text begins with a table under names.
pub(crate) fn is_table(head: &[u8], source: &Source) -> bool {
    // Names need a letter that numbers do not hold; most files of numbers have none.
    let letter = |b: &u8| !b.is_ascii() || b.is_ascii_alphabetic() && !b"eEdDqQijIJ".contains(b);
    let words = head[..head.len().min(encoding::LOOK)].iter().any(letter);
    let found = || dialect::of_table(&Text::of(source)?.head, &Options::default());
    words && encoding::is_text(head) && found().is_ok_and(|found| found.is_some())
}

/// Text of any kind: this is the last format tried.
pub(crate) fn is_text(head: &[u8], _: &Source) -> bool {
    encoding::is_text(head)
}

pub(crate) fn read_table(source: &Source, options: &Options) -> Result<Recording> {
    let text = Text::of(source)?;
    read(&text, &text.table(options)?, options)
}

pub(crate) fn read_numbers(source: &Source, options: &Options) -> Result<Recording> {
    let text = Text::of(source)?;
    read(&text, &dialect::of_numbers(&text.head, options)?, options)
}

pub(crate) fn survey_table(source: &Source, options: &Options) -> Result<Survey> {
    let text = Text::of(source)?;
    survey(&text, &text.table(options)?, options)
}

pub(crate) fn survey_numbers(source: &Source, options: &Options) -> Result<Survey> {
    let text = Text::of(source)?;
    survey(&text, &dialect::of_numbers(&text.head, options)?, options)
}

fn read(text: &Text, dialect: &Dialect, options: &Options) -> Result<Recording> {
    let shape = Shape::of(dialect, &text.head);
    let clean = shape.map(|shape| fast::read(&text.source, &shape)).transpose()?.flatten();
    let rows = match clean {
        Some(columns) => Rows { columns, ..Rows::default() },
        None => carefully(text, dialect, options)?,
    };
    let mut findings: Vec<Finding> =
        tail::cut_off(&text.tail, dialect.separator, dialect.decimal).into_iter().collect();
    if rows.remarks > rows.kept.len() {
        let found = Finding::note("remarks-dropped").count("n", rows.remarks);
        findings.push(found.count("kept", rows.kept.len()));
    }
    findings.extend(rows.footer.as_ref().map(footer::Footer::finding));
    findings.extend(missing::kept(rows.missing));
    let rows = bridged(rows, dialect, &mut findings);
    if dialect.decimal == b',' && dialect.columns == 1 && dialect.abscissa == Abscissa::Named {
        findings.push(Finding::caution("decimal-comma-assumed"));
    }
    let records = records::build(text, dialect, rows, options, &mut findings)?;
    Ok(Recording { path: text.path().to_owned(), format: dialect.format, records, findings })
}

/// Row by row, each complaint with its place.
fn carefully(text: &Text, dialect: &Dialect, options: &Options) -> Result<Rows> {
    let bytes = text.source.all()?;
    let bytes = if encoding::lone_cr(&bytes, false) { encoding::with_lf(bytes) } else { bytes };
    let whole = encoding::decode(&bytes);
    let rows = rows::read(text.path(), whole.trim_end_matches('\u{1a}'), dialect, options.allow_missing)?;
    let alone = rows.columns.first().filter(|_| dialect.columns == 1);
    if let Some(words) = rows.footer.as_ref().filter(|_| dialect.abscissa == Abscissa::Rising)
        && (words.ends_list(alone.into_iter().flat_map(Values::magnitudes))
            || SweepList::of(&text.source).is_some())
    {
        return Err(Error::input(
            Place::file(text.path()),
            "names of files behind numbers",
            "numbers and nothing else",
        )
        .hint("if this is the list of a sweep, its numbers do not go with its names: correct it and give it to `vibro response`"));
    }
    Ok(rows)
}

/// Rows without a first value, where the first column is an abscissa.
fn bridged(mut rows: Rows, dialect: &Dialect, findings: &mut Vec<Finding>) -> Rows {
    if rows.missing > 0 && dialect.abscissa == Abscissa::Rising {
        findings.extend(gaps::bridge(&mut rows.columns));
    }
    rows
}

/// Streams a clean single column; anything else is read as a whole.
fn survey(text: &Text, dialect: &Dialect, options: &Options) -> Result<Survey> {
    let shape = Shape::of(dialect, &text.head).filter(|_| dialect.columns == 1 && dialect.cell == Cell::Real);
    if let Some(shape) = shape {
        let mut summary = Summary::default();
        let bounds = (shape.first_byte, text.source.len());
        if fast::scan(&text.source, &shape, bounds, |v| summary.push(v.abs()))?.is_some() && summary.n > 0 {
            return streamed(text, dialect, options, &summary);
        }
    }
    let recording = read(text, dialect, options)?;
    Ok((recording.records.iter().map(Header::of).collect(), recording.findings))
}

/// The header of a column whose values are gone: the largest stands for them.
fn streamed(text: &Text, dialect: &Dialect, options: &Options, summary: &Summary) -> Result<Survey> {
    let mut findings: Vec<Finding> =
        tail::cut_off(&text.tail, dialect.separator, dialect.decimal).into_iter().collect();
    let largest = summary.max.map_or(0.0, |(_, max)| max);
    let rows =
        Rows { columns: vec![Values::Real(vec![largest])], counted: Some(summary.n), ..Rows::default() };
    let records = records::build(text, dialect, rows, options, &mut findings)?;
    let headers = records.iter().map(|record| {
        let mut header = Header::of(record);
        let max_abs = header.max_abs;
        header = header.summed(summary, 1.0, record.axis());
        Header { max_abs, ..header }
    });
    Ok((headers.collect(), findings))
}

/// The first characters of a text, for messages.
fn shorten(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { format!("{short}…") } else { short }
}

#[cfg(test)]
mod tests;
