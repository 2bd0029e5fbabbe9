//! `vibro run`, as typed.

use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Run {
    /// campaign.toml
    pub campaign: PathBuf,
    /// Folder for results [default: `out` in the campaign, else `results` beside it]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Allow names in lists that lead outside their folder
    #[arg(long)]
    pub allow_outside: bool,
}
