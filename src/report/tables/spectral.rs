//! Spectra and their tones.

use super::headed;
use crate::measure::spectral::SpectralResult;
use crate::report::{Cell, Table};

/// Largest peaks of a record that a table shows.
const SHOWN: usize = 8;

/// The largest peaks of each record, one row a peak.
pub fn spectra(all: &[(&str, &SpectralResult)]) -> Table {
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
    for (name, found) in all {
        for k in found.peaks(SHOWN) {
            let of = |values: &[f64]| values.get(k).copied().filter(|v| v.is_finite());
            let response = found.response.as_ref();
            table.push([
                Cell::from(*name),
                Cell::from(of(&found.frequency)),
                Cell::Estimate { value: found.value[k], std: of(&found.value_std) },
                Cell::from(found.unit.as_str()),
                Cell::from(found.scaling),
                Cell::from(response.and_then(|r| of(&r.phase))),
                Cell::from(response.and_then(|r| of(&r.coherence))),
            ]);
        }
    }
    table
}

/// The sines fitted to each record, one row a sine.
pub fn tones(all: &[(&str, &SpectralResult)]) -> Table {
    let columns = [("record", ""), ("frequency", "Hz"), ("amplitude", ""), ("unit", ""), ("phase", "rad")];
    let mut table = headed("Tones", &columns);
    for (name, found) in all {
        for tone in &found.tones {
            table.push([
                Cell::from(*name),
                Cell::from(&tone.frequency),
                Cell::from(&tone.amplitude),
                Cell::from(tone.amplitude.unit),
                Cell::from(&tone.phase),
            ]);
        }
    }
    table
}
