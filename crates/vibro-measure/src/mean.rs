//! Arithmetic means, and the mean of a serially correlated sequence with its uncertainty.

use crate::residuals::student;
use std::f64::consts::PI;

/// Fewest values whose scatter gives a standard uncertainty.
const FEWEST: usize = 4;
/// Most cosines: the variance then has an uncertainty of 26 %, and more cosines gain little.
const MOST: usize = 30;
/// Lower limit of the spectral density from the few cosines, relative to the density from neighbours
/// ([`density`]), which uses all values. Chance explains a smaller one.
const LEAST: f64 = 0.6;
/// One-sided 99 % quantile of the normal distribution, in standard deviations.
const SURE: f64 = 2.33;
/// Mean density over the cosines, over that at frequency 0, below which an uncertainty may be too small by a
/// third or more.
const STEEP: f64 = 0.5;
/// Largest correlation of neighbours that is corrected for: at 1 the correction is infinite.
const CLOSEST: f64 = 0.97;

/// Arithmetic mean; NaN where there is no value.
pub(crate) fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation; NaN for fewer than two values.
pub(crate) fn scatter(values: &[f64]) -> f64 {
    let mean = average(values);
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if values.len() < 2 { f64::NAN } else { (squares / (values.len() - 1) as f64).sqrt() }
}

/// Mean of `estimates` (logarithm of the weight, value, variance), and its variance: the mean of their
/// variances and the variance of their values.
pub(crate) fn mixture(estimates: &[(f64, f64, f64)]) -> (f64, f64) {
    let highest = estimates.iter().map(|e| e.0).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = estimates.iter().map(|e| (e.0 - highest).exp()).sum();
    let over = |of: &dyn Fn(f64, f64) -> f64| {
        estimates.iter().map(|e| (e.0 - highest).exp() * of(e.1, e.2)).sum::<f64>() / total
    };
    let mean = over(&|value, _| value);
    (mean, over(&|value, variance| variance + (value - mean).powi(2)))
}

/// A mean and its standard uncertainty.
///
/// Neighbouring values are rarely independent: speed and stroke of a machine wander. The variance of their
/// mean is taken from their slowest changes, the projections on K cosines `c_j = √(2/n) Σ x_t cos(πj(t −
/// ½)/n)`, j = 1 to K, of t = 1 to n. Each projection has the spectral density near zero frequency as its
/// variance, so that `Σ c_j²/(K n)` is the variance of the mean with K degrees of freedom (U. Müller, J.
/// Econometrics 141 (2007) 1331). K is 1.2 n^0.4, from 3 to 30: few enough that the density hardly changes
/// over them where neighbours are correlated moderately. The standard uncertainty is that of Student's
/// distribution ([`student`]).
///
/// Where neighbours have the correlation ρ, the density falls over the cosines, to the part (1 − ρ)²/(1 − 2ρ
/// cos ω + ρ²) of that at frequency 0. The variance is divided by the mean of these parts (prewhitening with
/// a first-order model, D. Andrews and J. Monahan, Econometrica 60 (1992) 953); ρ is the serial correlation
/// r, corrected for its bias −(1 + 3r)/n (M. Kendall, Biometrika 41 (1954) 403). The few cosines may be small
/// by chance: unless neighbours are clearly anticorrelated, the variance is at least 0.6 of what γ₀ and a
/// negative γ₁ give. ± 1.96 standard uncertainties cover the truth in 95 to 97 % of independent sequences, in
/// 93 % of 20 values or more up to ρ = 0.6; at ρ = 0.9 in 83 % of 20, 89 % of 60 and 94 % of 300. `wanders`
/// marks sequences whose uncertainty may be too small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mean {
    /// Arithmetic mean; NaN where there is no value.
    pub value: f64,
    /// Standard uncertainty; `None` for fewer than four values, or where one is missing.
    pub std: Option<f64>,
    /// Number of values.
    pub n: usize,
    /// Whether the values drift so slowly that the uncertainty may be too small.
    pub wanders: bool,
}

impl Mean {
    /// Mean of values in the order of time, taken as a sequence without gaps; the caller leaves out missing
    /// ones.
    pub fn of(values: &[f64]) -> Mean {
        let n = values.len();
        let value = average(values);
        if n < FEWEST {
            return Mean { value, std: None, n, wanders: false };
        }
        let count = cosines(n);
        let step = PI / n as f64;
        let squares: f64 = (1..=count)
            .map(|j| {
                let weight = |t: usize| (step * j as f64 * (t as f64 + 0.5)).cos();
                // The cosines sum to 0, so subtracting the mean changes only the rounding, for the better.
                let c: f64 = values.iter().enumerate().map(|(t, x)| (x - value) * weight(t)).sum();
                2.0 / n as f64 * (c * c)
            })
            .sum();
        if !squares.is_finite() {
            return Mean { value, std: None, n, wanders: false };
        }
        let about = values.iter().map(|x| (x - value).powi(2)).sum();
        let products = values.windows(2).map(|x| (x[0] - value) * (x[1] - value)).sum();
        let (part, chance) = part(about, products, n as f64, count);
        let density = density(about, products, n as f64);
        let variance = (squares / count as f64 / part).max(LEAST * density) / n as f64;
        let std = student(count).map(|factor| (factor * factor * variance).sqrt());
        Mean { value, std: std.filter(|s| s.is_finite()), n, wanders: part < STEEP && !chance }
    }
}

