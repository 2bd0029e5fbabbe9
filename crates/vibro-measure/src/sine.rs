//! The frequency and amplitude of one sine, as exact as the samples allow.
//!
//! Least squares of x(t) = C + a cos ωt + b sin ωt over all four unknowns (the four-parameter sine fit of IEEE Std 1057): in
//! white noise this is the maximum-likelihood estimate, which reaches the Cramér–Rao bound
//! var(f) ≥ 12/((2πΔt)² η N(N²−1)), η = A²/(2σ²) (S. M. Kay, Fundamentals of Statistical Signal Processing: Estimation
//! Theory, 1993, eq. 3.41), where the lines of a windowed spectrum lie a third above it. In coloured noise the density around the
//! line takes the place of σ²/rate ([`Coloured`]).

use super::coloured::Coloured;
use super::{Estimate, noise};
use nalgebra::{Matrix4, Vector4};
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result, Scaling, Trace, Window};
use vibro_signal::spectrum;

/// How often the largest line of pure noise may pass for a sine.
const BY_CHANCE: f64 = 1e-4;
/// Gauss–Newton steps; four suffice from a line's interpolated frequency.
const STEPS: usize = 20;
/// A frequency that is given may be off by so many lines.
const NEAR: f64 = 2.0;
/// From so many lines on the uncertainty in coloured noise holds what another sine does.
const FAR: f64 = 3.5;
/// Nearer to half the rate than this many lines a sine and its image are half a line apart, and shake each other as two sines do.
const IMAGE: f64 = 0.25;
const METHOD: &str = "least-squares sine fit";

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
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// A sentence, where the noise around the line at `frequency` in Hz is stronger by `widening` than white noise of its variance: what
/// a half more changes is no matter.
pub(super) fn coloured(frequency: f64, widening: f64) -> Option<String> {
    (widening > 1.5).then(|| {
        format!(
            "The noise is not white: around {frequency:.6} Hz it is {widening:.1} times as strong as white noise of its variance would be, and the uncertainties there are enlarged by that. Noise may pass for a sine there; a sine that is not steady looks the same."
        )
    })
}

/// A line that is left beside a sine.
pub(super) struct Beside {
    /// A sentence about it.
    pub said: String,
    /// Standard uncertainties of the frequency in Hz, of the amplitude as a part of itself, and of the phase in rad that allow for it; `None` where
    /// it is so large that how far it moves the sine is not known.
    allowed: Option<[f64; 3]>,
}

impl Beside {
    /// Widens frequency, amplitude and phase of the sine; where how far they are moved is not known, no uncertainty is left.
    pub fn widen(&self, frequency: &mut Estimate, amplitude: &mut Estimate, phase: &mut Estimate) {
        let size = amplitude.value;
        for (i, estimate) in [frequency, amplitude, phase].into_iter().enumerate() {
            let unit = if i == 1 { size } else { 1.0 };
            estimate.std = self.allowed.and_then(|a| Some(estimate.std?.hypot(unit * a[i])));
        }
    }
}

/// Up to this part of the amplitude, what stands beside a sine moves it by a small and known part.
const SMALL: f64 = 0.02;

/// Where what is left of a record after all sines that were fitted holds another line beside that of this `amplitude` at `frequency` in Hz: it
/// moves that sine by more than noise does.
///
/// A sine of a part r of the amplitude moves the frequency of a least-squares fit over T by up to 12r/T³ ∫t sin Δt dt/2π = 0.42 r/T, amplitude
/// and phase in the middle by up to r, so the phase at the first sample by 2.3 r; the fit may have taken up half of it.
pub(super) fn beside(left: &Trace, frequency: f64, amplitude: f64) -> Option<Beside> {
    let spacing = left.rate()? / left.values.len() as f64;
    let other = line(left, Some(frequency)).ok()?;
    let strongest = line(left, None).ok()?;
    let magnitudes = spectrum::plain(left, Window::Hann, Scaling::Peak, true).ok()?.values.magnitudes();
    let size = |f: f64| magnitudes.get((f / spacing).round() as usize).copied().unwrap_or(0.0);
    // A sine so far off that was not fitted, which the noise around this one holds, leaves a line here of up to that part of itself.
    let away = (strongest - frequency).abs() / spacing;
    if away >= FAR && size(other) * away < size(strongest) {
        return None;
    }
    let part = 2.0 * size(other) / amplitude;
    let allowed = (part <= SMALL).then_some([0.42 * part * spacing, part, 2.4 * part]);
    let place = format!(
        "What is left holds a line at {other:.6} Hz, {:.1} lines from {frequency:.6} Hz",
        (other - frequency).abs() / spacing
    );
    let said = if allowed.is_some() {
        format!(
            "{place}, of {:.1e} of its amplitude: its uncertainty allows for another sine there.",
            0.5 * part
        )
    } else {
        format!(
            "{place}, which has no uncertainty therefore: there is another sine (fit one more with it), or this one is not steady."
        )
    };
    Some(Beside { said, allowed })
}

