//! `vibro compare`, as typed.

use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Compare {
    /// campaign.toml with a rig, an excitation and sweeps
    pub campaign: PathBuf,
    /// Allow names in lists that lead outside their folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Folder for the overlay as SVG, PNG and CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
