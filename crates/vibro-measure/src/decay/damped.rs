//! Lines of damped sines, and their fit.
//!
//! The transform of a damped sine over a finite part is a geometric sum: no window is needed, and the leakage
//! from the ends of the part is in the model. A fit reads only the lines around a few sines, where noise is
//! white enough, whatever colour it has elsewhere.

use crate::residuals::{Whiteness, student};
use nalgebra::{DMatrix, DVector, SVD};
use num_complex::Complex64;
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::ops::Range;
use vibro_math::{Fit, least_squares};
use vibro_record::{Error, Result};
use vibro_signal::fft::Transform;

/// One sine Re(c e^((−d + 2πiκ) t/T)) over a part of duration T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped {
    /// Periods κ in the part, thus its position in lines.
    pub periods: f64,
    /// Decay d over the part: the amplitude ends at e^(−d) of its beginning.
    pub decay: f64,
    /// Complex amplitude c at the beginning, in the unit of the record.
    pub amplitude: Complex64,
}

impl Damped {
    /// Line `k` of a part of `n` samples, (2/N) Σ xⱼ e^(−2πijk/N).
    pub fn line(&self, k: usize, n: usize) -> Complex64 {
        self.of(exponentials(self.periods, self.decay, k, n))
    }

    /// A line of the sine, from the lines of its two exponentials.
    fn of(&self, [own, image]: [Complex64; 2]) -> Complex64 {
        self.amplitude * own + self.amplitude.conj() * image
    }

    /// Sample `i` of a part of `n` samples.
    pub fn sample(&self, i: usize, n: usize) -> f64 {
        let t = i as f64 / n as f64;
        (self.amplitude * (Complex64::new(-self.decay, TAU * self.periods) * t).exp()).re
    }

    /// Half-width at half power, in lines; at least 1.
    pub fn width(&self) -> f64 {
        (self.decay.abs() / TAU).max(1.0)
    }

    /// Number of lines on either side to which the sine is fitted.
    pub fn reach(&self) -> f64 {
        LINES.0.max(LINES.1 * self.width())
    }
}

/// A sine that does not decay, whose frequency is known before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    pub sine: Damped,
    /// Periods of its nominal frequency, and their standard uncertainty.
    pub nominal: f64,
    pub spread: f64,
    /// Standard deviation of the noise of a component of a line.
    pub noise: f64,
    /// Whether chance alone does not explain it.
    pub seen: bool,
}

/// Lines that are fitted on either side of a sine: least number, and number in half-widths of the sine.
pub const LINES: (f64, f64) = (8.0, 6.0);

/// The lines of a part, scaled as in [`Damped::line`].
pub fn lines(part: &[f64]) -> Vec<Complex64> {
    let n = part.len();
    Transform::new(n).forward(part).iter().map(|line| line * (2.0 / n as f64)).collect()
}

/// Line `k` of e^((−d ± 2πiκ) j/N), divided by N.
fn exponentials(periods: f64, decay: f64, k: usize, n: usize) -> [Complex64; 2] {
    let all = n as f64;
    [periods, -periods].map(|at| {
        let step = Complex64::new(-decay, TAU * (at - k as f64)) / all;
        if step.norm() == 0.0 {
            Complex64::new(1.0, 0.0)
        } else {
            less_one(step * all) / less_one(step) / all
        }
    })
}

/// Line `k` of a sine by the real and by the imaginary part of its amplitude.
pub fn quadratures(periods: f64, decay: f64, k: usize, n: usize) -> [Complex64; 2] {
    let [own, image] = exponentials(periods, decay, k, n);
    [own + image, Complex64::i() * (own - image)]
}

/// eᶻ − 1 without cancellation.
fn less_one(z: Complex64) -> Complex64 {
    let (sin, cos) = z.im.sin_cos();
    let half = (0.5 * z.im).sin();
    Complex64::new(z.re.exp_m1() * cos - 2.0 * half * half, z.re.exp() * sin)
}

/// Parameters of a sine: periods, decay, real and imaginary part of the amplitude.
pub const OWN: usize = 4;
/// Parameters of a sine that does not decay: periods, real and imaginary part of the amplitude.
const OF_HUM: usize = 3;
/// Parameters of the background under the sines, a complex straight line over frequency.
const REST: usize = 4;

/// Sines that were fitted together to some lines.
#[derive(Debug, Clone)]
pub struct SineGroup {
    /// The fitted lines.
    pub lines: Range<usize>,
    /// The sines, in the order of their starts.
    pub sines: Vec<Damped>,
    /// Sines of hum beside them.
    pub hum: Vec<Steady>,
    pub fit: Fit,
    widening: f64,
}

