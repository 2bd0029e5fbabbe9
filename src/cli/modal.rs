//! `vibro modal`: natural frequencies, damping ratios and modal constants.

use super::{args, print};
use crate::analysis::frf::Keys;
use crate::error::{Error, Result};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Modal {
    /// File with a frequency response function, or with two channels and a reference
    file: PathBuf,
    #[command(flatten)]
    keys: Keys,
    #[command(flatten)]
    record: args::Record,
}

pub fn run(typed: &Modal, json: bool) -> Result<()> {
    let mut answers = typed.record.measured(&typed.file, json, |source| typed.keys.measure(source))?;
    if answers.len() > 1 {
        let names: Vec<&str> = answers.iter().filter_map(|a| a.result["channel"].as_str()).collect();
        let found = format!("{} frequency response functions, and none was chosen", names.len());
        return Err(Error::usage(found, format!("one of {}", names.join(", "))).setting("channel"));
    }
    let Some(mut answer) = answers.pop() else {
        return Err(Error::refused("no frequency response function"));
    };
    if let Some(error) = answer.refused.take() {
        return Err(error);
    }
    print::answer(answer, typed.record.out.as_deref(), &[], "", json)
}
