//! `vibro convert`, as typed.

use super::Reading;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Convert {
    /// File to read
    pub input: PathBuf,
    /// File to write: .uff .unv (UFF-58), .csv .tsv, .wav, .npy
    pub output: PathBuf,
    /// Write UFF-58 as binary (58b)
    #[arg(long)]
    pub binary: bool,
    /// Write single instead of double precision, where the format has both
    #[arg(long)]
    pub single: bool,
    #[command(flatten)]
    pub reading: Reading,
}
