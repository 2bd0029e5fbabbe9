//! A power law of contact with each of the losses that the samples allow.

use super::ContactModel;
use super::fit::{FittedPulse, LOSS_EXPONENT, Samples};
use super::result::LIKELY;
use crate::mean::mixture;
use vibro_record::sort_by_number;

/// Index of the loss α among the parameters.
const LOSS: usize = 4;

/// Index of the exponent of the spring.
const EXPONENTS: usize = 5;

/// A likelihood below e⁻⁸ of the largest ends a series of losses.
const NEGLIGIBLE: f64 = 8.0;

/// As [`NEGLIGIBLE`], of the first loss of a series, which is a guess.
const FAR: f64 = 5.0 * NEGLIGIBLE;

/// Most fits of a series to either side of its first loss.
const MOST: usize = 32;

/// Least and most change of the logarithm of the likelihood between neighbouring losses: outside of it the
/// next step is doubled, the last one halved.
const CHANGE: [f64; 2] = [0.4, 1.6];

/// Largest loss of a series: less than a fifth of the speed is left.
const LARGEST: f64 = 3.0;

/// First guess of a loss where free parameters gain energy.
const SMALL: f64 = 0.05;

/// Series whose exponents of the loss differ by less than this at one loss are one.
const APART: f64 = 0.1;

/// Exponent of the loss below which the force rises to more than a quarter of its scale within a hundredth of
/// the contact.
const STEEP: f64 = 0.3;

impl Samples<'_> {
    /// The fit with the likeliest loss, and the fits with all likely losses.
    ///
    /// To first order a loss with the exponent s = n − 1 only moves the pulse to an earlier time, since
    /// zⁿ⁻¹z′ is proportional to the rate of zⁿ. So loss and exponent determine each other along a curve, and
    /// linear propagation fails. With a given loss the other parameters are nearly normal. They are fitted
    /// for series of losses α ≥ 0, each of the weight exp(−Q/2σ²) √|C| |dR/dα| Δα with the sum of squares Q
    /// and the cofactor C, for a uniform prior of the restitution R (nested Laplace approximation, Rue,
    /// Martino & Chopin, J. R. Statist. Soc. B 71 (2009) 319). `free` are fits of all parameters.
    pub(super) fn over_losses(
        &self,
        free: &[FittedPulse],
        starts: &[Vec<f64>],
        noise: f64,
    ) -> Option<FittedPulse> {
        // A minimum of an exponent below n − 1 may be far from those of the free fits.
        let below = |start: &&Vec<f64>| start[LOSS_EXPONENT] < 1.0;
        let guesses = [starts.iter().find(below), starts.iter().find(|start| !below(start))];
        let small: Vec<FittedPulse> =
            guesses.into_iter().flatten().filter_map(|start| self.with_loss(start, SMALL, noise)).collect();
        let freed = small
            .iter()
            .filter_map(|fit| self.from(ContactModel::PowerLaw, noise, &fit.fit.parameters, None, None));
        let freed: Vec<FittedPulse> = freed.collect();
        let own = free.iter().chain(&freed).map(|fit| &fit.fit.parameters).filter(|p| p[LOSS] > 0.0);
        let own: Vec<_> = own.filter_map(|p| self.with_loss(p, p[LOSS], noise)).collect();
        let mut firsts: Vec<FittedPulse> = own.into_iter().chain(small).collect();
        sort_by_number(&mut firsts, |fit| fit.cost(noise));
        let best = firsts.first()?;
        let (least, unit) = (best.cost(noise), 2.0 * best.fit.variance() * self.dispersion(&best.fit));
        let step = free.first()?.fit.std(LOSS).clamp(1e-4, 0.1);
        let mut all: Vec<Vec<FittedPulse>> = Vec::new();
        for first in firsts {
            let known = all.iter().any(|series| {
                let off =
                    |fit: &FittedPulse, i: usize| (fit.fit.parameters[i] - first.fit.parameters[i]).abs();
                let near = series.iter().min_by(|a, b| off(a, LOSS).total_cmp(&off(b, LOSS)));
                near.is_some_and(|near| off(near, LOSS_EXPONENT) < APART)
            });
            if !known && first.cost(noise) - least < FAR * unit {
                all.push(self.series(first, step, unit, noise));
            }
        }
        let weighted = |series: Vec<FittedPulse>| {
            let losses: Vec<f64> = series.iter().map(|fit| fit.fit.parameters[LOSS]).collect();
            let width = |i: usize| losses[(i + 1).min(losses.len() - 1)] - losses[i.saturating_sub(1)];
            let weight = |(i, fit): (usize, FittedPulse)| {
                let cofactor = fit.fit.cofactor.clone().remove_row(LOSS).remove_column(LOSS);
                let prior = (0.5 * width(i) * slope(&fit.fit.parameters)).abs().max(f64::MIN_POSITIVE);
                (-fit.cost(noise) / unit + 0.5 * cofactor.determinant().ln() + prior.ln(), fit)
            };
            series.into_iter().enumerate().map(weight).collect::<Vec<_>>()
        };
        let losses: Vec<(f64, FittedPulse)> = all.into_iter().flat_map(weighted).collect();
        let best = losses.iter().min_by(|(_, a), (_, b)| a.cost(noise).total_cmp(&b.cost(noise)))?;
        let mut best = best.1.clone();
        best.losses = losses;
        Some(best)
    }

    /// The fits of a series of rising losses around that of the `first`. A change of the sum of squares by
    /// `unit` divides the likelihood by e.
    fn series(&self, first: FittedPulse, step: f64, unit: f64, noise: f64) -> Vec<FittedPulse> {
        let mut least = first.cost(noise);
        let mut series = vec![first];
        for direction in [1.0, -1.0] {
            let mut by = step;
            let mut from = series[0].clone();
            let mut side = Vec::new();
            for _ in 0..MOST {
                let loss = (from.fit.parameters[LOSS] + direction * by).max(0.0);
                let next = self.with_loss(&from.fit.parameters, loss, noise);
                let change = next.as_ref().map_or(f64::INFINITY, |next| next.cost(noise) - from.cost(noise));
                let change = change.abs() / unit;
                // Between two minima over the onset or the exponent, no step is small enough.
                if change > CHANGE[1] && by > step / 16.0 {
                    by /= 2.0;
                    continue;
                }
                let Some(next) = next else { break };
                if change < CHANGE[0] {
                    by *= 2.0;
                }
                least = least.min(next.cost(noise));
                let ends = loss == 0.0 || loss > LARGEST || next.cost(noise) - least > NEGLIGIBLE * unit;
                side.push(std::mem::replace(&mut from, next));
                if ends {
                    break;
                }
            }
            side.push(from);
            if direction > 0.0 {
                series = side;
            } else {
                side.reverse();
                side.pop();
                side.append(&mut series);
                series = side;
            }
        }
        series
    }

    /// The fit of the other parameters with a given loss.
    fn with_loss(&self, from: &[f64], loss: f64, noise: f64) -> Option<FittedPulse> {
        let fitted = |start: &[f64]| self.from(ContactModel::PowerLaw, noise, start, None, Some(LOSS));
        let mut start = from.to_vec();
        start[LOSS] = loss;
        let mut best = fitted(&start)?;
        // The force of a small exponent of the loss rises between two samples. Each interval between samples
        // then has a minimum of its own.
        for side in [-1.0, 1.0] {
            while self.filter.is_none() && best.fit.parameters[LOSS_EXPONENT] < STEEP {
                let mut start = best.fit.parameters.clone();
                start[0] += side * self.step;
                let next = fitted(&start).filter(|next| next.cost(noise) < best.cost(noise));
                let Some(next) = next else { break };
                best = next;
            }
        }
        Some(best)
    }
}

