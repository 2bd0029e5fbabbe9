//! Several sines of one record, fitted together.
//!
//! The strongest line of what is left gives the next sine; all that are known are then fitted together (`sinusoids`).

use super::Estimate;
use super::sine::Lines;
use super::sinusoids::{Fit, fit};
use serde::Serialize;
use vibro_record::{Error, Finding, Result, Trace};

/// Most sines of one record.
pub const MOST: usize = 10;
/// Sines nearer than this part of 1/T shake each other so much that a fit of white noise finds two where there is one.
const NEAREST: f64 = 0.5;

/// One sine A cos(2πft + φ).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tone {
    /// Frequency in Hz.
    pub frequency: Estimate,
    /// Amplitude A.
    pub amplitude: Estimate,
    /// Phase φ in rad at the first sample.
    pub phase: Estimate,
}

/// Sines of a record, and what is left.
#[derive(Debug, Clone, PartialEq)]
pub struct Tones {
    /// The sines, the strongest first.
    pub tones: Vec<Tone>,
    /// Standard deviation of what is left, in the unit of the trace.
    pub noise: f64,
    /// Why there are fewer than asked for, and what limits their uncertainties.
    pub findings: Vec<Finding>,
}

/// The `count` strongest sines of a trace; fewer, with a finding, where no more stand out of the noise or can be parted. One beside
/// which what is left holds another large line has no uncertainty.
///
/// ```
/// use vibro_measure::tones::tones;
/// use vibro_record::{Axis, Meta, Trace};
/// use vibro_record::units::Unit;
/// let values = (0..500).map(|i| 2.0 * (0.3 * i as f64).cos() + 0.5 * (0.35 * i as f64).cos()).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let found = tones(&Trace { meta, axis: Axis::time(0.0, 1e-3, 500), values }, 2)?;
/// assert!((found.tones[1].frequency.value - 350.0 / std::f64::consts::TAU).abs() < 1e-6);
/// assert!((found.tones[1].amplitude.value - 0.5).abs() < 1e-6);
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If `count` is not 1 to [`MOST`]; as [`super::sine::sine`] where there is not even one.
pub fn tones(trace: &Trace, count: usize) -> Result<Tones> {
    if !(1..=MOST).contains(&count) {
        return Err(Error::usage(format!("{count} tones"), format!("1 to {MOST}")));
    }
    let mut fitted = fit(trace, &[Lines::of(trace)?.strongest(None)?])?;
    let spacing = trace.rate().unwrap_or(1.0) / trace.values.len() as f64;
    let mut findings = Vec::new();
    while fitted.count() < count {
        match one_more(trace, &fitted, spacing) {
            Ok(more) => fitted = more,
            Err(why) => {
                findings.push(why.count("known", fitted.count()).count("count", count));
                break;
            }
        }
    }
    let found = fitted.estimates(trace);
    findings.extend(found.findings);
    let mut tones = found.tones;
    tones.sort_by(|a, b| b.amplitude.value.total_cmp(&a.amplitude.value));
    for (i, a) in tones.iter().enumerate() {
        for b in &tones[..i] {
            let apart = (a.frequency.value - b.frequency.value).abs();
            if apart < spacing {
                findings.push(
                    Finding::caution("tones-close")
                        .number("first", b.frequency.value)
                        .number("second", a.frequency.value)
                        .number("apart", apart)
                        .number("resolution", spacing),
                );
            }
        }
    }
    Ok(Tones { tones, noise: fitted.noise, findings })
}

/// The fit with one more sine, or why there is none.
fn one_more(trace: &Trace, fitted: &Fit, spacing: f64) -> std::result::Result<Fit, Finding> {
    // What rounding leaves of exact sines has lines, too.
    if fitted.is_exact() {
        return Err(Finding::caution("tones-only-rounding-left"));
    }
    let Ok(next) = Lines::of(&fitted.rest(trace)).and_then(|left| left.strongest(None)) else {
        return Err(Finding::caution("tones-none-above-noise"));
    };
    let start: Vec<f64> = fitted.frequencies().into_iter().chain([next]).collect();
    let parted = |more: &Fit| {
        let mut f = more.frequencies();
        f.sort_by(f64::total_cmp);
        f.windows(2).all(|w| w[1] - w[0] >= NEAREST * spacing) && more.noise < fitted.noise
    };
    let more = fit(trace, &start).ok().filter(parted);
    more.ok_or_else(|| Finding::caution("tones-not-parted").number("frequency", next))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::trace;
    use std::f64::consts::TAU;
    use vibro_math::Noise;

    /// Of three sines two are asked for; what is left stands 1.5 lines beside one of them, 40 lines from the other.
    #[test]
    fn the_tone_beside_which_another_is_left_has_no_uncertainty() {
        let mut noise = Noise::new(5);
        let mut value = |i: i32| {
            let t = f64::from(i) * 1e-3;
            let sines = [(100.0, 1.0), (140.0, 2.0), (141.5, 0.3)];
            sines.iter().map(|(f, a)| a * (TAU * f * t + f).cos()).sum::<f64>() + 0.02 * noise.normal()
        };
        let trace = trace((0..1000).map(&mut value).collect());
        let found = tones(&trace, 2).unwrap();
        let near = |f: f64| found.tones.iter().find(|t| (t.frequency.value - f).abs() < 1.0).unwrap();
        let (doubtful, clear) = (near(140.0), near(100.0));
        assert!(clear.frequency.std.is_some() && clear.amplitude.std.is_some(), "{found:?}");
        let all = [&doubtful.frequency, &doubtful.amplitude, &doubtful.phase];
        assert!(all.iter().all(|e| e.std.is_none()), "{found:?}");
        assert!(found.findings.iter().any(|f| f.code == "sine-not-alone"), "{found:?}");
        // With the third nothing is left beside any.
        let found = tones(&trace, 3).unwrap();
        assert!(found.tones.iter().all(|t| t.frequency.std.is_some()), "{found:?}");
    }

    #[test]
    fn clean_sines_are_exact() {
        let truth = [(47.3, 2.0, 0.7), (211.0, 0.1, -1.2), (305.5, 1e-3, 2.5)];
        let value = |i: i32| {
            let sine = |(f, a, p): &(f64, f64, f64)| a * (TAU * f * f64::from(i) * 1e-3 + p).cos();
            truth.iter().map(sine).sum::<f64>() - 4.0
        };
        let found = tones(&trace((0..1000).map(value).collect()), 3).unwrap();
        assert!(found.findings.is_empty() && found.noise < 1e-11, "{found:?}");
        for (tone, (f, a, p)) in found.tones.iter().zip(truth) {
            assert!((tone.frequency.value - f).abs() < 1e-7 && (tone.amplitude.value - a).abs() < 1e-9);
            assert!((tone.phase.value - p).abs() < 1e-6, "{tone:?}");
        }
        let more = tones(&trace((0..1000).map(value).collect()), 4).unwrap();
        assert!(
            more.tones.len() == 3 && more.findings[0].code == "tones-only-rounding-left",
            "{:?}",
            more.findings
        );
    }
}
