//! Several sines of one record, fitted together.
//!
//! The strongest line of what is left gives the next sine; all that are known are then fitted together by least squares of
//! x(t) = C + Σ aᵢ cos ωᵢt + bᵢ sin ωᵢt over all unknowns, as [`super::sine`] does for one (S. M. Kay, Fundamentals of
//! Statistical Signal Processing: Estimation Theory, 1993, section 7.8: maximum likelihood in white noise). Uncertainties come from
//! the inverse of the whole normal matrix: what two close sines take from each other is in them. Where the noise is not white, that
//! around each line counts ([`Coloured`]).

use super::coloured::Coloured;
use super::{Estimate, sine};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result, Trace};

/// Most sines of one record.
pub const MOST: usize = 10;
/// Sines nearer than this part of 1/T shake each other so much that a fit of white noise finds two where there is one.
const NEAREST: f64 = 0.5;
/// Gauss–Newton steps.
const STEPS: usize = 40;

/// Part of the standard uncertainty of a frequency below which a step ends the fit: large residuals, as coloured noise leaves, slow
/// the steps down.
const SETTLED: f64 = 1e-4;
const METHOD: &str = "least-squares fit of all sines together";

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
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// The `count` strongest sines of a trace; fewer, with a warning, where no more stand out of the noise or can be parted. One beside which what is left
/// holds another line has no uncertainty.
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
/// If `count` is not 1 to [`MOST`]; as [`sine::sine`] where there is not even one.
pub fn tones(trace: &Trace, count: usize) -> Result<Tones> {
    if !(1..=MOST).contains(&count) {
        return Err(Error::usage(format!("{count} tones"), format!("1 to {MOST}")));
    }
    let first = sine::strongest(trace)?;
    let spacing = trace.rate().unwrap_or(1.0) / trace.values.len() as f64;
    let mut fit = fit(trace, &[first])?;
    let mut warnings = Vec::new();
    while fit.omega.len() < count {
        let known = fit.omega.len();
        let left = Trace { meta: trace.meta.clone(), axis: trace.axis.clone(), values: fit.rest(trace) };
        let stop = |why: String| format!("{known} of {count} tones are given: {why}.");
        // What rounding leaves of exact sines has lines, too.
        if fit.noise <= 1e-12 * fit.largest() {
            warnings.push(stop("nothing is left but rounding".to_owned()));
            break;
        }
        let next = match sine::strongest(&left) {
            Ok(next) => next,
            Err(error) => {
                warnings.push(stop(error.to_string().lines().next().unwrap_or_default().to_owned()));
                break;
            }
        };
        let nearest = |fit: &Fit| {
            let f = fit.frequencies();
            let apart = |i: usize, j: usize| (f[i] - f[j]).abs();
            (0..f.len())
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| apart(i, j))
                .fold(f64::INFINITY, f64::min)
        };
        let start: Vec<f64> = fit.frequencies().into_iter().chain([next]).collect();
        match self::fit(trace, &start) {
            Ok(more) if nearest(&more) >= NEAREST * spacing && more.noise < fit.noise => fit = more,
            _ => {
                warnings.push(stop(format!(
                    "what is left at {next:.6} Hz cannot be parted from the others, or is no steady sine"
                )));
                break;
            }
        }
    }
    let rest = Trace { meta: trace.meta.clone(), axis: trace.axis.clone(), values: fit.rest(trace) };
    let left = Coloured::of(&rest.values);
    let mut tones = fit.stated(trace, &left);
    if fit.noise > 1e-12 * fit.largest() {
        let rate = trace.rate().unwrap_or(1.0);
        warnings.extend(fit.frequencies().iter().filter_map(|f| sine::coloured(*f, left.widening(f / rate))));
        for tone in &mut tones {
            if let Some(other) = sine::beside(&rest, tone.frequency.value, tone.amplitude.value) {
                other.widen(&mut tone.frequency, &mut tone.amplitude, &mut tone.phase);
                warnings.push(other.said);
            }
        }
    }
    tones.sort_by(|a, b| b.amplitude.value.total_cmp(&a.amplitude.value));
    for (i, a) in tones.iter().enumerate() {
        for b in &tones[..i] {
            let apart = (a.frequency.value - b.frequency.value).abs();
            if apart < spacing {
                warnings.push(format!(
                    "The tones at {:.6} and {:.6} Hz are {} apart; a record of {:.4} s parts what is {} apart: both hold only if there are two steady sines, and noise without a line of its own there.",
                    b.frequency.value,
                    a.frequency.value,
                    quantity(apart, "Hz", 3),
                    1.0 / spacing,
                    quantity(spacing, "Hz", 3)
                ));
            }
        }
    }
    Ok(Tones { tones, noise: fit.noise, warnings })
}

