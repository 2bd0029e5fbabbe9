//! `vibro model`: predicted motion of a rig.

use super::question::{Asked, Question};
use super::study::Shared;
use crate::analysis::Answer;
use crate::analysis::model::{backbone, branch, choose, drill, map, orbit, response, simulate, sweep};
use crate::error::Result;
use crate::read::Folder;
use crate::report::files::Names;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct Model {
    #[command(subcommand)]
    question: Which,
}

#[derive(Debug, Subcommand)]
enum Which {
    /// All motions with one impact a period at one frequency, or those found with several, with existence and
    /// stability
    Orbit(ModelArgs<orbit::Keys>),
    /// Simulated motion: regime, traces, phase plane, Poincaré section
    Simulate(ModelArgs<simulate::Keys>),
    /// All motions with one impact a period over frequency, with folds and stability limits
    Response(PartArgs<response::Keys>),
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
    Map(PartArgs<map::Keys>),
    /// Impact unit of a hammer drill: blow energy and rate, regime, pressure, forces, speeds, start
    Drill(ModelArgs<drill::Keys>),
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

/// The keys of a study that is computed at once or in parts, and the folder for results or parts.
#[derive(Debug, Args)]
pub struct PartArgs<K: Args> {
    #[command(flatten)]
    of: ModelArgs<K>,
    /// Compute part I of N into --out; `vibro merge` joins them. Started again, it computes what is missing
    #[arg(value_name = "I/N")]
    shard: Option<String>,
}

impl Question for Model {
    fn allow_outside(&self) -> bool {
        false
    }

    fn work(&self) -> &'static str {
        "computing"
    }

    fn names(&self) -> Names {
        match &self.question {
            Which::Orbit(_) => orbit::Keys::FILES,
            Which::Simulate(_) => simulate::Keys::FILES,
            Which::Response(_) => response::Keys::FILES,
            Which::Backbone(_) => backbone::Keys::FILES,
            Which::Continue(_) => branch::Keys::FILES,
            Which::Sweep(_) => sweep::Keys::FILES,
            Which::Choose(_) => choose::Keys::FILES,
            Which::Map(_) => map::Keys::FILES,
            Which::Drill(_) => drill::Keys::FILES,
        }
    }

    fn files(&self) -> Vec<PathBuf> {
        let file = match &self.question {
            Which::Orbit(of) => &of.keys.scene.rig,
            Which::Simulate(of) => &of.keys.scene.rig,
            Which::Response(response) => &response.of.keys.scene.rig,
            Which::Backbone(of) => &of.keys.scene.rig,
            Which::Continue(of) => &of.keys.scene.rig,
            Which::Sweep(of) => &of.keys.scene.rig,
            Which::Choose(of) => &of.keys.scene.rig,
            Which::Map(map) => &map.of.keys.scene.rig,
            Which::Drill(of) => &of.keys.machine,
        };
        file.iter().cloned().collect()
    }

    fn out(&self) -> Option<&Path> {
        match &self.question {
            Which::Orbit(of) => of.out.as_deref(),
            Which::Simulate(of) => of.out.as_deref(),
            Which::Response(response) => response.of.out.as_deref(),
            Which::Backbone(of) => of.out.as_deref(),
            Which::Continue(of) => of.out.as_deref(),
            Which::Sweep(of) => of.out.as_deref(),
            Which::Choose(of) => of.out.as_deref(),
            Which::Map(map) => map.of.out.as_deref(),
            Which::Drill(of) => of.out.as_deref(),
        }
    }

    fn shard(&self) -> Option<&str> {
        match &self.question {
            Which::Map(map) => map.shard.as_deref(),
            Which::Response(response) => response.shard.as_deref(),
            _ => None,
        }
    }

    fn study(&self, _: &Folder) -> Result<Option<Shared>> {
        Ok(match &self.question {
            Which::Map(map) => Some(Shared::Map(map.of.keys.study()?)),
            Which::Response(response) => response.of.keys.study()?.map(Shared::Response),
            _ => None,
        })
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        match &self.question {
            Which::Orbit(of) => of.keys.answer(),
            Which::Simulate(of) => of.keys.answer(),
            Which::Response(response) => response.of.keys.answer(asked.progress),
            Which::Backbone(of) => of.keys.answer(),
            Which::Continue(of) => of.keys.answer(),
            Which::Sweep(of) => of.keys.answer(),
            Which::Choose(of) => of.keys.answer(),
            Which::Map(map) => map.of.keys.answer(asked.progress),
            Which::Drill(of) => of.keys.answer(asked.progress),
        }
    }
}
