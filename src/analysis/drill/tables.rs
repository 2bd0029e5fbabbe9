//! Tables of drills.

use crate::measure::Estimate;
use crate::measure::drill::Drill;
use crate::measure::drill::SmoothingKind;
use crate::report::layout::headed;
use crate::report::{Cell, Table};

/// What was found, one row a number.
pub fn drill(name: &str, d: &Drill) -> Table {
    let columns = [("record", ""), ("quantity", ""), ("value", ""), ("unit", ""), ("n", "")];
    let mut table = headed("Hammer drill", &columns);
    let mut row = |what: &str, value: Cell, unit: &str, n: usize| {
        table.push([Cell::from(name), Cell::from(what), value, Cell::from(unit), Cell::from(n)]);
    };
    let first = if d.groups.len() > 1 { "group 0: " } else { "" };
    let estimates: [(&str, Option<&Estimate>); 8] = [
        ("speed", Some(&d.speed)),
        ("velocity before impact", d.before.as_ref()),
        ("velocity after impact", d.after.as_ref()),
        ("phase of impact", d.phase.as_ref()),
        ("energy before impact", d.energy.as_ref()),
        ("energy given at impact", d.energy_given.as_ref()),
        ("restitution", d.restitution.as_ref()),
        ("stroke", Some(&d.displacement.stroke)),
    ];
    for (what, estimate) in estimates.into_iter().filter_map(|(w, e)| Some((w, e?))) {
        let unit = if what.starts_with("phase") { "turn" } else { estimate.unit };
        let of = if matches!(what, "speed" | "stroke") { "" } else { first };
        row(&format!("{of}{what}"), Cell::from(estimate), unit, estimate.n);
    }
    for (number, g) in d.groups.iter().enumerate().skip(1) {
        let all = [
            ("phase of impact", Some(&g.phase)),
            ("velocity before impact", Some(&g.before)),
            ("velocity after impact", Some(&g.after)),
            ("energy before impact", g.energy.as_ref()),
            ("energy given at impact", g.energy_given.as_ref()),
            ("restitution", g.restitution.as_ref()),
        ];
        for (what, estimate) in all.into_iter().filter_map(|(w, e)| Some((w, e?))) {
            let unit = if what.starts_with("phase") { "turn" } else { estimate.unit };
            row(&format!("group {number}: {what}"), Cell::from(estimate), unit, estimate.n);
        }
    }
    row("speed variation", Cell::Number(d.speed_variation), "Hz", d.cycles);
    row("drift of a turn", Cell::from(&d.displacement.drift), "m", d.displacement.drift.n);
    row("largest acceleration", Cell::Number(d.bandwidth.acceleration), "m/s²", d.averaged);
    row("f1", Cell::Number(d.bandwidth.f1), "Hz", d.averaged);
    row("f2", Cell::Number(d.bandwidth.f2), "Hz", d.averaged);
    if let Some(s) = &d.smoothing {
        row(
            if s.kind == SmoothingKind::Exponential {
                "smoothing of the average"
            } else {
                "low-pass of the average"
            },
            Cell::Number(s.corner),
            "Hz",
            d.averaged,
        );
    }
    if d.clipped > 0 {
        row("impacts over-range", Cell::from(d.clipped.to_string().as_str()), "", d.impacts.len());
    }
    row("drop-outs", Cell::from(d.dropouts.to_string().as_str()), "", d.faults.bridged + d.faults.lost);
    row("spikes", Cell::from(d.spikes.to_string().as_str()), "", d.spikes);
    if let Some(e) = &d.exposure {
        row("a_hv", Cell::from(&e.a_hv), "m/s²", e.a_hv.n);
        if let Some(a8) = &e.a8 {
            row("A(8)", Cell::from(a8), "m/s²", a8.n);
        }
        row("crest factor, weighted", Cell::Number(e.crest_factor), "", e.a_hv.n);
        row("peak, unweighted", Cell::Number(e.unweighted_peak), "m/s²", e.a_hv.n);
    }
    table
}

/// The average turn.
pub fn drill_average(drill: &Drill) -> Table {
    let columns = [("phase", "1"), ("velocity", "m/s"), ("velocity scatter", "m/s"), ("displacement", "m")];
    let mut table = headed("Average turn", &columns);
    let (a, x) = (&drill.average, &drill.displacement.value);
    for (((phase, mean), std), x) in a.phase.iter().zip(&a.mean).zip(&a.std).zip(x) {
        table.push([*phase, *mean, *std, *x].map(Cell::Number));
    }
    table
}

/// Every impact.
pub(crate) fn drill_impacts(drill: &Drill) -> Table {
    let columns = [
        ("cycle", ""),
        ("time", "s"),
        ("speed", "Hz"),
        ("phase", "1"),
        ("before", "m/s"),
        ("after", "m/s"),
        ("group", ""),
    ];
    let mut table = headed("Impacts", &columns);
    for i in &drill.impacts {
        let estimate = |value, std| Cell::Estimate { value, std: Some(std) };
        table.push([
            Cell::from(i.cycle),
            Cell::Number(i.time),
            Cell::from(drill.speeds.get(i.cycle).copied()),
            estimate(i.phase, i.phase_std),
            estimate(i.before, i.before_std),
            estimate(i.after, i.after_std),
            Cell::from(i.group),
        ]);
    }
    table
}
