//! The onset between two samples, where the force jumps.

use super::ContactModel;
use super::fit::{FittedPulse, Judged, Samples};
use nalgebra::{DMatrix, DVector};

/// Onsets between two samples over which a fit is averaged.
const ONSETS: u32 = 32;

/// Standard deviations of the onset from the likeliest within which onsets are taken: beyond are 6·10⁻⁷ of
/// them, and [`ONSETS`] are a third of a deviation apart.
const LIKELY: f64 = 5.0;

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
            // Where the samples tell the onset better than to a part of their interval, only there.
            let likeliest = fit.parameters[0].clamp(from, to);
            let reach = LIKELY * (variance * fit.cofactor[(0, 0)]).sqrt();
            let (from, to) = (from.max(likeliest - reach), to.min(likeliest + reach));
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

#[cfg(test)]
mod tests {
    use super::super::{Instrument, KelvinVoigt, PulseOptions, pulse};
    use vibro_math::Noise;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Trace};

    /// Noise of 6e-5 of the peak tells the onset to a hundredth of a sampling interval. The mean square of 60
    /// errors over their uncertainties lies within 4 of its standard deviations, √(2/60), of 1.
    #[test]
    fn an_onset_known_far_better_than_a_sample_has_its_uncertainty() {
        let contact = KelvinVoigt::lasting(4e-4, 0.2).unwrap();
        let mut squares = 0.0;
        for seed in 0..60 {
            let mut noise = Noise::new(seed);
            let onset = 150.0 + noise.between(0.0, 1.0);
            let value = |i: i32| {
                let t = (f64::from(i) - onset) / 1e5;
                let inside = (0.0..=contact.duration()).contains(&t);
                let force = if inside { contact.unbounded(t) / contact.peak() } else { 0.0 };
                force + 6e-5 * noise.normal()
            };
            let values: Vec<f64> = (0..400).map(value).collect();
            let meta = Meta::new("force", Unit::parse("N").unwrap());
            let trace = Trace { meta, axis: Axis::time(0.0, 1e-5, values.len()), values };
            let options = PulseOptions { instrument: Instrument::Flat, mass: Some(0.35) };
            let found = pulse(&trace, &options).unwrap();
            squares += ((found.xi.value - 0.2) / found.xi.std.unwrap()).powi(2) / 60.0;
        }
        assert!((squares - 1.0).abs() < 4.0 * f64::sqrt(2.0 / 60.0), "{squares}");
    }
}
