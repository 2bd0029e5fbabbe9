//! `vibro precision`: speed against accuracy, and where methods break.

use super::print;
use crate::analysis::Answer;
use crate::analysis::precision::{figures, tables};
use crate::compare::precision::{Earlier, FailureMap, Family, Scene, added, busy, estimators, models};
use crate::error::{Error, Result};
use crate::record::Finding;
use crate::report::files;
use clap::ValueEnum;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Precision {
    /// Fewer settings, repeats, records and cycles, so rougher errors: seconds instead of minutes
    #[arg(long)]
    quick: bool,
    /// Methods of this kind
    #[arg(long, value_name = "KIND", default_value = "both")]
    family: Kind,
    /// Tell also what the methods do at the borders of what they can: right, refused, wrong, stalled, crashed, not asked
    #[arg(long)]
    failures: bool,
    /// Measure nothing: take scenes and failures from what `vibro precision --json` printed into this file
    #[arg(long, value_name = "FILE", conflicts_with = "quick")]
    from: Option<PathBuf>,
    /// Add the lines that another program has measured and written into this file
    ///
    /// The file is a JSON list with an object for each method and setting: scene (its name as printed here), method
    /// (program, version and method), error (in what the scene's "Error:" names; null where it failed), `time_ns` (ns
    /// of one answer), and, where wanted, setting and why (the reason of a failure). For example:
    ///
    /// `[{"scene": "scene C", "method": "Peer 1.0", "error": 2e-4, "time_ns": 7e5}]`
    ///
    /// docs/precision.md says what each scene asks; benches/peers/peers.py writes such a file.
    #[arg(long, value_name = "FILE")]
    add: Vec<PathBuf>,
    /// Folder for charts as SVG and PNG, and tables as CSV
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    Models,
    Estimators,
    Both,
}

impl Kind {
    /// Whether methods of this family are meant.
    fn holds(self, family: Family) -> bool {
        match self {
            Kind::Models => family == Family::Models,
            Kind::Estimators => family == Family::Estimators,
            Kind::Both => true,
        }
    }
}

impl Precision {
    /// Measures, or takes up what was measured, and prints it.
    pub fn run(&self, json: bool) -> Result<()> {
        let Earlier { mut scenes, maps } = match &self.from {
            Some(path) => earlier(path, self)?,
            None => self.measured(json)?,
        };
        // Of a file or of this run: those of other programs come without quartiles.
        let mut said: Vec<String> = busy::busy(&scenes).into_iter().collect();
        for path in &self.add {
            said.extend(added::add(&mut scenes, path)?);
        }
        let mut answer = Answer::of(&json!({ "scenes": scenes }))?;
        answer.tell("", said.into_iter().map(|text| Finding::caution("said").name("text", text)));
        let developed = self.from.is_none() && cfg!(debug_assertions);
        answer.tell("", developed.then(|| Finding::caution("development-build")));
        for scene in &scenes {
            answer.figure(format!("precision_{}", files::slug(&scene.name)), figures::precision(scene));
            let bound = scene.bound.map_or(String::new(), |b| format!("; Cramér–Rao bound: {b:.1e}"));
            let Scene { name, says, error_of, .. } = scene;
            let mut table = tables::scene(scene);
            table.title = format!("{name}\n{says}\nError: {error_of}{bound}");
            answer.tables.push(table);
        }
        answer.csv("precision", &tables::precision(&scenes));
        if !maps.is_empty() {
            let cells = maps.iter().flat_map(|map| map.cells.iter().map(move |cell| (map.family, cell)));
            let of_family = |(family, cell): (Family, _)| {
                let mut told = json!(cell);
                told["family"] = json!(family);
                told
            };
            answer.result.insert("failures".to_owned(), cells.map(of_family).collect::<Vec<Value>>().into());
            answer.csv("failures", &tables::failures(&maps));
        }
        for map in &maps {
            for (name, figure) in figures::failures(map) {
                answer.figure(format!("failures_{}", files::slug(&name)), figure);
            }
            answer.tables.push(tables::borders(map));
        }
        print::answer(answer, self.out.as_deref(), json)
    }

    fn measured(&self, json: bool) -> Result<Earlier> {
        let wanted = |family: Family| self.family.holds(family);
        let (mut scenes, mut maps): (Vec<Scene>, Vec<FailureMap>) = Default::default();
        print::busy(json, "scenes", |bar| {
            let mut tell = |scene: &str| {
                bar.set_message(scene.to_owned());
                bar.inc(1);
            };
            if wanted(Family::Models) {
                scenes.extend(models::scenes(self.quick, &mut tell)?);
            }
            if wanted(Family::Estimators) {
                scenes.extend(estimators::scenes(self.quick, &mut tell)?);
            }
            if self.failures {
                tell("borders");
                if wanted(Family::Models) {
                    maps.push(models::failures(self.quick)?);
                }
                if wanted(Family::Estimators) {
                    maps.push(estimators::failures(self.quick)?);
                }
            }
            Ok(Earlier { scenes, maps })
        })
    }
}

/// What a file holds of the family that is asked for.
fn earlier(path: &Path, typed: &Precision) -> Result<Earlier> {
    let mut earlier = Earlier::from_path(path)?;
    let cells = |maps: &[FailureMap]| maps.iter().map(|map| map.cells.len()).sum::<usize>();
    let held = format!("scenes held: {}, failures held: {}", earlier.scenes.len(), cells(&earlier.maps));
    earlier.retain(|family| typed.family.holds(family));
    let of = match typed.family {
        Kind::Both => String::new(),
        kind => format!(" of the family {kind:?}").to_lowercase(),
    };
    if typed.failures && earlier.maps.is_empty() {
        return Err(Error::usage(
            format!("{}: no failures{of} ({held})", path.display()),
            "failures to draw",
        )
        .hint("write the file with `vibro precision --failures --json > FILE`")
        .setting("failures"));
    }
    if earlier.scenes.is_empty() && earlier.maps.is_empty() {
        return Err(Error::usage(format!("{}: nothing{of} ({held})", path.display()), "one scene at least")
            .hint("ask for the family that the file holds"));
    }
    Ok(earlier)
}
