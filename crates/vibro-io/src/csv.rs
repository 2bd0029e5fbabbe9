//! Named columns: CSV and TSV.
//!
//! ```text
//! # a remark                         comments behind # or %, kept as notes
//! Sample rate; 1000; Hz              preamble: `key: value`, or key and value in cells
//! time [s]; velocity [mm/s]          names, with units in the usual spellings (see `name`) …
//! s; mm/s                            … or with a second row that holds the units
//! 0,000; 1,5                         rows; comma, semicolon or tab separates, with a comma or point in numbers
//! ```
//! Every column but the abscissa is a record: a trace over time, a spectrum over frequency. Columns `X_re` and `X_im` over
//! frequency are one complex record. The whole file is read at once, for a survey too.

mod columns;
mod layout;
pub(super) mod name;
mod records;
mod rows;

use super::format::{Format, Survey};
use super::reader::{Options, Recording};
use super::source::HEAD;
use super::{Header, Source, cut_off, text};
use vibro_record::{Error, Place, Result};

pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    if !text::is_text(head) || !holds_words(head) {
        return false;
    }
    let decoded = text::decode(head);
    let mut whole = decoded.as_ref();
    if source.len() > head.len() as u64 {
        // The last line is cut off: it would have too few columns.
        whole = whole.rfind(['\n', '\r']).map_or("", |end| &whole[..end]);
    }
    layout::detect(whole, &Options::default(), named_csv(source)).is_some()
}

/// Whether any letter stands at the beginning that numbers do not hold: names need some, and most files of numbers have none.
fn holds_words(head: &[u8]) -> bool {
    head[..head.len().min(text::LOOK)]
        .iter()
        .any(|b| !b.is_ascii() || b.is_ascii_alphabetic() && !b"eEdDqQijIJ".contains(b))
}

fn named_csv(source: &Source) -> bool {
    matches!(source.extension().as_str(), "csv" | "tsv")
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let bytes = source.all()?;
    let text = text::decode(&bytes);
    let Some(layout) = layout::detect(&text, options, true) else {
        return Err(Error::input(
            Place::file(source.path()),
            "no row of numbers with names of columns right above it",
            "e.g. `time [s],velocity [mm/s]`, then rows of numbers",
        )
        .hint("numbers without names are read with --format ascii"));
    };
    let axis = records::axis_column(&layout.names);
    let at = axis.as_ref().map(|(at, _)| *at);
    let columns = columns::read(source.path(), &text, &layout, options, at)?;
    let decimal = if columns.comma { b',' } else { b'.' };
    let cut_off = cut_off::doubt(text.as_bytes(), layout.separator as u8, decimal);
    let (mut records, mut doubts) = records::build(source, layout, columns, axis, options)?;
    doubts.extend(cut_off);
    for record in &mut records {
        text::read_as(record.meta_mut(), &bytes[..bytes.len().min(HEAD)], decimal);
    }
    Ok(Recording { path: source.path().to_owned(), format: Format::Csv, records, doubts })
}

pub(super) fn survey(source: &Source, options: &Options) -> Result<Survey> {
    let recording = read(source, options)?;
    Ok((recording.records.iter().map(Header::of).collect(), recording.doubts))
}

#[cfg(test)]
mod tests;
