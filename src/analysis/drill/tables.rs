//! Tables of drills.

use crate::measure::Estimate;
use crate::measure::drill::{Corner, Drill, Group};
use crate::report::layout::{headed, pair};
use crate::report::{Cell, Table};

/// Note on the velocities: those in the middle of the contact differ from those at first contact if the drive
/// accelerates the striker, and the energy then differs by some per cent.
const MIDDLE: &str = "Velocities before and after impact, energy and restitution: continued to the middle of the contact, as if the impact took no time. First contact is earlier.";

/// Results of a drill, one row a number.
pub fn drill(name: &str, d: &Drill) -> Table {
    let columns = [("record", ""), ("quantity", ""), ("value", ""), ("unit", ""), ("n", "")];
    let mut table = headed("Hammer drill", &columns);
    let mut row = |what: &str, value: Cell, unit: &str, n: usize| {
        table.push([Cell::from(name), Cell::from(what), value, Cell::from(unit), Cell::from(n)]);
    };
    row("speed", Cell::from(&d.speed), "Hz", d.speed.n);
    let minute = Cell::Estimate { value: 60.0 * d.speed.value, std: d.speed.std.map(|std| 60.0 * std) };
    row("speed", minute, "rpm", d.speed.n);
    for (number, group) in d.groups.iter().enumerate() {
        let group_name = if d.groups.len() > 1 { format!("group {number}: ") } else { String::new() };
        for (what, e) in means(group) {
            let unit = if e.unit == "1" && what.starts_with("phase") { "turn" } else { e.unit };
            row(&format!("{group_name}{what}"), Cell::from(e), unit, e.n);
        }
    }
    let (x, b) = (&d.displacement, &d.bandwidth);
    let millimetres = |e: &Estimate| pair(1e3 * e.value, e.std.map(|std| 1e3 * std));
    row("stroke", millimetres(&x.stroke), "mm", x.stroke.n);
    row("speed variation", pair(d.speed_variation, None), "Hz", d.cycles);
    row("drift of a turn", millimetres(&x.drift), "mm", x.drift.n);
    row("largest acceleration", pair(b.acceleration, None), "m/s²", d.averaged);
    row("bandwidth f1, of velocity", pair(b.f1, None), "Hz", d.averaged);
    row("bandwidth f2, of acceleration", pair(b.f2, None), "Hz", d.averaged);
    if let Some(s) = &d.smoothing {
        let (what, corner) = match *s {
            Corner::ZeroPhaseLowPass(corner) => ("low-pass of the average", corner),
            Corner::Exponential(corner) => ("smoothing of the average", corner),
        };
        row(what, Cell::Number(corner), "Hz", d.averaged);
    }
    let mut count = |what: &str, number: usize, n: usize| row(what, Cell::from(number.to_string()), "", n);
    if d.clipped > 0 {
        count("impacts over-range", d.clipped, d.impacts.len());
    }
    count("drop-outs", d.dropouts, d.faults.bridged + d.faults.lost);
    count("spikes", d.faults.spikes, d.faults.spikes);
    if let Some(e) = &d.exposure {
        row("a_hv", Cell::from(&e.a_hv), "m/s²", e.a_hv.n);
        if let Some(a8) = &e.a8 {
            row("A(8)", Cell::from(a8), "m/s²", a8.n);
        }
        row("crest factor, weighted", pair(e.crest_factor, None), "", e.a_hv.n);
        row("peak, unweighted", pair(e.unweighted_peak, None), "m/s²", e.a_hv.n);
    }
    table.note(if d.impacts.is_empty() { "" } else { MIDDLE })
}

/// Means of a group of impacts, by their names.
fn means(group: &Group) -> impl Iterator<Item = (&'static str, &Estimate)> {
    let all = [
        ("velocity at first contact", Some(&group.first_contact)),
        ("velocity before impact", Some(&group.before)),
        ("velocity after impact", Some(&group.after)),
        ("phase of impact", Some(&group.phase)),
        ("energy before impact", group.energy.as_ref()),
        ("energy given at impact", group.energy_given.as_ref()),
        ("restitution", group.restitution.as_ref()),
    ];
    all.into_iter().filter_map(|(what, estimate)| Some((what, estimate?)))
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
    let units = ["", "s", "Hz", "1", "m/s", "m/s", ""];
    let names = ["cycle", "time", "speed", "phase", "before", "after", "group"];
    let columns: Vec<(&str, &str)> = names.into_iter().zip(units).collect();
    let mut table = headed("Impacts", &columns);
    for i in &drill.impacts {
        let estimate = |value, std| Cell::Estimate { value, std };
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
