//! `vibro model`: what the motion of a rig should be.

use super::print;
use crate::analysis::model::{choose, map, orbit, response, simulate, sweep};
use crate::error::Result;
use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub enum Model {
    /// All motions with one impact a period at one frequency, with existence and stability
    Orbit(Asked<orbit::Keys>),
    /// Simulated motion: regime, traces, phase plane, Poincaré section
    Simulate(Asked<simulate::Keys>),
    /// All motions with one impact a period over frequency, with folds and stability limits
    Response(Asked<response::Keys>),
    /// Simulated sweep of frequency or force; the state carries over from step to step
    Sweep(Asked<sweep::Keys>),
    /// The simplest adequate model of a scene, and why
    Choose(Asked<choose::Keys>),
    /// Regime and stability over two parameters
    Map(Asked<map::Keys>),
}

/// What is asked, and where results go.
#[derive(Debug, Args)]
pub struct Asked<K: Args> {
    #[command(flatten)]
    keys: K,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Model {
    /// Computes and prints the answer.
    pub fn run(&self, json: bool) -> Result<()> {
        let (answer, out) = print::busy(json, "computing", |bar| {
            Ok(match self {
                Model::Orbit(typed) => (typed.keys.answer()?, &typed.out),
                Model::Simulate(typed) => (typed.keys.answer()?, &typed.out),
                Model::Response(typed) => (typed.keys.answer()?, &typed.out),
                Model::Sweep(typed) => (typed.keys.answer()?, &typed.out),
                Model::Choose(typed) => (typed.keys.answer()?, &typed.out),
                Model::Map(typed) => (typed.keys.answer(bar)?, &typed.out),
            })
        })?;
        print::answer(answer, out.as_deref(), json)
    }
}
