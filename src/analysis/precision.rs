//! Speed against accuracy, and failures: figures and tables of scenes and of borders.

mod benchmark;
mod chart;
mod map;

pub use benchmark::Benchmark;
use chart::chart;
use map::maps;

use crate::analysis::Answer;
use crate::error::Result;
use crate::precision::{BenchmarkScene, BorderCell, FailureMap, Family, MeasuredMethod, Results};
use crate::record::Finding;
use crate::report::files;
use crate::report::layout::{headed, table};
use crate::report::{Cell, Table};
use map::OUTCOMES;

/// Families in the order of their results.
const FAMILIES: [Family; 2] = [Family::Models, Family::Estimators];

/// The answer of all results: charts, tables, failure maps.
///
/// # Errors
/// If it cannot be written as JSON.
pub fn answer(results: &Results, findings: &[Finding]) -> Result<Answer> {
    let mut answer = Answer::of(results)?;
    answer.add("", findings);
    let Results { scenes, failures } = results;
    for scene in scenes {
        answer.figure(format!("precision_{}", files::slug(&scene.name)), chart(scene));
        let bound = scene.bound.map_or(String::new(), |b| format!("; Cramér–Rao bound: {b:.1e}"));
        let BenchmarkScene { name, says, error_of, .. } = scene;
        let mut table = self::scene(scene);
        table.title = format!("{name}\n{says}\nError: {error_of}{bound}");
        answer.tables.push(table);
    }
    answer.csv("precision", &precision(scenes));
    if !failures.is_empty() {
        answer.csv("failures", &self::failures(failures));
    }
    for family in FAMILIES {
        let part = failures.of(family);
        for (name, figure) in maps(family, &part) {
            answer.figure(format!("failures_{}", files::slug(&name)), figure);
        }
        if !part.is_empty() {
            answer.tables.push(borders(family, &part));
        }
    }
    Ok(answer)
}

/// Every method of every scene with its error and time, for other programs.
fn precision(scenes: &[BenchmarkScene]) -> Table {
    type Row<'a> = (&'a BenchmarkScene, &'a MeasuredMethod);
    let rows = scenes.iter().flat_map(|scene| scene.methods.iter().map(move |m| (scene, m)));
    table(
        "Precision",
        rows,
        &[
            ("family", "", &|(s, _): &Row| s.family.name().into()),
            ("scene", "", &|(s, _)| s.name.as_str().into()),
            ("error of", "", &|(s, _)| s.error_of.as_str().into()),
            ("bound", "", &|(s, _)| s.bound.into()),
            ("method", "", &|(_, m)| m.method.as_str().into()),
            ("setting", "", &|(_, m)| m.setting.as_str().into()),
            ("own", "", &|(_, m)| yes(m.ours)),
            ("other program", "", &|(_, m)| yes(m.other_program)),
            ("error", "", &|(_, m)| m.error.into()),
            ("time", "s", &|(_, m)| (1e-9 * m.time_ns).into()),
            ("front", "", &|(_, m)| yes(m.front)),
            ("why", "", &|(_, m)| m.why.as_deref().unwrap_or_default().into()),
        ],
    )
}

/// The word yes, or an empty cell.
fn yes(yes: bool) -> Cell {
    if yes { "yes" } else { "" }.into()
}

/// Origin of a method's code, by the group of the method in the chart.
const CODE: [&str; 3] = ["vibro", "vibro, a common method", "other program"];

/// The methods of one scene, for a reader.
fn scene(scene: &BenchmarkScene) -> Table {
    table(
        "",
        &scene.methods,
        &[
            ("method", "", &|m: &&MeasuredMethod| m.method.as_str().into()),
            ("code", "", &|m| CODE[chart::group(m)].into()),
            ("setting", "", &|m| m.setting.as_str().into()),
            ("error", "", &|m| m.error.map_or(Cell::Missing, |e| format!("{e:.1e}").into())),
            ("time", "", &|m| time(m.time_ns).into()),
            ("front", "", &|m| yes(m.front)),
            ("", "", &|m| m.why.as_deref().unwrap_or_default().into()),
        ],
    )
}

/// A time with a prefix.
fn time(ns: f64) -> String {
    let prefixes = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")];
    let (scale, unit) = prefixes.into_iter().find(|(scale, _)| ns >= *scale).unwrap_or((1.0, "ns"));
    format!("{:.3} {unit}", ns / scale)
}

/// Every cell of a failure map with its reason.
fn failures(map: &FailureMap) -> Table {
    table(
        "Failures",
        &map.cells,
        &[
            ("family", "", &|c: &&BorderCell| c.family.name().into()),
            ("border", "", &|c| c.border.as_str().into()),
            ("scene", "", &|c| c.scene.as_str().into()),
            ("method", "", &|c| c.method.as_str().into()),
            ("own", "", &|c| yes(c.ours)),
            ("outcome", "", &|c| c.outcome.name().into()),
            ("why", "", &|c| c.why.as_str().into()),
        ],
    )
}

/// Number of outcomes of each kind, for each method of a family.
fn borders(family: Family, map: &FailureMap) -> Table {
    let columns: Vec<_> = std::iter::once(("method", "")).chain(OUTCOMES.map(|o| (o.0.name(), ""))).collect();
    let mut table = headed(format!("Borders of {}", family.name()), &columns);
    for method in map.methods() {
        let count = |o| map.cells.iter().filter(|c| c.method == method && c.outcome == o).count();
        table.push(std::iter::once(Cell::from(method)).chain(OUTCOMES.map(|o| count(o.0).into())));
    }
    table
}
