//! `vibro model orbit`, as typed.

use super::Scene;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Orbit {
    #[command(flatten)]
    pub scene: Scene,
    /// Excitation frequency in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub frequency: Option<f64>,
    /// Cycles of the excitation from impact to impact
    #[arg(long, value_name = "Q", default_value_t = 1)]
    pub cycles: u32,
    /// Standard uncertainty of the gap in m: a motion nearer to grazing is not relied on
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub gap_std: Option<f64>,
    /// Folder for a figure of each motion as SVG and PNG, and its course as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
