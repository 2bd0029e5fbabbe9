//! Where a record comes from: a table of a campaign, or a command line.

use super::{Analysis, Progress};
use crate::campaign::{Channel, Entry, Reading};
use crate::error::{Error, Result};
use crate::read::{Reader, Recording};
use crate::record::{Fact, Finding, Trace};
use crate::units::Unit;
use std::path::{Path, PathBuf};

/// A file, how it is read, and who is told of the progress.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Name of the record for people.
    pub name: &'a str,
    /// The file.
    pub path: &'a Path,
    /// Which record of the file.
    pub channel: &'a Channel,
    /// What the file does not say.
    pub reading: &'a Reading,
    /// Path of a further file that a key names.
    pub beside: &'a dyn Fn(&'static str, &Path) -> Result<PathBuf>,
    /// Told how many samples are done, of how many.
    pub progress: &'a dyn Progress,
}

impl Source<'_> {
    /// A reader that knows what is stated.
    ///
    /// # Errors
    /// If what is stated cannot be.
    pub fn reader(&self) -> Result<Reader> {
        self.reading.reader()
    }

    /// The recording, in which a base band gives the sampling rate.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn recording(&self) -> Result<Recording> {
        self.reader()?.rate_of_base_band().from_path(self.path)
    }

    /// The trace that is meant of a recording.
    ///
    /// # Errors
    /// If there is no such trace.
    pub fn trace(&self, recording: &Recording) -> Result<Trace> {
        let trace = recording.trace(self.channel.channel.as_deref(), self.channel.calibration)?;
        self.contradicted(&trace.meta.findings)?;
        Ok(trace)
    }

    /// Refuses a stated unit of another quantity than that of the file, which only a calibration leads to.
    pub(super) fn contradicted(&self, findings: &[Finding]) -> Result<()> {
        let unit = |found: &Finding, name| match found.fact(name) {
            Some(Fact::Name(symbol)) => Unit::parse(symbol),
            _ => None,
        };
        for found in findings.iter().filter(|f| f.code == "unit-overrides-file") {
            if let (Some(file), Some(used), None) =
                (unit(found, "file"), unit(found, "used"), self.channel.calibration)
                && file.quantity() != used.quantity()
            {
                let wrong = format!("the unit {} for a record in {}", used.symbol(), file.symbol());
                let expected = format!("a unit of {}, or a calibration", file.quantity());
                return Err(Error::usage(wrong, expected).setting("unit").setting("calibration"));
            }
        }
        Ok(())
    }

    /// Path of a further file, where a key names one.
    ///
    /// # Errors
    /// If it lies where none may lie, or does not exist.
    pub fn further(&self, key: &'static str, file: Option<&PathBuf>) -> Result<Option<PathBuf>> {
        file.map(|file| (self.beside)(key, file)).transpose()
    }
}

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}

/// Name of a table for people: that stated, else the file's, else that of its section with this number.
pub(crate) fn name_of<K: Analysis>(entry: &Entry<K>, number: usize) -> String {
    let own = entry.name.clone().or_else(|| entry.file.as_deref().map(file_name));
    own.unwrap_or_else(|| format!("{} {number}", K::SECTION))
}
