//! `vibro impacts`, as typed.

use super::{Channel, Reading};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Impacts {
    /// File with a contact trace, or any signal that jumps at each impact
    pub file: PathBuf,
    /// Print what the thesis' script timeav printed, mistakes included
    #[arg(long)]
    pub legacy: bool,
    /// Frequency of the excitation in Hz
    #[arg(long, value_name = "HZ", conflicts_with = "reference", value_parser = Frequency::typed)]
    pub excitation: Option<Frequency>,
    /// Its standard uncertainty in Hz [default: that of the digits typed]
    #[arg(long, value_name = "HZ", requires = "excitation")]
    pub excitation_std: Option<f64>,
    /// Record of the same file that rises once a cycle of the excitation, by name or by number from 1
    #[arg(long, value_name = "NAME")]
    pub reference: Option<String>,
    /// Record of one pulse, 5 to 10000 samples: each impact is matched to its shape
    #[arg(long, value_name = "FILE", conflicts_with = "legacy")]
    pub shape: Option<PathBuf>,
    /// Sampling rate of that record in Hz, where its file does not say
    #[arg(long, value_name = "HZ", requires = "shape", allow_negative_numbers = true)]
    pub shape_rate: Option<f64>,
    /// What is known to scatter: the onsets about even times, or the intervals, each on its own
    #[arg(long, value_enum, default_value = "unknown")]
    pub scatter: Scatter,
    /// No impact is missed and none is too many, however uneven the intervals
    #[arg(long)]
    pub none_missed: bool,
    #[command(flatten)]
    pub finding: Finding,
    /// Folder for figures as SVG and PNG, and the times as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
}

/// A frequency as sure as the digits it is typed with.
#[derive(Debug, Clone, Copy)]
pub struct Frequency {
    /// Hz.
    pub value: f64,
    /// Its standard uncertainty in Hz.
    pub std: f64,
}

impl Frequency {
    fn typed(text: &str) -> Result<Frequency, String> {
        crate::measure::impacts::typed(text)
            .map(|(value, std)| Frequency { value, std })
            .ok_or_else(|| "expected a number".to_owned())
    }
}

/// What is known to scatter.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Scatter {
    /// Onsets
    Onsets,
    /// Intervals
    Intervals,
    /// Either, or both
    Unknown,
}

/// How impacts are found in a trace.
#[derive(Debug, clap::Args)]
pub struct Finding {
    /// Lowest impact, as part of the median one [default: 0.125; of drops 0.02]
    #[arg(long, value_name = "PART")]
    pub threshold: Option<f64>,
    /// Pause in s that parts two impacts [default: found from the trace]
    #[arg(long, value_name = "S")]
    pub refractory: Option<f64>,
    /// Leave mains hum in the trace
    #[arg(long)]
    pub keep_hum: bool,
}
