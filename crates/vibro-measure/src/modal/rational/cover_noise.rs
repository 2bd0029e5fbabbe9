//! What the noise of the lines may be instead.

use super::Rational;
use super::again::Again;
use super::linear::Under;
use crate::mean::mixture;
use crate::residuals::student;

impl Rational {
    /// Widens the uncertainties to cover other weights of the lines, by their evidence: few lines hardly tell
    /// equal noise from noise in proportion to the response.
    pub fn cover_noise(&mut self, again: &Again<'_>) {
        let Again { scaled, fit, noise, rivals } = again;
        // Noise that is known by the file has no rival.
        if rivals.len() < 2 {
            return;
        }
        let linear = scaled.linear_about(&fit.parameters);
        let Some(own) = linear.under(noise) else { return };
        let slopes = scaled.slopes(&fit.parameters);
        let widened = self.whiteness.inflation * student(fit.degrees_of_freedom()).unwrap_or(f64::NAN);
        let quantities = |under: &Under| {
            let covariance = &slopes * &under.cofactor * slopes.transpose() * under.variance;
            (&slopes * &under.step, covariance.diagonal() * widened.powi(2))
        };
        let before = quantities(&own).1;
        let others = rivals.iter().filter_map(|rival| linear.under(rival));
        let others: Vec<_> = others.map(|other| (-0.5 * other.unlikely, quantities(&other))).collect();
        if others.is_empty() {
            return;
        }
        for (q, std) in self.std.iter_mut().flatten().enumerate() {
            let all = others.iter().map(|(log_weight, (step, variance))| (*log_weight, step[q], variance[q]));
            let all: Vec<(f64, f64, f64)> = all.collect();
            let (mean, variance) = mixture(&all);
            // What a hidden mode adds stays.
            *std = (variance + mean * mean + (std.powi(2) - before[q]).max(0.0)).sqrt();
        }
    }
}
