//! `vibro restitution`, as typed.

use super::impacts::Finding;
use super::{Channel, Reading};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Restitution {
    /// Traces of drops or of trains of bounces, one a drop
    pub files: Vec<PathBuf>,
    /// Height of the fall in m
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub height: Option<f64>,
    /// Its standard uncertainty in m
    #[arg(long, value_name = "M")]
    pub height_std: Option<f64>,
    /// Time from first to second impact in s
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with = "files")]
    pub interval: Option<f64>,
    /// Standard uncertainty of the interval in s
    #[arg(long, value_name = "S")]
    pub interval_std: Option<f64>,
    /// Times between successive impacts of one train of bounces, in s
    #[arg(
        long,
        value_name = "A,B,C",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "files"
    )]
    pub intervals: Vec<f64>,
    /// Acceleration of free fall in m/s² [default: 9.80665]
    #[arg(long, value_name = "M/S²", allow_negative_numbers = true)]
    pub gravity: Option<f64>,
    /// Its standard uncertainty in m/s²
    #[arg(long, value_name = "M/S²")]
    pub gravity_std: Option<f64>,
    /// Masses in kg: the striking and the struck one
    #[arg(long, value_name = "M1,M2", value_delimiter = ',')]
    pub masses: Vec<f64>,
    /// Velocities of both masses before the impact, in m/s
    #[arg(long, value_name = "V1,V2", value_delimiter = ',', allow_negative_numbers = true)]
    pub before: Vec<f64>,
    /// Velocities of both masses after it, in m/s; of mass 1 alone where masses are given
    #[arg(long, value_name = "V1,V2", value_delimiter = ',', allow_negative_numbers = true)]
    pub after: Vec<f64>,
    /// Velocity of mass 2 after it, in m/s, where that of mass 1 is not known and masses are given
    #[arg(long, value_name = "V2", allow_negative_numbers = true)]
    pub after2: Option<f64>,
    /// Standard uncertainty of each velocity, in m/s
    #[arg(long, value_name = "M/S")]
    pub velocity_std: Option<f64>,
    #[command(flatten)]
    pub finding: Finding,
    /// Folder for figures of the traces as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
}
