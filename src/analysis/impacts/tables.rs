//! Tables of impacts.

use crate::measure::impacts::Impacts;
use crate::report::layout::headed;
use crate::report::{Cell, Table};

/// What the impacts of a trace repeat, in one row.
pub fn impacts(name: &str, found: &Impacts) -> Table {
    let columns = [
        ("trace", ""),
        ("impacts", ""),
        ("interval", "s"),
        ("frequency", "Hz"),
        ("median interval", "s"),
        ("interval spread", "s"),
        ("missed", ""),
        ("double", ""),
        ("impacts/cycles", ""),
        ("rhythm", ""),
    ];
    let rhythm = match found.regular {
        true => "regular",
        false if found.n == 2 => "unknown (2 impacts)",
        false if found.beat.is_some() => "drifts against the excitation",
        false => "irregular",
    };
    headed("Impacts", &columns).row([
        Cell::from(name),
        Cell::from(found.n),
        Cell::from(&found.interval),
        Cell::from(&found.frequency),
        Cell::Number(found.median_interval),
        Cell::from(found.spread),
        Cell::from(found.missed),
        Cell::from(found.doubled),
        Cell::from(found.per_cycle.map(|p| format!("{}/{}", p.impacts, p.cycles))),
        Cell::from(rhythm),
    ])
    .note("Impacts/cycles needs the excitation frequency. Missed: intervals of several periods. Double: a second impact within half an interval.")
}

/// Every impact: time, height, phase.
pub(crate) fn impact_times(found: &Impacts) -> Table {
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
