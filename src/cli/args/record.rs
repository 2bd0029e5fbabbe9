//! What commands on the record of a file have in common, as typed.

use crate::analysis::Source;
use crate::campaign::{Channel, Reading};
use crate::error::Result;
use std::path::{Path, PathBuf};

/// Which record, how its file is read, and where results go.
#[derive(Debug, clap::Args)]
pub struct Record {
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl Record {
    /// Measures the record of a file, with a bar of progress.
    ///
    /// # Errors
    /// As `measure`.
    pub fn measured<T>(
        &self,
        file: &Path,
        json: bool,
        measure: impl FnOnce(&Source<'_>) -> Result<T>,
    ) -> Result<T> {
        let name = file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let bar = super::super::progress::bar(json);
        bar.set_message("samples");
        let progress = |done: usize, all: usize| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        };
        let found = measure(&Source::typed(&name, file, &self.channel, &self.reading, &progress));
        // Before a complaint, too.
        bar.finish_and_clear();
        found
    }
}
