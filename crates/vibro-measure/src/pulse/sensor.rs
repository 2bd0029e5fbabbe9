//! A mode of the sensor, fitted together with the contact.

use super::fit::{FittedPulse, Samples};
use super::normalised::{Normalised, TAIL};
use super::result::Unfitted;
use super::{ContactModel, LowPass, rivals};
use crate::residuals::NO_SUPPORT;
use nalgebra::{DMatrix, DVector};

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

/// Part of the gain of a fit that the best first guess has at least, and each further one. By its damping
/// ratio a guess loses a tenth, by its frequency a fortieth; the contact yields further than along its
/// tangents.
const GUESSED: [f64; 2] = [0.4, 0.7];

/// Part of a parameter by which it is moved for a tangent: integrated contacts are smooth to 1e-5 only.
const TANGENT: f64 = 5e-3;

/// Least tangent over the pulse: a smaller one is rounding.
const LEAST_TANGENT: f64 = 1e-9;

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
    let needed = colour * (NO_SUPPORT + chance) + 2.0 * PARAMETERS;
    for (k, (guessed, mode)) in without.modes(&alone).into_iter().enumerate() {
        if guessed < GUESSED[k.min(1)] * needed {
            break;
        }
        let samples = samples(Some(mode));
        let gains = |fit: &FittedPulse| (alone.aicc() - fit.aicc()) / colour > NO_SUPPORT + chance;
        let Ok(main) = samples.fit(ContactModel::KelvinVoigt) else { continue };
        // The other models are fitted where one of these is likely.
        let same = || samples.fit(best.model).is_ok_and(|same| gains(&same));
        if !gains(&main) && (best.model == ContactModel::KelvinVoigt || !same()) {
            continue;
        }
        let (fits, unfitted) = rivals(&samples, main);
        let Some(best) = fits.iter().min_by(|a, b| a.aicc().total_cmp(&b.aicc())) else { continue };
        let share = best.fit.parameters[3 + best.model.parameters()];
        if gains(best)
            && SHARES.contains(&share)
            && samples.rings_on(best, &alone)
            && !samples.unexplained(best)
        {
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

    /// Whether the samples behind the contact, too, support the mode of a fit over one `without`. A contact
    /// of another shape looks like a mode only while it lasts.
    fn rings_on(&self, fitted: &FittedPulse, without: &FittedPulse) -> bool {
        let end = fitted.end() + TAIL * self.filter.map_or(0.0, LowPass::delay);
        let from = self.times.partition_point(|t| *t <= end);
        let squares = |fit: &FittedPulse| fit.fit.residuals[from..].iter().map(|r| r * r).sum::<f64>();
        (self.times.len() - from) as f64 * (squares(without) / squares(fitted)).ln() > NO_SUPPORT
    }

    /// Number of frequencies of a mode that the samples tell apart.
    fn frequencies(&self) -> f64 {
        (self.fastest() - SLOWEST) * self.duration()
    }

    /// First guesses of a mode whose response to the contact `fitted` explains the samples best, the best
    /// first, each with about twice the logarithm of the likelihood that it gains. The contact yields to each
    /// as far as its tangents go.
    fn modes(&self, fitted: &FittedPulse) -> Vec<(f64, [f64; 3])> {
        let (length, fastest) = (self.duration(), self.fastest());
        let stride = (self.times.len() as f64 / (ENOUGH * fastest * length)).max(1.0) as usize;
        let thin = |all: &[f64]| all.iter().copied().step_by(stride).collect::<Vec<f64>>();
        let (times, values) = (thin(&self.times), DVector::from_vec(thin(&self.values)));
        let Some(bare) = fitted.at(self, &times).map(DVector::from_vec) else { return Vec::new() };
        let mut p = fitted.fit.parameters.clone();
        let contact = p.len();
        let towards = |i: usize, side: f64| {
            let mut near = fitted.clone();
            near.fit.parameters[i] += side * TANGENT * near.fit.parameters[i].abs().max(0.1);
            Some(DVector::from_vec(near.at(self, &times)?) - &bare)
        };
        // At a bound the other side is taken.
        let tangent = |i: usize| towards(i, 1.0).or_else(|| towards(i, -1.0));
        let is_shown = |tangent: &DVector<f64>| tangent.norm() > LEAST_TANGENT * bare.norm();
        let tangents: Vec<_> = (0..contact).filter_map(tangent).filter(is_shown).collect();
        let tangents = DMatrix::from_columns(&tangents).qr().q();
        let beside = |v: DVector<f64>| &v - &tangents * tangents.tr_mul(&v);
        let rest = beside(values - &bare);
        let without = rest.norm_squared();
        let mut line = |frequency: f64, zeta: f64| {
            p.truncate(contact);
            p.extend([1.0, frequency, zeta]);
            let rings = DVector::from_vec(self.model(fitted.model, &p, &times, None)?);
            let rings = beside(rings - &bare);
            let (common, square) = (rest.dot(&rings), rings.norm_squared());
            Some((without - common * common / square, common / square))
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
