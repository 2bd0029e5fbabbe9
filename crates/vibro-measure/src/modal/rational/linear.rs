//! A fit that is linear about its parameters, under other noise.

use super::rivals::Named;
use super::{LineNoise, Scaled};
use nalgebra::{DMatrix, DVector};
use vibro_record::sort_by_number;

/// Residuals of a model at some parameters and their derivatives, both not whitened.
pub(super) struct Linear {
    residuals: DVector<f64>,
    jacobian: DMatrix<f64>,
}

/// The least squares of a linear model under some noise.
pub(super) struct Under {
    /// Change of the parameters to the least sum of squares.
    pub step: DVector<f64>,
    /// Covariance of the parameters for residuals of unit variance.
    pub cofactor: DMatrix<f64>,
    pub variance: f64,
    /// Minus twice the logarithm of the evidence of the noise: its likelihood, over all parameters and over
    /// its variance (restricted likelihood: Harville, Biometrika 61 (1974) 383). The largest likelihood
    /// favours the noise of the lines that the parameters follow.
    pub unlikely: f64,
}

impl Scaled<'_> {
    /// The model about `p`; for complex lines.
    pub(super) fn linear_about(&self, p: &[f64]) -> Linear {
        let plain = LineNoise::independent(vec![1.0; self.x.len()]);
        let mut residuals = vec![0.0; self.rows()];
        self.white(p, &plain, &mut residuals);
        Linear { residuals: DVector::from_vec(residuals), jacobian: self.jacobian(p, &plain) }
    }

    /// Sorts what the noise may be by its evidence, with the model about `p`; magnitudes by its likelihood.
    pub(super) fn likeliest_first(&self, p: &[f64], noises: Vec<Named>) -> Vec<Named> {
        if noises.len() < 2 {
            return noises;
        }
        let linear = (!self.magnitude_only).then(|| self.linear_about(p));
        let unlikely = |noise: &LineNoise| {
            if let Some(linear) = &linear {
                return linear.under(noise).map_or(f64::INFINITY, |under| under.unlikely);
            }
            let mut left = vec![0.0; self.rows()];
            self.white(p, noise, &mut left);
            noise.unlikely(&left)
        };
        let mut all: Vec<(f64, Named)> =
            noises.into_iter().map(|named| (unlikely(&named.0), named)).collect();
        sort_by_number(&mut all, |rival| rival.0);
        all.into_iter().map(|(_, named)| named).collect()
    }
}

impl Linear {
    /// `None` where the lines do not determine the parameters.
    pub(super) fn under(&self, noise: &LineNoise) -> Option<Under> {
        let (mut residuals, mut jacobian) = (self.residuals.clone(), self.jacobian.clone());
        noise.whiten(residuals.as_mut_slice());
        jacobian.as_mut_slice().chunks_mut(residuals.len()).for_each(|column| noise.whiten(column));
        let root = jacobian.tr_mul(&jacobian).cholesky()?;
        let step = -root.solve(&jacobian.tr_mul(&residuals));
        let sum = (residuals + &jacobian * &step).norm_squared();
        let (numbers, free) = (jacobian.nrows(), (jacobian.nrows() - jacobian.ncols()) as f64);
        let volume = root.l_dirty().diagonal().iter().map(|v| v.ln()).sum::<f64>();
        let unlikely = free * sum.ln() + noise.spread(numbers) + 2.0 * volume;
        Some(Under { step, cofactor: root.inverse(), variance: sum / free, unlikely })
            .filter(|under| under.unlikely.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modal::{Measured, Pole};
    use num_complex::Complex64;
    use vibro_record::units::Quantity;

    /// A mode on twelve lines with errors of a thousandth that no model follows.
    fn lines() -> Measured {
        let pole = Pole { frequency: 100.0, zeta: 0.02, constant: Complex64::new(1.0, 0.0) };
        let frequency: Vec<f64> = (0..12).map(|k| 94.0 + f64::from(k)).collect();
        let off = |k: usize| 1.0 + 1e-3 * Complex64::cis(2.4 * (k * k) as f64);
        let values = frequency.iter().enumerate().map(|(k, f)| pole.at(*f, 0) * off(k)).collect();
        Measured::new(frequency, values, Quantity::Receptance)
    }

    /// The noise is known up to a factor, which its evidence integrates over: the terms of the likelihood, of
    /// the determinant and of the volume of the parameters cancel.
    #[test]
    fn a_factor_on_the_noise_changes_its_variance_alone() {
        let (measured, starts) = (lines(), [(100.0, 0.02)]);
        let scaled = Scaled::of(&measured, 0..12, &starts, &[]);
        let each: Vec<f64> = (0..12).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        let fit = scaled.refit(&LineNoise::independent(each.clone())).unwrap();
        let linear = scaled.linear_about(&fit.parameters);
        let under = |factor: f64| {
            linear.under(&LineNoise::independent(each.iter().map(|v| v * factor).collect())).unwrap()
        };
        let (one, three) = (under(1.0), under(3.0));
        // Rounding of terms of some hundreds.
        assert!((one.unlikely - three.unlikely).abs() < 1e-9, "{} {}", one.unlikely, three.unlikely);
        assert!((one.variance / three.variance / 9.0 - 1.0).abs() < 1e-9);
        assert!((one.variance / fit.variance() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_step_under_other_noise_leads_to_the_fit_under_it() {
        let (measured, starts) = (lines(), [(100.0, 0.02)]);
        let scaled = Scaled::of(&measured, 0..12, &starts, &[]);
        let equal = scaled.refit(&LineNoise::independent(vec![1.0; 12])).unwrap();
        let share = LineNoise::independent(scaled.values.iter().map(|v| v.norm()).collect());
        let other = scaled.refit(&share).unwrap();
        let step = scaled.linear_about(&equal.parameters).under(&share).unwrap().step;
        for ((from, to), step) in equal.parameters.iter().zip(&other.parameters).zip(step.iter()) {
            // Both fits differ by about 1e-3 of the parameters' scale of 1; a step of Gauss and Newton
            // squares that.
            assert!((from + step - to).abs() < 1e-5, "{from} + {step} is not {to}");
        }
        let apart = equal.parameters.iter().zip(&other.parameters).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) > 1e-4, "the noise matters");
    }
}
