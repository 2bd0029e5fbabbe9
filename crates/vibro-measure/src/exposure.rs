//! Hand-arm vibration: the weighting `W_h` of ISO 5349-1 on the lines of a spectrum, `a_hv` and A(8).

use super::Estimate;
use super::mean::{Mean, average};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_record::{Error, Finding, Result, uncertain};
use vibro_signal::fft::Transform;

/// Corners of the band limitation in Hz (ISO 5349-1:2001, table A.1).
const BAND: [f64; 2] = [6.310, 1258.9];
/// Quality factor of both corners. Table A.1 prints 0.71; table A.2 of the standard was made with 1/√2.
const BAND_Q: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Transition from acceleration to velocity in Hz (the same table).
const TRANSITION: f64 = 15.915;
/// Quality factor of the transition (the same table).
const TRANSITION_Q: f64 = 0.64;
/// Lowest sampling rate in Hz: four times the upper corner, so that the weighting has room to fall.
const LOWEST_RATE: f64 = 4.0 * 1258.9;
/// Length in s of the parts whose scatter gives the uncertainty: six periods of the lower corner.
const SPAN: f64 = 1.0;
/// Duration in s after which the weighting has settled: its slowest pole falls by e^(−π √2 · 6.31 · t), e⁻¹⁴
/// in this time.
const SETTLED: f64 = 0.5;
/// Least length of the parts that are weighted at once, in multiples of [`SETTLED`].
const PART: usize = 16;

/// The weighting at a frequency in Hz, by the formula of the standard: high-pass, low-pass, transition from
/// acceleration to velocity.
pub fn weighting(frequency: f64) -> Complex64 {
    let s = Complex64::new(0.0, TAU * frequency);
    let [w1, w2] = BAND.map(|f| TAU * f);
    let w3 = TAU * TRANSITION;
    let section = |w: f64, q: f64| w * w + s * (w / q + s);
    s * s / section(w1, BAND_Q) * (w2 * w2) / section(w2, BAND_Q) * (w3 * (s + w3))
        / section(w3, TRANSITION_Q)
}

/// One axis of a handle, weighted; the half second in which the weighting settles is left out.
struct WeightedAxis {
    /// Mean square in m²/s⁴.
    mean_square: f64,
    /// Mean square of each whole second, in m²/s⁴.
    seconds: Vec<f64>,
    /// Largest weighted value, in m/s².
    peak: f64,
    /// Largest unweighted deviation from the mean, in m/s².
    unweighted_peak: f64,
    /// Evaluated duration in s.
    duration: f64,
}

/// Weights accelerations by the formula of the standard at each spectral line of overlapping parts: no
/// frequency is warped at any sampling rate. The first value is continued before the record, so that an
/// offset of the sensor is not a shock. After the record follows its mirror image about the last value,
/// faded to the first value. [`SETTLED`] is left out at both ends of a part, because the transform treats
/// the part as periodic.
///
/// # Errors
/// If the rate is below four times the upper corner of the weighting.
fn weighted(values: &[f64], rate: f64) -> Result<Vec<f64>> {
    if !(rate >= LOWEST_RATE && rate.is_finite()) {
        let why = format!("a rate of {rate} Hz is too low for the weighting W_h, which reaches to 1259 Hz");
        return Err(Error::refused(why).hint(format!("sample the handle at {LOWEST_RATE:.0} Hz or more")));
    }
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return Ok(Vec::new()) };
    let settle = (SETTLED * rate).ceil() as usize;
    let fade = |i: usize| 0.5 + 0.5 * (PI * (i + 1) as f64 / settle as f64).cos();
    let mirror = values.iter().rev().skip(1).take(settle).enumerate();
    let behind = mirror.map(|(i, v)| fade(i) * (2.0 * last - v - first));
    let n = (PART * settle).next_power_of_two();
    let transform = Transform::new(n);
    let weights: Vec<Complex64> =
        (0..transform.lines()).map(|k| weighting(k as f64 * rate / n as f64)).collect();
    let mut record = vec![0.0; settle];
    record.extend(values.iter().map(|v| v - first).chain(behind));
    let mut out = Vec::with_capacity(values.len());
    while out.len() < values.len() {
        let mut lines = transform.forward(&record[out.len()..record.len().min(out.len() + n)]);
        lines.iter_mut().zip(&weights).for_each(|(line, weight)| *line *= weight);
        out.extend_from_slice(&transform.inverse(&lines)[settle..n - settle]);
    }
    out.truncate(values.len());
    Ok(out)
}

