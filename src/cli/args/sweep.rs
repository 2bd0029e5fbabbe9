//! A stepped-sine sweep, as typed.

use crate::analysis::sweep::Stored;

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
    #[command(flatten)]
    pub stored: Stored,
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
