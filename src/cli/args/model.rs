//! `vibro model`, as typed.

mod orbit;
mod response;
mod scene;

pub use orbit::Orbit;
pub use response::ModelResponse;
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
    /// The same over a range of frequencies, with the places where motions appear, vanish and change
    Response(ModelResponse),
}
