//! Mains hum in the responses of a sweep.
//!
//! Hum has the same frequency and amplitude in all steps, and a phase of its own in each. To each response an
//! excitation with harmonics, a mean, and a sine of hum are fitted together. Steps whose excitation is far
//! away tell the amplitude A of the hum. In a step whose excitation is near, both components of the hum have
//! a normal distribution about 0 with the variance A²/2: what cannot be told apart is in the uncertainty.

use super::common;
use crate::chance::chi_squared_above;
use crate::mains::{Hum, harmonics};
use crate::mean::average;
use crate::noise;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::{Axis, Result, Scaling, Trace, Window, median, sort_by_number};
use vibro_signal::spectrum;

/// Harmonics of the excitation that are fitted, itself included.
const OWN: usize = 4;
/// Lines on either side of the excitation or a harmonic that belong to it.
const NEAR: f64 = 4.0;
/// Least mean power of a line of hum over that of noise, in steps with the excitation elsewhere, that is
/// searched; noise has 1.
const VISIBLE: f64 = 2.0;
/// Frequencies that are tried in a line of the longest step.
const FINE: f64 = 4.0;
/// Probability with which noise alone passes for hum.
const BY_CHANCE: f64 = 1e-6;
/// Largest amplitude of hum in one step, over that common to all; a larger line is not hum alone.
const LARGEST: f64 = 1.5;
/// Distances from a line, in lines, at which the noise beside it is read.
const BESIDE: [f64; 8] = [-6.5, -5.4, -4.3, -3.2, 3.2, 4.3, 5.4, 6.5];
/// Median of the power of noise over its variance, χ² of two degrees of freedom: 2 ln 2.
const TYPICAL: f64 = 2.0 * std::f64::consts::LN_2;
/// Change of the exponent over a response by which a growth is formed.
const SLOW: f64 = 0.1;
/// Variance of an unknown amplitude over that of the response.
const UNKNOWN: f64 = 1e6;

/// A line of hum that was removed.
pub(super) struct Removed {
    /// The line, with the amplitude that is common to all steps.
    pub hum: Hum,
    /// Standard uncertainty of one component of the response that it leaves in each step.
    pub left: Vec<f64>,
}

/// The settled part of the response of a step.
pub(super) struct Settled<'a> {
    pub rate: f64,
    /// First settled sample.
    pub begins: usize,
    /// Frequency of the excitation in Hz.
    pub frequency: f64,
    /// Relative rate of growth in 1/samples, and its standard uncertainty.
    pub growth: (f64, f64),
    pub response: &'a mut Trace,
}

/// Removes hum from the responses of a sweep.
///
/// # Errors
/// If a response has no spectrum.
pub(super) fn remove(mut steps: Vec<Settled>) -> Result<Vec<Removed>> {
    let all: Vec<Spectral> = steps.iter().map(Spectral::of).collect::<Result<_>>()?;
    let mut found = Vec::new();
    for (nominal, tolerance) in candidates(&steps, &all) {
        let mut fits: Vec<Fitter> =
            steps.iter().zip(&all).map(|(step, s)| Fitter::of(step, s, nominal)).collect();
        let (frequency, tried) = strongest(&fits, nominal, tolerance);
        for fit in &mut fits {
            fit.allow_leakage(frequency);
        }
        let alone: Vec<Option<Fitted>> = fits.iter().map(|fit| fit.at(frequency, None)).collect();
        let power = alone.iter().flatten().map(|fitted| fitted.power).sum();
        if chi_squared_above(power, 2 * fits.len()) > BY_CHANCE / tried as f64 {
            continue;
        }
        let squares: Vec<(f64, f64)> =
            alone.iter().flatten().map(|f| (f.hum.norm_sqr(), 2.0 * f.variance)).collect();
        let amplitude = common(&squares).sqrt();
        if amplitude == 0.0 {
            continue;
        }
        let known: Vec<Option<Fitted>> = fits.iter().map(|fit| fit.at(frequency, Some(amplitude))).collect();
        drop(fits);
        for (step, hum) in steps.iter_mut().zip(&known) {
            if let Some(hum) = hum {
                step.subtract(frequency, hum.hum * (LARGEST * amplitude / hum.hum.norm()).min(1.0));
            }
        }
        let left = known.iter().map(|hum| hum.as_ref().map_or(0.0, |hum| hum.left)).collect();
        found.push(Removed { hum: Hum { frequency, amplitude, harmonics: 1 }, left });
    }
    Ok(found)
}

