//! `vibro convert`: any readable file to UFF-58, CSV, WAV or NPY.

use super::excitation::write_beside;
use super::{args, complain, print, settings};
use crate::error::Result;
use crate::write::{Precision, Storage, Target};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Serialize)]
struct Answer {
    written: PathBuf,
    format: &'static str,
    records: usize,
    warnings: Vec<String>,
}

pub fn run(typed: &args::Convert, json: bool) -> Result<()> {
    let target = Target::of(&typed.output)?;
    let recording = settings::reader(&typed.reading)?.from_path(&typed.input)?;
    let mut bytes = Vec::new();
    let precision = if typed.single { Precision::Single } else { Precision::Double };
    target.write(&recording.records, Storage { binary: typed.binary, precision }, &mut bytes)?;
    let warnings = recording.all_doubts();
    let written = write_beside(&typed.output, &bytes)?;
    if json {
        return print::json(&Answer {
            written,
            format: target.name(),
            records: recording.records.len(),
            warnings,
        });
    }
    complain::warn(&warnings);
    print::text(&format!(
        "{}: {} record(s) as {}\n",
        written.display(),
        recording.records.len(),
        target.name()
    ))
}
