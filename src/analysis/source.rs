//! Source of a record: a table of a campaign, or a command line.

use super::progress::Progress;
use crate::campaign::{Channel, Reading};
use crate::error::Result;
use crate::read::{Folder, Reader, Recording};
use crate::record::{Trace, shown};
use std::path::{Path, PathBuf};

/// A file, its settings for reading, and the receiver of progress.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Name of the record for people.
    pub name: &'a str,
    /// The file.
    pub path: &'a Path,
    /// Channel of the file and its calibration.
    pub channel: &'a Channel,
    /// Settings for reading that the file does not state.
    pub reading: &'a Reading,
    /// Access to the files.
    pub folder: &'a Folder,
    /// Path of another file that a key names.
    pub beside: &'a dyn Fn(&'static str, &Path) -> Result<PathBuf>,
    /// Receives the number of samples done, and of all.
    pub progress: &'a dyn Progress,
}

impl Source<'_> {
    /// A reader with the stated settings.
    ///
    /// # Errors
    /// If a stated setting is impossible.
    pub fn reader(&self) -> Result<Reader> {
        Ok(self.reading.reader()?.within(self.folder))
    }

    /// The recording; a stated base band sets the sampling rate.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn recording(&self) -> Result<Recording> {
        self.reader()?.rate_of_base_band().from_path(self.path)
    }

    /// As [`Source::recording`], with values of at least the chosen channel and the channel `also`. The
    /// analysis takes `beside` times the memory of these values in addition.
    ///
    /// # Errors
    /// If the file cannot be read, or would take more memory than is allowed.
    pub fn channels(&self, also: Option<&String>, beside: f64) -> Result<Recording> {
        let only = self.channel.channel.iter().chain(also).cloned();
        let only = only.take(if self.channel.channel.is_some() { 2 } else { 0 });
        self.reader()?.rate_of_base_band().beside(beside).only(only).from_path(self.path)
    }

    /// The chosen trace of a recording.
    ///
    /// # Errors
    /// If there is no such trace.
    pub fn trace(&self, recording: &Recording) -> Result<Trace> {
        recording.trace(self.channel.channel.as_deref(), self.channel.calibration)
    }

    /// Path of another file, if a key names one.
    ///
    /// # Errors
    /// If it is outside the allowed folder or does not exist.
    pub fn further(&self, key: &'static str, file: Option<&PathBuf>) -> Result<Option<PathBuf>> {
        file.map(|file| (self.beside)(key, file)).transpose()
    }
}

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    shown(path.file_name().map_or(path, Path::new))
}
