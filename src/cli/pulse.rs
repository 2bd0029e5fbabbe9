//! `vibro pulse`: damping ratio and frequency of a contact.

use super::{args, print};
use crate::analysis::pulse::Keys;
use crate::error::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Pulse {
    /// Record of the acceleration (or force) of a contact
    file: Option<PathBuf>,
    #[command(flatten)]
    keys: Keys,
    #[command(flatten)]
    record: args::Record,
}

pub fn run(typed: &Pulse, json: bool) -> Result<()> {
    typed.keys.usable(typed.file.is_some())?;
    let answer = match &typed.file {
        Some(file) => typed.record.measured(file, json, |source| typed.keys.measure(source))?,
        None => typed.keys.times("")?,
    };
    print::answer(answer, typed.record.out.as_deref(), &[], "", json)
}
