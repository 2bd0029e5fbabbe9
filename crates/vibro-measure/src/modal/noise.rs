//! Noise of the lines of a function: the variance of each, and the correlation of neighbours.
//!
//! A segment's lines are F = Σ W f and X = Σ W H f + v: the window's transform W at the distance of each
//! frequency, the force f, the noise v of the response. βF is the part of X that the smoothed function β
//! explains. The rest, e = Σ (H − β) W f + v, is leakage and noise. It is independent of F on its own line,
//! but not on others. H1 has the error Σ conj(F) e / Σ |F|². Over a common factor the covariance of lines i
//! and j is `E[conj(Fᵢ) Fⱼ] E[eᵢ conj(eⱼ)]`, their pseudo-covariance `E[eᵢ conj(Fⱼ)] E[eⱼ conj(Fᵢ)]`
//! (Isserlis 1918), summed over segments that overlap by half. Leakage gives neighbouring lines opposite
//! errors in the direction of a shift in frequency, and equal ones in that of damping. With lines taken as
//! independent, the true uncertainty of ζ is 1.3 times the stated one.

use crate::mean::average;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Window;
use vibro_signal::window::line_shape;

/// Noise of the lines, up to a common factor.
#[derive(Debug, Clone)]
pub(super) struct LineNoise {
    /// Standard deviation of each line.
    pub each: Vec<f64>,
    /// Cholesky factor of the covariance of all components (real and imaginary part of each line in turn),
    /// where lines are not independent.
    factor: Option<Banded>,
}

/// A lower triangular band matrix. Each row holds the `band` numbers before the diagonal, then the diagonal.
#[derive(Debug, Clone)]
struct Banded {
    band: usize,
    rows: Vec<f64>,
}

impl LineNoise {
    /// Independent lines.
    pub fn independent(each: Vec<f64>) -> LineNoise {
        LineNoise { each, factor: None }
    }

    /// Whitens residuals of the lines, first the real parts and then the imaginary parts.
    pub fn whiten(&self, left: &mut [f64]) {
        let n = self.each.len();
        let Some(Banded { band, rows }) = &self.factor else {
            left.iter_mut().enumerate().for_each(|(i, v)| *v /= self.each[i % n]);
            return;
        };
        let place = |r: usize| r / 2 + (r % 2) * n;
        for (r, row) in rows.chunks(band + 1).enumerate() {
            let first = r.saturating_sub(*band);
            let known: f64 = (first..r).map(|c| row[band + c - r] * left[place(c)]).sum();
            left[place(r)] = (left[place(r)] - known) / row[*band];
        }
    }

    /// Logarithm of the determinant of the covariance of `numbers` residuals: the term of the noise in minus
    /// twice the logarithm of the likelihood.
    pub fn spread(&self, numbers: usize) -> f64 {
        match &self.factor {
            Some(Banded { band, rows }) => {
                2.0 * rows.chunks(band + 1).map(|row| row[*band].ln()).sum::<f64>()
            }
            None => {
                2.0 * self.each.iter().map(|w| w.ln()).sum::<f64>() * numbers as f64 / self.each.len() as f64
            }
        }
    }

    /// Minus twice the logarithm of the likelihood of whitened residuals, whose variance is unknown.
    pub fn unlikely(&self, left: &[f64]) -> f64 {
        let n = left.len() as f64;
        n * (left.iter().map(|r| r * r).sum::<f64>() / n).ln() + self.spread(left.len())
    }
}

impl Banded {
    /// Cholesky factor of the matrix with the lower triangle `at` (row, column); `None` where that is not
    /// positive definite.
    fn factor(n: usize, band: usize, at: impl Fn(usize, usize) -> f64) -> Option<Banded> {
        let mut rows = vec![0.0; n * (band + 1)];
        for r in 0..n {
            for c in r.saturating_sub(band)..=r {
                let first = r.saturating_sub(band);
                let (own, other) = (r * (band + 1) + band - r, c * (band + 1) + band - c);
                let sum: f64 = (first..c).map(|k| rows[own + k] * rows[other + k]).sum();
                let left = at(r, c) - sum;
                rows[own + c] = if r == c { left.sqrt() } else { left / rows[other + c] };
            }
            // NaN fails this test, too.
            (rows[r * (band + 1) + band] > 0.0).then_some(())?;
        }
        Some(Banded { band, rows })
    }
}

/// Grid steps for each line. The grid then covers a time of four segments, in which a mode with a bandwidth
/// of one line decays to exp(−4π).
pub(super) const STEPS: usize = 4;

/// Lines on either side of a line from which leakage is taken: beyond, the transform of a Hann window is
/// below 0.01.
const REACH: usize = 4;

/// Steps of the grid before the first line, and after the last.
pub(super) const MARGIN: usize = REACH * STEPS;

/// Least variance of the noise of a line, over that of the leakage there: no excitation spectrum is quite
/// flat, and the covariance matrix must have an inverse.
const LEAST: f64 = 0.02;

