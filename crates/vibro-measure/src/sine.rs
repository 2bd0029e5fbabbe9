//! The frequency and amplitude of one sine.
//!
//! The least-squares fit of `sinusoids` reaches the Cramér–Rao bound in white noise,
//! var(f) ≥ 12/((2πΔt)² η N(N²−1)), η = A²/(2σ²) (S. M. Kay, Fundamentals of Statistical Signal Processing: Estimation
//! Theory, 1993, eq. 3.41), where the lines of a windowed spectrum lie a third above it.

use super::sinusoids::fit;
use super::{Estimate, noise};
use serde::Serialize;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Finding, Result, Scaling, Trace, Window};
use vibro_signal::spectrum;

/// How often the largest line of pure noise may pass for a sine.
const BY_CHANCE: f64 = 1e-4;
/// A frequency that is given may be off by so many lines.
const NEAR: f64 = 2.0;

/// A sine A cos(2πft + φ) + C in noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sine {
    /// Frequency in Hz.
    pub frequency: Estimate,
    /// Amplitude A.
    pub amplitude: Estimate,
    /// Phase φ in rad at the first sample.
    pub phase: Estimate,
    /// Mean C.
    pub mean: Estimate,
    /// Standard deviation of what is left, in the unit of the trace.
    pub noise: f64,
    /// What the noise and what is left beside the sine do to its uncertainty.
    pub findings: Vec<Finding>,
}

/// Fits the sine of the largest line, or of the largest within two lines of `near` Hz. Where what is left holds another large
/// line within two of it, frequency, amplitude and phase have no uncertainty: [`super::tones`] fits both.
///
/// ```
/// use vibro_measure::sine::sine;
/// use vibro_record::{Axis, Meta, Trace};
/// use vibro_record::units::Unit;
/// let values = (0..500).map(|i| 2.0 * (0.3 * i as f64).sin() + 0.5).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let found = sine(&Trace { meta, axis: Axis::time(0.0, 1e-3, 500), values }, None)?;
/// assert!((found.frequency.value - 300.0 / std::f64::consts::TAU).abs() < 1e-9);
/// assert!((found.amplitude.value - 2.0).abs() < 1e-9);
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If the trace has no spectrum ([`spectrum::plain`]), no line stands out of the noise, or fewer than one and a half periods
/// are there.
pub fn sine(trace: &Trace, near: Option<f64>) -> Result<Sine> {
    let fitted = fit(trace, &[Lines::of(trace)?.strongest(near)?])?;
    let mut found = fitted.estimates(trace);
    let tone = found.tones.swap_remove(0);
    Ok(Sine {
        frequency: tone.frequency,
        amplitude: tone.amplitude,
        phase: tone.phase,
        mean: found.mean,
        noise: fitted.noise,
        findings: found.findings,
    })
}

/// Lines of a record under a Hann window, without its mean.
pub(super) struct Lines {
    magnitudes: Vec<f64>,
    /// Distance of two lines in Hz.
    pub spacing: f64,
}

impl Lines {
    /// # Errors
    /// If the trace has no spectrum ([`spectrum::plain`]).
    pub fn of(trace: &Trace) -> Result<Lines> {
        let lines = spectrum::plain(trace, Window::Hann, Scaling::Peak, true)?;
        Ok(Lines { magnitudes: lines.values.magnitudes(), spacing: lines.axis.step().unwrap_or(0.0) })
    }

    /// Height of the line nearest to `frequency` in Hz.
    pub fn height(&self, frequency: f64) -> f64 {
        self.magnitudes.get((frequency / self.spacing).round() as usize).copied().unwrap_or(0.0)
    }

