//! The ordered table of formats.

#[cfg(feature = "hdf5")]
use super::hdf5;
use super::reader::Options;
use super::{Source, lvm, mat, tdms, text, uff, wav};
use crate::held::Contents;
use vibro_record::Result;

/// A readable format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Universal File Format with data set 58 or 58b.
    Uff,
    /// RIFF or RF64 wave.
    Wav,
    /// HDF5.
    Hdf5,
    /// MATLAB's MAT-file, of version 7.3 too.
    Mat,
    /// NI's TDMS.
    Tdms,
    /// LabVIEW measurement.
    Lvm,
    /// Named columns.
    Csv,
    /// Columns of numbers, with or without header lines.
    Ascii,
}

/// How one format is told apart and read.
pub(super) struct Entry {
    pub format: Format,
    pub name: &'static str,
    /// Whether the first bytes are of this format.
    pub sniff: fn(head: &[u8], source: &Source) -> bool,
    /// Reads the records of a source; for a `survey` the ends of their values are enough where the format
    /// can tell them in less memory.
    pub read: fn(&Source, &Options, survey: bool) -> Result<Contents>,
}

/// Binary formats with a signature first, then text formats from the strictest to the loosest.
pub(super) const TABLE: &[Entry] = &[
    Entry { format: Format::Wav, name: "wav", sniff: wav::sniff, read: wav::read },
    #[cfg(feature = "hdf5")]
    Entry { format: Format::Hdf5, name: "hdf5", sniff: hdf5::sniff, read: hdf5::read },
    Entry { format: Format::Mat, name: "mat", sniff: mat::sniff, read: mat::read },
    Entry { format: Format::Tdms, name: "tdms", sniff: tdms::sniff, read: tdms::read },
    Entry { format: Format::Lvm, name: "lvm", sniff: lvm::sniff, read: lvm::read },
    Entry { format: Format::Uff, name: "uff", sniff: uff::sniff, read: uff::read },
    Entry { format: Format::Csv, name: "csv", sniff: text::is_table, read: text::read_table },
    Entry {
        format: Format::Ascii,
        name: "ascii",
        sniff: |head, _| text::encoding::is_text(head),
        read: text::read_numbers,
    },
];

impl Format {
    /// The format whose first bytes a source has.
    pub(super) fn of(source: &Source) -> Option<&'static Entry> {
        TABLE.iter().find(|e| (e.sniff)(source.head(), source))
    }

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
