//! `vibro drill`, as typed.

use super::{LowPass, Reading};
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Drill {
    /// File with a velocity and a reference channel
    pub file: PathBuf,
    /// Velocity channel, by name or by number from 1
    #[arg(long, value_name = "CH")]
    pub velocity: String,
    /// Channel with the pulses of the crank
    #[arg(long, value_name = "CH")]
    pub reference: String,
    /// Velocity along the beam in m/s for one unit of the channel [default: 1 where the file says it is a velocity]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    pub sensitivity: Option<f64>,
    /// Angle of the beam in degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub beam_angle: f64,
    /// From where that angle is counted: the normal to the motion, or its axis
    #[arg(long)]
    pub from: From,
    /// Pulses of the reference in a turn
    #[arg(long, value_name = "N")]
    pub pulses_per_turn: usize,
    /// Edge of the pulse that counts
    #[arg(long)]
    pub edge: Edge,
    /// Level of the edge, in the unit of the reference [default: the middle of its two levels]
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    pub level: Option<f64>,
    /// Mass that is measured, in kg: gives energies
    #[arg(long, value_name = "KG")]
    pub mass: Option<f64>,
    /// Mass that it strikes, in kg, at rest before: gives the restitution
    #[arg(long, value_name = "KG", requires = "mass")]
    pub struck_mass: Option<f64>,
    /// Longest contact in s
    #[arg(long, value_name = "TIME", default_value_t = 0.2e-3)]
    pub contact: f64,
    /// Duration in s of the fits before and after a contact
    #[arg(long, value_name = "TIME", default_value_t = 0.5e-3)]
    pub fit: f64,
    /// Longest drop-out in s that is bridged
    #[arg(long, value_name = "TIME", default_value_t = 2e-3)]
    pub longest_dropout: f64,
    /// Time in s by which the velocity was recorded later than the reference, as the decoder of a vibrometer does: it is taken off
    #[arg(long, value_name = "TIME", default_value_t = 0.0, allow_negative_numbers = true)]
    pub delay: f64,
    /// Phases of the average
    #[arg(long, value_name = "N", default_value_t = 720)]
    pub points: usize,
    /// Corner in Hz of the zero-phase low-pass for average and displacement, or `none` [default: what the phases of the
    /// average can show]
    #[arg(long, value_name = "HZ", conflicts_with = "smoothing", value_parser = super::low_pass)]
    pub low_pass: Option<LowPass>,
    /// Time constant in s of exponential smoothing instead of the low-pass
    #[arg(long, value_name = "TIME")]
    pub smoothing: Option<f64>,
    /// Highest frequency in Hz that the instrument passes
    #[arg(long, value_name = "HZ")]
    pub instrument: Option<f64>,
    /// Record of the velocity channel without motion: the noise floor
    #[arg(long, value_name = "FILE")]
    pub noise: Option<PathBuf>,
    /// Margin in dB by which motion must stand above the noise
    #[arg(long, value_name = "DB", default_value_t = 10.0)]
    pub margin: f64,
    /// Acceleration channel of a handle, up to three times: hand-arm exposure
    #[arg(long, value_name = "CH")]
    pub handle: Vec<String>,
    /// Acceleration in m/s² for one unit of these channels
    #[arg(long, value_name = "FACTOR", requires = "handle", allow_negative_numbers = true)]
    pub handle_sensitivity: Option<f64>,
    /// Hours a day of that exposure: A(8)
    #[arg(long, value_name = "HOURS", requires = "handle")]
    pub exposure: Option<f64>,
    /// Write every impact with the speed of its turn, and beside it the velocity of every turn over the phase
    #[arg(long, value_name = "CSV")]
    pub each_cycle: Option<PathBuf>,
    /// Folder for figures as SVG and PNG and tables as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum From {
    Normal,
    Axis,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Edge {
    Rising,
    Falling,
}
