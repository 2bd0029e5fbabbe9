//! Speed against accuracy, and failures, as tables.

use crate::compare::precision::{FailureMap, Outcome, Scene};
use crate::report::layout::headed;
use crate::report::{Cell, Table};

/// Every method of every scene with its error and time, for other programs.
pub fn precision(scenes: &[Scene]) -> Table {
    let mut table = headed(
        "Precision",
        &[
            ("family", ""),
            ("scene", ""),
            ("error of", ""),
            ("bound", ""),
            ("method", ""),
            ("setting", ""),
            ("own", ""),
            ("error", ""),
            ("error lower quartile", ""),
            ("error upper quartile", ""),
            ("time", "s"),
            ("time lower quartile", "s"),
            ("time upper quartile", "s"),
            ("front", ""),
            ("why", ""),
        ],
    );
    for scene in scenes {
        for m in &scene.methods {
            table.push([
                scene.family.name().into(),
                scene.name.clone().into(),
                scene.error_of.clone().into(),
                scene.bound.into(),
                m.method.clone().into(),
                m.setting.clone().into(),
                yes(m.ours),
                m.error.into(),
                m.error_spread.map(|s| s[0]).into(),
                m.error_spread.map(|s| s[1]).into(),
                (1e-9 * m.time_ns).into(),
                m.time_spread.map(|s| 1e-9 * s[0]).into(),
                m.time_spread.map(|s| 1e-9 * s[1]).into(),
                yes(m.front),
                m.why.clone().unwrap_or_default().into(),
            ]);
        }
    }
    table
}

fn yes(yes: bool) -> Cell {
    if yes { "yes" } else { "" }.into()
}

/// The methods of one scene, for a reader.
pub fn scene(scene: &Scene) -> Table {
    let mut table =
        headed("", &[("method", ""), ("setting", ""), ("error", ""), ("time", ""), ("front", ""), ("", "")]);
    for m in &scene.methods {
        table.push([
            m.method.clone().into(),
            m.setting.clone().into(),
            m.error.map_or(Cell::Missing, |e| format!("{e:.1e}").into()),
            time(m.time_ns).into(),
            yes(m.front),
            m.why.clone().unwrap_or_default().into(),
        ]);
    }
    table
}

/// A time with a prefix.
fn time(ns: f64) -> String {
    let (scale, unit) = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")]
        .into_iter()
        .find(|(scale, _)| ns >= *scale)
        .unwrap_or((1.0, "ns"));
    format!("{:.3} {unit}", ns / scale)
}

/// Every cell of failure maps with its reason.
pub fn failures(maps: &[FailureMap]) -> Table {
    let columns = [
        ("family", ""),
        ("border", ""),
        ("scene", ""),
        ("method", ""),
        ("own", ""),
        ("outcome", ""),
        ("why", ""),
    ];
    let mut table = headed("Failures", &columns);
    for map in maps {
        for cell in &map.cells {
            table.push([
                map.family.name().into(),
                cell.border.clone().into(),
                cell.scene.clone().into(),
                cell.method.clone().into(),
                yes(cell.ours),
                cell.outcome.name().into(),
                cell.why.clone().into(),
            ]);
        }
    }
    table
}

/// How often each method came out how, and what went wrong.
pub fn borders(map: &FailureMap) -> Table {
    let outcomes = [
        Outcome::Right,
        Outcome::Refused,
        Outcome::Wrong,
        Outcome::Stalled,
        Outcome::Crashed,
        Outcome::NotAsked,
    ];
    let head = std::iter::once(("method", "")).chain(outcomes.map(|o| (o.name(), "")));
    let mut table = headed(format!("Borders of {}", map.family.name()), &head.collect::<Vec<_>>());
    for method in map.methods() {
        let count = |outcome: Outcome| {
            map.cells.iter().filter(|c| c.method == method && c.outcome == outcome).count()
        };
        table.push(std::iter::once(Cell::from(method)).chain(outcomes.map(|o| Cell::from(count(o)))));
    }
    table
}
