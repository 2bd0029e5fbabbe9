//! Hand-arm vibration: the weighting `W_h` of ISO 5349-1 as a digital filter, `a_hv` and A(8).

mod handle;

pub use handle::Handle;

use super::Estimate;
use super::mean::Mean;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::{Error, Finding, Result};
use vibro_signal::filter::{Analogue, Filter, Running};

/// Corners of the band limitation in Hz and their quality (ISO 5349-1:2001, table A.1, where it is
/// printed as 0.71; its table A.2 was made with 1/√2).
const BAND: [f64; 2] = [6.310, 1258.9];
const BAND_Q: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Transition from acceleration to velocity.
const TRANSITION: f64 = 15.915;
const TRANSITION_Q: f64 = 0.64;
/// Lowest sampling rate in Hz: four times the upper corner, so that the weighting has room to fall.
const LOWEST_RATE: f64 = 4.0 * 1258.9;
/// Duration in s over which the scatter of the vibration is taken.
const SPAN: f64 = 1.0;
/// Part of a record that may be missing: what takes away samples is likely what shakes most, and a mean over the rest then says little.
const MISSING: f64 = 0.05;
/// Duration in s after which the weighting has settled: its slowest pole falls by e^(−π √2 · 6.31 · t), e⁻¹⁴ in this time.
const SETTLED: f64 = 0.5;

/// The weighting at a frequency in Hz, by the formula of the standard.
pub fn weighting(frequency: f64) -> Complex64 {
    let s = Complex64::new(0.0, TAU * frequency);
    analogue().iter().map(|(b, a)| (b[0] + s * (b[1] + s * b[2])) / (a[0] + s * (a[1] + s * a[2]))).product()
}

/// Numerators and denominators in rising powers of s: high-pass, low-pass, transition.
fn analogue() -> [([f64; 3], [f64; 3]); 3] {
    let [w1, w2] = BAND.map(|f| TAU * f);
    let w3 = TAU * TRANSITION;
    [
        ([0.0, 0.0, 1.0], [w1 * w1, w1 / BAND_Q, 1.0]),
        ([w2 * w2, 0.0, 0.0], [w2 * w2, w2 / BAND_Q, 1.0]),
        ([w3 * w3, w3, 0.0], [w3 * w3, w3 / TRANSITION_Q, 1.0]),
    ]
}

/// The weighting as a digital filter. Each section is transformed bilinearly so that it is exact at its own corner.
#[derive(Debug, Clone)]
struct Weighting {
    filter: Filter,
    running: Option<Running>,
}

impl Weighting {
    /// A filter for `rate` samples a second.
    ///
    /// # Errors
    /// If the rate is below four times the upper corner of the weighting.
    fn new(rate: f64) -> Result<Weighting> {
        if !(rate >= LOWEST_RATE && rate.is_finite()) {
            return Err(Error::refused(format!(
                "a rate of {rate} Hz is too low for the weighting W_h, which reaches to 1259 Hz"
            ))
            .hint(format!("sample the handle at {LOWEST_RATE:.0} Hz or more")));
        }
        let corners = [BAND[0], BAND[1], TRANSITION];
        let sections: Vec<Analogue> =
            analogue().into_iter().zip(corners).map(|((b, a), exact)| Analogue { b, a, exact }).collect();
        Ok(Weighting { filter: Filter::analogue(&sections, rate)?, running: None })
    }

    /// Weights the next samples in place. The filter begins as if the first value had been there for ever: an offset of the
    /// sensor is no shock.
    fn apply(&mut self, values: &mut [f64]) {
        let Some(first) = values.first() else { return };
        let filter = &self.filter;
        self.running.get_or_insert_with(|| filter.settled_at(*first)).apply(values);
    }
}

/// Records shorter than this in s are unlikely to be reliable (ISO 5349-2:2001, 5.4.1).
const SHORT: f64 = 8.0;

/// Exposure of a hand.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Exposure {
    /// Weighted RMS acceleration of each axis.
    pub axes: Vec<Estimate>,
    /// Vibration total value: root of the sum of squares of the axes.
    pub a_hv: Estimate,
    /// Daily exposure related to eight hours; `None` where no duration was given.
    pub a8: Option<Estimate>,
    /// Duration in hours of A(8).
    pub hours: Option<f64>,
    /// Largest weighted acceleration over the weighted RMS, of the axis where that is largest.
    pub crest_factor: f64,
    /// Largest unweighted deviation of any axis from its mean, in m/s².
    pub unweighted_peak: f64,
    /// What must be known with these numbers.
    pub findings: Vec<Finding>,
}

