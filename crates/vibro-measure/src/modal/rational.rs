//! Modes and residual terms fitted to a part of a frequency response function in the complex plane.

mod again;
mod beside;
mod blow_before;
mod cover_noise;
mod hidden;
mod linear;
mod rivals;

pub(super) use hidden::MATTERS;

use super::leakage::Leakage;
use super::noise::{LineNoise, MARGIN, STEPS, of_segments};
use super::peak::Peak;
use super::{Measured, Pole};
use crate::mean::average;
use crate::residuals::{Whiteness, aicc, student};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use rivals::rivals;
use std::cell::RefCell;
use std::f64::consts::TAU;
use vibro_math::{Fit, minimise};
use vibro_record::{Error, Result, Window, sort_by_number};

/// Modes fitted together.
pub(super) struct Rational {
    /// By frequency.
    pub modes: Vec<Pole>,
    /// Standard uncertainties of frequency, damping ratio, magnitude and phase in rad of the modal constant.
    pub std: Vec<[f64; 4]>,
    /// The fitted response at its lines.
    pub fitted: Vec<Complex64>,
    pub whiteness: Whiteness,
    /// Root mean square of the residuals without weights, over the highest line.
    pub unexplained: f64,
    /// Akaike's criterion with the weights of the noise, to compare numbers of modes on the same lines.
    pub aicc: f64,
    /// How the noise of the lines was weighted.
    pub noise: &'static str,
    /// Whether the uncertainties cover a further mode that the noise may hide.
    pub covers_hidden: bool,
    weights: LineNoise,
}

/// Lines in scaled units: frequency over `unit` in Hz, values over `height`.
struct Scaled<'a> {
    x: Vec<f64>,
    values: Vec<Complex64>,
    /// (ix)^power.
    factor: Vec<Complex64>,
    starts: &'a [(f64, f64)],
    unit: f64,
    height: f64,
    power: i32,
    /// Leakage of the windowed segments over which the function was averaged.
    leakage: Option<Leakage>,
    magnitude_only: bool,
    /// Cache of each mode: frequency and damping of its last evaluation, as bits, and its values at all
    /// lines.
    known: RefCell<Vec<([u64; 2], Vec<Complex64>)>>,
}

/// Smallest unweighted sum of squared residuals of modes near `starts`, to choose among first guesses.
pub(super) fn residual_sum(
    measured: &Measured,
    part: std::ops::Range<usize>,
    starts: &[(f64, f64)],
    others: &[Pole],
) -> Option<f64> {
    let scaled = Scaled::of(measured, part, starts, others).averaged();
    scaled.start(starts.len(), 0.0, &vec![1.0; scaled.x.len()]).map(|(sum, _)| sum)
}

impl<'a> Scaled<'a> {
    /// The lines `part` without the modes `others`.
    fn of(
        measured: &Measured,
        part: std::ops::Range<usize>,
        starts: &'a [(f64, f64)],
        others: &[Pole],
    ) -> Scaled<'a> {
        let power = measured.power();
        let f = &measured.frequency[part.clone()];
        let taken = |f: f64| others.iter().map(|o| o.at(f, power)).sum::<Complex64>();
        let values: Vec<Complex64> =
            f.iter().zip(&measured.values[part]).map(|(f, v)| v - taken(*f)).collect();
        let height = values.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let unit = starts.iter().map(|s| s.0).sum::<f64>() / starts.len() as f64;
        let x: Vec<f64> = f.iter().map(|f| f / unit).collect();
        Scaled {
            factor: x.iter().map(|x| Complex64::new(0.0, *x).powi(power)).collect(),
            values: values.iter().map(|v| v / height).collect(),
            x,
            starts,
            unit,
            height,
            power,
            leakage: measured.leakage(TAU * unit),
            magnitude_only: measured.magnitude_only,
            known: RefCell::new(vec![Default::default(); starts.len()]),
        }
    }
}

