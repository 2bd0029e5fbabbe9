//! `vibro excitation`, as typed.

use super::Sweep;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Excitation {
    #[command(flatten)]
    pub sweep: Sweep,
    /// Write the two hand-over files of sineswpf, with force and with response names
    #[arg(long, num_args = 2, value_names = ["FORCE", "RESPONSE"])]
    pub write_lists: Option<Vec<PathBuf>>,
}
