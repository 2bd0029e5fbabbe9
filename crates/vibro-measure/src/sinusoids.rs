//! Several sines and a mean fitted to a record together.
//!
//! Least squares of x(t) = C + Σ aᵢ cos ωᵢt + bᵢ sin ωᵢt over all unknowns: maximum likelihood in white noise (S. M. Kay,
//! Fundamentals of Statistical Signal Processing: Estimation Theory, 1993, section 7.8), for one sine the four-parameter fit of IEEE
//! Std 1057. Uncertainties come from the inverse of the whole normal matrix: what two close sines take from each other is in them.
//! In noise that is not white the density around each line takes the place of σ²/rate ([`Coloured`]).

use super::Estimate;
use super::coloured::Coloured;
use super::sine::Lines;
use super::tones::Tone;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};
use vibro_record::{Error, Finding, Result, Trace};

/// Gauss–Newton steps.
const STEPS: usize = 40;

/// Part of the standard uncertainty of a frequency below which a step ends the fit: large residuals, as coloured noise leaves, slow
/// the steps down.
const SETTLED: f64 = 1e-4;

/// What is left of exact sines, in parts of the largest.
const ROUNDING: f64 = 1e-12;

/// Nearer to half the rate than this many lines a sine and its image are half a line apart, and shake each other as two sines do.
const IMAGE: f64 = 0.25;

/// Noise around a line this much stronger than white noise of its variance is worth a finding: a half more changes no conclusion.
const COLOURED: f64 = 1.5;

/// From so many lines on the uncertainty in coloured noise holds what another sine does.
const FAR: f64 = 3.5;

/// Up to this part of the amplitude, what stands beside a sine moves it by a small and known part.
const SMALL: f64 = 0.02;

const METHOD: &str = "least-squares sine fit";

/// Sines in the order of the fit, and the mean.
pub(super) struct Estimates {
    pub tones: Vec<Tone>,
    pub mean: Estimate,
    pub findings: Vec<Finding>,
}

impl Tone {
    /// Widens the uncertainties where what is left holds another line beside this sine, which moves it by more than noise does; where
    /// that line is large, how far is not known, and no uncertainty is left.
    ///
    /// A sine of a part r of the amplitude moves the frequency of a least-squares fit over T by up to
    /// 12r/T³ ∫t sin Δt dt/2π = 0.42 r/T, amplitude and phase in the middle by up to r, so the phase at the first sample by 2.3 r;
    /// the fit may have taken up half of it.
    fn widened(&mut self, left: &Lines) -> Option<Finding> {
        let at = self.frequency.value;
        let other = left.strongest(Some(at)).ok()?;
        let strongest = left.strongest(None).ok()?;
        // A sine so far off that was not fitted, which the noise around this one holds, leaves a line here of up to that part of itself.
        let away = (strongest - at).abs() / left.spacing;
        if away >= FAR && left.height(other) * away < left.height(strongest) {
            return None;
        }
        let part = 2.0 * left.height(other) / self.amplitude.value;
        let small = part <= SMALL;
        let moved = [0.42 * part * left.spacing, part * self.amplitude.value, 2.4 * part];
        for (estimate, moved) in
            [&mut self.frequency, &mut self.amplitude, &mut self.phase].into_iter().zip(moved)
        {
            estimate.std = estimate.std.filter(|_| small).map(|s| s.hypot(moved));
        }
        let finding =
            if small { Finding::caution("sine-line-beside") } else { Finding::doubt("sine-not-alone") };
        let apart = (other - at).abs() / left.spacing;
        Some(
            finding
                .number("frequency", at)
                .number("line", other)
                .number("apart", apart)
                .number("part", 0.5 * part),
        )
    }
}

/// Sines and a mean fitted to a record. Time runs from its middle, in parts of half of it: frequency and phase are then almost
/// uncorrelated.
pub(super) struct Fit {
    /// Angular frequencies.
    omega: Vec<f64>,
    /// a and b of each sine, then the mean.
    linear: Vec<f64>,
    /// Of a, b, A δω of each sine, then the mean.
    inverse: DMatrix<f64>,
    /// Standard deviation of what is left.
    pub noise: f64,
    /// Half of the record in s.
    half: f64,
}

