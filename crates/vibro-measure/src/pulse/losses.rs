//! A power law of contact with each of the losses that the samples allow.

use super::ContactModel;
use super::fit::{FittedPulse, Samples};
use super::result::LIKELY;
use crate::residuals::Whiteness;
use vibro_math::{Minimum, minimise};
use vibro_record::sort_by_number;

/// Index of the loss α among the parameters.
const LOSS: usize = 4;

/// Index of the exponent of the spring.
pub(super) const EXPONENT: usize = 5;

/// Index of the exponent of the loss.
const LOSS_EXPONENT: usize = 6;

/// A likelihood below e⁻⁸ of the largest ends a series of losses.
const NEGLIGIBLE: f64 = 8.0;

/// As [`NEGLIGIBLE`], of the first loss of a series, which is a guess.
const FAR: f64 = 5.0 * NEGLIGIBLE;

/// Most fits of a series to either side of its first loss.
const MOST: usize = 32;

/// Most better minima that a series moves to.
const MOST_BETTER: usize = 4;

/// Least and most change of the logarithm of the likelihood between neighbouring losses: outside of it the
/// next step is doubled, the last one halved.
const CHANGE: [f64; 2] = [0.4, 1.6];

/// Largest loss of a series: less than a fifth of the speed is left.
const LARGEST: f64 = 3.0;

/// Part of the sum of squares, and of the parameters, by which the last step of a fit of a series changes
/// them.
const GAIN: f64 = 1e-4;

/// A small loss, and exponents on either side of n − 1, and one whose force nearly jumps: first guesses
/// beside the free fits.
const GUESSES: [(f64, f64); 3] = [(0.05, 0.4), (0.05, 1.5), (0.05, 0.03)];

/// Series whose exponents of the loss differ by less than this at one loss are one.
const APART: f64 = 0.1;

/// Exponent of the loss below which the force rises to more than a quarter of its scale within a hundredth of
/// the contact.
const STEEP: f64 = 0.3;