    /// The frequency of the strongest line that stands out of the noise, or of those within two lines of `near` Hz, interpolated
    /// between lines.
    ///
    /// # Errors
    /// If there is none, or it holds fewer than one and a half periods.
    pub fn strongest(&self, near: Option<f64>) -> Result<f64> {
        let Lines { magnitudes, spacing } = self;
        let within = |k: &usize| near.is_none_or(|f| (*k as f64 - f / spacing).abs() <= NEAR);
        let largest = (1..magnitudes.len().saturating_sub(1))
            .filter(within)
            .max_by(|a, b| magnitudes[*a].total_cmp(&magnitudes[*b]))
            .ok_or_else(|| Error::refused("no line of the spectrum lies there"))?;
        // Rayleigh: one of n lines of noise passes t standard deviations with a chance of n e^(−t²/2).
        let visible = (2.0 * (magnitudes.len() as f64 / BY_CHANCE).ln()).sqrt();
        let floor = noise::around(magnitudes, largest, Some(Window::Hann));
        if let Some(floor) = floor.filter(|n| magnitudes[largest] < visible * n) {
            return Err(Error::refused(format!(
                "no sine stands out of the noise: the largest line, {:.6} Hz, has {}, the noise of a line is {}",
                largest as f64 * spacing,
                quantity(magnitudes[largest], "1", 3),
                quantity(floor, "1", 3)
            ))
            .hint("take a longer record, or state the frequency"));
        }
        let position = super::line::interpolate(magnitudes, largest, Some(Window::Hann), None)
            .map_or(largest as f64, |l| l.position);
        if position < 1.5 {
            return Err(Error::refused(format!(
                "the record holds {position:.2} periods: a mean and a sine cannot be parted"
            ))
            .hint("take a longer record"));
        }
        Ok(spacing * position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::trace;
    use std::f64::consts::TAU;

    #[test]
    fn a_clean_sine_is_exact_from_two_periods_on() {
        for f in [12.0, 47.3, 211.0, 455.5] {
            let truth = |i: i32| 3.0 * (TAU * f * f64::from(i) * 1e-3 + 0.7).cos() - 1.0;
            let found = sine(&trace((0..200).map(truth).collect()), None).unwrap();
            assert!((found.frequency.value / f - 1.0).abs() < 1e-11, "{f}: {:?}", found.frequency);
            assert!((found.amplitude.value - 3.0).abs() < 1e-10 && (found.mean.value + 1.0).abs() < 1e-10);
            assert!((found.phase.value - 0.7).abs() < 1e-9, "{:?}", found.phase);
        }
    }

    #[test]
    fn the_line_that_is_meant_is_fitted() {
        let two = |i: i32| (0.5 * f64::from(i)).cos() + 0.01 * (1.1 * f64::from(i)).cos();
        let found = sine(&trace((0..2000).map(two).collect()), Some(1.1e3 / TAU)).unwrap();
        // The larger sine is what the smaller one has for noise: 1/√2 over 2000 samples.
        assert!((found.frequency.value - 1.1e3 / TAU).abs() < 0.1, "{:?}", found.frequency);
        assert!((found.amplitude.value - 0.01).abs() < 5e-3);
    }

    #[test]
    fn another_sine_beside_is_said_and_half_the_rate_is_refused() {
        // 200 Hz and 201.5 Hz in lines of 1 Hz: 1.5 lines apart.
        let two = |i: i32| {
            let t = f64::from(i) * 1e-3;
            (TAU * 200.0 * t).cos()
                + 0.5 * (TAU * 201.5 * t + 1.0).cos()
                + 0.01 * (f64::from(i * i) * 0.7).sin()
        };
        let found = sine(&trace((0..1000).map(two).collect()), None).unwrap();
        assert!(found.findings.iter().any(|f| f.code == "sine-not-alone"), "{:?}", found.findings);
        let alone = [&found.frequency, &found.amplitude, &found.phase];
        assert!(alone.iter().all(|e| e.value.is_finite() && e.std.is_none()), "{found:?}");
        let noise = |i: i32| (TAU * 0.2 * f64::from(i)).cos() + 0.01 * (f64::from(i * i) * 0.7).sin();
        let found = sine(&trace((0..1000).map(noise).collect()), None).unwrap();
        assert!(found.findings.is_empty() && found.frequency.std.is_some(), "{found:?}");
        // An eighth of a line below half the rate.
        let last = |i: i32| (TAU * 499.875 * f64::from(i) * 1e-3 + 0.4).cos();
        let error = sine(&trace((0..1000).map(last).collect()), None).unwrap_err().to_string();
        assert!(error.contains("half the sampling rate"), "{error}");
    }

    /// What is found of a sine of amplitude 1 with another of amplitude `size` so many lines apart, in noise; frequency and phase of the first.
    fn beside_another(seed: u64, apart: f64, size: f64, floor: f64) -> (Sine, f64, f64) {
        let mut noise = vibro_math::Noise::new(seed);
        let (f, p, q) = (noise.between(50.0, 400.0), noise.between(0.0, TAU), noise.between(0.0, TAU));
        let mut value = |i: i32| {
            let t = f64::from(i) * 1e-3;
            (TAU * f * t + p).cos() + size * (TAU * (f + apart) * t + q).cos() + floor * noise.normal()
        };
        (sine(&trace((0..1000).map(&mut value).collect()), None).unwrap(), f, p)
    }

    /// A sine of half a hundredth of the amplitude 0.7 to 2 lines off is allowed for.
    #[test]
    fn a_small_sine_beside_is_allowed_for() {
        for apart in [0.7, 1.0, 2.0] {
            let mut wide = 0;
            for seed in 0..100 {
                let (found, f, p) = beside_another(seed, apart, 0.005, 1e-5);
                let turn = |a: f64| (a + std::f64::consts::PI).rem_euclid(TAU) - std::f64::consts::PI;
                let off = [
                    (&found.frequency, found.frequency.value - f),
                    (&found.amplitude, found.amplitude.value - 1.0),
                    (&found.phase, turn(found.phase.value - p)),
                ];
                for (estimate, off) in off {
                    // What is allowed is the most that can be, but for the half that the fit may have taken up.
                    let std = estimate.std.unwrap();
                    assert!(off.abs() < 3.0 * std, "{apart} lines apart, seed {seed}: {off} with {std}");
                }
                wide += usize::from(found.frequency.std.unwrap() > 5e-4);
            }
            assert!(wide > 50, "{apart} lines apart: {wide}");
        }
    }

    /// A sine of half the amplitude 5 to 40 lines off is noise to this one, and counted in its uncertainty; 1 to 2 lines off there is none.
    #[test]
    fn what_is_stated_beside_another_sine_holds() {
        for (apart, stated) in [(1.0, 0), (2.0, 0), (5.0, 100), (16.0, 100), (40.0, 100)] {
            let mut all = 0;
            for seed in 0..100 {
                let (found, f, _) = beside_another(seed, apart, 0.5, 7e-3);
                if let Some(std) = found.frequency.std {
                    all += 1;
                    let off = (found.frequency.value - f).abs() / std;
                    // Four standard uncertainties of 300: one of 50 cases.
                    assert!(off < 4.0, "{apart} lines apart, seed {seed}: {off}");
                }
            }
            assert!(if stated == 0 { all == 0 } else { 2 * all > stated }, "{apart} lines apart: {all}");
        }
    }

    #[test]
    fn what_is_no_sine_is_refused() {
        let mut state = 3u64;
        let mut noise = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64
        };
        let error = sine(&trace((0..1000).map(&mut noise).collect()), None).err().unwrap().to_string();
        assert!(error.contains("stands out"), "{error}");
        assert!(sine(&trace(vec![1.0; 100]), None).is_err());
        let short = sine(&trace((0..100).map(|i| (0.06 * f64::from(i)).sin()).collect()), None);
        assert!(short.err().unwrap().to_string().contains("periods"));
    }
}
