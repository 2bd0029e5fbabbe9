//! Spectra and their tones.

use crate::measure::spectral::SpectralResult;
use crate::report::layout::headed;
use crate::report::{Cell, Table};

/// Largest peaks of a record that a table shows.
const SHOWN: usize = 8;

/// The largest peaks of a record, one row a peak.
pub fn peaks(name: &str, found: &SpectralResult) -> Table {
    let columns = [
        ("record", ""),
        ("frequency", "Hz"),
        ("value", ""),
        ("unit", ""),
        ("scaling", ""),
        ("phase", "°"),
        ("coherence", ""),
    ];
    let mut table = headed("Largest peaks of spectra", &columns);
    for k in found.peaks(SHOWN) {
        let of = |values: &[f64]| values.get(k).copied().filter(|v| v.is_finite());
        let response = found.response.as_ref();
        table.push([
            Cell::from(name),
            Cell::from(of(&found.frequency)),
            Cell::Estimate { value: found.value[k], std: of(&found.value_std) },
            Cell::from(found.unit.as_str()),
            Cell::from(found.scaling),
            Cell::from(response.and_then(|r| of(&r.phase))),
            Cell::from(response.and_then(|r| of(&r.coherence))),
        ]);
    }
    table
}

/// How the lines of a record were taken.
pub fn taken(found: &SpectralResult) -> Table {
    let columns = [
        ("record", ""),
        ("lines", ""),
        ("scaling", ""),
        ("unit", ""),
        ("levels in", ""),
        ("window", ""),
        ("ENBW", "lines"),
        ("detrend", ""),
        ("averages", ""),
    ];
    headed("How they were taken", &columns).row([
        Cell::from(found.name.as_str()),
        Cell::from(found.frequency.len()),
        Cell::from(found.scaling),
        Cell::from(found.unit.as_str()),
        Cell::from(found.level_unit.as_deref().unwrap_or("-")),
        Cell::from(found.window),
        Cell::Number(found.enbw),
        Cell::from(found.detrend),
        Cell::from(found.averages),
    ])
}

/// The sines fitted to a record, one row a sine.
pub fn tones(name: &str, found: &SpectralResult) -> Table {
    let columns = [("record", ""), ("frequency", "Hz"), ("amplitude", ""), ("unit", ""), ("phase", "rad")];
    let mut table = headed("Tones", &columns);
    for tone in &found.tones {
        table.push([
            Cell::from(name),
            Cell::from(&tone.frequency),
            Cell::from(&tone.amplitude),
            Cell::from(tone.amplitude.unit),
            Cell::from(&tone.phase),
        ]);
    }
    table
}
