//! Motions with several impacts a period, as JSON and as rows of tables.

use crate::error::{Error, Result};
use crate::model::{Excitation, PeriodicOrbit, Sine};
use crate::report::layout::table;
use crate::report::{Cell, Table};
use num_complex::Complex64;
use serde_json::{Value, json};

/// The sine force: for other excitations, motions with several impacts a period are not solved.
///
/// # Errors
/// If it is another excitation.
pub(super) fn sine(excitation: &Excitation) -> Result<Sine> {
    match excitation {
        Excitation::Sine(sine) => Ok(*sine),
        _ => Err(Error::usage(
            "an excitation that is no sine",
            "a sine force: only of it several impacts a period are solved",
        )
        .setting("force")),
    }
}

/// A motion as JSON: the keys of one with a single impact a period, and its impacts. `gap_std` is the
/// standard uncertainty of the gap in m.
pub(super) fn to_json(orbit: &PeriodicOrbit, gap_std: Option<f64>) -> Value {
    let v = &orbit.validity;
    let mut fields = json!({
        "frequency": orbit.sine.frequency,
        "cycles": orbit.cycles,
        "impacts": orbit.beats,
        "impulse": orbit.beats.iter().map(|b| b.impulse).sum::<f64>(),
        "multipliers": orbit.multipliers.map(|all| all.map(|z| [z.re, z.im])),
        "spectral_radius": orbit.spectral_radius(),
        "robust": gap_std.map(|std| v.real() && v.grazing_distance > std),
        "near_grazing": gap_std.map(|std| v.grazing_distance <= std),
        "peak_to_peak": orbit.peak_to_peak,
        "fundamental": orbit.fundamental.map(Complex64::norm),
        "fundamental_phase": orbit.fundamental.map(Complex64::arg),
    });
    for (key, verdict) in v.keys() {
        fields[key] = verdict;
    }
    fields
}

/// Quantities, validity and stability of each motion.
pub(super) fn motions(orbits: &[PeriodicOrbit], gap_std: Option<f64>) -> Table {
    table(
        "Motions with several impacts a period",
        orbits.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("impulse a period", "N s", &|(_, o)| Cell::from(o.beats.iter().map(|b| b.impulse).sum::<f64>())),
            ("slowest impact", "m/s", &|(_, o)| {
                Cell::from(o.beats.iter().map(|b| b.approach_velocity).fold(f64::INFINITY, f64::min))
            }),
            ("x1 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[1])),
            ("admissible", "", &|(_, o)| o.validity.admissible.into()),
            ("stability", "", &|(_, o)| match o.validity.instability {
                Some(loss) => Cell::from(format!("{}: {}", o.validity.stability(), loss.name())),
                None => Cell::from(o.validity.stability()),
            }),
            ("robust", "", &|(_, o)| {
                gap_std.map(|std| o.validity.real() && o.validity.grazing_distance > std).into()
            }),
            ("largest multiplier", "", &|(_, o)| Cell::from(o.spectral_radius())),
            ("least gap", "m", &|(_, o)| Cell::from(o.validity.min_gap)),
            ("grazing distance, first order", "m", &|(_, o)| Cell::from(o.validity.grazing_distance)),
        ],
    )
    .note("Admissible: the masses do not pass through each other. Robust: farther from grazing than the gap is uncertain.")
}

/// The impacts of each motion.
pub(super) fn impacts(orbits: &[PeriodicOrbit]) -> Table {
    let all = orbits.iter().enumerate();
    table(
        "Impacts of each motion",
        all.flat_map(|(i, o)| o.beats.iter().enumerate().map(move |(k, beat)| (i, k, beat))),
        &[
            ("no.", "", &|(i, ..)| Cell::from(i + 1)),
            ("impact", "", &|(_, k, _)| Cell::from(k + 1)),
            ("phase of the force", "rad", &|(.., b)| Cell::from(b.phase)),
            ("impulse", "N s", &|(.., b)| Cell::from(b.impulse)),
            ("approach speed", "m/s", &|(.., b)| Cell::from(b.approach_velocity)),
            ("time to the next", "s", &|(.., b)| Cell::from(b.interval)),
        ],
    )
}