impl WeightedAxis {
    fn new(values: &[f64], rate: f64) -> Result<WeightedAxis> {
        let refused = |why: String, hint| Err(Error::refused(why).hint(hint).setting("handle"));
        let missing = values.iter().filter(|v| !v.is_finite()).count();
        if missing > 0 {
            let hint = "mend the cable or the sensor, cut the record, or leave the handle out";
            return refused(format!("{missing} accelerations of the handle are missing"), hint);
        }
        let (settle, span) = ((SETTLED * rate).ceil() as usize, (SPAN * rate) as usize);
        let weighted = weighted(values, rate)?;
        let counted = weighted.get(settle..).unwrap_or_default();
        if counted.is_empty() {
            let why = format!("the handle is shorter than {SETTLED} s, in which the weighting W_h settles");
            return refused(why, "measure longer, or leave the handle out");
        }
        let mean_square = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>() / part.len() as f64;
        let largest =
            |values: &[f64], mean: f64| values.iter().fold(0.0, |top: f64, v| top.max((v - mean).abs()));
        Ok(WeightedAxis {
            mean_square: mean_square(counted),
            seconds: counted.chunks_exact(span).map(mean_square).collect(),
            peak: largest(counted, 0.0),
            unweighted_peak: largest(values, average(values)),
            duration: counted.len() as f64 / rate,
        })
    }
}

uncertain!(Exposure: ; scaled: axes, a_hv, a8);

/// Records shorter than this, in s, are unlikely to be reliable (ISO 5349-2:2001, 5.4.1).
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
    /// Findings: limits of these numbers.
    pub findings: Vec<Finding>,
}

/// Exposure from one to three axes of a handle, in m/s² at `rate` samples a second, for `hours` a day.
///
/// `a_hv` = √(Σ `a_hw²`) and A(8) = `a_hv` √(T/8 h) (ISO 5349-1:2001, equations 1 and 2). Uncertainties come
/// from the scatter from second to second (Müller 2007, as for turns of a drill). That of `a_hv` uses the sum
/// of squares over the axes, since they rise and fall together. Below four seconds there are none. They
/// contain neither calibration nor mounting.
///
/// # Errors
/// If there is no axis or there are more than three, a rate that is too low, a duration that is not above 0
/// and at most 24 h, a missing sample, a record in which the weighting does not settle, or no vibration.
pub fn exposure(rate: f64, handles: &[&[f64]], hours: Option<f64>) -> Result<Exposure> {
    if handles.is_empty() || handles.len() > 3 {
        return Err(Error::usage(format!("{} axes of a handle", handles.len()), "one to three"));
    }
    check_hours(hours)?;
    let all: Vec<WeightedAxis> =
        handles.iter().map(|values| WeightedAxis::new(values, rate)).collect::<Result<_>>()?;
    let total: f64 = all.iter().map(|a| a.mean_square).sum();
    if total <= 0.0 {
        return Err(Error::refused("the handle does not vibrate: its acceleration does not change"));
    }
    // Uncertainty of a root x of y = x²: u_x = u_y/(2x).
    let root = |square: f64, mean: &Mean, method| {
        let rms = square.sqrt();
        Estimate::new(rms, mean.std.map(|s| s / (2.0 * rms)), "m/s²", mean.n, method)
    };
    let axes =
        all.iter().map(|a| root(a.mean_square, &Mean::of(&a.seconds), "RMS weighted by W_h, ISO 5349-1"));
    let seconds = all.iter().map(|a| a.seconds.len()).min().unwrap_or(0);
    let together: Vec<f64> = (0..seconds).map(|k| all.iter().map(|a| a.seconds[k]).sum()).collect();
    let together = Mean::of(&together);
    let a_hv = root(total, &together, "root of the sum of squares of the axes");
    let a8 = hours.map(|h| {
        let part = (h / 8.0).sqrt();
        Estimate::new(part * a_hv.value, a_hv.std.map(|s| part * s), "m/s²", a_hv.n, "a_hv √(T/8 h)")
    });
    let duration = all.iter().map(|a| a.duration).fold(f64::INFINITY, f64::min);
    let missing = Finding::caution("exposure-axes-missing").count("axes", handles.len());
    let short = Finding::caution("exposure-record-short").number("duration", duration);
    let findings = [
        (true, Finding::note("exposure-understates-shocks")),
        (handles.len() < 3, missing),
        (together.wanders, Finding::caution("exposure-slow-changes")),
        (duration < SHORT, short),
    ];
    let crest = all.iter().map(|a| a.peak / a.mean_square.sqrt()).filter(|c| c.is_finite());
    Ok(Exposure {
        crest_factor: crest.fold(0.0, f64::max),
        unweighted_peak: all.iter().map(|a| a.unweighted_peak).fold(0.0, f64::max),
        axes: axes.collect(),
        a_hv,
        a8,
        hours,
        findings: findings.into_iter().filter(|f| f.0).map(|f| f.1).collect(),
    })
}

/// Checks the hours a day of an exposure.
///
/// # Errors
/// If they are not above 0 and at most 24.
pub(crate) fn check_hours(hours: Option<f64>) -> Result<()> {
    let Some(h) = hours.filter(|h| !(*h > 0.0 && *h <= 24.0)) else { return Ok(()) };
    let found = format!("an exposure of {h} hours a day");
    Err(Error::usage(found, "a number above 0, at most 24").setting("exposure"))
}

#[cfg(test)]
mod tests;
