//! Motions of a rig as tables.

use crate::model::{NoImpact, Orbit, Response, Softened};
use crate::report::layout::table;
use crate::report::{Cell, Table};

fn word(yes: bool) -> Cell {
    Cell::from(if yes { "yes" } else { "no" })
}

/// What each motion does.
pub fn orbits(orbits: &[Orbit]) -> Table {
    let unit = orbits.first().map_or("rad", Orbit::timing_unit);
    table(
        "Motions with one impact a period",
        orbits.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("impulse", "N s", &|(_, o)| Cell::from(o.impulse)),
            ("approach speed", "m/s", &|(_, o)| Cell::from(o.approach_velocity)),
            ("timing", unit, &|(_, o)| Cell::from(o.timing)),
            ("x1 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[1])),
            ("x1 fundamental", "m", &|(_, o)| Cell::from(o.fundamental[0].norm())),
            ("x2 fundamental", "m", &|(_, o)| Cell::from(o.fundamental[1].norm())),
        ],
    )
}

/// What each motion is worth; `gap_std` is the standard uncertainty of the gap in m.
pub fn verdicts(orbits: &[Orbit], gap_std: Option<f64>) -> Table {
    table(
        "Verdicts",
        orbits.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("exists", "", &|(_, o)| word(o.validity.exists)),
            ("admissible", "", &|(_, o)| word(o.validity.admissible)),
            ("stability", "", &|(_, o)| match o.validity.instability {
                Some(loss) => Cell::from(format!("{}: {}", o.validity.stability.name(), loss.name())),
                None if o.validity.exists => Cell::from(o.validity.stability.name()),
                None => Cell::Missing,
            }),
            ("robust", "", &|(_, o)| gap_std.map_or(Cell::Missing, |std| word(o.robust(std)))),
            ("largest multiplier", "", &|(_, o)| Cell::from(o.spectral_radius())),
            ("least gap", "m", &|(_, o)| Cell::from(o.validity.min_gap)),
            ("closest approach", "m", &|(_, o)| Cell::from(o.validity.clearance)),
            ("grazing distance, first order", "m", &|(_, o)| Cell::from(o.validity.grazing_distance)),
            ("energy rule", "", &|(_, o)| word(o.validity.energy_rule)),
        ],
    )
}

/// The motion without impacts.
pub fn no_impact(motion: &NoImpact) -> Table {
    Table::new("Motion without impacts")
        .column("possible", "")
        .column("amplitude", "m")
        .column("largest x1", "m")
        .row([word(motion.possible), motion.amplitude.into(), motion.largest.into()])
}

/// The course of a motion over two periods, from an impact on.
pub fn course(orbit: &Orbit, gap: f64, points: usize) -> Table {
    let rows = (0..=2 * points).map(|i| {
        let t = orbit.period() * i as f64 / points as f64;
        (t, orbit.state(t))
    });
    table(
        "Course",
        rows,
        &[
            ("time", "s", &|(t, _)| Cell::from(*t)),
            ("x1", "m", &|(_, s)| Cell::from(s.x1)),
            ("v1", "m/s", &|(_, s)| Cell::from(s.v1)),
            ("x2", "m", &|(_, s)| Cell::from(s.x2)),
            ("v2", "m/s", &|(_, s)| Cell::from(s.v2)),
            ("gap", "m", &move |(_, s)| Cell::from(gap + s.x2 - s.x1)),
        ],
    )
}

/// Every motion at every frequency.
pub fn branches(response: &Response) -> Table {
    let rows = response.points.iter().flat_map(|p| p.orbits.iter().filter(|o| o.validity.exists));
    table(
        "Motions with one impact a period",
        rows,
        &[
            ("frequency", "Hz", &|o| Cell::from(o.frequency)),
            ("impulse", "N s", &|o| Cell::from(o.impulse)),
            ("approach speed", "m/s", &|o| Cell::from(o.approach_velocity)),
            ("x1 peak to peak", "m", &|o| Cell::from(o.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|o| Cell::from(o.peak_to_peak[1])),
            ("x1 fundamental", "m", &|o| Cell::from(o.fundamental[0].norm())),
            ("x2 fundamental", "m", &|o| Cell::from(o.fundamental[1].norm())),
            ("admissible", "", &|o| word(o.validity.admissible)),
            ("stability", "", &|o| Cell::from(o.validity.stability.name())),
            ("largest multiplier", "", &|o| Cell::from(o.spectral_radius())),
            ("least gap", "m", &|o| Cell::from(o.validity.min_gap)),
            ("grazing distance, first order", "m", &|o| Cell::from(o.validity.grazing_distance)),
        ],
    )
}

/// Where motions change.
pub fn changes(response: &Response) -> Table {
    table(
        "Changes",
        &response.changes,
        &[
            ("frequency", "Hz", &|c| Cell::from(c.frequency)),
            ("change", "", &|c| Cell::from(c.kind.name())),
            ("x1 amplitude", "m", &|c| Cell::from(c.amplitude[0])),
            ("x2 amplitude", "m", &|c| Cell::from(c.amplitude[1])),
        ],
    )
}

/// What the duration of the contact changes in each motion.
pub fn soft(all: &[Option<Softened>]) -> Table {
    table(
        "With the contact's duration",
        all.iter().enumerate().filter_map(|(i, soft)| soft.map(|s| (i, s))),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("impulse", "N s", &|(_, s)| Cell::from(s.impulse)),
            ("approach speed", "m/s", &|(_, s)| Cell::from(s.approach_velocity)),
            ("change of impulse", "1", &|(_, s)| Cell::from(s.change)),
            ("in contact", "1", &|(_, s)| Cell::from(s.share)),
            ("x1 peak to peak", "m", &|(_, s)| Cell::from(s.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|(_, s)| Cell::from(s.peak_to_peak[1])),
        ],
    )
}
