//! What can be typed. Nothing here is checked beyond its form; [`super::settings`] does that.

mod compare;
mod convert;
mod excitation;
mod info;
mod model;
mod precision;
mod record;
mod response;
mod run;
mod sweep;
mod waterfall;

pub use compare::Compare;
pub use convert::{Change, Convert};
pub use excitation::Excitation;
pub use info::Info;
pub use model::{
    Came, Law, Looked, Model, ModelChoose, ModelCommand, ModelMap, ModelResponse, ModelSweep, Observable,
    Orbit, Over, Scene, Simulate, Way,
};
pub use precision::Precision;
pub use record::Record;
pub use response::Response;
pub use run::Run;
pub use sweep::{Sweep, Taking};
pub use waterfall::Waterfall;

use super::{
    drill::Drill, impacts::Impacts, modal::Modal, pulse::Pulse, restitution::Restitution, spectrum::Spectrum,
};
use clap::{Parser, Subcommand};

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
    /// Give the spectrum of a channel, or the frequency response function of two
    Spectrum(Spectrum),
    /// Find the excitation frequency of every point of a sweep
    Excitation(Excitation),
    /// Draw all response spectra of a sweep as a waterfall
    Waterfall(Waterfall),
    /// Take the response at the excitation, with resonances and jumps
    Response(Response),
    /// Measure speed, impacts and the average turn of a hammer drill
    Drill(Box<Drill>),
    /// Find the impacts in a contact trace: interval, frequency, impacts per cycle
    Impacts(Impacts),
    /// Coefficient of restitution from drops, bounces or velocities, every method side by side
    Restitution(Restitution),
    /// Natural frequency, damping and modal constant of the modes of a frequency response function
    Modal(Modal),
    /// Damping ratio, frequency and restitution of a contact from its pulse
    Pulse(Pulse),
    /// What the motion of a rig should be: orbits with their verdicts, simulations, sweeps
    Model(Box<Model>),
    /// Overlay a campaign's measured responses on the model's prediction
    Compare(Compare),
    /// Speed against accuracy of every method on scenes with a known truth, and where each breaks
    Precision(Precision),
    /// Do all that a campaign asks for: results, tables, figures, report
    Run(Run),
}
