//! The onset between two samples, where the force jumps.

use super::ContactModel;
use super::fit::{FittedPulse, Judged, Samples};
use nalgebra::{DMatrix, DVector};

/// Onsets between two samples over which a fit is averaged.
const ONSETS: u32 = 32;

impl Samples<'_> {
    /// Replaces the best of the `fits` whose onsets lie between different samples by the mean over all
    /// onsets between any of these, each weighted with its likelihood by the sum of squares. For an onset x
    /// the other parameters pᵢ with cofactor C are pᵢ + Cᵢ₀/C₀₀ (x − p₀). The jump of the force shows
    /// between which samples the contact begins. This determines the onset, and with it ξ, better than the
    /// shape does.
    pub(super) fn between_samples(&self, fits: &mut [Judged]) {
        let Some(((false, _), FittedPulse { fit: best, first: Some(_), .. })) = fits.first() else { return };
        let shown = || best.variance().max(self.noise().1.powi(2)).max(f64::EPSILON.powi(2));
        let variance = self.planned.unwrap_or_else(shown);
        // Logarithm of the weight, parameters, and index of the fit.
        let mut onsets: Vec<(f64, DVector<f64>, usize)> = Vec::new();
        for (index, (_, fitted)) in fits.iter().enumerate().filter(|(_, ((outside, _), _))| !outside) {
            let (fit, Some(first)) = (&fitted.fit, fitted.first) else { continue };
            let (from, to) = (self.times[first - 1], self.times[first]);
            let slopes = fit.cofactor.column(0) / fit.cofactor[(0, 0)];
            onsets.extend((0..ONSETS).map(|k| {
                let off = from + (to - from) * (f64::from(k) + 0.5) / f64::from(ONSETS) - fit.parameters[0];
                let squares = fit.sum_of_squares() + off * off / fit.cofactor[(0, 0)];
                let width = (to - from).ln();
                let p = DVector::from_column_slice(&fit.parameters) + &slopes * off;
                (width - 0.5 * squares / variance, p, index)
            }));
        }
        let most = onsets.iter().map(|o| o.0).fold(f64::NEG_INFINITY, f64::max);
        for onset in &mut onsets {
            onset.0 = (onset.0 - most).exp();
        }
        let total: f64 = onsets.iter().map(|o| o.0).sum();
        let n = best.parameters.len();
        let mean = onsets.iter().fold(DVector::zeros(n), |sum, (w, p, _)| sum + p * (w / total));
        let cofactor = onsets.iter().fold(DMatrix::zeros(n, n), |sum, (w, p, index)| {
            let own = &fits[*index].1.fit.cofactor;
            let column = own.column(0);
            let off = p - &mean;
            let given = own - column * column.transpose() / own[(0, 0)];
            sum + (given + &off * off.transpose() / variance) * (w / total)
        });
        let first = self.times.partition_point(|t| *t < mean[0]);
        let p = mean.as_slice();
        let Some(model) = self.model(ContactModel::KelvinVoigt, p, &self.times, Some(first)) else { return };
        let fitted = &mut fits[0].1;
        fitted.fit.parameters = p.to_vec();
        fitted.fit.residuals = self.values.iter().zip(model).map(|(v, m)| v - m).collect();
        fitted.fit.cofactor = cofactor;
        fitted.first = Some(first);
    }
}
