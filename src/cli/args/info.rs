//! `vibro info`, as typed.

use crate::campaign::Reading;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Info {
    /// Measurement files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}