/// Noise of H1 over segments under a window. `h` is the function without leakage on a grid; the lines are at
/// the grid indices `at` and have the variances `total`. `None` where the covariance has no inverse.
pub(super) fn of_segments(window: Window, h: &[Complex64], at: &[usize], total: &[f64]) -> Option<LineNoise> {
    // The window's transform on the grid; real, since time is counted from the window's middle.
    let offset = |k: usize| (k as f64 - MARGIN as f64) / STEPS as f64;
    let kernel: Vec<f64> = (0..=2 * MARGIN).map(|k| line_shape(window, offset(k))).collect();
    let power: f64 = kernel.iter().map(|w| w * w).sum();
    let near = |i: usize| kernel.iter().zip(&h[at[i] - MARGIN..]);
    let leaked: Vec<Vec<Complex64>> = (0..at.len())
        .map(|i| {
            let mean = near(i).map(|(w, h)| h * w * w).sum::<Complex64>() / power;
            near(i).map(|(w, h)| (h - mean) * w).collect()
        })
        .collect();
    let leakage: Vec<f64> =
        leaked.iter().map(|e| e.iter().map(Complex64::norm_sqr).sum::<f64>() / power).collect();
    let own: Vec<f64> = background(total, &leakage).into_iter().map(f64::sqrt).collect();
    // Covariance and pseudo-covariance of lines i ≥ j.
    let shared = |i: usize, j: usize| {
        let apart = at[i] - at[j];
        if apart >= kernel.len() {
            return [Complex64::ZERO; 2];
        }
        // The segment itself, the one half a segment before, and the one after.
        let part = |turns: f64| {
            let [mut force, mut both, mut one, mut other] = [Complex64::ZERO; 4];
            for (a, b) in (apart..kernel.len()).enumerate() {
                let later = Complex64::cis(TAU * turns * b as f64 / STEPS as f64);
                force += later * (kernel[a] * kernel[b]);
                both += leaked[i][a] * leaked[j][b].conj() * later.conj();
                one += leaked[i][a] * kernel[b] * later.conj();
                other += leaked[j][b] * kernel[a] * later;
            }
            [force * (both + own[i] * own[j] * force.conj()), one * other]
        };
        let [a, b, c] = [0.0, -0.5, 0.5].map(part);
        [0, 1].map(|k| (a[k] + b[k] + c[k]) / (power * power))
    };
    let lags = 2 * REACH;
    let pair = |(i, lag): (usize, usize)| i.checked_sub(lag).map_or([Complex64::ZERO; 2], |j| shared(i, j));
    let pairs = (0..at.len()).flat_map(|i| (0..=lags).map(move |lag| (i, lag)));
    let pairs: Vec<[Complex64; 2]> = pairs.map(pair).collect();
    let covariance = |r: usize, c: usize| {
        let (i, j) = (r / 2, c / 2);
        let Some([proper, pseudo]) = pairs.get(i * (lags + 1) + i - j).filter(|_| i - j <= lags) else {
            return 0.0;
        };
        0.5 * match (r % 2, c % 2) {
            (0, 0) => proper.re + pseudo.re,
            (1, 1) => proper.re - pseudo.re,
            (0, 1) => pseudo.im - proper.im,
            _ => pseudo.im + proper.im,
        }
    };
    let each = (0..at.len()).map(|i| (leakage[i] + own[i] * own[i]).sqrt()).collect();
    let factor = Banded::factor(2 * at.len(), 2 * lags + 1, covariance)?;
    Some(LineNoise { each, factor: Some(factor) })
}

/// Variance of the noise of the response at each line: the excess of `total` over the leakage. It is
/// averaged over near lines, since noise is smooth, with weights by their uncertainty. At least [`LEAST`] of
/// the leakage.
fn background(total: &[f64], leakage: &[f64]) -> Vec<f64> {
    let all = |(i, mean): (usize, f64)| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in near(i, total.len()) {
            let weight = (mean + leakage[k]).powi(-2);
            sum += weight * (total[k] - leakage[k]);
            weights += weight;
        }
        (sum / weights).max(LEAST * leakage[i])
    };
    smoothed(total).into_iter().enumerate().map(all).collect()
}

/// Variance of each line with noise in the response and in the excitation. Noise of the excitation n changes
/// F to F + n, and H by the factor 1 − n/F: its variance is a fixed share of |H|², the `power` of a line.
/// That of the response is smooth over frequency `x`: a sum of 1/x², 1 and x², each at least 0.
///
/// `total` holds a measured variance of each line, which scatters as χ² (Bendat & Piersol 2010, 8.2). The
/// shares are likeliest where Σ ln m + v/m is least, found by steps that keep them above 0 and lower the sum
/// (Févotte & Idier 2011, Itakura–Saito divergence).
pub(super) fn of_both(total: &[f64], power: &[f64], x: &[f64]) -> Vec<f64> {
    let middle = x[x.len() / 2];
    let parts = |i: usize| {
        let x2 = (x[i] / middle).powi(2);
        [power[i], 1.0, x2, 1.0 / x2]
    };
    let mean = average(total);
    let of_power = mean / average(power);
    let mut share = [0.25 * of_power, 0.25 * mean, 0.25 * mean, 0.25 * mean];
    let model = |share: &[f64; 4], i: usize| parts(i).iter().zip(share).map(|(p, s)| p * s).sum::<f64>();
    for _ in 0..STEPS_OF_SHARES {
        let (mut up, mut down) = ([0.0; 4], [0.0; 4]);
        for (i, v) in total.iter().enumerate() {
            let m = model(&share, i);
            for (k, part) in parts(i).into_iter().enumerate() {
                up[k] += part * v / (m * m);
                down[k] += part / m;
            }
        }
        (0..4).for_each(|k| share[k] *= (up[k] / down[k]).sqrt());
    }
    (0..total.len()).map(|i| model(&share, i)).collect()
}

