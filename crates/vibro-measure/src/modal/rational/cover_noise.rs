//! What the noise of the lines may be instead.

use super::Rational;
use super::again::Again;
use crate::mean::mixture;
use crate::residuals::student;

impl Rational {
    /// Widens the uncertainties to cover other weights of the lines, by their likelihood: few lines hardly
    /// tell equal noise from noise in proportion to the response.
    pub fn cover_noise(&mut self, again: &Again<'_>) {
        let Again { scaled, fit, noise, rivals } = again;
        let own = scaled.quantities(&fit.parameters);
        for rival in rivals {
            let Some(other) = scaled.refit(rival) else { continue };
            let log_weight = 0.5 * (noise.unlikely(&fit.residuals) - rival.unlikely(&other.residuals));
            let variance = other.variance() * self.whiteness.inflation.powi(2);
            let covariance = scaled.covariance(&other.parameters, &other.cofactor, variance);
            let widened = student(other.degrees_of_freedom()).unwrap_or(f64::NAN).powi(2);
            let quantities = scaled.quantities(&other.parameters);
            for (q, std) in self.std.iter_mut().flatten().enumerate() {
                let with = (log_weight, quantities[q] - own[q], covariance[(q, q)] * widened);
                let (mean, variance) = mixture(&[(0.0, 0.0, std.powi(2)), with]);
                *std = variance.sqrt().hypot(mean);
            }
        }
    }
}
