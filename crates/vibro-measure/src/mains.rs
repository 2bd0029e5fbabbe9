//! Mains hum, as it is found and removed.

use serde::Serialize;
use vibro_record::Finding;

/// Nominal frequencies of the mains in Hz.
pub(crate) const MAINS: [f64; 2] = [50.0, 60.0];
/// Highest harmonic of the mains that is looked for, the fundamental included.
pub(crate) const HARMONICS: usize = 7;
/// Largest deviation of the mains from a nominal frequency during a record, in Hz.
const TOLERANCE: f64 = 0.2;

/// Nominal frequencies of the mains and their harmonics, and the largest deviations from them, in Hz.
pub(crate) fn harmonics() -> impl Iterator<Item = (f64, f64)> {
    let orders = |mains: f64| (1..=HARMONICS).map(move |k| (mains * k as f64, TOLERANCE * k as f64));
    MAINS.into_iter().flat_map(orders)
}

/// A fitted mains sine.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Hum {
    /// Frequency in Hz, the mean where the record was fitted in pieces.
    pub frequency: f64,
    /// Amplitude of the fundamental, in the unit of the trace.
    pub amplitude: f64,
    /// Number of fitted harmonics, the fundamental included.
    pub harmonics: usize,
}

impl Hum {
    /// Note that it was removed from values of this `unit`.
    pub(crate) fn removed(&self, unit: &str) -> Finding {
        let removed = Finding::note("mains-hum-removed").number("frequency", self.frequency);
        removed.name("unit", unit).number("amplitude", self.amplitude).count("harmonics", self.harmonics)
    }
}
