//! `vibro response`, as typed.

use super::{Sweep, Taking};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Response {
    #[command(flatten)]
    pub sweep: Sweep,
    #[command(flatten)]
    pub taking: Taking,
    /// Folder for the curve as SVG, PNG and CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