/// Exposure from one to three axes of a handle; `hours` of it a day.
///
/// `a_hv` = √(Σ `a_hw²`) and A(8) = `a_hv` √(T/8 h) (ISO 5349-1:2001, equations 1 and 2). Uncertainties are those of the scatter
/// from second to second (Müller 2007, as for turns of a drill), for `a_hv` of the sum of squares over the axes, since they rise and fall
/// together; only seconds without a gap in any axis count for them, and there are none below four. Missing samples, and the half
/// second behind each, in which the weighting settles anew, are in no mean square. Neither calibration nor mounting are in them.
///
/// # Errors
/// If there is no axis or there are more than three, a duration that is not above 0 and at most 24 h, more than 5 % of an axis
/// missing, a record without a stretch in which the weighting settles, or no vibration.
pub fn exposure(handles: &[Handle], hours: Option<f64>) -> Result<Exposure> {
    if handles.is_empty() || handles.len() > 3 {
        return Err(Error::usage(format!("{} axes of a handle", handles.len()), "one to three"));
    }
    check_hours(hours)?;
    for handle in handles {
        let part = 100.0 * handle.missing as f64 / handle.samples().max(1) as f64;
        if part > 100.0 * MISSING {
            let limit = 100.0 * MISSING;
            return Err(Error::refused(format!(
                "{part:.1} % of the accelerations of the handle are missing, more than {limit:.0} %"
            ))
            .hint("mend the cable or the sensor, cut the record, or leave the handle out")
            .setting("handle"));
        }
    }
    if handles.iter().any(|h| h.counted() == 0) {
        return Err(Error::refused(format!(
            "the handle has no stretch without a gap for {SETTLED} s, in which the weighting W_h settles"
        ))
        .hint("measure longer, or leave the handle out")
        .setting("handle"));
    }
    // Of y = x²: u_x = u_y/(2x).
    let root = |square: f64, seconds: &[f64], method: &str| {
        let (rms, mean) = (square.sqrt(), Mean::of(seconds));
        Estimate::new(rms, mean.std.map(|s| s / (2.0 * rms)), "m/s²", mean.n, method)
    };
    let axis = |h: &Handle| {
        let seconds: Vec<f64> = h.seconds().flatten().collect();
        root(h.mean_square(), &seconds, "RMS weighted by W_h, ISO 5349-1")
    };
    let axes: Vec<Estimate> = handles.iter().map(axis).collect();
    let total: f64 = handles.iter().map(Handle::mean_square).sum();
    if total <= 0.0 {
        return Err(Error::refused("the handle does not vibrate: its acceleration does not change"));
    }
    let mut sums: Vec<Option<f64>> = handles[0].seconds().collect();
    for handle in &handles[1..] {
        sums = sums.iter().zip(handle.seconds()).map(|(a, b)| Some((*a)? + b?)).collect();
    }
    let together: Vec<f64> = sums.into_iter().flatten().collect();
    let a_hv = root(total, &together, "root of the sum of squares of the axes");
    let a8 = hours.map(|h| {
        let part = (h / 8.0).sqrt();
        Estimate::new(part * a_hv.value, a_hv.std.map(|s| part * s), "m/s²", a_hv.n, "a_hv √(T/8 h)")
    });
    let crest = |h: &Handle| h.peak / h.mean_square().sqrt();
    let crest_factor = handles.iter().map(crest).filter(|c| c.is_finite()).fold(0.0, f64::max);
    let mut findings = vec![Finding::note("exposure-understates-shocks")];
    if handles.len() < 3 {
        findings.push(Finding::caution("exposure-axes-missing").count("axes", handles.len()));
    }
    if Mean::of(&together).wanders {
        findings.push(Finding::caution("exposure-slow-changes"));
    }
    let duration = handles.iter().map(Handle::duration).fold(f64::INFINITY, f64::min);
    if duration < SHORT {
        findings.push(Finding::caution("exposure-record-short").number("duration", duration));
    }
    let missing: usize = handles.iter().map(|h| h.missing).sum();
    if missing > 0 {
        let counted: usize = handles.iter().map(Handle::counted).sum();
        let all: usize = handles.iter().map(Handle::samples).sum();
        let share = counted as f64 / all as f64;
        findings
            .push(Finding::caution("exposure-samples-missing").count("n", missing).number("counted", share));
    }
    let unweighted_peak = handles.iter().map(Handle::unweighted_peak).fold(0.0, f64::max);
    Ok(Exposure { axes, a_hv, a8, hours, crest_factor, unweighted_peak, findings })
}

/// Hours a day of an exposure.
///
/// # Errors
/// If they are not above 0 and at most 24.
pub(crate) fn check_hours(hours: Option<f64>) -> Result<()> {
    match hours.filter(|h| !(*h > 0.0 && *h <= 24.0)) {
        Some(h) => {
            Err(Error::usage(format!("an exposure of {h} hours a day"), "a number above 0, at most 24")
                .setting("exposure"))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