impl Samples<'_> {
    /// A power law `fitted` with free parameters, with the likeliest loss instead, and with the fits of all
    /// likely losses. `None` where the samples prefer a loss below 0, as those of a ringing sensor may.
    ///
    /// To first order a loss with the exponent s = n − 1 only moves the pulse to an earlier time, since
    /// zⁿ⁻¹z′ is proportional to the rate of zⁿ. So loss and exponent determine each other along a curve, and
    /// linear propagation fails. With a given loss the other parameters are nearly normal. They are fitted
    /// for series of losses α ≥ 0, each of the weight exp(−Q/2σ²) √|C| |dR/dα| Δα with the sum of squares Q
    /// and the cofactor C, for a uniform prior of the restitution R (nested Laplace approximation, Rue,
    /// Martino & Chopin, J. R. Statist. Soc. B 71 (2009) 319).
    pub(super) fn over_losses(&self, fitted: &FittedPulse) -> Option<FittedPulse> {
        let noise = self.noise().0;
        let free = std::iter::once(fitted).chain(&fitted.also).map(|fit| fit.fit.parameters.clone());
        let guesses = GUESSES.iter().map(|(loss, exponent)| {
            let mut guess = fitted.fit.parameters.clone();
            (guess[LOSS], guess[LOSS_EXPONENT]) = (*loss, *exponent);
            guess
        });
        let starts = free.filter(|p| p[LOSS] > 0.0).chain(guesses);
        let one = 2.0 * fitted.fit.variance() * self.dispersion(&fitted.fit);
        // Where noise is low, a guess lies far from its minimum: all parameters are fitted first.
        let first = |p: Vec<f64>| {
            let first = self.with_loss(&p, p[LOSS], noise)?;
            if first.cost(noise) - fitted.cost(noise) < FAR * one {
                return Some(first);
            }
            let free = self.from(ContactModel::PowerLaw, noise, &first.fit.parameters, None)?;
            let loss = free.fit.parameters[LOSS];
            if loss > 0.0 { self.with_loss(&free.fit.parameters, loss, noise) } else { None }
        };
        let mut firsts: Vec<_> = starts.filter_map(first).collect();
        sort_by_number(&mut firsts, |fit| fit.cost(noise));
        let best = firsts.first()?;
        let (mut least, unit) = (best.cost(noise), 2.0 * best.fit.variance() * self.dispersion(&best.fit));
        let step = fitted.fit.std(LOSS).clamp(1e-4, 0.1);
        let mut all: Vec<Vec<FittedPulse>> = Vec::new();
        for first in firsts {
            let known = all.iter().any(|series| {
                let off =
                    |fit: &FittedPulse, i: usize| (fit.fit.parameters[i] - first.fit.parameters[i]).abs();
                let near = series.iter().min_by(|a, b| off(a, LOSS).total_cmp(&off(b, LOSS)));
                near.is_some_and(|near| off(near, LOSS_EXPONENT) < APART)
            });
            if !known && first.cost(noise) - least < FAR * unit {
                let mut series = self.series(&first, (least, unit), step, noise);
                // A better minimum has losses of its own around it.
                for _ in 0..MOST_BETTER {
                    let best = series.iter().min_by(|a, b| a.cost(noise).total_cmp(&b.cost(noise)));
                    let Some(best) = best.filter(|best| best.cost(noise) < least - NEGLIGIBLE * unit) else {
                        break;
                    };
                    least = best.cost(noise);
                    series = self.series(&best.clone(), (least, unit), step, noise);
                }
                all.push(series);
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
        let best = best.1.clone();
        let known = best.cost(noise) - fitted.cost(noise) <= NEGLIGIBLE * unit;
        let best = self.judged(FittedPulse { losses, ..best }, false);
        (known && best.widening.is_some()).then_some(best)
    }

    /// The fits of a series of rising losses around that of the `first`. A change of the sum of squares by
    /// `unit` divides the likelihood by e; `least` is the smallest one known.
    fn series(
        &self,
        first: &FittedPulse,
        (mut least, unit): (f64, f64),
        step: f64,
        noise: f64,
    ) -> Vec<FittedPulse> {
        let mut side = |direction: f64| {
            let (mut by, mut side) = (step, vec![first.clone()]);
            for _ in 0..MOST {
                let from = &side[side.len() - 1];
                let loss = (from.fit.parameters[LOSS] + direction * by).max(0.0);
                let next = self.with_loss(&continued(&side, loss), loss, noise);
                let before = from.cost(noise);
                // A sample at the onset of a force that rises at once has a narrow minimum, beside which a
                // straight line ends.
                let beside = next.as_ref().is_none_or(|next| next.cost(noise) > before + CHANGE[1] * unit);
                let near = beside.then(|| self.with_loss(&from.fit.parameters, loss, noise)).flatten();
                let next =
                    next.into_iter().chain(near).min_by(|a, b| a.cost(noise).total_cmp(&b.cost(noise)));
                let after = next.as_ref().map(|next| next.cost(noise));
                let change = after.map_or(f64::INFINITY, |after| (after - before).abs() / unit);
                // Between two minima over the onset or the exponent, no step is small enough. Steps may be
                // longer where the likelihood is small.
                if change > CHANGE[1] + (before - least) / unit && by > step / 16.0 {
                    by /= 2.0;
                    continue;
                }
                let (Some(next), Some(after)) = (next, after) else { break };
                if change < CHANGE[0] {
                    by *= 2.0;
                }
                least = least.min(after);
                side.push(next);
                let unlikely = after > before && after - least > NEGLIGIBLE * unit;
                if loss == 0.0 || loss > LARGEST || unlikely {
                    break;
                }
            }
            side
        };
        let (above, below) = (side(1.0), side(-1.0));
        below.into_iter().skip(1).rev().chain(above).collect()
    }

    /// The fit of the other parameters with a given loss.
    fn with_loss(&self, from: &[f64], loss: f64, noise: f64) -> Option<FittedPulse> {
        let fitted = |start: &[f64]| self.given_loss(start, loss, noise);
        let mut best = fitted(from)?;
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

    /// The fit of the other parameters from these.
    fn given_loss(&self, start: &[f64], loss: f64, noise: f64) -> Option<FittedPulse> {
        let model = ContactModel::PowerLaw;
        let whole = |of: &[f64]| [&of[..LOSS], &[loss], &of[LOSS..]].concat();
        let mut begin = start.to_vec();
        begin.remove(LOSS);
        let scale: Vec<f64> = begin.iter().map(|p| p.abs().max(0.1)).collect();
        let (n, residuals) = (self.times.len(), self.residuals(model, noise, None));
        let residuals = |of: &[f64], out: &mut [f64]| residuals(&whole(of), out);
        let fit = minimise(residuals, n + LIKELY.len(), &begin, &scale, Some(GAIN));
        let mut fit = fit.and_then(Minimum::fit).ok()?;
        fit.residuals.truncate(n);
        fit.parameters.insert(LOSS, loss);
        fit.cofactor = fit.cofactor.insert_row(LOSS, 0.0).insert_column(LOSS, 0.0);
        let whiteness = Whiteness { p_value: None, inflation: 1.0 };
        let (also, losses) = (Vec::new(), Vec::new());
        let converged = fit.converged;
        converged.then_some(FittedPulse { model, fit, whiteness, widening: None, first: None, also, losses })
    }
}

impl FittedPulse {
    /// Sum of squares of the residuals, and of the distances of exponents from their prior means, where one
    /// standard deviation of the prior counts as one of the `noise`.
    fn cost(&self, noise: f64) -> f64 {
        let unlikely = self.model.unlikely(&self.fit.parameters, noise);
        self.fit.sum_of_squares() + unlikely.iter().map(|u| u * u).sum::<f64>()
    }
}

/// Parameters at a `loss`, on a straight line through the last two of a series.
fn continued(series: &[FittedPulse], loss: f64) -> Vec<f64> {
    let of = |fit: &FittedPulse| fit.fit.parameters.clone();
    match series {
        [.., before, last] => {
            let (before, last) = (of(before), of(last));
            let part = (loss - last[LOSS]) / (last[LOSS] - before[LOSS]);
            last.iter().zip(&before).map(|(last, before)| last + part * (last - before)).collect()
        }
        _ => series.last().map_or_else(Vec::new, of),
    }
}

/// dR/dα at given exponents.
fn slope(parameters: &[f64]) -> f64 {
    // The integration is good to 1e-5 of R.
    let step = 1e-3;
    let restitution = |loss: f64| {
        let shape = [loss, parameters[EXPONENT], parameters[LOSS_EXPONENT]];
        ContactModel::PowerLaw.rebound(&shape).map_or(f64::NAN, |contact| contact.restitution)
    };
    (restitution(parameters[LOSS] + step) - restitution(parameters[LOSS])) / step
}

#[cfg(test)]
mod tests {
    use super::super::{Instrument, LowPass, PulseOptions, PulseResult, Rebound, pulse};
    use crate::Estimate;
    use vibro_math::Noise;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Trace};

    /// Result for a contact of 60 samples with noise of 0.2 % of its peak, in a unit of force.
    fn found(contact: &Rebound, filter: Option<&LowPass>, seed: u64, unit: f64) -> PulseResult {
        let mut noise = Noise::new(seed);
        let times: Vec<f64> = (0..300).map(|i| (f64::from(i) - 80.3) * 1e-5).collect();
        let shape = contact.decelerations(6e-4, filter.map(|f| &f.linear), &times);
        let peak = shape.iter().copied().fold(0.0, f64::max);
        let values: Vec<f64> = shape.iter().map(|v| unit * (v + 0.002 * peak * noise.normal())).collect();
        let meta = Meta::new("force", Unit::parse("N").unwrap());
        let trace = Trace { meta, axis: Axis::time(0.0, 1e-5, values.len()), values };
        let instrument = filter.map_or(Instrument::Flat, |filter| Instrument::LowPass(filter.clone()));
        pulse(&trace, &PulseOptions { instrument, mass: None }).unwrap()
    }

    /// Another unit changes the last digits of all samples and nothing else. Differences over 6e-6 turn them
    /// into 1e-10 of a slope, and the exponents, which are nearly dependent, into 1e-7 of an uncertainty.
    #[test]
    fn the_answer_does_not_depend_on_the_last_digits() {
        let filter = LowPass::new(4e3, 2).unwrap();
        for (seed, (alpha, n, s)) in
            [(0.4, 1.0, 0.0), (0.3, 1.5, 0.3), (0.1, 1.3, 1.2)].into_iter().enumerate()
        {
            let contact = Rebound::power_law(alpha, n, s).unwrap();
            for filter in [None, Some(&filter)] {
                let [a, b] = [1.0, 1.1].map(|unit| found(&contact, filter, seed as u64, unit));
                let of = |found: &PulseResult, unit: f64| {
                    let force = |e: &Option<Estimate>| {
                        e.as_ref().map_or([f64::NAN; 2], |e| [e.value / unit, e.std.unwrap() / unit])
                    };
                    let ratio = |e: &Estimate| [e.value, e.std.unwrap()];
                    [
                        ratio(&found.restitution),
                        ratio(&found.duration),
                        force(&found.peak),
                        force(&found.impulse),
                    ]
                    .concat()
                };
                for (one, other) in of(&a, 1.0).iter().zip(of(&b, 1.1)) {
                    assert!((one / other - 1.0).abs() < 1e-6, "{seed} {one} {other}");
                }
            }
        }
    }
}
