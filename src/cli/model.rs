//! `vibro model`: what the motion of a rig should be.

use super::{Run, print};
use crate::analysis::model::{branch, choose, map, orbit, response, simulate, sweep};
use crate::error::Result;
use crate::read::Folder;
use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct Model {
    #[command(subcommand)]
    question: Question,
}

#[derive(Debug, Subcommand)]
enum Question {
    /// All motions with one impact a period at one frequency, or those found with several, with existence and stability
    Orbit(Asked<orbit::Keys>),
    /// Simulated motion: regime, traces, phase plane, Poincaré section
    Simulate(Asked<simulate::Keys>),
    /// All motions with one impact a period over frequency, with folds and stability limits
    Response(Asked<response::Keys>),
    /// Motions with P impacts in Q cycles followed over frequency, force, gap or restitution, through folds, flips and grazing
    Continue(Asked<branch::Keys>),
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

impl Run for Model {
    /// Computes and prints the answer.
    fn run(&self, json: bool) -> Result<u8> {
        let (out, names) = match &self.question {
            Question::Orbit(typed) => (&typed.out, orbit::Keys::FILES),
            Question::Simulate(typed) => (&typed.out, simulate::Keys::FILES),
            Question::Response(typed) => (&typed.out, response::Keys::FILES),
            Question::Continue(typed) => (&typed.out, branch::Keys::FILES),
            Question::Sweep(typed) => (&typed.out, sweep::Keys::FILES),
            Question::Choose(typed) => (&typed.out, choose::Keys::FILES),
            Question::Map(typed) => (&typed.out, map::Keys::FILES),
        };
        let output = print::results(&Folder::default(), out.as_deref(), names)?;
        let answer = print::busy(json, "computing", |bar| match &self.question {
            Question::Orbit(typed) => typed.keys.answer(),
            Question::Simulate(typed) => typed.keys.answer(),
            Question::Response(typed) => typed.keys.answer(),
            Question::Continue(typed) => typed.keys.answer(),
            Question::Sweep(typed) => typed.keys.answer(),
            Question::Choose(typed) => typed.keys.answer(),
            Question::Map(typed) => typed.keys.answer(bar),
        })?;
        print::answer(answer, output, json)
    }
}
