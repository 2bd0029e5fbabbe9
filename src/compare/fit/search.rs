//! Where to begin: several starting points, every step on that motion which lies nearest to what was measured.
//!
//! Far from the truth a simulated sweep says little of the measured one, so here no history is asked, and points of other patterns cannot be
//! recognised. A residual z is ln (measured/predicted) over a part κ of the amplitude or three standard deviations, and it costs ln (1 + z²)
//! (Cauchy's: P. J. Huber, *Robust Statistics* (1981), 4.8): an outlier pulls the less the farther it lies off. κ falls in steps, so that the
//! valley that most points share is found before its floor (graduated non-convexity: A. Blake & A. Zisserman, *Visual Reconstruction*
//! (1987), 7).

use super::super::prediction::Kind;
use super::data::{Data, Reading, Step};
use super::setting::Setting;
use super::unknown::{Unknown, at, coordinates, fold};
use crate::campaign::Parameter;
use crate::math::minimise;
use rayon::prelude::*;

/// κ of the search, in turn: the starts are off by up to a half.
const COARSE: [f64; 2] = [0.3, 0.1];
/// κ once motions are those of simulated sweeps, down to where noise takes over.
pub(crate) const FINE: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// So many standard deviations of a point count as one, so that noise is no outlier.
const WIDE: f64 = 3.0;
/// Places that cost the same but for this, a tenth of a point …
const SAME_COST: f64 = 0.1;
/// … and have the same coordinates but for this part are one, and followed once. Losses that replace each other cost the same, and are not.
const SAME_PLACE: f64 = 0.02;
/// Starting values lie within this factor of the first: what a person knows of a rig.
const REACH: f64 = 1.5;
/// Starting values of a parameter between two bounds lie within this of the first in its logit: a loss 1 − R within a factor of 4.5.
const LOGIT: f64 = 1.5;
/// Places whose cost is looked at for each start: one evaluation costs a hundredth of following a start.
const SCREENED: usize = 16;
/// Places beside an answer in one turn.
const AROUND: usize = 8;
/// A fit to given motions ends where a step gains less than this.
const GAIN: f64 = 1e-3;
/// Rounds of choosing motions and fitting for each κ: motions stay after two or three.
const ROUNDS: usize = 4;

/// Where some starts ended.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// Coordinates of the unknowns.
    pub u: Vec<f64>,
    /// How many starts ended there.
    pub starts: usize,
}

/// Follows `starts` starting points, the first from `base` itself; gives where they ended, each place once, the cheapest first.
pub fn search(data: &Data, base: &Setting, unknowns: &[Unknown], starts: usize) -> Vec<End> {
    let mut screened: Vec<(f64, Vec<f64>)> = (1..=SCREENED * (starts - 1))
        .into_par_iter()
        .map(|i| {
            let u = spread(base, unknowns, i);
            (cost(data, base, unknowns, &u), u)
        })
        .collect();
    screened.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut all = vec![coordinates(base, unknowns)];
    all.extend(screened.into_iter().take(starts - 1).map(|s| s.1));
    let one = |u: &Vec<f64>| {
        let u = follow(data, base, unknowns, u);
        (cost(data, base, unknowns, &u), End { u, starts: 1 })
    };
    let mut ends: Vec<(f64, End)> = all.par_iter().map(one).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    ends.dedup_by(|b, a| {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_PLACE * a.abs().max(b.abs());
        let same = (a.0 - b.0).abs() <= SAME_COST && a.1.u.iter().zip(&b.1.u).all(near);
        a.1.starts += if same { b.1.starts } else { 0 };
        same
    });
    ends.into_iter().map(|end| end.1).collect()
}