/// Fits the sine of the largest line, or of the largest within two lines of `near` Hz. Where what is left holds another line within two of it,
/// frequency, amplitude and phase have no uncertainty: [`super::tones`] fits both.
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
    fit(trace, line(trace, near)?)
}

/// The frequency of the strongest line that stands out of the noise, interpolated between lines.
///
/// # Errors
/// As [`sine`].
pub(super) fn strongest(trace: &Trace) -> Result<f64> {
    line(trace, None)
}

fn line(trace: &Trace, near: Option<f64>) -> Result<f64> {
    let lines = spectrum::plain(trace, Window::Hann, Scaling::Peak, true)?;
    let step = lines.axis.step().unwrap_or(0.0);
    let magnitudes = lines.values.magnitudes();
    let within = |k: &usize| near.is_none_or(|f| (*k as f64 - f / step).abs() <= NEAR);
    let largest = (1..magnitudes.len().saturating_sub(1))
        .filter(within)
        .max_by(|a, b| magnitudes[*a].total_cmp(&magnitudes[*b]))
        .ok_or_else(|| Error::refused("no line of the spectrum lies there"))?;
    // Rayleigh: one of n lines of noise passes t standard deviations with a chance of n e^(−t²/2).
    let visible = (2.0 * (magnitudes.len() as f64 / BY_CHANCE).ln()).sqrt();
    if let Some(floor) =
        noise::around(&magnitudes, largest, Some(Window::Hann)).filter(|n| magnitudes[largest] < visible * n)
    {
        return Err(Error::refused(format!(
            "no sine stands out of the noise: the largest line, {:.6} Hz, has {}, the noise of a line is {}",
            largest as f64 * step,
            quantity(magnitudes[largest], "1", 3),
            quantity(floor, "1", 3)
        ))
        .hint("a longer record, or state the frequency"));
    }
    let position = super::line::interpolate(&magnitudes, largest, Some(Window::Hann), None)
        .map_or(largest as f64, |l| l.position);
    if position < 1.5 {
        return Err(Error::refused(format!(
            "the record holds {position:.2} periods: a mean and a sine cannot be told apart"
        ))
        .hint("a longer record"));
    }
    Ok(step * position)
}

/// Gauss–Newton from a frequency within half a line.
fn fit(trace: &Trace, start: f64) -> Result<Sine> {
    let n = trace.values.len();
    let rate = trace.rate().unwrap_or(1.0);
    // Time from the middle of the record, in parts of half of it: frequency and phase are then almost uncorrelated.
    let half = 0.5 * n as f64 / rate;
    let time = |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) / rate / half;
    let (mut omega, mut p) = (TAU * start * half, Vector4::<f64>::zeros());
    let all: f64 = trace.values.iter().map(|v| v * v).sum();
    for step in 0..STEPS {
        let (mut normal, mut right) = (Matrix4::<f64>::zeros(), Vector4::zeros());
        for (i, v) in trace.values.iter().enumerate() {
            let t = time(i);
            let (sin, cos) = (omega * t).sin_cos();
            let row = Vector4::new(cos, sin, 1.0, t * (p[1] * cos - p[0] * sin));
            normal += row * row.transpose();
            right += row * *v;
        }
        if step == 0 {
            // No amplitude is known yet: three parameters only.
            normal[(3, 3)] = 1.0;
        }
        let inverse =
            normal.try_inverse().ok_or_else(|| Error::refused("the samples do not determine a sine"))?;
        p = inverse * right;
        let change = if step == 0 { 0.0 } else { p[3] };
        omega += change;
        // Far below what the noise lets be known; large residuals, as coloured noise leaves, slow the steps down.
        let left = (all - p.dot(&right)).max(0.0) / (n as f64 - 4.0).max(1.0);
        let std = (left * inverse[(3, 3)]).sqrt();
        if step > 0 && change.abs() <= (1e-4 * std).max(1e-13 * omega) {
            let short = 0.5 * n as f64 - omega / TAU * 2.0;
            if short < IMAGE {
                return Err(Error::refused(format!(
                    "the sine stands {short:.2} lines from half the sampling rate, where phase and amplitude cannot be told apart"
                ))
                .hint("sample faster"));
            }
            return Ok(stated(trace, omega / half, &p, &inverse, half));
        }
    }
    Err(Error::refused("the sine fit does not settle: the line is not one sine")
        .hint("look at the spectrum: two close lines, or a frequency that drifts"))
}

