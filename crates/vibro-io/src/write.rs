//! Writes records to files that other programs read.
//!
//! Values are written in the SI units of the records. Facts that a format cannot hold are lost or refused:
//! see each writer. Findings are never written; of history and notes, only a few facts are written, in
//! header lines and remarks.
//!
//! ```
//! use vibro_io::Reader;
//! use vibro_io::write::{Storage, Target};
//! let recording = Reader::new().from_reader("x.csv", "t [ms],v [mm/s]\n0.0,1\n0.5,2\n".as_bytes())?;
//! let mut out = Vec::new();
//! Target::of("x.tsv")?.write(&recording.records, Storage::default(), &mut out)?;
//! assert_eq!(String::from_utf8_lossy(&out), "time [s]\tv [m/s]\n0\t0.001\n0.0005\t0.002\n");
//! # Ok::<(), vibro_record::Error>(())
//! ```

pub mod csv;
mod listed;
pub mod npy;
pub mod uff58;
pub mod wav;

use std::io::Write;
use std::path::Path;
pub use uff58::{Precision, Storage};
use vibro_record::{Error, Record, Result};

/// A format to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Target {
    /// Universal file, data set 58: text, or binary if requested.
    Uff,
    /// Universal file, data set 58b: always binary.
    UffBinary,
    /// Columns with names and units between commas.
    Csv,
    /// Columns with names and units between tabs.
    Tsv,
    /// Wave audio of 64-bit floats, or of 32-bit floats in single precision.
    Wav,
    /// numpy's array file.
    Npy,
}

/// Formats, their file endings, and their names.
const TARGETS: [(Target, &str, &str); 8] = [
    (Target::Uff, "uff", "uff"),
    (Target::Uff, "unv", "uff"),
    (Target::Uff, "58", "uff"),
    (Target::UffBinary, "ufb", "uff"),
    (Target::Csv, "csv", "csv"),
    (Target::Tsv, "tsv", "tsv"),
    (Target::Wav, "wav", "wav"),
    (Target::Npy, "npy", "npy"),
];

impl Target {
    /// The format that a file name's ending means, in upper or lower case.
    ///
    /// # Errors
    /// If no format has this ending.
    pub fn of(path: impl AsRef<Path>) -> Result<Target> {
        let path = path.as_ref();
        let ending = path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase());
        TARGETS.iter().find(|row| row.1 == ending).map(|row| row.0).ok_or_else(|| {
            let what = if ending.is_empty() { "has no ending".into() } else { format!("ends in .{ending}") };
            Error::usage(
                format!("{} {what}, which is no format that can be written", path.display()),
                "a name that ends in .uff, .unv or .58 (UFF-58), .ufb (UFF-58b), .csv, .tsv, .wav or .npy",
            )
            .hint("give the file to write one of these endings")
        })
    }

    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        TARGETS.iter().find(|row| row.0 == self).map_or("", |row| row.2)
    }

    /// Writes records in this format; `storage` sets how a universal file stores its numbers, and the
    /// precision of a wave file.
    ///
    /// # Errors
    /// If the format cannot hold these records together, with the reason, or if the output cannot be
    /// written.
    pub fn write(self, records: &[Record], storage: Storage, out: &mut impl Write) -> Result<()> {
        match self {
            Target::Uff => uff58::write_uff58(records, out, storage),
            Target::UffBinary => uff58::write_uff58(records, out, Storage { binary: true, ..storage }),
            Target::Csv => csv::write(records, ',', out),
            Target::Tsv => csv::write(records, '\t', out),
            Target::Wav => wav::write(records, storage.precision, out),
            Target::Npy => npy::write(records, out),
        }
    }
}

#[cfg(test)]
mod tests;