/// Nominal frequencies of lines that may be hum, and their tolerances, in Hz; the strongest first, since it
/// leaks to the others.
fn candidates(steps: &[Settled], all: &[Spectral]) -> Vec<(f64, f64)> {
    let top = steps.iter().map(|step| step.rate).fold(f64::INFINITY, f64::min) / 2.0;
    let lines = harmonics().filter(|(nominal, tolerance)| nominal + tolerance < top);
    let height = |(nominal, tolerance): (f64, f64)| {
        let seen: Vec<f64> = all.iter().filter_map(|s| s.height(nominal, tolerance)).collect();
        // A line that the excitation of every step hides may be there.
        if seen.is_empty() { VISIBLE } else { average(&seen) }
    };
    let mut lines: Vec<_> = lines.map(|line| (height(line), line)).filter(|(h, _)| *h >= VISIBLE).collect();
    sort_by_number(&mut lines, |line| -line.0);
    lines.into_iter().map(|(_, line)| line).collect()
}

/// The frequency of the strongest line about `nominal` Hz that is common to all steps, and the number of
/// frequencies tried.
fn strongest(fits: &[Fitter], nominal: f64, tolerance: f64) -> (f64, usize) {
    let power = |frequency: f64| -> f64 {
        fits.iter().filter_map(|fit| fit.at(frequency, None)).map(|f| f.power).sum()
    };
    let longest = fits.iter().map(|fit| fit.values.len() as f64 / fit.rate).fold(0.0, f64::max);
    let tried = (tolerance * longest * FINE).ceil().max(1.0) as i32;
    let mut step = tolerance / f64::from(tried);
    let at = |k: i32| nominal + f64::from(k) * step;
    let best = (-tried..=tried).map(|k| (at(k), power(at(k)))).max_by(|a, b| a.1.total_cmp(&b.1));
    let (mut middle, mut height) = best.unwrap_or((nominal, 0.0));
    // The vertex of a parabola through three frequencies, ever nearer to each other.
    for _ in 0..3 {
        let [low, high]: [f64; 2] = [middle - step, middle + step].map(power);
        let bend = low + high - 2.0 * height;
        let moved = if bend < 0.0 { 0.5 * (low - high) / bend * step } else { 0.0 };
        middle += moved.clamp(-step, step);
        height = power(middle);
        step /= 4.0;
    }
    (middle, (2 * tried + 1) as usize)
}

/// The spectrum of a settled response, under a Hann window.
struct Spectral {
    magnitudes: Vec<f64>,
    spacing: f64,
    excitation: f64,
}

impl Spectral {
    fn of(step: &Settled) -> Result<Spectral> {
        let values = step.response.values[step.begins..].to_vec();
        let (axis, n) = (Axis::time(0.0, 1.0 / step.rate, values.len()), values.len() as f64);
        let trace = Trace { meta: step.response.meta.clone(), axis, values };
        let magnitudes = spectrum::plain(&trace, Window::Hann, Scaling::Peak, true)?.values.magnitudes();
        Ok(Spectral { magnitudes, spacing: step.rate / n, excitation: step.frequency })
    }

    /// Noise of one component of the lines near `frequency` in Hz.
    fn floor(&self, frequency: f64) -> Option<f64> {
        let k = (frequency / self.spacing).round() as usize;
        noise::around(&self.magnitudes, k, noise::REACH, Some(Window::Hann))
    }

    /// Power of the largest line within `tolerance` of `frequency` over that of noise; `None` where the
    /// excitation or a harmonic is near.
    fn height(&self, frequency: f64, tolerance: f64) -> Option<f64> {
        let reach = tolerance + NEAR * self.spacing;
        let near = (1..=OWN).any(|order| (order as f64 * self.excitation - frequency).abs() < reach);
        let floor = self.floor(frequency).filter(|floor| *floor > 0.0 && !near)?;
        let [low, high] = [-1.0, 1.0].map(|side| (frequency + side * tolerance) / self.spacing);
        let lines = self.magnitudes.get(low.floor() as usize..=high.ceil() as usize)?;
        Some(0.5 * (lines.iter().copied().fold(0.0, f64::max) / floor).powi(2))
    }
}

