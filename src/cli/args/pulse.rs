//! `vibro pulse`, as typed.

use super::{Channel, LowPass, Reading};
use std::path::PathBuf;

/// Options that say how a file is read, or what its instrument did.
const OF_A_FILE: [&str; 11] = [
    "low_pass",
    "order",
    "channel",
    "calibration",
    "format",
    "allow_missing",
    "rate",
    "base_band",
    "unit",
    "decimal",
    "complex",
];

#[derive(Debug, clap::Args)]
pub struct Pulse {
    /// Record of the acceleration (or force) of a contact
    #[arg(required_unless_present = "time_to_peak", conflicts_with_all = ["time_to_peak", "duration", "std"])]
    pub file: Option<PathBuf>,
    /// Time from the onset to the largest force, in s: instead of a file
    #[arg(long, value_name = "S", requires = "duration", allow_negative_numbers = true, conflicts_with_all = OF_A_FILE)]
    pub time_to_peak: Option<f64>,
    /// Time from the onset to the end of the contact, in s
    #[arg(long, value_name = "S", requires = "time_to_peak", allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Standard uncertainty of each of the two times, in s
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub std: Option<f64>,
    /// Mass that is decelerated, in kg, for stiffness and damping
    #[arg(long, value_name = "KG", allow_negative_numbers = true)]
    pub mass: Option<f64>,
    /// Corner (-3 dB) of the instrument's Butterworth low-pass, in Hz, or none [default: not known, and no uncertainty]
    #[arg(long, value_name = "HZ", value_parser = super::low_pass, allow_negative_numbers = true)]
    pub low_pass: Option<LowPass>,
    /// Order of that low-pass, 1 to 10
    #[arg(long, value_name = "N", requires = "low_pass")]
    pub order: Option<usize>,
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
    /// Folder for the figure as SVG and PNG, and the fits as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
