//! `vibro precision`, as typed.

use crate::compare::precision::Family;
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Precision {
    /// Fewer settings, repeats, records and cycles, so rougher errors: seconds instead of minutes
    #[arg(long)]
    pub quick: bool,
    /// Methods of this kind
    #[arg(long, value_name = "KIND", default_value = "both")]
    pub family: Kind,
    /// Tell also what the methods do at the borders of what they can: right, refused, wrong, stalled, crashed, not asked
    #[arg(long)]
    pub failures: bool,
    /// Measure nothing: take scenes and failures from what `vibro precision --json` printed into this file
    #[arg(long, value_name = "FILE", conflicts_with = "quick")]
    pub from: Option<PathBuf>,
    /// Add the lines that another program has measured and written into this file
    ///
    /// The file is a JSON list with an object for each method and setting: scene (its name as printed here), method
    /// (program, version and method), error (in what the scene's "Error:" names; null where it failed), `time_ns` (ns
    /// of one answer), and, where wanted, setting and why (the reason of a failure). For example:
    ///
    /// `[{"scene": "scene C", "method": "Peer 1.0", "error": 2e-4, "time_ns": 7e5}]`
    ///
    /// docs/precision.md says what each scene asks; benches/peers/peers.py writes such a file.
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
    Both,
}

impl Kind {
    /// Whether methods of this family are meant.
    pub fn holds(self, family: Family) -> bool {
        match self {
            Kind::Models => family == Family::Models,
            Kind::Estimators => family == Family::Estimators,
            Kind::Both => true,
        }
    }
}
