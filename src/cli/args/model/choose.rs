//! `vibro model choose`, as typed.

use super::Scene;
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Choose {
    #[command(flatten)]
    pub scene: Scene,
    /// Excitation frequency in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, conflicts_with_all = ["from", "to", "points"])]
    pub frequency: Option<f64>,
    /// Lowest excitation frequency in Hz of an axis
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, requires = "to")]
    pub from: Option<f64>,
    /// Highest excitation frequency in Hz of an axis
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, requires = "from")]
    pub to: Option<f64>,
    /// Number of frequencies of an axis
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub points: usize,
    /// What is looked at
    #[arg(long, value_enum, value_name = "WHAT", default_value = "fundamental")]
    pub observable: Looked,
    /// Part by which it may be off
    #[arg(long, value_name = "PART", default_value_t = 0.02, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Noise floor of the measurement, in the unit of what is looked at: less than it does not matter
    #[arg(long, value_name = "SIZE", default_value_t = 0.0, allow_negative_numbers = true)]
    pub noise: f64,
    /// Standard uncertainty of the gap in m: a closed form nearer to grazing is not relied on
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true)]
    pub gap_std: f64,
    /// Which way the frequency came, for where several motions are possible
    #[arg(long, value_enum, value_name = "WAY")]
    pub history: Option<Came>,
    /// Folder for the figure as SVG and PNG, and the rungs as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Looked {
    /// Amplitude of both masses at the excitation frequency
    Fundamental,
    /// Half of the peak-to-peak value of both masses
    Peak,
    /// Speed with which the masses meet
    ImpactSpeed,
    /// Impulse of an impact
    Impulse,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Came {
    /// It rose
    Up,
    /// It fell
    Down,
}
