//! `vibro precision`, as typed.

use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Precision {
    /// Fewer settings and repeats: seconds instead of minutes
    #[arg(long)]
    pub quick: bool,
    /// Only methods of this kind [default: both]
    #[arg(long, value_name = "KIND")]
    pub family: Option<Kind>,
    /// Tell also what the methods do at the borders of what they can: right, refused, wrong, stalled, crashed, not asked
    #[arg(long)]
    pub failures: bool,
    /// Measure nothing: take the scenes from what `vibro precision --json` printed into this file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["quick", "failures"])]
    pub from: Option<PathBuf>,
    /// Add the lines that another program has measured and written into this file (see benches/peers)
    #[arg(long, value_name = "FILE")]
    pub add: Vec<PathBuf>,
    /// Write charts and CSV into this folder
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    Models,
    Estimators,
}