/// A cosine and a sine, the parts of Σ aₖ e^{zₖt} with zₖ in 1/samples and t from the middle of the response.
struct Pair {
    terms: Vec<(f64, Complex64)>,
    /// Σ y Σ aₖ e^{zₖt} over the samples y.
    sum: Complex64,
    /// Variance with which its amplitudes lie about 0; `None` where nothing is known of them.
    prior: Option<f64>,
}

impl Pair {
    fn of(values: &[f64], terms: Vec<(f64, Complex64)>, prior: Option<f64>) -> Pair {
        let sum = terms.iter().map(|(factor, z)| *factor * transform(values, *z)).sum();
        Pair { terms, sum, prior }
    }

    /// Whether it has a sine; a mean has none.
    fn turns(&self) -> bool {
        self.terms.iter().any(|(_, z)| z.im > 0.0)
    }

    /// Sums over `n` samples of its product with another, and with the complex conjugate of that.
    fn products(&self, other: &Pair, n: usize) -> [Complex64; 2] {
        let mut sums = [Complex64::ZERO; 2];
        for (a, one) in &self.terms {
            for (b, other) in &other.terms {
                sums[0] += a * b * geometric(n, one + other);
                sums[1] += a * b * geometric(n, one + other.conj());
            }
        }
        sums
    }
}

/// Fits an excitation and hum to the response of a step.
struct Fitter<'a> {
    rate: f64,
    values: &'a [f64],
    /// The excitation and its harmonics, its growth, and the mean.
    own: Vec<Pair>,
    /// Products of their cosines and sines, the same for all frequencies of hum.
    products: DMatrix<f64>,
    /// Variance with which hum of unknown amplitude lies about 0.
    unknown: f64,
    /// Variance of the noise of a sample near the line of hum.
    noise: f64,
}

/// Hum of a step.
struct Fitted {
    /// Phasor of the hum, about the middle of the response.
    hum: Complex64,
    /// Variance of one of its components.
    variance: f64,
    /// Squared components over their variances.
    power: f64,
    /// Standard uncertainty that hum adds to one component of the excitation.
    left: f64,
}

impl Settled<'_> {
    /// Subtracts a sine with this phasor about the middle.
    fn subtract(&mut self, frequency: f64, phasor: Complex64) {
        let rate = self.rate;
        let values = &self.response.values;
        let middle = f64::midpoint(self.begins as f64, values.len() as f64 - 1.0);
        for (i, v) in self.response.values.iter_mut().enumerate() {
            *v -= (phasor * Complex64::cis(TAU * frequency / rate * (i as f64 - middle))).re;
        }
    }
}

/// A cosine, or a sine, of a pair.
type Row<'a> = (&'a Pair, bool);

/// Cosine and sine of each pair; a mean has a cosine alone.
fn rows<'a>(pairs: impl IntoIterator<Item = &'a Pair>) -> Vec<Row<'a>> {
    let both = pairs.into_iter().flat_map(|pair| [(pair, false), (pair, true)]);
    both.filter(|(pair, sine)| pair.turns() || !sine).collect()
}

/// Sums over `n` samples of the products of rows; those of the first rows are `known`.
fn products(rows: &[Row], n: usize, known: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows.len(), |i, k| {
        if i.max(k) < known.nrows() {
            return known[(i, k)];
        }
        let [sum, difference] = rows[i].0.products(rows[k].0, n);
        0.5 * match (rows[i].1, rows[k].1) {
            (false, false) => sum.re + difference.re,
            (true, true) => difference.re - sum.re,
            (false, true) => sum.im - difference.im,
            (true, false) => sum.im + difference.im,
        }
    })
}

/// Σ v e^{zt} over the samples v, with t from their middle.
fn transform(values: &[f64], z: Complex64) -> Complex64 {
    let (turn, middle) = (z.exp(), 0.5 * (values.len() as f64 - 1.0));
    let horner = values.iter().rev().fold(Complex64::ZERO, |sum, v| sum * turn + v);
    horner * (-z * middle).exp()
}

/// Σ e^{zt} over `n` samples, with t from their middle.
fn geometric(n: usize, z: Complex64) -> Complex64 {
    let half = 0.5 * z;
    if half.norm() < 1e-9 { Complex64::from(n as f64) } else { (half * n as f64).sinh() / half.sinh() }
}

