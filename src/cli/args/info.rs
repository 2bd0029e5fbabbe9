//! `vibro info`, as typed.

use super::Reading;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Info {
    /// Measurement files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}
