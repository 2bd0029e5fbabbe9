//! What a person knows of a file that the file does not say.

use clap::ValueEnum;

/// How a measurement file is to be read, where it does not say itself.
#[derive(Debug, clap::Args)]
pub struct Reading {
    /// Force the format instead of finding it out
    #[arg(long, value_name = "NAME")]
    pub format: Option<String>,
    /// Keep NaN, Inf and blank values as missing instead of refusing them
    #[arg(long)]
    pub allow_missing: bool,
    /// Sampling rate in Hz: the values are a time trace
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, conflicts_with = "base_band")]
    pub rate: Option<f64>,
    /// Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56 times it
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub base_band: Option<f64>,
    /// Unit of the values, such as mm/s
    #[arg(long)]
    pub unit: Option<String>,
    /// Decimal mark, where the file leaves it open
    #[arg(long, value_name = "MARK")]
    pub decimal: Option<Decimal>,
    /// Two columns of values are real and imaginary part
    #[arg(long)]
    pub complex: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Decimal {
    Comma,
    Point,
}

/// Which record of a file is meant, and its calibration.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Channel {
    /// Record of the file, by name or by number from 1 [default: the only one]
    #[arg(long, value_name = "NAME")]
    pub channel: Option<String>,
    /// Factor on the stored values; with --unit, to that unit
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    pub calibration: Option<f64>,
}
