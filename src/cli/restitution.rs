//! `vibro restitution`: by every method that the data allow.

use super::{args, print};
use crate::analysis::drop::{Keys, Series};
use crate::error::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Restitution {
    /// Traces of drops or of trains of bounces, one a drop
    files: Vec<PathBuf>,
    #[command(flatten)]
    keys: Keys,
    #[command(flatten)]
    record: args::Record,
}

pub fn run(typed: &Restitution, json: bool) -> Result<()> {
    typed.keys.usable(!typed.files.is_empty())?;
    let mut series = Series::new(&typed.keys);
    series.add_numbers(&typed.keys);
    for (i, file) in typed.files.iter().enumerate() {
        typed.record.measured(file, json, |source| series.add_record(&typed.keys, source, i + 1))?;
    }
    print::answer(series.answer("")?, typed.record.out.as_deref(), &[], "", json)
}
