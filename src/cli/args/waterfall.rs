//! `vibro waterfall`, as typed.

use super::{Sweep, Taking};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Waterfall {
    #[command(flatten)]
    pub sweep: Sweep,
    #[command(flatten)]
    pub taking: Taking,
    /// Highest frequency drawn, in Hz [default: the base band]
    #[arg(long)]
    pub fmax: Option<f64>,
    /// Folder for waterfall and map as SVG and PNG, and the matrix as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
