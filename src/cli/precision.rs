//! `vibro precision`: speed and accuracy of methods, and their limits.

use super::{CommandArgs, print};
use crate::analysis::Answer;
use crate::analysis::precision as shown;
use crate::error::{Error, Result};
use crate::precision::{BenchmarkScene, Family, Results};
use crate::read::Folder;
use crate::record::Finding;
use crate::report::files::{self, Names};
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
    /// Folder for charts as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Names of written files: one chart a scene, one failure map a method.
const NAMES: Names = Names::Named(&["precision", "failures"]);

const FAMILIES: [Family; 2] = [Family::Models, Family::Estimators];

impl CommandArgs for Precision {
    /// Benchmarks the methods, or reads earlier results, and prints them.
    fn run(&self, json: bool) -> Result<u8> {
        let output = print::results(&Folder::default(), self.out.as_deref(), NAMES)?;
        let mut results = match &self.results {
            Some(path) => Results::from_path(path)?,
            None => self.measured(json)?,
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
        let mut answer = Answer::of(&results)?;
        answer.add("", &findings);
        let Results { scenes, failures } = &results;
        for scene in scenes {
            answer.figure(format!("precision_{}", files::slug(&scene.name)), shown::chart(scene));
            let bound = scene.bound.map_or(String::new(), |b| format!("; Cramér–Rao bound: {b:.1e}"));
            let BenchmarkScene { name, says, error_of, .. } = scene;
            let mut table = shown::scene(scene);
            table.title = format!("{name}\n{says}\nError: {error_of}{bound}");
            answer.tables.push(table);
        }
        answer.csv("precision", &shown::precision(scenes));
        if !nothing {
            answer.csv("failures", &shown::failures(failures));
        }
        for family in FAMILIES {
            let part = failures.of(family);
            for (name, figure) in shown::maps(family, &part) {
                answer.figure(format!("failures_{}", files::slug(&name)), figure);
            }
            if !part.is_empty() {
                answer.tables.push(shown::borders(family, &part));
            }
        }
        print::answer(answer, output, json)
    }
}

impl Precision {
    fn measured(&self, json: bool) -> Result<Results> {
        print::busy(json, "scenes", |bar| {
            let mut results = Results::default();
            let mut tell = |scene: &str| {
                bar.set_message(scene.to_owned());
                bar.inc(1);
            };
            for family in FAMILIES.into_iter().filter(|f| self.family.is_none_or(|only| only == *f)) {
                results.measure(family, self.quick, self.failures, &mut tell)?;
            }
            Ok(results)
        })
    }
}