/// Angular frequencies over time in parts of half the record, and what belongs to them.
struct Fit {
    omega: Vec<f64>,
    /// a and b of each sine, then the mean.
    linear: Vec<f64>,
    /// Of a, b, A δω of each sine, then the mean.
    inverse: DMatrix<f64>,
    noise: f64,
    half: f64,
}

/// Time of a sample from the middle of the record, in parts of half of it.
fn time(i: usize, n: usize) -> f64 {
    (2 * i + 1) as f64 / n as f64 - 1.0
}

fn fit(trace: &Trace, start: &[f64]) -> Result<Fit> {
    let (n, count) = (trace.values.len(), start.len());
    let half = 0.5 * n as f64 / trace.rate().unwrap_or(1.0);
    let size = 3 * count + 1;
    if n <= size {
        return Err(Error::refused(format!("{n} samples do not determine {count} sines")));
    }
    let mut omega: Vec<f64> = start.iter().map(|f| TAU * f * half).collect();
    let mut linear = vec![0.0; 2 * count + 1];
    let mut row = vec![0.0; size];
    let all: f64 = trace.values.iter().map(|v| v * v).sum();
    for step in 0..STEPS {
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
        for (i, v) in trace.values.iter().enumerate() {
            let t = time(i, n);
            for (k, w) in omega.iter().enumerate() {
                let (sin, cos) = (w * t).sin_cos();
                let (a, b) = (linear[2 * k], linear[2 * k + 1]);
                let slope = if step == 0 { 0.0 } else { t * (b * cos - a * sin) / a.hypot(b) };
                row[3 * k..3 * k + 3].copy_from_slice(&[cos, sin, slope]);
            }
            row[size - 1] = 1.0;
            for (j, x) in row.iter().enumerate() {
                right[j] += x * v;
                for (l, y) in row[..=j].iter().enumerate() {
                    normal[(j, l)] += x * y;
                }
            }
        }
        normal.fill_upper_triangle_with_lower_triangle();
        if step == 0 {
            // No amplitudes are known yet: frequencies stay.
            (0..count).for_each(|k| normal[(3 * k + 2, 3 * k + 2)] = 1.0);
        }
        let unclear = || Error::refused("the samples do not determine these sines");
        let inverse = normal.cholesky().ok_or_else(unclear)?.inverse();
        let p = &inverse * &right;
        // Variance of what is left, to first order: the steps end far below what it lets be known.
        let left = (all - p.dot(&right)).max(0.0) / (n - size) as f64;
        let mut settled = step > 0;
        for (k, w) in omega.iter_mut().enumerate() {
            let (a, b) = (p[3 * k], p[3 * k + 1]);
            (linear[2 * k], linear[2 * k + 1]) = (a, b);
            let change = if step == 0 { 0.0 } else { p[3 * k + 2] / a.hypot(b) };
            // A sine may not leave its line in one step.
            *w += change.clamp(-0.5, 0.5);
            let std = (left * inverse[(3 * k + 2, 3 * k + 2)]).sqrt() / a.hypot(b);
            settled = settled && change.abs() <= (SETTLED * std).max(1e-12 * *w);
        }
        linear[2 * count] = p[size - 1];
        if omega.iter().any(|w| !w.is_finite()) {
            return Err(unclear());
        }
        if settled {
            let mut fit = Fit { omega, linear, inverse, noise: 0.0, half };
            let squares: f64 = fit.rest(trace).iter().map(|v| v * v).sum();
            fit.noise = (squares / (n - size) as f64).sqrt();
            return Ok(fit);
        }
    }
    Err(Error::refused("the fit of the sines does not settle"))
}

