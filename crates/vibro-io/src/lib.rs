//! Reads files of analysers, vibrometers and recorders to records, and writes records to files.
//!
//! After `cargo add vibro-io`, a channel of any file is an array in SI units:
//!
//! ```no_run
//! fn main() -> vibro_io::record::Result<()> {
//!     let recording = vibro_io::Reader::new().from_path("bench.tdms")?;
//!     let velocity = recording.trace(Some("velocity"), None)?; // by its name, or its number from 1
//!     let unit = velocity.meta.unit.symbol();
//!     println!("{:?} Hz, {} values in {unit}", velocity.rate(), velocity.values.len());
//!     Ok(())
//! }
//! ```
//!
//! A [`Reader`] detects the format from the first bytes, reads all records of a file, and reports its
//! assumptions as [findings](record::Finding). What the file does not state is set on the reader.
//!
//! ```
//! use vibro_io::{Reader, record::Record};
//!
//! let text = "Messung: 7\nZeit [ms];Weg [mm]\n0,0;1,5\n0,5;-2\n1,0;0,25\n";
//! let recording = Reader::new().from_reader("bench.csv", text.as_bytes())?;
//! let Record::Trace(trace) = &recording.records[0] else { panic!("a time trace") };
//! assert_eq!((trace.meta.name.as_str(), trace.meta.unit.symbol()), ("Weg", "m"));
//! assert_eq!((trace.rate(), trace.values[1]), (Some(2000.0), -2e-3));
//! assert!(recording.all_findings().is_empty());
//! # Ok::<(), vibro_io::record::Error>(())
//! ```
//!
//! | format | module | what it is |
//! |---|---|---|
//! | `wav` | `wav` | RIFF and RF64 wave |
//! | `hdf5` | `hdf5` | HDF5 of any program, MATLAB 7.3 (feature `hdf5`) |
//! | `mat` | `mat` | MATLAB level 4 and 5 |
//! | `tdms` | `tdms` | LabVIEW's and NI-DAQmx' TDMS |
//! | `lvm` | `lvm` | LabVIEW measurement |
//! | `uff` | `uff` | Universal File Format, data sets 58 and 58b |
//! | `csv`, `ascii` | `text` | tables with names; columns of numbers |
//!
//! A zip archive or a workbook (features `zip`, `sheets`) is read as the one file or sheet in it that has
//! the most rows. A path such as `walk.zip/Gyroscope.csv` names another.
//!
//! [`Reader::stream`] reads long time traces block by block, [`SweepReader`] a sweep of spectra.
//! [`mod@write`] writes records to files.

mod assemble;
mod binary;
mod choose;
mod folder;
mod foreign;
mod format;
#[cfg(feature = "hdf5")]
mod hdf5;
mod held;
mod level;
mod limit;
mod lvm;
mod magnitude;
mod mat;
mod memory;
mod missing;
mod number;
mod options;
mod packed;
mod reader;
mod recording;
mod registry;
mod repeated;
mod source;
mod span;
mod steps;
mod sweep;
mod sweep_list;
mod tdms;
mod text;
mod uff;
mod variables;
mod wav;

pub mod write;

pub use assemble::longest_stretch;
pub use folder::{Digest, Folder, Lock, Manifest, Occupant, Owner, Staged, Walk, hexadecimal, listed, plain};
pub use format::Format;
pub use limit::Limit;
pub use magnitude::MAGNITUDE;
pub use missing::is_missing;
pub use reader::{Header, Reader};
pub use recording::Recording;
pub use repeated::repeated;
pub use steps::Steps;
pub use sweep::SweepReader;
pub use sweep_list::SweepList;
pub use vibro_record as record;

#[cfg(test)]
mod tests {
    use crate::source::Source;
    use crate::{Header, Reader, Recording};
    use std::borrow::Cow;
    use vibro_record::{Fact, Finding, Result};

    /// Reads a source, and asserts that a survey gives the same headers, findings and errors.
    pub fn read_both_ways(source: &Source) -> Result<Recording> {
        let (read, survey) = (Reader::new().read(source), Reader::new().headers(source));
        match (&read, survey) {
            (Ok(read), Ok(survey)) => {
                let headers = read.records.iter().map(Header::of).collect();
                assert_eq!(survey, (read.format, headers, read.findings.clone()), "{:?}", source.path());
            }
            (read, survey) => {
                let text = |error: Option<&vibro_record::Error>| error.map(ToString::to_string);
                assert_eq!(text(read.as_ref().err()), text(survey.as_ref().err()), "{:?}", source.path());
            }
        }
        read
    }

    /// Findings as text, numbers with six digits: `axis-uneven column=column "t" smallest=0.1`.
    pub fn texts(findings: &[Finding]) -> Vec<String> {
        let fact = |(name, fact): &(Cow<'static, str>, Fact)| match fact {
            Fact::Number(value) => format!("{name}={}", crate::assemble::short(*value)),
            Fact::Numbers(values) => format!("{name}={values:?}"),
            Fact::Name(text) => format!("{name}={text}"),
        };
        let facts = |found: &Finding| found.facts.iter().map(fact).collect::<Vec<_>>().join(" ");
        findings.iter().map(|found| format!("{} {}", found.code, facts(found))).collect()
    }

    /// Whether one of the findings, as text, has the code `code` and contains all `facts`.
    pub fn has_finding(findings: &[Finding], code: &str, facts: &[&str]) -> bool {
        texts(findings)
            .iter()
            .any(|t| t.split(' ').next() == Some(code) && facts.iter().all(|f| t.contains(f)))
    }
}