/// Lines in the narrowest half bandwidth that are enough for first guesses.
const ENOUGH: f64 = 16.0;

/// The search over frequencies and damping ratios ends where a step lowers the sum of squares by less than
/// this fraction; then all parameters are fitted together.
const NEAR_ENOUGH: f64 = 1e-6;

/// The last search ends where a step lowers the sum of squares of `n` numbers by less than this fraction: by
/// 1e-10 n of the noise, where a standard uncertainty is 1. Rounding may keep a search from ever ending.
const AT_THE_MINIMUM: f64 = 1e-10;

impl<'a> Scaled<'a> {
    /// Number of lines in a row whose means leave [`ENOUGH`] in the narrowest half bandwidth of the first
    /// guesses.
    fn row(&self) -> usize {
        let half = self.starts.iter().map(|(f, zeta)| f * zeta / self.unit).fold(f64::INFINITY, f64::min);
        let width = (self.x[self.x.len() - 1] - self.x[0]) / self.x.len() as f64;
        if self.magnitude_only { 1 } else { ((half / width / ENOUGH) as usize).max(1) }
    }

    /// Means of lines, from which first guesses are found as from all lines, in less time.
    fn averaged(&self) -> Scaled<'a> {
        let x: Vec<f64> = self.x.chunks(self.row()).map(average).collect();
        let mean = |values: &[Complex64]| values.iter().sum::<Complex64>() / values.len() as f64;
        Scaled {
            factor: x.iter().map(|x| Complex64::new(0.0, *x).powi(self.power)).collect(),
            values: self.values.chunks(self.row()).map(mean).collect(),
            x,
            leakage: self.leakage.clone(),
            known: RefCell::new(vec![Default::default(); self.starts.len()]),
            ..*self
        }
    }
}