/// Steps of the search for the shares of the noise.
const STEPS_OF_SHARES: usize = 200;

/// Lines on either side over which the noise that the coherence gives is averaged. With two averages the
/// noise of one line has 2 degrees of freedom, that of all 31 has 62: a weight then scatters by 9 %.
const NEAR: usize = 15;

fn near(i: usize, n: usize) -> std::ops::Range<usize> {
    i.saturating_sub(NEAR)..(i + NEAR + 1).min(n)
}

/// Means over each value and up to [`NEAR`] on either side.
pub(super) fn smoothed(values: &[f64]) -> Vec<f64> {
    (0..values.len()).map(|i| average(&values[near(i, values.len())])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    /// A mode of ten lines in the bandwidth; noise of the response of 1, and of the excitation of 0.02 H,
    /// which is 10 times the former at the peak. Four degrees of freedom a line, as of three blows.
    #[test]
    fn noise_of_the_excitation_is_a_share_of_the_response() {
        let mut noise = vibro_math::Noise::new(4);
        let x: Vec<f64> = (0..81).map(|i| 0.8 + 0.005 * f64::from(i)).collect();
        let power: Vec<f64> =
            x.iter().map(|x| 500f64.powi(2) / (1.0 + ((x - 1.0) / 0.025).powi(2))).collect();
        let truth: Vec<f64> = power.iter().map(|power| 1.0 + 4e-4 * power).collect();
        let total: Vec<f64> =
            truth.iter().map(|v| v * (0..4).map(|_| noise.normal().powi(2)).sum::<f64>() / 4.0).collect();
        let found = of_both(&total, &power, &x);
        // Variances of 81 lines scatter by √(2/4) each. The shares rest on about 15 lines of the peak and 30
        // beside: by 18 % and 13 %, of which four deviations are within a factor of two.
        assert!(found.iter().zip(&truth).all(|(f, t)| (0.5..2.0).contains(&(f / t))), "{found:?}");
        let plain = smoothed(&total);
        assert!(plain[40] < 0.7 * truth[40] || plain[10] > 2.0 * truth[10], "a mean is of neither");
    }

    /// Hann: the transform has −½, 1, −½ on lines; neighbours of independent noise correlate by (2/3)² and
    /// (1/6)², and with the segments beside, of a correlation of 1/6 each, the variance is 1 + 2/36.
    #[test]
    fn neighbours_share_the_noise_of_the_response_as_the_window_says() {
        let n = 12;
        let at: Vec<usize> = (0..n).map(|i| MARGIN + STEPS * i).collect();
        let h = vec![Complex64::new(1.0, 0.5); at[n - 1] + MARGIN + 1];
        let noise = of_segments(Window::Hann, &h, &at, &vec![4.0; n]).unwrap();
        assert!(noise.each.iter().all(|e| (e - 2.0).abs() < 1e-9), "{noise:?}");
        let Banded { band, rows } = noise.factor.as_ref().unwrap();
        let row = |r: usize| (0..=*band).map(move |k| (r + k, rows[r * (band + 1) + k]));
        let of = |a: usize, b: usize| {
            let b: Vec<(usize, f64)> = row(b).collect();
            row(a).filter_map(|(k, v)| b.iter().find(|(at, _)| *at == k).map(|(_, w)| v * w)).sum::<f64>()
        };
        let all = of(12, 12);
        assert!((all / (0.5 * 4.0 * (1.0 + 2.0 / 36.0)) - 1.0).abs() < 1e-3, "{all}");
        assert!(of(12, 13).abs() < 1e-9 * all);
        // White residuals of the covariance L Lᵀ come out as they went in.
        let white: Vec<f64> = (0..2 * n).map(|k| (k as f64 * SQRT_2).sin()).collect();
        let coloured =
            |r: usize| row(r).filter(|(k, _)| *k >= *band).map(|(k, v)| v * white[k - band]).sum::<f64>();
        let mut left: Vec<f64> = (0..2 * n).map(|k| coloured(2 * (k % n) + k / n)).collect();
        noise.whiten(&mut left);
        for (k, v) in left.iter().enumerate() {
            assert!((v - white[2 * (k % n) + k / n]).abs() < 1e-9, "{k}");
        }
    }
}