/// Spectral density at frequency 0 of `n` values where only neighbours are correlated: γ₀ + 2γ₁, a positive
/// γ₁ left out. `squares` is the sum of squares about the mean, `products` that of products of neighbours.
/// Returns 0 if neighbours are clearly anticorrelated, like intervals between edges.
fn density(squares: f64, products: f64, n: f64) -> f64 {
    if products < -SURE * squares / n.sqrt() {
        return 0.0;
    }
    ((squares + 2.0 * products.min(0.0)) / n).max(0.0)
}

/// Mean spectral density over `count` cosines, relative to that at frequency 0, for a first-order
/// autoregressive series with the correlation of the values; at most 1. The second value tells whether
/// independent values are as correlated in more than 1 % of cases: their r is about −1/n ± 1/√n.
fn part(squares: f64, products: f64, n: f64, count: usize) -> (f64, bool) {
    let r = if squares > 0.0 { products / squares } else { 0.0 };
    let rho = (r + (1.0 + 3.0 * r) / n).clamp(0.0, CLOSEST);
    let density = |j: usize| {
        let cos = (PI * j as f64 / n).cos();
        (1.0 - rho) * (1.0 - rho) / (1.0 - 2.0 * rho * cos + rho * rho)
    };
    ((1..=count).map(density).sum::<f64>() / count as f64, r + 1.0 / n < SURE / n.sqrt())
}

/// Number of cosines for `n` values.
fn cosines(n: usize) -> usize {
    ((1.2 * (n as f64).powf(0.4)).round() as usize).clamp(3, MOST).min(n.saturating_sub(1))
}

/// Root mean square of standard uncertainties; `None` where one is not known.
pub(crate) fn together(stds: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let squares: Vec<f64> = stds.map(|s| s.map(|s| s * s)).collect::<Option<_>>()?;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    /// `n` values of unit variance, each `rho` times the one before plus new noise.
    fn chain(noise: &mut Noise, n: usize, rho: f64) -> Vec<f64> {
        let mut x = noise.normal();
        let new = (1.0 - rho * rho).sqrt();
        (0..n)
            .map(|_| {
                let now = x;
                x = rho * now + new * noise.normal();
                now
            })
            .collect()
    }

    #[test]
    fn three_cosines_hold_all_that_four_values_scatter() {
        let values = [3.0, -1.0, 4.0, 1.5];
        let mean = Mean::of(&values);
        let squares: f64 = values.iter().map(|x| (x - 1.875f64).powi(2)).sum();
        // Three cosines and the constant are a complete basis: the variance is s²/n with 3 degrees of
        // freedom. Student's distribution gives the factor √3.
        let expected = 3f64.sqrt() * (squares / 3.0 / 4.0).sqrt();
        assert!((mean.std.unwrap() / expected - 1.0).abs() < 1e-14, "{mean:?} {expected}");
        assert!((mean.value, mean.n) == (1.875, 4));
    }

    #[test]
    fn few_values_and_equal_ones() {
        assert!(Mean::of(&[]).value.is_nan() && Mean::of(&[]).std.is_none());
        assert_eq!(Mean::of(&[1.0, 2.0, 4.0]).std, None);
        assert_eq!(Mean::of(&[1.0, f64::NAN, 1.0, 2.0]).std, None);
        assert_eq!(Mean::of(&[0.1; 50]).std.map(|s| s < 1e-16), Some(true));
    }

    /// Two shares of 2000 sequences (seed `n`) in %: those whose ±1.96 standard uncertainties cover the true
    /// mean 0, and those that are reported to wander.
    fn coverage(n: usize, rho: f64) -> (f64, f64) {
        let mut noise = Noise::new(n as u64);
        let (mut inside, mut told) = (0, 0);
        for _ in 0..2000 {
            let mean = Mean::of(&chain(&mut noise, n, rho));
            inside += i32::from(mean.value.abs() < 1.96 * mean.std.unwrap_or(f64::NAN));
            told += i32::from(mean.wanders);
        }
        let parts = (0.05 * f64::from(inside), 0.05 * f64::from(told));
        println!("n = {n}, rho = {rho}: {:.1} %, {:.1} % said to wander", parts.0, parts.1);
        parts
    }

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        for (n, rho) in [
            (4, 0.0),
            (8, 0.0),
            (20, 0.0),
            (20, 0.3),
            (60, 0.0),
            (60, 0.3),
            (60, 0.6),
            (300, 0.6),
            (20, 0.6),
            (300, 0.9),
        ] {
            let (part, told) = coverage(n, rho);
            assert!((92.0..=98.0).contains(&part), "n = {n}, rho = {rho}: {part} %");
            // Independent values are reported to wander in 1 % of cases, which scatters by 0.2 %; four times
            // that.
            assert!(rho > 0.0 || told < 1.9, "n = {n}: {told} %");
        }
        // 20 or 60 values span too few correlation lengths of a chain of 0.9 to show its correlation: the
        // coverage is the stated 83 % and 89 %, and most sequences are reported to wander. The share of 2000
        // sequences scatters by 0.8 %, four times that.
        for (n, stated) in [(20, 83.0), (60, 89.0)] {
            let (part, told) = coverage(n, 0.9);
            assert!((part - stated).abs() < 3.2 && told > 50.0, "n = {n}: {part} %, {told} %");
        }
    }
}
