//! `vibro model response`, as typed.

use super::Scene;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct ModelResponse {
    #[command(flatten)]
    pub scene: Scene,
    /// Lowest excitation frequency in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub from: f64,
    /// Highest excitation frequency in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub to: f64,
    /// Number of frequencies
    #[arg(long, value_name = "N", default_value_t = 400)]
    pub points: usize,
    /// Cycles of the excitation from impact to impact
    #[arg(long, value_name = "Q", default_value_t = 1)]
    pub cycles: u32,
    /// Standard uncertainty of the gap in m: a motion nearer to grazing is not relied on
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub gap_std: Option<f64>,
    /// Folder for the figure as SVG and PNG, and the motions as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
