//! `vibro model`: predicted motion of a rig.

use super::{CommandArgs, print};
use crate::analysis::Answer;
use crate::analysis::model::{backbone, branch, choose, map, orbit, response, simulate, sweep};
use crate::error::Result;
use crate::read::Folder;
use clap::{Args, Subcommand};
use indicatif::ProgressBar;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct Model {
    #[command(subcommand)]
    question: Question,
}

#[derive(Debug, Subcommand)]
enum Question {
    /// All motions with one impact a period at one frequency, or those found with several, with existence and
    /// stability
    Orbit(ModelArgs<orbit::Keys>),
    /// Simulated motion: regime, traces, phase plane, Poincaré section
    Simulate(ModelArgs<simulate::Keys>),
    /// All motions with one impact a period over frequency, with folds and stability limits
    Response(ModelArgs<response::Keys>),
    /// Response of one mass on its curved spring without impacts: jumps and backbone, beside exact motions
    Backbone(ModelArgs<backbone::Keys>),
    /// Motions with P impacts in Q cycles followed over frequency, force, gap or restitution, through folds,
    /// flips and grazing
    Continue(ModelArgs<branch::Keys>),
    /// Simulated sweep of frequency or force; the state carries over from step to step
    Sweep(ModelArgs<sweep::Keys>),
    /// The simplest adequate model of a scene, and why
    Choose(ModelArgs<choose::Keys>),
    /// Regime and stability over two parameters
    Map(ModelArgs<map::Keys>),
}

/// The keys of an analysis, and the folder for results.
#[derive(Debug, Args)]
pub struct ModelArgs<K: Args> {
    #[command(flatten)]
    keys: K,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl CommandArgs for Model {
    /// Computes and prints the answer.
    fn run(&self, json: bool) -> Result<u8> {
        type Ask<'a> = Box<dyn FnOnce(&ProgressBar) -> Result<Answer> + 'a>;
        let (out, names, ask): (_, _, Ask<'_>) = match &self.question {
            Question::Orbit(of) => (&of.out, orbit::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Simulate(of) => (&of.out, simulate::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Response(of) => (&of.out, response::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Backbone(of) => (&of.out, backbone::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Continue(of) => (&of.out, branch::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Sweep(of) => (&of.out, sweep::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Choose(of) => (&of.out, choose::Keys::FILES, Box::new(|_| of.keys.answer())),
            Question::Map(of) => (&of.out, map::Keys::FILES, Box::new(|bar| of.keys.answer(bar))),
        };
        let output = print::results(&Folder::default(), out.as_deref(), names)?;
        let answer = print::busy(json, "computing", ask)?;
        print::answer(answer, output, json)
    }
}
