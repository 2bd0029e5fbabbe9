//! `vibro spectrum`, as typed.

use super::{Channel, Reading};
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Spectrum {
    /// Measurement file with samples over time
    pub file: PathBuf,
    #[command(flatten)]
    pub channel: Channel,
    /// One transform of the whole record, or the average over segments
    #[arg(
        long,
        value_name = "METHOD",
        default_value = "welch",
        default_value_if("tones", clap::builder::ArgPredicate::IsPresent, "fft")
    )]
    pub method: Method,
    /// Fit the N strongest sines of the whole record, 1 to 10: frequency, amplitude and phase with their uncertainties
    #[arg(long, value_name = "N", conflicts_with_all = ["reference", "segment", "overlap"], value_parser = clap::value_parser!(u8).range(1..=10))]
    pub tones: Option<u8>,
    /// Samples of a segment [default: 8192, or the whole of a shorter record]
    #[arg(long, value_name = "SAMPLES")]
    pub segment: Option<usize>,
    /// Part of a segment that it shares with the next [default: 0.5]
    #[arg(long, value_name = "PART", allow_negative_numbers = true)]
    pub overlap: Option<f64>,
    /// What is taken out before the window; the line at 0 Hz goes with the mean [default: mean with welch or --integrate, else none]
    #[arg(long, value_name = "WHAT")]
    pub detrend: Option<Detrend>,
    /// Window: hann, rectangular, hamming, blackman, blackman-harris, flat-top
    #[arg(long, value_name = "NAME", default_value = "hann")]
    pub window: String,
    /// What a line means: peak, rms, power or psd
    #[arg(long, value_name = "NAME", default_value = "peak", conflicts_with = "reference")]
    pub scaling: String,
    /// Integrations in frequency: 1 takes velocity to displacement, −1 to acceleration
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(i8).range(-2..=2))]
    pub integrate: i8,
    /// Lowest frequency given, in Hz [default: two lines where integrated, else 0]
    #[arg(long, value_name = "HZ")]
    pub fmin: Option<f64>,
    /// Channel of the excitation: gives the frequency response function from it
    #[arg(long, value_name = "NAME")]
    pub reference: Option<String>,
    /// Which noise the function does not mind: h1 that of the response, h2 that of the excitation, hv both alike
    #[arg(long, value_name = "NAME", default_value = "h1", requires = "reference")]
    pub estimator: Estimator,
    /// The excitation is a hammer: one record a blow, of --segment samples, from the level before it
    #[arg(long, requires = "reference", conflicts_with_all = ["window", "overlap", "method", "detrend"])]
    pub hammer: bool,
    /// Width of the force window in s
    #[arg(long, value_name = "S", requires = "hammer")]
    pub force_window: Option<f64>,
    /// What an exponential window leaves of the response at the end of a record, e.g. 0.01
    #[arg(long, value_name = "PART", requires = "hammer")]
    pub left_at_end: Option<f64>,
    /// Time in s by which the channel was recorded later than the reference, as the decoder of a vibrometer does: it is taken off
    #[arg(long, value_name = "S", requires = "reference", allow_negative_numbers = true)]
    pub delay: Option<f64>,
    /// Give levels in decibels over this reference, in SI units of the channel: 1, or 1e-6 for 1 µm/s²
    #[arg(long, value_name = "REF")]
    pub decibel: Option<f64>,
    /// Folder for the figure as SVG and PNG, and the lines as CSV and UFF
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    Fft,
    Welch,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Detrend {
    None,
    Mean,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Estimator {
    H1,
    H2,
    Hv,
}