impl Scaled<'_> {
    /// Scaled frequency and damping ratio of mode `m`. Its parameters are the shift from the first guess in
    /// half bandwidths, and the damping ratio over its first guess.
    fn shape(&self, p: &[f64], m: usize) -> (f64, f64) {
        let (f, zeta) = self.starts[m];
        ((f + p[4 * m] * zeta * f) / self.unit, p[4 * m + 1] * zeta)
    }

    /// Mode `m` at line `i` for a constant of 1. Most evaluations of a fit leave its frequency and damping
    /// as they were, so its lines are cached.
    fn mode(&self, i: usize, p: &[f64], m: usize) -> Complex64 {
        let shape = self.shape(p, m);
        let bits = [shape.0.to_bits(), shape.1.to_bits()];
        let mut known = self.known.borrow_mut();
        if known[m].0 != bits || known[m].1.is_empty() {
            known[m] = (bits, (0..self.x.len()).map(|i| self.shaped(i, shape)).collect());
        }
        known[m].1[i]
    }

    fn shaped(&self, i: usize, (own, zeta): (f64, f64)) -> Complex64 {
        let x = self.x[i];
        if let Some(leakage) = self.leakage.as_ref().filter(|_| zeta.abs() < 1.0) {
            return leakage.mode(x, (own, zeta), self.power);
        }
        self.factor[i] / Complex64::new(own * own - x * x, 2.0 * zeta * own * x)
    }

    /// The model at line `i`: modes, and residual terms of modes above (U) and below (L/x²) the lines, as
    /// receptances.
    fn at(&self, p: &[f64], i: usize) -> Complex64 {
        let amplitude = |at: usize| Complex64::new(p[at], p[at + 1]);
        let modes = self.starts.len();
        let sum: Complex64 = (0..modes).map(|m| amplitude(4 * m + 2) * self.mode(i, p, m)).sum();
        let (above, below) = (amplitude(4 * modes), amplitude(4 * modes + 2));
        sum + self.factor[i] * (above + below / (self.x[i] * self.x[i]))
    }

    /// Residual of the model at line `i`, or of its magnitude where phases are not known.
    fn left(&self, p: &[f64], i: usize) -> Complex64 {
        let model = self.at(p, i);
        if self.magnitude_only { (self.values[i].re - model.norm()).into() } else { self.values[i] - model }
    }

    /// Number of real values in the lines: one per line for magnitudes, else two.
    fn rows(&self) -> usize {
        if self.magnitude_only { self.x.len() } else { 2 * self.x.len() }
    }

    /// Columns of the linear parameters at line `i`: modes with a constant of 1, and the residual terms.
    fn columns(&self, p: &[f64], i: usize, into: &mut [Complex64]) {
        let modes = self.starts.len();
        (0..modes).for_each(|m| into[m] = self.mode(i, p, m));
        (into[modes], into[modes + 1]) = (self.factor[i], self.factor[i] / (self.x[i] * self.x[i]));
    }

    /// Sets the linear parameters of `p`, constants and residual terms, by least squares for its frequencies
    /// and damping ratios. Returns the sum of squares.
    ///
    /// The normal equations are summed line by line, without a matrix of all lines.
    fn linear(&self, p: &mut [f64], weight: &[f64]) -> Option<f64> {
        let modes = self.starts.len();
        let mut row = vec![Complex64::ZERO; modes + 2];
        let mut product = DMatrix::<Complex64>::zeros(modes + 2, modes + 2);
        let mut right = DVector::<Complex64>::zeros(modes + 2);
        for (i, (value, weight)) in self.values.iter().zip(weight).enumerate() {
            self.columns(p, i, &mut row);
            let power = 1.0 / (weight * weight);
            for (j, own) in row.iter().enumerate() {
                let own = own.conj() * power;
                right[j] += own * value;
                (0..=j).for_each(|k| product[(j, k)] += own * row[k]);
            }
        }
        // Columns of length 1; the factorisation reads the lower triangle.
        let size: Vec<f64> = (0..modes + 2).map(|j| product[(j, j)].re.sqrt()).collect();
        (0..modes + 2).for_each(|j| {
            right[j] /= size[j];
            (0..=j).for_each(|k| product[(j, k)] /= size[j] * size[k]);
        });
        let solution = product.cholesky()?.solve(&right);
        let solution: Vec<Complex64> = solution.iter().zip(&size).map(|(v, size)| v / size).collect();
        let mut sum = 0.0;
        for (i, (value, weight)) in self.values.iter().zip(weight).enumerate() {
            self.columns(p, i, &mut row);
            let model: Complex64 = row.iter().zip(&solution).map(|(a, v)| a * v).sum();
            sum += (value - model).norm_sqr() / (weight * weight);
        }
        for (j, value) in solution.iter().enumerate() {
            let at = if j < modes { 4 * j + 2 } else { 4 * modes + 2 * (j - modes) };
            (p[at], p[at + 1]) = (value.re, value.im);
        }
        sum.is_finite().then_some(sum)
    }

    /// First guess: frequency and damping of each mode but the first `known` in turn on a small grid, with
    /// shifts up to half the line spacing `width`; all else by linear least squares. Returns the sum of
    /// squares and the parameters.
    fn start(&self, known: usize, width: f64, weight: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut p = vec![0.0; 4 * self.starts.len() + 4];
        (0..self.starts.len()).for_each(|m| p[4 * m + 1] = 1.0);
        for (m, (f, zeta)) in self.starts.iter().enumerate().skip(known) {
            let mut least = (f64::INFINITY, p.clone());
            for shift in [-0.5, -0.25, 0.0, 0.25, 0.5] {
                for damping in [0.1, 0.3, 0.6, 1.0, 1.6] {
                    p[4 * m] = shift * width / (zeta * f);
                    p[4 * m + 1] = damping;
                    if let Some(sum) = self.linear(&mut p, weight).filter(|s| *s < least.0) {
                        least = (sum, p.clone());
                    }
                }
            }
            p = least.1;
        }
        Some((self.linear(&mut p, weight)?, p))
    }

    /// Parameters near the minimum: a search over frequency and damping of the modes alone, with all else by
    /// linear least squares for each (Golub & Pereyra 1973).
    fn nearer(&self, start: &[f64], weight: &[f64]) -> Result<Vec<f64>> {
        if self.magnitude_only {
            return Ok(self.fit(start, &LineNoise::independent(weight.to_vec()))?.parameters);
        }
        let whole = |q: &[f64]| {
            let mut p = start.to_vec();
            q.chunks(2).enumerate().for_each(|(m, shape)| p[4 * m..4 * m + 2].copy_from_slice(shape));
            self.linear(&mut p, weight).map(|_| p)
        };
        let n = self.x.len();
        let residuals = |q: &[f64], out: &mut [f64]| match whole(q) {
            Some(p) => (0..n).for_each(|i| {
                let left = self.left(&p, i) / weight[i];
                (out[i], out[n + i]) = (left.re, left.im);
            }),
            None => out.fill(f64::NAN),
        };
        let q: Vec<f64> = (0..self.starts.len()).flat_map(|m| [start[4 * m], start[4 * m + 1]]).collect();
        let found = minimise(residuals, self.rows(), &q, &vec![1.0; q.len()], Some(NEAR_ENOUGH))?;
        whole(&found.parameters)
            .ok_or_else(|| Error::refused("the modes of a fit do not determine their constants"))
    }

    /// Residuals of the model at all lines, whitened by the noise.
    fn white(&self, p: &[f64], noise: &LineNoise, out: &mut [f64]) {
        let n = self.x.len();
        for i in 0..n {
            let left = self.left(p, i);
            out[i] = left.re;
            if !self.magnitude_only {
                out[n + i] = left.im;
            }
        }
        noise.whiten(out);
    }

    fn fit(&self, start: &[f64], noise: &LineNoise) -> Result<Fit> {
        let free = self.free();
        let expand = |q: &[f64]| {
            let mut p = start.to_vec();
            free.iter().zip(q).for_each(|(i, v)| p[*i] = *v);
            p
        };
        let residuals = |q: &[f64], out: &mut [f64]| self.white(&expand(q), noise, out);
        let q: Vec<f64> = free.iter().map(|i| start[*i]).collect();
        let largest = q.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let scale: Vec<f64> = q.iter().map(|v| v.abs().max(1e-3 * largest.min(1.0))).collect();
        let mut fit = minimise(residuals, self.rows(), &q, &scale, Some(AT_THE_MINIMUM))?.fit()?;
        if !fit.converged {
            return Err(Error::refused("the fit did not converge"));
        }
        fit.parameters = expand(&fit.parameters);
        Ok(fit)
    }

    /// The noise of segments under a window, from the response of the model and the variance `total` of each
    /// line. `None` for magnitudes, or where gaps between lines make the grid more than twice as long as
    /// without gaps.
    fn of_segments(&self, window: Window, spacing: f64, p: &[f64], total: &[f64]) -> Option<LineNoise> {
        let step = spacing / self.unit / STEPS as f64;
        let at = |x: &f64| MARGIN + STEPS * ((x - self.x[0]) / step / STEPS as f64).round() as usize;
        let at: Vec<usize> = self.x.iter().map(at).collect();
        let last = at[at.len() - 1] + MARGIN;
        if self.magnitude_only || last > 2 * (STEPS * at.len() + 2 * MARGIN) {
            return None;
        }
        let first = self.x[0] - MARGIN as f64 * step;
        let x: Vec<f64> = (0..=last).map(|k| (first + k as f64 * step).abs().max(step)).collect();
        let factor = x.iter().map(|x| Complex64::new(0.0, *x).powi(self.power)).collect();
        let known = RefCell::new(vec![Default::default(); self.starts.len()]);
        let plain = Scaled { x, factor, values: Vec::new(), leakage: None, known, ..*self };
        let h: Vec<Complex64> = (0..=last).map(|k| plain.at(p, k)).collect();
        of_segments(window, &h, &at, total)
    }

    /// Indices of the parameters that the values determine. Without phases these are not the imaginary parts
    /// of modal constants, the residual term from below, and the imaginary part of that from above, which
    /// changes |H| as the modal constant does.
    fn free(&self) -> Vec<usize> {
        let modes = 4 * self.starts.len();
        (0..modes + 4).filter(|i| !self.magnitude_only || (*i < modes && i % 4 != 3) || *i == modes).collect()
    }
}

