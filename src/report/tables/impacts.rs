//! Impacts and restitution.

use super::headed;
use crate::measure::impacts::Impacts;
use crate::measure::restitution::Restitution;
use crate::report::{Cell, Table};

/// What the impacts of each trace repeat, one row a trace.
pub fn impacts(all: &[(String, &Impacts)]) -> Table {
    let columns = [
        ("trace", ""),
        ("impacts", ""),
        ("interval", "s"),
        ("frequency", "Hz"),
        ("median", "s"),
        ("spread", "s"),
        ("missed", ""),
        ("doubled", ""),
        ("per cycle", ""),
    ];
    let mut table = headed("Impacts", &columns);
    for (name, found) in all {
        let per_cycle = match (found.per_cycle, found.regular) {
            (Some(p), _) => format!("{}/{}", p.impacts, p.cycles),
            (None, false) if found.n == 2 => "not known".to_owned(),
            (None, false) if found.beat.is_some() => "drifts".to_owned(),
            (None, false) => "irregular".to_owned(),
            (None, true) => "regular".to_owned(),
        };
        table.push([
            Cell::from(name.as_str()),
            Cell::from(found.n),
            Cell::from(&found.interval),
            Cell::from(&found.frequency),
            Cell::Number(found.median_interval),
            Cell::from(found.spread),
            Cell::from(found.missed),
            Cell::from(found.doubled),
            Cell::from(per_cycle),
        ]);
    }
    table
}

/// Every impact: time, height, phase.
pub fn impact_times(found: &Impacts) -> Table {
    let mut table = headed("Times of impacts", &[("time", "s"), ("height", ""), ("phase", "")]);
    for (i, (time, height)) in found.times.iter().zip(&found.heights).enumerate() {
        table.push([
            Cell::Estimate { value: *time, std: found.onset_std },
            Cell::Number(*height),
            Cell::from(found.phase.get(i).copied()),
        ]);
    }
    table
}

/// Restitution by every method, one row a method.
pub fn restitution(all: &[(String, &Restitution)]) -> Table {
    let columns = [("name", ""), ("method", ""), ("R", ""), ("samples", ""), ("how", "")];
    let mut table = headed("Coefficient of restitution", &columns);
    for (name, found) in all {
        for way in &found.by {
            table.push([
                Cell::from(name.as_str()),
                Cell::from(way.method.name()),
                Cell::from(&way.restitution),
                Cell::from(way.restitution.n),
                Cell::from(way.restitution.method.as_str()),
            ]);
        }
        if found.agree == Some(false) {
            table.push([
                Cell::from(name.as_str()),
                Cell::from("together"),
                Cell::Missing,
                Cell::Missing,
                Cell::from("the methods disagree"),
            ]);
        }
    }
    table
}
