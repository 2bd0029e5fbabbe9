//! `vibro model sweep`, as typed.

use super::{Law, Scene};
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Sweep {
    #[command(flatten)]
    pub scene: Scene,
    /// What is swept
    #[arg(long, value_enum, value_name = "WHAT", default_value = "frequency")]
    pub over: Over,
    /// Lower end in Hz, in N (N s for impulses) with --over force
    #[arg(long, value_name = "LOW", allow_negative_numbers = true)]
    pub from: f64,
    /// Upper end
    #[arg(long, value_name = "HIGH", allow_negative_numbers = true)]
    pub to: f64,
    /// Excitation frequency in Hz of a sweep of the force
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub frequency: Option<f64>,
    /// Law of the contact
    #[arg(long, value_enum, value_name = "LAW", default_value_t = Law::Restitution)]
    pub model: Law,
    /// Direction
    #[arg(long, value_enum, value_name = "WAY", default_value = "both")]
    pub direction: Way,
    /// Change the frequency continuously by this many Hz/s, instead of in steps
    #[arg(long, value_name = "HZ/S", allow_negative_numbers = true, conflicts_with_all = ["settle", "measure"])]
    pub rate: Option<f64>,
    /// Points: steps of a stepped sweep, readings of a continuous one
    #[arg(long, value_name = "N", default_value_t = 221)]
    pub steps: usize,
    /// Cycles that pass at each step before it is read
    #[arg(long, value_name = "CYCLES", default_value_t = 100)]
    pub settle: u32,
    /// Cycles read at each step
    #[arg(long, value_name = "CYCLES", default_value_t = 12)]
    pub measure: u32,
    /// What is read of both masses
    #[arg(long, value_enum, value_name = "WHAT", default_value = "fundamental")]
    pub observable: Observable,
    /// Follow every branch of motions with one impact a cycle, unstable ones too (sine, --over frequency)
    #[arg(long)]
    pub branches: bool,
    /// Write figure and CSV into this folder
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Over {
    /// The excitation frequency
    Frequency,
    /// The size of the force, or of the impulse
    Force,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Way {
    Up,
    Down,
    Both,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Observable {
    /// Amplitude at the excitation frequency
    Fundamental,
    /// Half of the peak-to-peak value
    Peak,
    /// Running RMS through a low-pass of 10 rad/s
    Rms,
}