/// Starting point number `i` of Halton's sequence (1960), within [`REACH`] of the base, or two standard uncertainties of a prior.
fn spread(base: &Setting, unknowns: &[Unknown], i: usize) -> Vec<f64> {
    const PRIMES: [usize; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
    let one = |(unknown, prime): (&Unknown, usize)| {
        let part = 2.0 * radical_inverse(i, prime) - 1.0;
        let value = base.get(unknown.parameter);
        let place = |v: f64| unknown.coordinate.of(v);
        match unknown.prior {
            Some([value, std]) => place(value + 2.0 * std * part),
            None if unknown.coordinate.high.is_finite() => place(value) + LOGIT * part,
            None => place(value * REACH.powf(part)),
        }
    };
    unknowns.iter().zip(PRIMES).map(one).collect()
}

/// Places beside the answer `u` with other losses: they replace one another, and the points determine them worst.
pub fn around(base: &Setting, unknowns: &[Unknown], u: &[f64], turn: usize) -> Vec<Vec<f64>> {
    let is_loss = |k: &Unknown| matches!(k.parameter, Parameter::Restitution | Parameter::C1 | Parameter::C2);
    if !unknowns.iter().any(is_loss) {
        return Vec::new();
    }
    let place = |i: usize| {
        let fresh = spread(base, unknowns, i);
        unknowns.iter().zip(fresh).zip(u).map(|((k, new), u)| if is_loss(k) { new } else { *u }).collect()
    };
    (turn * AROUND + 1..=(turn + 1) * AROUND).map(place).collect()
}

/// The digits of `i` behind the point, in reverse.
fn radical_inverse(mut i: usize, base: usize) -> f64 {
    let (mut digit, mut sum) = (1.0, 0.0);
    while i > 0 {
        digit /= base as f64;
        sum += digit * (i % base) as f64;
        i /= base;
    }
    sum
}

fn follow(data: &Data, base: &Setting, unknowns: &[Unknown], start: &[f64]) -> Vec<f64> {
    let mut u = start.to_vec();
    for part in COARSE {
        let mut kinds = Vec::new();
        for _ in 0..ROUNDS {
            let setting = at(base, unknowns, &u);
            let next: Vec<_> =
                data.steps.iter().map(|step| Some(nearest(data, &setting, step, part).0)).collect();
            if next == kinds {
                break;
            }
            kinds = next;
            u = approached(data, base, unknowns, &kinds, part, u);
        }
    }
    u
}

/// Goes from `u` towards the least of Σ ln (1 + z²) with these motions; steps without one cost nothing.
pub fn approached(
    data: &Data,
    base: &Setting,
    unknowns: &[Unknown],
    kinds: &[Option<Kind>],
    part: f64,
    u: Vec<f64>,
) -> Vec<f64> {
    let residuals = |u: &[f64], r: &mut [f64]| {
        let setting = at(base, unknowns, u);
        let points = data.steps.iter().zip(kinds).flat_map(|(step, kind)| {
            let shows = kind.map(|kind| setting.shows(kind, setting.force_at(data, step), step.frequency));
            step.clear().map(move |(mass, reading)| {
                let z = shows.map_or(0.0, |shows| away(reading, shows[mass], part, data.calibration));
                (z * z).ln_1p().sqrt().copysign(z)
            })
        });
        let priors = unknowns.iter().map(|unknown| prior(unknown, &setting));
        r.iter_mut().zip(points.chain(priors)).for_each(|(r, value)| *r = value);
    };
    let n = data.clear() + unknowns.len();
    let Ok(mut minimum) = minimise(residuals, n, &u, &vec![0.1; u.len()], Some(GAIN)) else { return u };
    fold(unknowns, &mut minimum.parameters);
    minimum.parameters
}

/// Σ ln (1 + z²) of all points at the finer of the coarse κ, each on its nearest motion, and of the priors.
fn cost(data: &Data, base: &Setting, unknowns: &[Unknown], u: &[f64]) -> f64 {
    let setting = at(base, unknowns, u);
    let one = |step: &Step| nearest(data, &setting, step, COARSE[1]).1;
    prior_cost(unknowns, &setting) + data.steps.iter().map(one).sum::<f64>()
}

/// What the priors add to a cost.
pub(crate) fn prior_cost(unknowns: &[Unknown], setting: &Setting) -> f64 {
    unknowns.iter().map(|unknown| prior(unknown, setting).powi(2)).sum()
}

/// Σ min (z², 1) of a step's points over all the finer κ, where these amplitudes are predicted.
pub fn unexplained(data: &Data, step: &Step, shows: [f64; 2]) -> f64 {
    let z = |(mass, reading): (usize, &Reading), part: f64| {
        away(reading, shows[mass], part, data.calibration).powi(2).min(1.0)
    };
    FINE.iter().flat_map(|part| step.clear().map(|point| z(point, *part))).sum()
}

fn prior(unknown: &Unknown, setting: &Setting) -> f64 {
    unknown.prior.map_or(0.0, |[value, std]| (setting.get(unknown.parameter) - value) / (WIDE * std))
}

/// z of a point; a motion that shows nothing, or does not exist, is as far as can be.
fn away(reading: &Reading, shows: f64, part: f64, calibration: f64) -> f64 {
    /// e^20 is beyond any amplitude.
    const FARTHEST: f64 = 20.0;
    let r = (reading.amplitude / shows).ln();
    let r = if r.is_finite() { r.clamp(-FARTHEST, FARTHEST) } else { FARTHEST };
    r / part.hypot(WIDE * (reading.std / reading.amplitude).hypot(calibration))
}

/// The motion nearest to a step, and what its points cost.
fn nearest(data: &Data, setting: &Setting, step: &Step, part: f64) -> (Kind, f64) {
    let shows = |kind| setting.shows(kind, setting.force_at(data, step), step.frequency);
    let [impacting, free] = [Kind::Impacting, Kind::Free].map(shows);
    let costs = |shows: [f64; 2]| -> f64 {
        let z = |(mass, reading): (usize, &Reading)| away(reading, shows[mass], part, data.calibration);
        step.clear().map(|point| z(point).powi(2).ln_1p()).sum()
    };
    // A mass in the noise speaks against impacts; without weight in the sum, since it is the same for all parameters.
    let silent = (0..2).any(|mass| {
        let limit = step.readings[mass].as_ref().and_then(|r| r.upper_limit);
        limit.is_some_and(|limit| impacting[mass] > 2.0 * limit)
    });
    // No sharp border while the parameters are wrong.
    let clears = free[0] < REACH * setting.rig.gap;
    let (impacting, free) = (costs(impacting), costs(free));
    if silent || clears && free < impacting { (Kind::Free, free) } else { (Kind::Impacting, impacting) }
}
