//! Parabolas fitted before and after an impact, and the lack of fit that they have in common.

use super::faults::State;
use crate::residuals::Whiteness;
use nalgebra::{Matrix3, Vector3};
use std::ops::RangeInclusive;

/// Fewest samples of a fit: twice its parameters.
pub(super) const FEWEST: usize = 6;
/// Threshold of a lack of fit: mean square of the common residual over its value for noise, in standard
/// deviations above 1.
const SIGNIFICANT: f64 = 5.0;

/// Least-squares parabola, extrapolated to the middle of the contact.
#[derive(Debug, Clone)]
pub(super) struct Parabola {
    /// Extrapolated value, in the unit of the samples.
    pub value: f64,
    /// Slope there per sample, and half the second derivative.
    pub slope: f64,
    pub bend: f64,
    /// Variance of the value for unit variance of the samples.
    pub leverage: f64,
    /// Sum of the squares of the residuals, and their degrees of freedom.
    pub squares: f64,
    pub freedom: f64,
    /// Residuals; 0 where nothing was measured.
    pub residuals: Vec<f64>,
}

impl Parabola {
    /// Parabola through the measured samples of `range`, extrapolated to the sample position `at`; `None`
    /// where fewer than two thirds of the samples are measured.
    pub fn through(
        values: &[f64],
        states: &[State],
        at: f64,
        range: RangeInclusive<isize>,
    ) -> Option<Parabola> {
        let (from, to) = (usize::try_from(*range.start()).ok()?, usize::try_from(*range.end()).ok()?);
        let (part, known) = (values.get(from..=to)?, states.get(from..=to)?);
        let scale = 1.0 / part.len().max(1) as f64;
        let good = || {
            let all = part.iter().zip(known).enumerate().filter(|(_, (_, s))| s.measured());
            all.map(|(k, (v, _))| (k, ((from + k) as f64 - at) * scale, *v))
        };
        let n = good().count();
        if n < FEWEST || 3 * n < 2 * part.len() {
            return None;
        }
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (_, x, y) in good() {
            let powers = Vector3::new(1.0, x, x * x);
            normal += powers * powers.transpose();
            right += powers * y;
        }
        // x counts from `at`: the constant term is the extrapolated value.
        let inverse = normal.try_inverse()?;
        let fitted = inverse * right;
        let mut residuals = vec![0.0; part.len()];
        good().for_each(|(k, x, y)| residuals[k] = y - fitted[0] - x * (fitted[1] + x * fitted[2]));
        let squares = residuals.iter().map(|r| r * r).sum();
        let (value, leverage, freedom) = (fitted[0], inverse[(0, 0)], n as f64 - 3.0);
        let (slope, bend) = (fitted[1] * scale, fitted[2] * scale * scale);
        value.is_finite().then_some(Parabola { value, slope, bend, leverage, squares, freedom, residuals })
    }

    /// Value of the parabola `by` samples after the position to which it is extrapolated.
    pub fn beside(&self, by: f64) -> f64 {
        self.value + by * (self.slope + by * self.bend)
    }

    /// Variance of the extrapolated value, from the residuals of this fit alone.
    pub fn variance(&self) -> f64 {
        self.leverage * self.squares / self.freedom
    }
}

/// Lack of fit that the parabolas on one side of all impacts have in common.
///
/// Noise differs from impact to impact. A common residual is motion that is no parabola: ringing, a contact
/// longer than the gap between the fits, or a slow instrument. It biases all speeds by the same amount, so
/// the scatter from impact to impact does not show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LackOfFit {
    /// Root of the mean square of the common residual, in m/s.
    pub residual: f64,
    /// Largest bias of the speed at the impact, in m/s.
    pub bias: f64,
}

