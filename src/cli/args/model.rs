//! `vibro model`, as typed.

mod orbit;
mod response;
mod scene;
mod simulate;

pub use orbit::Orbit;
pub use response::ModelResponse;
pub use scene::Scene;
pub use simulate::{Law, Simulate};

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
}
