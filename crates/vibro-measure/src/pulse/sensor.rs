//! A mode of the sensor, fitted together with the contact.

use super::fit::{FittedPulse, Samples};
use super::normalised::Normalised;
use super::result::Unfitted;
use super::{ContactModel, rivals};
use crate::residuals::NO_SUPPORT;
use nalgebra::{Matrix3, Vector3};

/// Lowest frequency of a mode, in cycles per length of the pulse: a slower one only changes the baseline.
const SLOWEST: f64 = 0.4;

/// Highest frequency of a mode, in cycles per length of the pulse: the contact hardly excites a faster one.
const FASTEST: f64 = 16.0;

/// Parts of the signal that may pass through a mode.
const SHARES: std::ops::Range<f64> = 0.0..1.0;

/// Damping ratios of the first guesses.
const DAMPING: [f64; 5] = [0.005, 0.02, 0.06, 0.15, 0.35];

/// Frequencies of the first guesses in one over the duration of the samples: a mode is seen over as much.
const STEPS: f64 = 6.0;

/// Most samples that the search for a first guess uses, for each cycle of the fastest mode.
const ENOUGH: f64 = 4.0;

/// First guesses of a mode from which fits begin.
const GUESSES: usize = 3;

/// Part of the gain of a fit that the best first guess has at least. By its damping ratio it loses a tenth,
/// by its frequency a fortieth, and some by the contact, which is not fitted anew.
const GUESSED: f64 = 0.7;

/// Parameters of a mode.
const PARAMETERS: f64 = 3.0;

/// The models of the contact behind a sensor with one mode, on the samples up to the end of the ringing.
pub(super) struct Ringing<'a> {
    pub samples: Samples<'a>,
    pub fits: Vec<FittedPulse>,
    pub unfitted: Vec<Unfitted>,
}

/// The fits with a mode of the sensor, where they leave only noise and have more support than those without,
/// `bare`. Uses the samples behind the pulse, too.
///
/// The mode of each of M frequencies may be the best one by chance, which takes 2 ln M of the gain. What is
/// left without a mode has a colour, by whose square the gain is divided, so that 1/f noise is no mode.
pub(super) fn ringing<'a>(scale: &'a Normalised<'_>, bare: &[FittedPulse]) -> Option<Ringing<'a>> {
    let best = bare.iter().min_by(|a, b| a.aicc().total_cmp(&b.aicc()))?;
    let samples = |mode| Samples { mode, ..scale.ringing(best.end()) };
    let without = samples(None);
    let alone = without.fit(best.model).ok()?;
    let colour = alone.whiteness.inflation.max(1.0).powi(2);
    let chance = 2.0 * without.frequencies().max(1.0).ln();
    // An AICc counts two for each parameter.
    let least = GUESSED * (colour * (NO_SUPPORT + chance) + 2.0 * PARAMETERS);
    for (_, mode) in without.modes(&alone).into_iter().filter(|(gain, _)| *gain > least) {
        let samples = samples(Some(mode));
        let Ok(main) = samples.fit(ContactModel::KelvinVoigt) else { continue };
        let (fits, unfitted) = rivals(&samples, main);
        let Some(best) = fits.iter().min_by(|a, b| a.aicc().total_cmp(&b.aicc())) else { continue };
        let share = best.fit.parameters[3 + best.model.parameters()];
        let gain = (alone.aicc() - best.aicc()) / colour;
        if gain > NO_SUPPORT + chance && SHARES.contains(&share) && !samples.unexplained(best) {
            return Some(Ringing { samples, fits, unfitted });
        }
    }
    None
}

impl Samples<'_> {
    /// Highest frequency of a mode, in cycles per length of the pulse.
    fn fastest(&self) -> f64 {
        FASTEST.min(0.5 / self.step)
    }

    /// Duration of the samples, in lengths of the pulse.
    fn duration(&self) -> f64 {
        self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Number of frequencies of a mode that the samples tell apart.
    fn frequencies(&self) -> f64 {
        (self.fastest() - SLOWEST) * self.duration()
    }

    /// First guesses of a mode whose response to the contact `fitted` explains the samples best, the best
    /// first, each with about twice the logarithm of the likelihood that it gains.
    fn modes(&self, fitted: &FittedPulse) -> Vec<(f64, [f64; 3])> {
        let (length, fastest) = (self.duration(), self.fastest());
        let stride = (self.times.len() as f64 / (ENOUGH * fastest * length)).max(1.0) as usize;
        let thin = |all: &[f64]| all.iter().copied().step_by(stride).collect::<Vec<f64>>();
        let (times, values) = (thin(&self.times), thin(&self.values));
        let mut p = fitted.fit.parameters.clone();
        let contact = p.len();
        let Some(bare) = fitted.at(self, &times) else { return Vec::new() };
        let without: f64 = bare.iter().zip(&values).map(|(b, v)| (v - b).powi(2)).sum();
        let mut line = |frequency: f64, zeta: f64| {
            p.truncate(contact);
            p.extend([1.0, frequency, zeta]);
            let rings = self.model(fitted.model, &p, &times, None)?;
            share([&bare, &rings], &values, fitted.fit.parameters[1])
        };
        let steps = (STEPS * self.frequencies()).ceil().max(1.0) as usize;
        let frequency = |i: usize| SLOWEST + (fastest - SLOWEST) * i as f64 / steps as f64;
        let best: Vec<(f64, [f64; 3])> = (0..=steps)
            .filter_map(|i| {
                let of = |zeta: &f64| {
                    let (left, share) = line(frequency(i), *zeta)?;
                    SHARES.contains(&share).then_some((left, [share, frequency(i), *zeta]))
                };
                DAMPING.iter().filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0))
            })
            .collect();
        let lower = |i: usize, other: Option<&(f64, [f64; 3])>| other.is_none_or(|o| best[i].0 <= o.0);
        let is_least = |i: &usize| lower(*i, best.get(i.wrapping_sub(1))) && lower(*i, best.get(i + 1));
        let mut least: Vec<_> = (0..best.len()).filter(is_least).map(|i| best[i]).collect();
        least.sort_by(|a, b| a.0.total_cmp(&b.0));
        let gain = |left: f64| self.times.len() as f64 * (without / left).ln();
        least.into_iter().take(GUESSES).map(|(left, mode)| (gain(left), mode)).collect()
    }
}

/// Sum of squares left of the `values` by the best sum of a baseline, the bare contact and what rings, and
/// the share of the latter. Both contacts have the baseline `level`.
fn share([bare, rings]: [&[f64]; 2], values: &[f64], level: f64) -> Option<(f64, f64)> {
    let row = |(b, r): (&f64, &f64)| Vector3::new(1.0, b - level, r - level);
    let rows = || bare.iter().zip(rings).map(row);
    let normal: Matrix3<f64> = rows().map(|row| row * row.transpose()).sum();
    let right: Vector3<f64> = rows().zip(values).map(|(row, v)| row * *v).sum();
    let p = normal.cholesky()?.solve(&right);
    let left: f64 = rows().zip(values).map(|(row, v)| (v - row.dot(&p)).powi(2)).sum();
    let share = p[2] / (p[1] + p[2]);
    (left.is_finite() && share.is_finite()).then_some((left, share))
}