impl Fit {
    fn frequencies(&self) -> Vec<f64> {
        self.omega.iter().map(|w| w / (TAU * self.half)).collect()
    }

    fn largest(&self) -> f64 {
        self.linear.chunks_exact(2).map(|p| p[0].hypot(p[1])).fold(0.0, f64::max)
    }

    fn rest(&self, trace: &Trace) -> Vec<f64> {
        let n = trace.values.len();
        let mean = self.linear.last().copied().unwrap_or(0.0);
        let sum = |t: f64| -> f64 {
            let each = self.omega.iter().zip(self.linear.chunks_exact(2));
            each.map(|(w, p)| p[0] * (w * t).cos() + p[1] * (w * t).sin()).sum()
        };
        trace.values.iter().enumerate().map(|(i, v)| v - mean - sum(time(i, n))).collect()
    }

    /// Estimates with first-order uncertainties.
    fn stated(&self, trace: &Trace, left: &Coloured) -> Vec<Tone> {
        let n = trace.values.len();
        let rate = trace.rate().unwrap_or(1.0);
        let unit = trace.meta.unit.quantity().symbol();
        // The first sample, in the time of the fit.
        let first = time(0, n);
        let tone = |(k, (omega, p)): (usize, (&f64, &[f64]))| {
            let (a, b) = (p[0], p[1]);
            let amplitude = a.hypot(b);
            let frequency = omega / (TAU * self.half);
            let noise = left.widening(frequency / rate) * self.noise;
            let std = |g: [f64; 3]| {
                let part = self.inverse.view((3 * k, 3 * k), (3, 3));
                let square: f64 = (0..3)
                    .flat_map(|i| (0..3).map(move |j| (i, j)))
                    .map(|(i, j)| g[i] * part[(i, j)] * g[j])
                    .sum();
                Some(noise * square.max(0.0).sqrt())
            };
            let phase = (-b.atan2(a) + omega * first + PI).rem_euclid(TAU) - PI;
            let square = amplitude * amplitude;
            let estimate = |value, gradient, unit| Estimate::new(value, std(gradient), unit, n, METHOD);
            Tone {
                frequency: estimate(frequency, [0.0, 0.0, 1.0 / (amplitude * TAU * self.half)], "Hz"),
                amplitude: estimate(amplitude, [a / amplitude, b / amplitude, 0.0], unit),
                phase: estimate(phase, [b / square, -a / square, first / amplitude], "rad"),
            }
        };
        self.omega.iter().zip(self.linear.chunks_exact(2)).enumerate().map(tone).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta};

    fn trace(values: Vec<f64>) -> Trace {
        let meta = Meta::new("a", Unit::parse("m").unwrap());
        Trace { meta, axis: Axis::time(0.0, 1e-3, values.len()), values }
    }

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
        assert!(found.warnings.iter().any(|w| w.contains("another sine")), "{found:?}");
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
        assert!(found.warnings.is_empty() && found.noise < 1e-11, "{found:?}");
        for (tone, (f, a, p)) in found.tones.iter().zip(truth) {
            assert!((tone.frequency.value - f).abs() < 1e-7 && (tone.amplitude.value - a).abs() < 1e-9);
            assert!((tone.phase.value - p).abs() < 1e-6, "{tone:?}");
        }
        let more = tones(&trace((0..1000).map(value).collect()), 4).unwrap();
        assert!(more.tones.len() == 3 && more.warnings[0].contains("rounding"), "{:?}", more.warnings);
    }
}