impl SineGroup {
    /// Fits sines to `lines` of a spectrum of `n` samples, starting from these periods and decays, and `hum`,
    /// starting from its periods.
    ///
    /// # Errors
    /// If the lines do not determine the sines.
    pub fn fit(
        spectrum: &[Complex64],
        lines: Range<usize>,
        n: usize,
        starts: &[(f64, f64)],
        hum: &[Steady],
    ) -> Result<SineGroup> {
        let start = start(spectrum, &lines, n, starts, hum)?;
        let size = |amplitude: &[f64]| amplitude[0].hypot(amplitude[1]).max(f64::MIN_POSITIVE);
        let (own, linear) = start.split_at(OWN * starts.len());
        let mut scale = Vec::new();
        for p in own.chunks_exact(OWN) {
            scale.extend([1.0, p[1].abs().max(1.0), size(&p[2..]), size(&p[2..])]);
        }
        scale.extend(
            linear.chunks_exact(OF_HUM).take(hum.len()).flat_map(|p| [1.0, size(&p[1..]), size(&p[1..])]),
        );
        let largest = scale.iter().skip(2).copied().fold(f64::MIN_POSITIVE, f64::max);
        scale.extend([largest; REST]);
        // A numerical derivative changes one parameter, so the exponentials of all other sines are kept.
        let known = RefCell::new(vec![([f64::NAN; 2], Vec::new()); starts.len() + hum.len()]);
        let count = lines.len();
        let residuals = |p: &[f64], out: &mut [f64]| {
            let (sines, rest) = all(p, starts.len());
            let mut known = known.borrow_mut();
            for (sine, (at, of)) in sines.iter().zip(known.iter_mut()) {
                let Damped { periods, decay, .. } = *sine;
                if *at != [periods, decay] {
                    *at = [periods, decay];
                    *of = lines.clone().map(|k| exponentials(periods, decay, k, n)).collect();
                }
            }
            for ((i, k), out) in lines.clone().enumerate().zip(out.chunks_exact_mut(2)) {
                let all = sines.iter().zip(known.iter()).map(|(sine, (_, of))| sine.of(of[i]));
                let left = spectrum[k] - all.sum::<Complex64>() - beside(rest, place(i, count));
                out.copy_from_slice(&[left.re, left.im]);
            }
            for ((hum, sine), out) in hum.iter().zip(&sines[starts.len()..]).zip(&mut out[2 * count..]) {
                *out = (sine.periods - hum.nominal) / hum.spread * hum.noise;
            }
        };
        let fit = least_squares(residuals, 2 * lines.len() + hum.len(), &start, &scale)?;
        if !fit.converged {
            return Err(Error::refused("the fit of damped sines does not settle"));
        }
        let (mut sines, _) = all(&fit.parameters, starts.len());
        let steady = sines.split_off(starts.len());
        let hum = hum.iter().zip(steady).map(|(hum, sine)| Steady { sine, ..*hum }).collect();
        let own = &fit.residuals[..2 * count];
        let part = |odd: usize| own.iter().skip(odd).step_by(2).copied().collect::<Vec<f64>>();
        let white = Whiteness::of(&[&part(0), &part(1)]);
        let widening = student(fit.degrees_of_freedom()).unwrap_or(f64::NAN) * white.inflation;
        Ok(SineGroup { lines, sines, hum, fit, widening })
    }

    /// The sines, and those of hum.
    pub fn all(&self) -> impl Iterator<Item = &Damped> {
        self.sines.iter().chain(self.hum.iter().map(|hum| &hum.sine))
    }

    /// Whether two sines are so near each other that they are fitted together.
    pub fn near(a: &Damped, b: &Damped) -> bool {
        (a.periods - b.periods).abs() < 0.5 * (a.reach() + b.reach())
    }

    /// The group of a record without noise, with the uncertainties that noise gives it. `variance` is that of
    /// each component of a line.
    pub fn under_noise(mut self, variance: impl Fn(usize) -> f64) -> SineGroup {
        let first = self.lines.start;
        self.fit = self.fit.under_noise(|gain| {
            DMatrix::from_fn(gain.nrows(), gain.ncols(), |i, j| variance(first + i / 2) * gain[(i, j)])
        });
        self.widening = 1.0;
        self
    }

    /// Frequency and damping of sine `m`: indices among the parameters, and names with this ending.
    pub fn shapes(m: usize, ending: &str) -> [(usize, String); 2] {
        [(OWN * m, format!("frequency{ending}")), (OWN * m + 1, format!("zeta{ending}"))]
    }

    /// Standard uncertainty of a function of the parameters of sine `m` with this gradient.
    pub fn std(&self, m: usize, gradient: [f64; OWN]) -> f64 {
        let at =
            |i: usize, j: usize| gradient[i] * gradient[j] * self.fit.covariance(OWN * m + i, OWN * m + j);
        let sum: f64 = (0..OWN).flat_map(|i| (0..OWN).map(move |j| (i, j))).map(|(i, j)| at(i, j)).sum();
        self.widening * sum.max(0.0).sqrt()
    }
}

fn sine(p: &[f64]) -> Damped {
    Damped { periods: p[0], decay: p[1], amplitude: Complex64::new(p[2], p[3]) }
}

