//! `vibro model`, as typed.

mod orbit;
mod scene;

pub use orbit::Orbit;
pub use scene::Scene;

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
}
