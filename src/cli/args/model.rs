//! `vibro model`, as typed.

mod choose;
mod map;
mod orbit;
mod response;
mod scene;
mod simulate;
mod sweep;

pub use choose::{Came, Choose as ModelChoose, Looked};
pub use map::Map as ModelMap;
pub use orbit::Orbit;
pub use response::ModelResponse;
pub use scene::Scene;
pub use simulate::{Law, Simulate};
pub use sweep::{Observable, Over, Sweep as ModelSweep, Way};

use clap::Subcommand;

#[derive(Debug, clap::Args)]
pub struct Model {
    #[command(subcommand)]
    pub command: ModelCommand,
}

#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// All motions with one impact a period at one frequency, each with its verdicts
    Orbit(Orbit),
    /// A motion from impact to impact, its regime, traces and Poincaré section
    Simulate(Simulate),
    /// The same over a range of frequencies, with the places where motions appear, vanish and change
    Response(ModelResponse),
    /// Sweep frequency or force up and down, the motion carried on from step to step
    Sweep(Box<ModelSweep>),
    /// The simplest model that is good enough for a scene, and why
    Choose(Box<ModelChoose>),
    /// Map regime and stability over two parameters
    Map(ModelMap),
}
