//! `vibro precision`: speed and accuracy of methods, and their limits.

use super::study::Shared;
use super::{CommandArgs, print};
use crate::analysis::precision::{self as shown, Benchmark};
use crate::analysis::study::{Computed, Study};
use crate::error::{Error, Result};
use crate::precision::{Family, Results};
use crate::read::Folder;
use crate::record::Finding;
use indicatif::ProgressBar;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Precision {
    /// Fewer settings, repeats, records and cycles, so rougher errors: seconds instead of minutes
    quick: bool,
    /// Only the methods of this kind: models or estimators [default: both]
    #[arg(value_name = "KIND", value_parser = crate::campaign::word::<Family>)]
    family: Option<Family>,
    /// Show also the outcome of each method at its limits: right, refused, wrong, stalled, crashed, not
    /// asked
    failures: bool,
    /// Use the results that `vibro precision --json` wrote to this file
    #[arg(conflicts_with = "quick")]
    results: Option<PathBuf>,
    /// Add results of another program from this file
    ///
    /// The file is a JSON list with an object for each method and setting: scene (its name as printed here),
    /// method (program, version and method), error (in what the scene's "Error:" names; null where it
    /// failed), `time_ns` (ns of one answer), and, where wanted, setting and why (the reason of a
    /// failure). For example:
    ///
    /// `[{"scene": "scene C", "method": "Peer 1.0", "error": 2e-4, "time_ns": 7e5}]`
    ///
    /// docs/precision.md says what each scene asks; benches/peers/peers.py writes such a file.
    #[arg(long, value_name = "FILE")]
    add: Vec<PathBuf>,
    /// Measure part I of N into --out; `vibro merge` joins them. Started again, it measures what is missing
    #[arg(value_name = "I/N", conflicts_with_all = ["results", "add"])]
    shard: Option<String>,
    /// Folder for charts as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl CommandArgs for Precision {
    /// Benchmarks the methods, or reads earlier results, and prints them.
    fn run(&self, json: bool) -> Result<u8> {
        if let Some(shard) = &self.shard {
            return Shared::Precision(self.benchmark()).printed(shard.parse()?, self.out.as_deref(), json);
        }
        let output = print::results(&Folder::default(), self.out.as_deref(), Benchmark::FILES)?;
        let mut results = if let Some(path) = &self.results {
            Results::from_path(path)?
        } else {
            let benchmark = self.benchmark();
            let all = benchmark.cells();
            print::busy(json, benchmark.what(), |bar: &ProgressBar| {
                Benchmark::results(&mut Computed::new(&benchmark, 0..all, all, bar).map(|(_, cell)| cell))
            })?
        };
        results.retain(|family| self.family.is_none_or(|only| only == family));
        let nothing = results.failures.is_empty();
        if nothing && (self.failures || results.scenes.is_empty()) {
            let missing = if self.failures { "failures" } else { "scenes" };
            return Err(Error::usage(format!("no {missing} of this kind in the file"), "one at least")
                .hint("write it with `vibro precision --failures --json > FILE`"));
        }
        let mut findings = Vec::new();
        for path in &self.add {
            let left = results.add(path)?;
            let lines = left.chunk_by(|a, b| a == b);
            findings.extend(lines.map(|l| {
                let left = Finding::caution("lines-of-unknown-scene").count("n", l.len());
                left.name("scene", l[0].as_str()).about(path.display().to_string())
            }));
        }
        if self.results.is_none() && cfg!(debug_assertions) {
            findings.push(Finding::caution("development-build"));
        }
        let answer = shown::answer(&results, &findings)?;
        print::answer(answer, output, json)
    }
}

impl Precision {
    /// What is to be measured.
    fn benchmark(&self) -> Benchmark {
        Benchmark { family: self.family, quick: self.quick, failures: self.failures }
    }
}