/// Time of a sample from the middle of the record, in parts of half of it.
fn time(i: usize, n: usize) -> f64 {
    (2 * i + 1) as f64 / n as f64 - 1.0
}

/// Least squares of sines from first guesses of their frequencies in Hz within half a line, by Gauss–Newton.
///
/// # Errors
/// If the samples do not determine them, or one ends within a quarter of a line of half the sampling rate.
pub(super) fn fit(trace: &Trace, start: &[f64]) -> Result<Fit> {
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
            let highest = omega.iter().copied().fold(0.0, f64::max);
            let short = 0.5 * n as f64 - highest / TAU * 2.0;
            if short < IMAGE {
                return Err(Error::refused(format!(
                    "the sine stands {short:.2} lines from half the sampling rate, where phase and amplitude cannot be parted"
                ))
                .hint("sample faster"));
            }
            let mut fit = Fit { omega, linear, inverse, noise: 0.0, half };
            let squares: f64 = fit.rest(trace).values.iter().map(|v| v * v).sum();
            fit.noise = (squares / (n - size) as f64).sqrt();
            return Ok(fit);
        }
    }
    Err(Error::refused("the fit does not settle: what is there is no steady sine")
        .hint("look at the spectrum: two close lines, or a frequency that drifts"))
}

impl Fit {
    /// Frequencies in Hz.
    pub fn frequencies(&self) -> Vec<f64> {
        self.omega.iter().map(|w| w / (TAU * self.half)).collect()
    }

    /// Number of sines.
    pub fn count(&self) -> usize {
        self.omega.len()
    }

    /// Whether nothing is left but rounding.
    pub(crate) fn is_exact(&self) -> bool {
        let largest = self.linear.chunks_exact(2).map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
        self.noise <= ROUNDING * largest
    }

    /// The record without the sines and the mean.
    pub fn rest(&self, trace: &Trace) -> Trace {
        let n = trace.values.len();
        let mean = self.linear.last().copied().unwrap_or(0.0);
        let sum = |t: f64| -> f64 {
            let each = self.omega.iter().zip(self.linear.chunks_exact(2));
            each.map(|(w, p)| p[0] * (w * t).cos() + p[1] * (w * t).sin()).sum()
        };
        let values = trace.values.iter().enumerate().map(|(i, v)| v - mean - sum(time(i, n))).collect();
        Trace { meta: trace.meta.clone(), axis: trace.axis.clone(), values }
    }

    /// The sines and the mean with their uncertainties, widened by the noise around each and by what is left beside it.
    pub fn estimates(&self, trace: &Trace) -> Estimates {
        let rest = self.rest(trace);
        let left = Coloured::of(&rest.values);
        let mut tones = self.tones(trace, &left);
        let mut findings = Vec::new();
        if !self.is_exact() {
            let rate = trace.rate().unwrap_or(1.0);
            let widenings = self.frequencies().into_iter().map(|f| (f, left.widening(f / rate)));
            findings.extend(widenings.filter(|w| w.1 > COLOURED).map(|(f, factor)| {
                Finding::caution("sine-noise-coloured").number("frequency", f).number("factor", factor)
            }));
            if let Ok(lines) = Lines::of(&rest) {
                findings.extend(tones.iter_mut().filter_map(|tone| tone.widened(&lines)));
            }
        }
        let last = self.inverse.nrows() - 1;
        let std = left.widening(0.0) * self.noise * self.inverse[(last, last)].sqrt();
        let mean = self.linear.last().copied().unwrap_or(0.0);
        let unit = trace.meta.unit.quantity().symbol();
        let mean = Estimate::new(mean, Some(std), unit, trace.values.len(), METHOD);
        Estimates { tones, mean, findings }
    }

    /// Estimates with first-order uncertainties.
    fn tones(&self, trace: &Trace, left: &Coloured) -> Vec<Tone> {
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