/// The sines of all parameters, of which `decaying` decay, and the parameters of the background.
fn all(p: &[f64], decaying: usize) -> (Vec<Damped>, &[f64]) {
    let (own, others) = p.split_at(OWN * decaying);
    let (of_hum, rest) = others.split_at(others.len() - REST);
    let steady = |p: &[f64]| sine(&[p[0], 0.0, p[1], p[2]]);
    (own.chunks_exact(OWN).map(sine).chain(of_hum.chunks_exact(OF_HUM).map(steady)).collect(), rest)
}

/// Position of line `i` of `n`, scaled to −1 … 1.
fn place(i: usize, n: usize) -> f64 {
    2.0 * i as f64 / (n - 1) as f64 - 1.0
}

fn beside(rest: &[f64], place: f64) -> Complex64 {
    Complex64::new(rest[0] + place * rest[2], rest[1] + place * rest[3])
}

/// Starting values of all parameters: the given periods and decays, the linear ones by least squares.
fn start(
    spectrum: &[Complex64],
    range: &Range<usize>,
    n: usize,
    starts: &[(f64, f64)],
    hum: &[Steady],
) -> Result<Vec<f64>> {
    let steady = hum.iter().map(|hum| (hum.sine.periods, 0.0));
    let sines: Vec<(f64, f64)> = starts.iter().copied().chain(steady).collect();
    let (rows, columns) = (2 * range.len(), 2 * sines.len() + REST);
    if rows <= columns + 2 * sines.len() {
        return Err(Error::refused(format!("{} lines do not determine {} sines", range.len(), sines.len())));
    }
    let (mut matrix, mut right) = (DMatrix::zeros(rows, columns), DVector::zeros(rows));
    for (i, k) in range.clone().enumerate() {
        let mut put = |column: usize, value: Complex64| {
            (matrix[(2 * i, column)], matrix[(2 * i + 1, column)]) = (value.re, value.im);
        };
        for (m, (periods, decay)) in sines.iter().enumerate() {
            let [real, imaginary] = quadratures(*periods, *decay, k, n);
            put(2 * m, real);
            put(2 * m + 1, imaginary);
        }
        for c in 0..REST {
            let mut unit = [0.0; REST];
            unit[c] = 1.0;
            put(2 * sines.len() + c, beside(&unit, place(i, range.len())));
        }
        (right[2 * i], right[2 * i + 1]) = (spectrum[k].re, spectrum[k].im);
    }
    let svd = SVD::try_new(matrix, true, true, f64::EPSILON, 10_000);
    let solved = svd.and_then(|svd| svd.solve(&right, 1e-12 * svd.singular_values.max()).ok());
    let linear = solved.ok_or_else(|| Error::refused("the lines do not determine the sines"))?;
    let of = |m: usize| [linear[2 * m], linear[2 * m + 1]];
    let mut all: Vec<f64> = Vec::new();
    for (m, (periods, decay)) in sines.iter().enumerate() {
        all.push(*periods);
        all.extend((m < starts.len()).then_some(decay));
        all.extend(of(m));
    }
    all.extend(linear.iter().skip(2 * sines.len()));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the transform of the samples; the geometric sum of N terms rounds to N ε.
    #[test]
    fn lines_are_those_of_the_samples() {
        for (n, periods, decay) in [(64, 5.3, 2.0), (101, 0.7, 0.0), (500, 249.1, 9.0), (64, 7.0, -1.5)] {
            let sine = Damped { periods, decay, amplitude: Complex64::from_polar(1.3, 0.4) };
            let samples: Vec<f64> = (0..n).map(|i| sine.sample(i, n)).collect();
            for (k, line) in Transform::new(n).forward(&samples).iter().enumerate() {
                let error = (sine.line(k, n) - line * (2.0 / n as f64)).norm();
                assert!(error < 1e-14 * (1.0 + (-decay).exp()) * n as f64, "{n} {k}: {error}");
            }
        }
    }

    #[test]
    fn two_sines_a_line_apart_are_found_without_noise() {
        let n = 2000;
        let truth = [(40.2, 3.0, 1.0), (41.3, 4.0, 0.5)].map(|(periods, decay, a)| Damped {
            periods,
            decay,
            amplitude: Complex64::from_polar(a, a),
        });
        let spectrum: Vec<Complex64> = (0..100).map(|k| truth.iter().map(|s| s.line(k, n)).sum()).collect();
        let group = SineGroup::fit(&spectrum, 30..52, n, &[(40.0, 2.0), (41.5, 2.0)], &[]).unwrap();
        for (found, truth) in group.sines.iter().zip(&truth) {
            // The Jacobian is from central differences, and the fit ends at steps below 1e-8 of a line.
            assert!((found.periods - truth.periods).abs() < 1e-6 && (found.decay - truth.decay).abs() < 1e-5);
        }
        assert!(SineGroup::fit(&spectrum, 38..42, n, &[(40.0, 2.0), (41.5, 2.0)], &[]).is_err());
    }
}
