//! `vibro compare`, as typed.

use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Compare {
    /// campaign.toml with a rig, an excitation and sweeps
    pub campaign: PathBuf,
    /// Allow names in lists that lead outside their folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Parameters to be found from the responses, with commas between: force, restitution, c1, c2, gap, k1, k2, and m1, m2 with a prior in
    /// [fit] [default: those of [fit] in the campaign]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub fit: Vec<String>,
    /// Folder for the overlay and the fit as SVG, PNG and CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
