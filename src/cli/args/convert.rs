//! `vibro convert`, as typed.

use crate::campaign::{Channel, Reading};
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
    pub change: Change,
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
}

/// What is done to time traces on the way.
#[derive(Debug, clap::Args)]
pub struct Change {
    /// Corner in Hz of a zero-phase Butterworth low-pass of order 4
    #[arg(long, value_name = "HZ")]
    pub low_pass: Option<f64>,
    /// Time constant in s of exponential smoothing, which is late, instead of a zero-phase low-pass
    #[arg(long, value_name = "TIME", conflicts_with = "low_pass")]
    pub smoothing: Option<f64>,
    /// Corner in Hz of a zero-phase Butterworth high-pass of order 4
    #[arg(long, value_name = "HZ")]
    pub high_pass: Option<f64>,
    /// Integrations in time: 1 takes velocity to displacement, −1 to acceleration
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(i8).range(-2..=2))]
    pub integrate: i8,
    /// Cut-off in Hz: corner of the zero-phase high-pass of order 4 after each integration, or before a differentiation
    #[arg(long, value_name = "HZ", requires = "integrate")]
    pub fmin: Option<f64>,
    /// Frequency of the excitation in Hz: the mean is taken over whole periods before it is taken out
    #[arg(long, value_name = "HZ", requires = "integrate")]
    pub excitation: Option<f64>,
}