/// Estimates with first-order uncertainties from the inverse of the normal matrix.
fn stated(trace: &Trace, omega: f64, p: &Vector4<f64>, inverse: &Matrix4<f64>, half: f64) -> Sine {
    let n = trace.values.len();
    let rate = trace.rate().unwrap_or(1.0);
    let middle = 0.5 * (n as f64 - 1.0) / rate;
    let [a, b, mean] = [p[0], p[1], p[2]];
    let rest = trace.values.iter().enumerate().map(|(i, v)| {
        let (sin, cos) = (omega * (i as f64 / rate - middle)).sin_cos();
        v - mean - a * cos - b * sin
    });
    let rest: Vec<f64> = rest.collect();
    let variance = rest.iter().map(|r| r * r).sum::<f64>() / (n - 4) as f64;
    let std = |g: Vector4<f64>| (variance * (g.transpose() * inverse * g)[0].max(0.0)).sqrt();
    let amplitude = a.hypot(b);
    let square = amplitude * amplitude;
    // φ = −atan2(b, a) − ω·middle.
    let phase = (-b.atan2(a) - omega * middle + std::f64::consts::PI).rem_euclid(TAU) - std::f64::consts::PI;
    let unit = trace.meta.unit.quantity().symbol();
    let left = Coloured::of(&rest);
    let wide = left.widening(omega / TAU / rate);
    // What rounding leaves of an exact sine is no noise.
    let noisy = variance.sqrt() > 1e-12 * amplitude;
    let warnings = coloured(omega / TAU, wide).into_iter().filter(|_| noisy).collect();
    let left_over = Trace { meta: trace.meta.clone(), axis: trace.axis.clone(), values: rest };
    let beside = beside(&left_over, omega / TAU, amplitude).filter(|_| noisy);
    let estimate = |value, gradient, unit| Estimate::new(value, Some(wide * std(gradient)), unit, n, METHOD);
    let level = Vector4::new(0.0, 0.0, 1.0, 0.0);
    let mut sine = Sine {
        frequency: estimate(omega / TAU, Vector4::new(0.0, 0.0, 0.0, 1.0 / (TAU * half)), "Hz"),
        amplitude: estimate(amplitude, Vector4::new(a, b, 0.0, 0.0) / amplitude, unit),
        phase: estimate(phase, Vector4::new(b / square, -a / square, 0.0, -middle / half), "rad"),
        mean: Estimate::new(mean, Some(left.widening(0.0) * std(level)), unit, n, METHOD),
        noise: variance.sqrt(),
        warnings,
    };
    if let Some(other) = beside {
        other.widen(&mut sine.frequency, &mut sine.amplitude, &mut sine.phase);
        sine.warnings.push(other.said);
    }
    sine
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta};

    fn trace(values: Vec<f64>) -> Trace {
        let meta = Meta::new("a", Unit::parse("m").unwrap());
        Trace { meta, axis: Axis::time(0.0, 1e-3, values.len()), values }
    }

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
        assert!(found.warnings.iter().any(|w| w.contains("another sine")), "{:?}", found.warnings);
        let alone = [&found.frequency, &found.amplitude, &found.phase];
        assert!(alone.iter().all(|e| e.value.is_finite() && e.std.is_none()), "{found:?}");
        let noise = |i: i32| (TAU * 0.2 * f64::from(i)).cos() + 0.01 * (f64::from(i * i) * 0.7).sin();
        let found = sine(&trace((0..1000).map(noise).collect()), None).unwrap();
        assert!(found.warnings.is_empty() && found.frequency.std.is_some(), "{found:?}");
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
