//! The ordered table of formats.

use super::reader::{Options, Recording};
use super::{Header, Source, mat, text, uff, wav};
use vibro_record::{Finding, Result};

/// A readable format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Universal File Format with data set 58 or 58b.
    Uff,
    /// RIFF or RF64 wave.
    Wav,
    /// MATLAB level 5 MAT-file.
    Mat,
    /// Named columns.
    Csv,
    /// Columns of numbers, with or without header lines.
    Ascii,
}

/// Headers of the records, and findings about the file as a whole.
pub(super) type Survey = (Vec<Header>, Vec<Finding>);

/// How one format is told apart and read.
pub(super) struct Entry {
    pub format: Format,
    pub name: &'static str,
    /// Whether the first bytes (at most [`super::source::HEAD`]) are of this format.
    pub sniff: fn(head: &[u8], source: &Source) -> bool,
    /// All records with their values.
    pub read: fn(&Source, &Options) -> Result<Recording>,
    /// The records without their values, in memory that does not grow with the file where the format allows; and
    /// findings about the file as a whole.
    pub survey: fn(&Source, &Options) -> Result<Survey>,
}

/// Binary formats with a signature first, then text formats from the strictest to the loosest.
pub(super) const TABLE: &[Entry] = &[
    Entry { format: Format::Wav, name: "wav", sniff: wav::sniff, read: wav::read, survey: wav::survey },
    Entry { format: Format::Mat, name: "mat", sniff: mat::sniff, read: mat::read, survey: mat::survey },
    Entry { format: Format::Uff, name: "uff", sniff: uff::sniff, read: uff::read, survey: uff::survey },
    Entry {
        format: Format::Csv,
        name: "csv",
        sniff: text::is_table,
        read: text::read_table,
        survey: text::survey_table,
    },
    Entry {
        format: Format::Ascii,
        name: "ascii",
        sniff: text::is_text,
        read: text::read_numbers,
        survey: text::survey_numbers,
    },
];

impl Format {
    /// Name on the command line and in JSON.
    pub fn name(self) -> &'static str {
        TABLE.iter().find(|e| e.format == self).map_or("unknown", |e| e.name)
    }

    /// The format with this name.
    pub fn from_name(name: &str) -> Option<Format> {
        TABLE.iter().find(|e| e.name.eq_ignore_ascii_case(name)).map(|e| e.format)
    }

    /// Names of all formats, in the order in which they are tried.
    pub fn names() -> Vec<&'static str> {
        TABLE.iter().map(|e| e.name).collect()
    }
}
