//! Bands in which impacts ring, for records that as a whole show none: a resonance that each impact excites,
//! above hum, shafts and noise.

use crate::mean::average;
use vibro_record::{Finding, Result, Trace};
use vibro_signal::filter::Filter;

/// Order of one pass of a filter.
const ORDER: usize = 4;
/// Highest corner over half the sampling rate: the filter needs room for its flank.
const HIGHEST: f64 = 0.9;
/// Number of bands, each an octave wide and half an octave below the one before.
const BANDS: i32 = 10;
/// Least kurtosis of a band with impacts: noise has 3, a tone whose amplitude varies as a sine 2.9 or less
/// (J. Antoni, Mech. Syst. Signal Process. 20 (2006) 282).
const IMPULSIVE: f64 = 3.5;

/// Octaves in Hz below half the `rate` in Hz, the highest first.
pub fn octaves(rate: f64) -> impl Iterator<Item = (f64, f64)> {
    let high = move |k: i32| 0.5 * HIGHEST * rate * 2f64.powf(-0.5 * f64::from(k));
    (0..BANDS).map(high).map(|high| (0.5 * high, high))
}

/// The values, zero-phase filtered to the band between both corners in Hz.
///
/// # Errors
/// As [`Filter::high_pass`] and [`Filter::zero_phase`].
pub fn within(values: &[f64], (low, high): (f64, f64), rate: f64) -> Result<Vec<f64>> {
    let above = Filter::high_pass(low, ORDER, rate)?.zero_phase(values)?;
    Filter::low_pass(high, ORDER, rate)?.zero_phase(&above)
}

/// Whether impacts ring in a band of a trace.
pub fn is_impulsive(trace: &Trace, band: (f64, f64)) -> bool {
    let values = trace.sampling_rate().and_then(|rate| within(&trace.values, band, rate)).unwrap_or_default();
    let moment = |power: i32| average(&values.iter().map(|v| v.powi(power)).collect::<Vec<f64>>());
    moment(4) > IMPULSIVE * moment(2).powi(2)
}

/// Finding that impacts were searched in this band.
pub fn chosen((low, high): (f64, f64)) -> Finding {
    Finding::caution("impacts-in-band").number("low", low).number("high", high)
}
