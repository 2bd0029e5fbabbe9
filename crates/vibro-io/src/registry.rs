//! The table of formats, in the order in which they are tried: how each is detected and read.

use crate::format::Format;
use crate::held::Contents;
use crate::options::Options;
use crate::source::Source;
use vibro_record::Result;

/// How one format is detected and read.
pub struct Entry {
    pub format: Format,
    /// Usual endings of its files, in lower case.
    pub endings: &'static [&'static str],
    /// Whether its reader keeps all bytes of the file in memory, beside values that take at least as much.
    pub whole: bool,
    /// Whether a source that begins with the bytes `head` is in this format.
    pub sniff: fn(head: &[u8], source: &Source) -> bool,
    /// Reads the records of a source. For a `survey`, a format may read only the smallest and largest
    /// values, where that needs less memory.
    pub read: fn(&Source, &Options, survey: bool) -> Result<Contents>,
}

/// In the order of detection: binary formats with a signature, then text formats from the strictest to the
/// loosest.
#[rustfmt::skip] // a table
pub const TABLE: &[Entry] = &[
    Entry { format: Format::Wav, endings: &["wav"], whole: false, sniff: crate::wav::layout::sniff, read: crate::wav::read },
    #[cfg(feature = "hdf5")]
    Entry { format: Format::Hdf5, endings: &["h5", "hdf5"], whole: false, sniff: crate::hdf5::sniff, read: crate::hdf5::read },
    Entry { format: Format::Mat, endings: &["mat"], whole: true, sniff: crate::mat::sniff, read: crate::mat::read },
    Entry { format: Format::Tdms, endings: &["tdms"], whole: false, sniff: crate::tdms::sniff, read: crate::tdms::read },
    Entry { format: Format::Lvm, endings: &["lvm"], whole: true, sniff: crate::lvm::sniff, read: crate::lvm::read },
    Entry { format: Format::Uff, endings: crate::uff::ENDINGS, whole: true, sniff: crate::uff::sniff, read: crate::uff::read },
    Entry { format: Format::Csv, endings: &["csv", "tsv"], whole: false, sniff: crate::text::is_table, read: crate::text::read_table },
    Entry {
        format: Format::Ascii, endings: &["txt", "dat", "asc"], whole: false,
        sniff: |head, _| crate::text::encoding::is_text(head), read: crate::text::read_numbers,
    },
];

/// Records that were made in memory: no format of a file.
const MEMORY: Entry = Entry {
    format: Format::Memory,
    endings: &[],
    whole: false,
    sniff: |_, source| source.in_records().is_some(),
    read: crate::memory::read,
};

impl Entry {
    /// The first format that the first bytes of a source fit.
    pub fn of(source: &Source) -> Option<&'static Entry> {
        [&MEMORY].into_iter().chain(TABLE).find(|e| (e.sniff)(source.head(), source))
    }
}

impl Format {
    /// The format with this name.
    pub fn from_name(name: &str) -> Option<Format> {
        TABLE.iter().map(|e| e.format).find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// Names of all formats, in the order in which they are tried.
    pub fn names() -> Vec<&'static str> {
        TABLE.iter().map(|e| e.format.name()).collect()
    }

    /// Usual endings of the files of all formats, in lower case.
    pub fn endings() -> impl Iterator<Item = &'static str> {
        TABLE.iter().flat_map(|e| e.endings).copied()
    }
}
