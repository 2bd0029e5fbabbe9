//! Spectra and their tones.

use crate::measure::spectral::SpectralResult;
use crate::report::layout::table;
use crate::report::{Cell, Table};

/// Largest peaks of a record that a table shows.
const SHOWN: usize = 8;

/// The largest peaks of a record, one row a peak.
pub fn peaks(name: &str, found: &SpectralResult) -> Table {
    let of = |values: &[f64], k: usize| values.get(k).copied().filter(|v| v.is_finite());
    let response = found.response.as_ref();
    table(
        "Largest peaks of spectra",
        found.peaks(SHOWN),
        &[
            ("record", "", &|_| Cell::from(name)),
            ("frequency", "Hz", &|k| Cell::from(of(&found.frequency, *k))),
            ("value", "", &|k| Cell::Estimate { value: found.value[*k], std: of(&found.value_std, *k) }),
            ("unit", "", &|_| Cell::from(found.unit.as_str())),
            ("scaling", "", &|_| Cell::from(found.scaling)),
            ("phase", "°", &|k| Cell::from(response.and_then(|r| of(&r.phase, *k)))),
            ("coherence", "", &|k| Cell::from(response.and_then(|r| of(&r.coherence, *k)))),
        ],
    )
}

/// How the lines of a record were taken.
pub fn taken(found: &SpectralResult) -> Table {
    table(
        "Settings of the spectra",
        [found],
        &[
            ("record", "", &|f| Cell::from(f.name.as_str())),
            ("lines", "", &|f| Cell::from(f.frequency.len())),
            ("scaling", "", &|f| Cell::from(f.scaling)),
            ("unit", "", &|f| Cell::from(f.unit.as_str())),
            ("levels in", "", &|f| Cell::from(f.level_unit.as_deref().unwrap_or("-"))),
            ("window", "", &|f| Cell::from(f.window)),
            ("ENBW", "lines", &|f| Cell::Number(f.enbw)),
            ("detrend", "", &|f| Cell::from(f.detrend)),
            ("averages", "", &|f| Cell::from(f.averages)),
        ],
    )
}

/// The sines fitted to a record, one row a sine.
pub fn tones(name: &str, found: &SpectralResult) -> Table {
    table(
        "Tones",
        &found.tones,
        &[
            ("record", "", &|_| Cell::from(name)),
            ("frequency", "Hz", &|t| Cell::from(&t.frequency)),
            ("amplitude", "", &|t| Cell::from(&t.amplitude)),
            ("unit", "", &|t| Cell::from(t.amplitude.unit)),
            ("phase", "rad", &|t| Cell::from(&t.phase)),
        ],
    )
}
