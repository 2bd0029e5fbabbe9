//! What can be typed. Nothing here is checked beyond its form; [`super::settings`] does that.

mod compare;
mod convert;
mod excitation;
mod info;
mod modal;
mod pulse;
mod reading;
mod response;
mod run;
mod sweep;
mod waterfall;

pub use compare::Compare;
pub use convert::Convert;
pub use excitation::Excitation;
pub use info::Info;
pub use modal::Modal;
pub use pulse::Pulse;
pub use reading::{Channel, Decimal, Reading};
pub use response::Response;
pub use run::Run;
pub use sweep::{Sweep, Taking};
pub use waterfall::Waterfall;

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
    /// Find the excitation frequency of every point of a sweep
    Excitation(Excitation),
    /// Draw all response spectra of a sweep as a waterfall
    Waterfall(Waterfall),
    /// Take the response at the excitation, with resonances and jumps
    Response(Response),
    /// Natural frequency, damping and modal constant of the modes of a frequency response function
    Modal(Modal),
    /// Damping ratio, frequency and restitution of a contact from its pulse
    Pulse(Pulse),
    /// Overlay a campaign's measured responses on the model's prediction
    Compare(Compare),
    /// Do all that a campaign asks for: results, tables, figures, report
    Run(Run),
}
