//! Converts texts of any encoding to UTF-8 or Latin-1.

use super::encoding;
use crate::limit::Limit;
use crate::source::Source;
use std::borrow::Cow;
use vibro_record::{Place, Result};

/// A text and its first lines, before its rows are read.
pub struct Text<'a> {
    /// UTF-8 or Latin-1, with LF or CR LF.
    pub source: &'a Source,
    /// First whole lines, without the end mark of DOS (0x1A).
    pub head: Cow<'a, str>,
    /// Encoding of the file, if not UTF-8.
    pub encoding: Option<&'static str>,
}

impl<'a> Text<'a> {
    pub fn of(source: &'a Source, encoding: Option<&'static str>) -> Text<'a> {
        let head = source.head();
        let cut = source.len() > head.len() as u64;
        let whole = if cut { head.iter().rposition(|b| *b == b'\n').unwrap_or(0) } else { head.len() };
        let whole = &head[..whole];
        let ends = whole.iter().rposition(|b| *b != 0x1a).map_or(0, |last| last + 1);
        Text { source, head: encoding::decode(&whole[..ends]), encoding }
    }

    /// Whether the file name ends as that of a table. Then one column is enough, and the number of names
    /// need not match the rows.
    pub fn called_csv(&self) -> bool {
        matches!(self.source.extension().as_str(), "csv" | "tsv") || self.source.is_sheet()
    }
}

/// Passes a source to `read`, after converting UTF-16, other scripts and lone CRs to UTF-8 with LF.
pub fn with_text<T>(source: &Source, limit: Limit, read: impl FnOnce(&Text) -> Result<T>) -> Result<T> {
    let head = source.head();
    let cut = source.len() > head.len() as u64;
    if encoding::is_utf16(head) || encoding::foreign(head).is_some() || encoding::lone_cr(head, cut) {
        // Memory for the bytes, and for text of twice their size.
        limit.hold(3.0 * source.len() as f64)?;
    }
    let converted = if encoding::is_utf16(head) {
        Some(encoding::decode(&source.all()?).into_owned().into_bytes())
    } else if let Some(encoding) = encoding::foreign(head) {
        Some(encoding.decode(&source.all()?).0.into_owned().into_bytes())
    } else if encoding::lone_cr(head, cut) {
        Some(source.all()?.into_owned())
    } else {
        None
    };
    let converted =
        converted.map(|bytes| Source::memory(source.path(), encoding::with_lf(bytes))).transpose()?;
    read(&Text::of(converted.as_ref().unwrap_or(source), encoding::name(head)))
}

/// Place of an error; the reader adds the file.
pub fn in_line(line: u64) -> Place {
    Place { line: Some(line), ..Place::default() }
}

/// The first 40 characters of a text, for messages.
pub fn shorten(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { format!("{short}…") } else { short }
}
