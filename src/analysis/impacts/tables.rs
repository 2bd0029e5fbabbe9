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
        ("median", "s"),
        ("spread", "s"),
        ("missed", ""),
        ("doubled", ""),
        ("per cycle", ""),
    ];
    let per_cycle = match (found.per_cycle, found.regular) {
        (Some(p), _) => format!("{}/{}", p.impacts, p.cycles),
        (None, false) if found.n == 2 => "not known".to_owned(),
        (None, false) if found.beat.is_some() => "drifts".to_owned(),
        (None, false) => "irregular".to_owned(),
        (None, true) => "regular".to_owned(),
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
        Cell::from(per_cycle),
    ])
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
