//! What can be typed. Nothing here is checked beyond its form; [`super::settings`] does that.

use clap::{Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Measure impacting machines: from analyser files to answers, each with its uncertainty.
#[derive(Debug, Parser)]
#[command(name = "vibro", version, max_term_width = 100)]
pub struct Args {
    /// Print one JSON object instead of a table
    #[arg(long, global = true)]
    pub json: bool,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say what is in a file
    Info(Info),
    /// Rewrite a file as UFF-58, CSV, WAV or NPY, chosen by the ending of OUT
    Convert(Convert),
    /// Find the excitation frequency of every point of a sweep
    Excitation(Excitation),
    /// Draw all response spectra of a sweep as a waterfall
    Waterfall(Waterfall),
    /// Take the response at the excitation, with resonances and jumps
    Response(Response),
    /// Overlay a campaign's measured responses on the model's prediction
    Compare(Compare),
    /// Do all that a campaign asks for: results, tables, figures, report
    Run(Run),
}

#[derive(Debug, clap::Args)]
pub struct Info {
    /// Measurement files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}

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
    pub reading: Reading,
}

#[derive(Debug, clap::Args)]
pub struct Excitation {
    #[command(flatten)]
    pub sweep: Sweep,
    /// Write the two hand-over files of sineswpf, with force and with response names
    #[arg(long, num_args = 2, value_names = ["FORCE", "RESPONSE"])]
    pub write_lists: Option<Vec<PathBuf>>,
}

#[derive(Debug, clap::Args)]
pub struct Waterfall {
    #[command(flatten)]
    pub sweep: Sweep,
    #[command(flatten)]
    pub taking: Taking,
    /// Highest frequency drawn, in Hz [default: the base band]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub fmax: Option<f64>,
    /// Folder for waterfall and map as SVG and PNG, and the matrix as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

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

#[derive(Debug, clap::Args)]
pub struct Compare {
    /// campaign.toml with a rig, an excitation and sweeps
    pub campaign: PathBuf,
    /// Allow names in lists that lead outside their folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Folder for the overlay as SVG, PNG and CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub struct Run {
    /// campaign.toml
    pub campaign: PathBuf,
    /// Folder for results [default: `out` in the campaign, else `results` beside it]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Allow names in lists that lead outside their folder
    #[arg(long)]
    pub allow_outside: bool,
}

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
    /// Base band in Hz: the values are a spectrum from 0 to it
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

/// A sweep, and what its analyser stored.
#[derive(Debug, clap::Args)]
pub struct Sweep {
    /// List file, hand-over file, or campaign.toml#name
    #[arg(value_name = "SWEEP")]
    pub source: String,
    /// Reproduce the thesis' script, mistakes included
    #[arg(long)]
    pub legacy: bool,
    /// Allow names in the list that lead outside its folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Unit of the stored responses [default: m]
    #[arg(long)]
    pub unit: Option<String>,
    /// Factor on the stored responses
    #[arg(long, allow_negative_numbers = true)]
    pub calibration: Option<f64>,
    /// Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top, unknown [default: hann, assumed]
    #[arg(long)]
    pub window: Option<String>,
    /// Scaling of the spectra: peak or rms [default: peak, assumed]
    #[arg(long)]
    pub scaling: Option<String>,
    /// How often the analyser integrated before it stored [default: once for a displacement]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub analyser_integrated: Option<u8>,
    /// Lowest frequency looked at, in Hz [default: two lines or a quarter of the lowest excitation]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub fmin: Option<f64>,
}

/// How a response is taken from a spectrum.
#[derive(Debug, clap::Args)]
pub struct Taking {
    /// Integrations in frequency: 1 takes velocity to displacement [default: what takes the stored quantity to displacement]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i8).range(-2..=2))]
    pub integrate: Option<i8>,
    /// Lines on both sides of the excitation in which the peak is looked for
    #[arg(long, value_name = "LINES", allow_negative_numbers = true, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub band: u16,
}