impl LackOfFit {
    /// Significant lack of fit of the parabolas with these residuals. From each fit to the middle of its
    /// contact there are `gap` samples.
    ///
    /// Over n impacts, the residual at each sample has the mean m and the variance s². In noise nΣm²/Σs² is
    /// 1 ± √(2/f), f being the number of independent samples. The bias is the common residual extrapolated to
    /// the middle of the contact. It is taken as Legendre's cubic, √7 P₃ for an RMS of 1: the smoothest curve
    /// that a parabola does not fit.
    pub fn of(residuals: &[&[f64]], gap: usize) -> Option<LackOfFit> {
        let (n, places) = (residuals.len() as f64, residuals.first()?.len());
        let (mut common, mut chance) = (0.0, 0.0);
        for k in 0..places {
            let mean = residuals.iter().map(|r| r[k]).sum::<f64>() / n;
            let squares: f64 = residuals.iter().map(|r| (r[k] - mean).powi(2)).sum();
            common += mean * mean;
            chance += squares / (n - 1.0) / n;
        }
        let independent = places as f64 / Whiteness::of(residuals).inflation.powi(2);
        let significant = common > chance * (1.0 + SIGNIFICANT * (2.0 / independent).sqrt());
        let residual = ((common - chance).max(0.0) / places as f64).sqrt();
        let x = 1.0 + 2.0 * gap as f64 / places as f64;
        let bias = residual * 7f64.sqrt() * 0.5 * x * (5.0 * x * x - 3.0);
        significant.then_some(LackOfFit { residual, bias })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    /// Percentage of 1000 sets of `n` impacts with a significant lack of fit. The noise has a variance of 1
    /// and an autocorrelation of `rho` from sample to sample; `ring` is the amplitude of a ringing.
    fn significant(n: usize, rho: f64, ring: f64) -> f64 {
        let mut noise = Noise::new(17);
        let significant = (0..1000).filter(|_| {
            let one = |_| {
                let mut x = noise.normal();
                let values: Vec<f64> = (0..26)
                    .map(|k| {
                        x = rho * x + (1.0 - rho * rho).sqrt() * noise.normal();
                        x + ring * (f64::from(k) * 0.7).sin()
                    })
                    .collect();
                Parabola::through(&values, &[State::Good; 26], -6.0, 0..=25).unwrap().residuals
            };
            let residuals: Vec<Vec<f64>> = (0..n).map(one).collect();
            LackOfFit::of(&residuals.iter().map(Vec::as_slice).collect::<Vec<&[f64]>>(), 6).is_some()
        });
        let part = 0.1 * significant.count() as f64;
        println!("{n} impacts, rho {rho}, ring {ring}: {part:.1} % significant");
        part
    }

    #[test]
    fn noise_is_no_lack_of_fit_and_ringing_is() {
        no_lack_of_fit(&[4, 10]);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn noise_of_any_number_of_impacts_is_no_lack_of_fit() {
        no_lack_of_fit(&[4, 6, 10, 40, 200]);
    }

    fn no_lack_of_fit(impacts: &[usize]) {
        for &n in impacts {
            for rho in [0.0, 0.5, 0.9] {
                // The threshold alone allows 0.03 %. Few impacts leave the autocorrelation uncertain, so 2 %
                // is accepted.
                assert!(significant(n, rho, 0.0) < 2.0, "{n} {rho}");
            }
        }
        // Ringing as large as the noise at 40 impacts: a ratio of 20, against 1 ± 0.3 in noise.
        assert!(significant(40, 0.0, 1.0) == 100.0);
    }

    #[test]
    fn the_residual_is_continued_to_the_contact() {
        // Legendre's cubic on 3200 samples: its RMS is 1/√7, its value at the end, where the contact is, 1.
        let cubic = |k: usize| {
            let x = (k as f64 + 0.5) / 1600.0 - 1.0;
            0.5 * x * (5.0 * x * x - 3.0)
        };
        let residuals: Vec<f64> = (0..3200).map(cubic).collect();
        let found = LackOfFit::of(&[&residuals[..]; 4], 0).unwrap();
        assert!(
            (found.residual * 7f64.sqrt() - 1.0).abs() < 1e-5 && (found.bias - 1.0).abs() < 1e-5,
            "{found:?}"
        );
    }
}
