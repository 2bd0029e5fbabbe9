//! `vibro spectrum`: lines of a channel, or the response of one channel to another.

use super::{args, print};
use crate::analysis::spectrum::Keys;
use crate::error::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Spectrum {
    /// Measurement file with samples over time
    file: PathBuf,
    #[command(flatten)]
    keys: Keys,
    #[command(flatten)]
    record: args::Record,
}

pub fn run(typed: &Spectrum, json: bool) -> Result<()> {
    let answer = typed.record.measured(&typed.file, json, |source| typed.keys.measure(source))?;
    print::answer(answer, typed.record.out.as_deref(), &[], "all lines: --json, or files with --out", json)
}