impl<'a> Fitter<'a> {
    fn of(step: &'a Settled, spectral: &Spectral, line: f64) -> Fitter<'a> {
        let values = &step.response.values[step.begins..];
        let omega = TAU * step.frequency / step.rate;
        let inside = |z: &Complex64| z.im < std::f64::consts::PI;
        let orders = (1..=OWN).map(|order| Complex64::new(step.growth.0, omega * order as f64));
        let all = orders.filter(inside).chain([Complex64::ZERO]);
        let mut own: Vec<Pair> = all.map(|z| Pair::of(values, vec![(1.0, z)], None)).collect();
        // e^{zt} sinh(ht)/h grows as t e^{zt} does.
        let (z, h) = (own[0].terms[0].1, SLOW / values.len() as f64);
        let size = 2.0 * own[0].sum.norm() / values.len() as f64;
        let grows = vec![(0.5 / h, z + h), (-0.5 / h, z - h)];
        own.push(Pair::of(values, grows, Some((size * step.growth.1).powi(2))));
        let products = products(&rows(&own), values.len(), &DMatrix::zeros(0, 0));
        let unknown = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64 * UNKNOWN;
        // A line of a Hann window has the noise of three samples over their number.
        let noise = spectral.floor(line).map_or(0.0, |floor| floor * floor * values.len() as f64 / 3.0);
        Fitter { rate: step.rate, values, own, products, unknown, noise }
    }

    /// Adds to the noise what leaks from lines elsewhere to the line at `frequency` in Hz, which the window
    /// of the spectrum holds back: the power beside the line, with the line itself fitted.
    fn allow_leakage(&mut self, frequency: f64) {
        let spacing = self.rate / self.values.len() as f64;
        let z = Complex64::new(0.0, TAU * frequency / self.rate);
        self.own.push(Pair::of(self.values, vec![(1.0, z)], None));
        let with_line = products(&rows(&self.own), self.values.len(), &self.products);
        let without_line = std::mem::replace(&mut self.products, with_line);
        let beside = BESIDE.iter().filter_map(|lines| self.at(frequency + lines * spacing, None));
        let above = median(beside.map(|fitted| fitted.power)) / TYPICAL;
        self.own.pop();
        self.products = without_line;
        self.noise *= if above > 1.0 { above } else { 1.0 };
    }

    /// Fits hum of `frequency` in Hz with this amplitude; with any, where it is not known.
    fn at(&self, frequency: f64, amplitude: Option<f64>) -> Option<Fitted> {
        let z = Complex64::new(0.0, TAU * frequency / self.rate);
        let prior = amplitude.map_or(self.unknown, |a| 0.5 * a * a);
        let hum = Pair::of(self.values, vec![(1.0, z)], Some(prior));
        let rows = rows(self.own.iter().chain([&hum]));
        // Normal equations of the amplitudes.
        let mut normal = products(&rows, self.values.len(), &self.products);
        for (i, (pair, _)) in rows.iter().enumerate() {
            normal[(i, i)] += pair.prior.map_or(0.0, |prior| self.noise / prior.max(f64::MIN_POSITIVE));
        }
        let right = rows.iter().map(|(pair, sine)| if *sine { pair.sum.im } else { pair.sum.re });
        let (size, right) = (rows.len(), DVector::from_iterator(rows.len(), right));
        let without = normal.view((0, 0), (size - 2, size - 2)).into_owned().cholesky()?.inverse();
        let inverse = normal.cholesky()?.inverse();
        let solved = &inverse * right;
        let covariance = inverse.view((size - 2, size - 2), (2, 2)) * self.noise;
        let both = DVector::from_column_slice(&[solved[size - 2], solved[size - 1]]);
        let power = both.dot(&(covariance.clone().try_inverse()? * &both));
        let added = (0..2).map(|i| inverse[(i, i)] - without[(i, i)]).sum::<f64>() / 2.0;
        Some(Fitted {
            // a cos + b sin is the real part of (a − ib) e^{iωt}.
            hum: Complex64::new(both[0], -both[1]),
            variance: 0.5 * covariance.trace(),
            power,
            left: (added.max(0.0) * self.noise).sqrt(),
        })
    }
}
