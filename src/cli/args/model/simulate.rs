//! `vibro model simulate`, as typed.

use super::Scene;
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Simulate {
    #[command(flatten)]
    pub scene: Scene,
    /// Excitation frequency in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub frequency: Option<f64>,
    /// Law of the contact
    #[arg(long, value_enum, default_value_t = Law::Restitution)]
    pub model: Law,
    /// Cycles of the excitation that are looked at
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub cycles: u32,
    /// Cycles that the motion is given to settle before
    #[arg(long, value_name = "N", default_value_t = 500)]
    pub settle: u32,
    /// Displacements in m and velocities in m/s at the start [default: at rest]
    #[arg(long, value_name = "X1,V1,X2,V2", value_delimiter = ',', allow_hyphen_values = true)]
    pub initial: Vec<f64>,
    /// Phase of the excitation's cycle at the start, in rad: 0 is the crest of a sine and the beginning of a pulse
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    pub phase: f64,
    /// Approach speed in m/s below which an impact counts as grazing
    #[arg(long, value_name = "M/S", allow_negative_numbers = true, default_value_t = crate::model::simulate::GRAZING_SPEED)]
    pub grazing: f64,
    /// Folder for traces, phase plane and Poincaré section as SVG, PNG and CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Laws of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Law {
    /// Instantaneous, with the rig's restitution
    Restitution,
    /// Spring and damper that do not pull
    KelvinVoigt,
    /// Spheres
    Hertz,
    /// Spheres with losses
    HuntCrossley,
    /// A mass that is loose on its spring
    LooseMass,
}