/// Fits modes near the first guesses `starts` (frequency in Hz, damping ratio), the first `known` of which
/// come from a fit, to the lines `part` of a function from which `others` are subtracted.
///
/// Lines are weighted by their stated uncertainty. Else the coherence gives their noise: with the window of
/// the segments, or with the level of noise or its share of the response smoothed over lines. Else noise is
/// in part equal on all lines, in part proportional to the response; the likeliest share is taken.
pub(super) fn rational(
    measured: &Measured,
    part: std::ops::Range<usize>,
    (starts, known): (&[(f64, f64)], usize),
    others: &[Pole],
) -> Result<Rational> {
    let lines = part.len();
    let f = &measured.frequency[part.clone()];
    let taken = |f: f64| others.iter().map(|o| o.at(f, measured.power())).sum::<Complex64>();
    let scaled = Scaled::of(measured, part.clone(), starts, others);
    let (numbers, parameters) = (scaled.rows(), scaled.free().len());
    if numbers < parameters + 3 {
        let why = format!(
            "{lines} lines hold {numbers} numbers, too few for {parameters} parameters and their uncertainty"
        );
        return Err(Error::refused(why).hint("take a wider band").setting("band"));
    }
    let width = (f[f.len() - 1] - f[0]) / (f.len() - 1) as f64;
    let few = scaled.averaged();
    let equal = vec![1.0; few.x.len()];
    let refuse = || Error::refused("no first guess of the modes fits the lines");
    let start = if measured.magnitude_only {
        scaled.guess()
    } else {
        few.start(known, width, &equal).ok_or_else(refuse)?.1
    };
    let mut at = few.nearer(&start, &equal)?;
    let weights = |noise: &LineNoise| noise.each.chunks(scaled.row()).map(average).collect::<Vec<f64>>();
    let rivals = |p: &[f64]| scaled.likeliest_first(p, rivals(measured, part.clone(), &scaled, p));
    let mut noises = rivals(&at);
    // What is likely beside a fit to equal noise need not be so beside a fit to the likeliest.
    if let [(likeliest, _), _, ..] = noises.as_slice()
        && let Ok(nearer) = few.nearer(&at, &weights(likeliest))
    {
        noises = rivals(&nearer);
        at = nearer;
    }
    let mut failed = refuse();
    for (noise, named) in noises {
        match few.nearer(&at, &weights(&noise)).and_then(|p| scaled.fit(&p, &noise)) {
            Ok(fit) => {
                let mut result = scaled.result(&fit, named, &noise);
                result.fitted.iter_mut().zip(f).for_each(|(v, f)| *v += taken(*f));
                return Ok(result);
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// Largest standard uncertainty of a damping ratio, over the ratio, of a mode that is determined; beyond it
/// the fit does not determine the mode.
const KNOWN: f64 = 0.5;

impl Rational {
    /// Which modes are sound: damped, determined, and near their peaks, which are in the same order.
    pub fn sound(&self, measured: &Measured, peaks: &[Peak]) -> Vec<bool> {
        let stands = |((mode, std), peak): ((&Pole, &[f64; 4]), &Peak)| {
            let f = &measured.frequency;
            let lines = f[peak.at + 1] - f[peak.at - 1];
            mode.zeta > 0.0
                && std[1] < KNOWN * mode.zeta
                && std[0] < mode.zeta * mode.frequency
                && (mode.frequency - f[peak.at]).abs() <= peak.width.max(lines)
        };
        self.modes.iter().zip(&self.std).zip(peaks).map(stands).collect()
    }
}

impl Scaled<'_> {
    /// First guess for magnitudes: the modes alone, each as high as the response at its frequency.
    fn guess(&self) -> Vec<f64> {
        let mut p = vec![0.0; 4 * self.starts.len() + 4];
        for (m, (f, zeta)) in self.starts.iter().enumerate() {
            let own = f / self.unit;
            let near = (0..self.x.len())
                .min_by(|a, b| (self.x[*a] - own).abs().total_cmp(&(self.x[*b] - own).abs()));
            let height = near.map_or(1.0, |i| self.values[i].norm());
            p[4 * m + 1] = 1.0;
            p[4 * m + 2] = height * 2.0 * zeta * own.powi(2 - self.power);
        }
        p
    }

    /// Factor from a scaled to a modal constant.
    fn to_constant(&self) -> f64 {
        self.height * (TAU * self.unit).powi(2 - self.power)
    }

    /// Derivatives of frequency, damping ratio, magnitude and phase of the modal constant, of each mode in
    /// turn (rows), with respect to the free parameters (columns).
    fn slopes(&self, p: &[f64]) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(4 * self.starts.len(), p.len());
        for (m, (f, zeta)) in self.starts.iter().enumerate() {
            let (at, a) = (4 * m, Complex64::new(p[4 * m + 2], p[4 * m + 3]));
            let (cos, sin) = (a.re / a.norm(), a.im / a.norm());
            (all[(at, at)], all[(at + 1, at + 1)]) = (f * zeta, *zeta);
            let magnitude = [cos, sin].map(|part| part * self.to_constant());
            let phase = [-sin, cos].map(|part| part / a.norm());
            for (k, (magnitude, phase)) in magnitude.into_iter().zip(phase).enumerate() {
                (all[(at + 2, at + 2 + k)], all[(at + 3, at + 2 + k)]) = (magnitude, phase);
            }
        }
        all.select_columns(&self.free())
    }

    fn result(&self, fit: &Fit, noise: &'static str, weight: &LineNoise) -> Rational {
        let n = self.x.len();
        let whiteness = Whiteness::of_fit(fit, n);
        let p = &fit.parameters;
        let to_constant = self.to_constant();
        // Fits of fewer than three degrees of freedom were refused.
        let widened = whiteness.inflation * student(fit.degrees_of_freedom()).unwrap_or(f64::NAN);
        let covariance = self.covariance(p, &fit.cofactor, fit.variance());
        let mode = |m: usize| {
            let (own, damping) = self.shape(p, m);
            let a = Complex64::new(p[4 * m + 2], p[4 * m + 3]);
            let pole = Pole { frequency: own * self.unit, zeta: damping, constant: a * to_constant };
            (pole, [0, 1, 2, 3].map(|q| covariance[(4 * m + q, 4 * m + q)].sqrt() * widened))
        };
        let mut found: Vec<(Pole, [f64; 4])> = (0..self.starts.len()).map(mode).collect();
        sort_by_number(&mut found, |a| a.0.frequency);
        let (modes, std) = found.into_iter().unzip();
        // Without weights, so that fits with different weights can be compared.
        let sum: f64 = (0..n).map(|i| self.left(p, i).norm_sqr()).sum();
        Rational {
            unexplained: (sum / n as f64).sqrt(),
            modes,
            std,
            aicc: aicc(fit.sum_of_squares(), fit.residuals.len(), self.free().len() as f64)
                + weight.spread(fit.residuals.len()),
            fitted: (0..n).map(|i| self.at(p, i) * self.height).collect(),
            whiteness,
            noise,
            covers_hidden: false,
            weights: weight.clone(),
        }
    }
}

#[cfg(test)]
mod tests;