impl FittedPulse {
    /// Effective number of parameters: an exponent counts by the part of its prior variance that the samples
    /// remove (Spiegelhalter et al., J. R. Statist. Soc. B 64 (2002) 583).
    pub(super) fn determined(&self) -> f64 {
        let known = |(i, (_, std)): (usize, &(f64, f64))| {
            let of = |(weight, fit): &(f64, FittedPulse)| {
                (*weight, fit.fit.parameters[EXPONENTS + i], fit.fit.covariance(EXPONENTS + i, EXPONENTS + i))
            };
            let (_, variance) = mixture(&self.losses.iter().map(of).collect::<Vec<_>>());
            (variance / (std * std)).min(1.0)
        };
        let unknown = if self.losses.is_empty() { 0.0 } else { LIKELY.iter().enumerate().map(known).sum() };
        self.fit.parameters.len() as f64 - unknown
    }

    /// Sum of squares of the residuals, and of the distances of exponents from their prior means, where one
    /// standard deviation of the prior counts as one of the `noise`.
    fn cost(&self, noise: f64) -> f64 {
        let unlikely = self.model.unlikely(&self.fit.parameters);
        self.fit.sum_of_squares() + unlikely.iter().map(|u| (noise * u).powi(2)).sum::<f64>()
    }
}

/// dR/dα at given exponents.
fn slope(parameters: &[f64]) -> f64 {
    // The integration is good to 1e-5 of R.
    let step = 1e-3;
    let restitution = |loss: f64| {
        let shape = [loss, parameters[EXPONENTS], parameters[LOSS_EXPONENT]];
        ContactModel::PowerLaw.rebound(&shape).map_or(f64::NAN, |contact| contact.restitution)
    };
    (restitution(parameters[LOSS] + step) - restitution(parameters[LOSS])) / step
}
