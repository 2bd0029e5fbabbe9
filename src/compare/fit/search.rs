//! Where to begin: from several starting points, with every step on that motion which lies nearest to what was measured.
//!
//! Far from the truth a simulated sweep says little of the measured one, so here no history is asked, and points of other patterns cannot be
//! told beforehand. A residual z is the logarithm of measured over shown, over a part κ of the amplitude or three standard deviations,
//! and it costs ln (1 + z²) (P. J. Huber, *Robust Statistics* (1981), 4.8: Cauchy's): a point that lies far off pulls the less the farther it
//! is. κ falls from three tenths on in steps, so that the valley that most points share is found before its floor (A. Blake & A. Zisserman,
//! *Visual Reconstruction* (1987), 7: graduated non-convexity).

use super::super::prediction::Kind;
use super::data::{Data, Seen, Step};
use super::setting::Setting;
use super::unknown::{Unknown, at, coordinates, fold};
use crate::campaign::Parameter;
use crate::math::approach;
use rayon::prelude::*;

/// κ of the search, in turn.
const COARSE: [f64; 2] = [0.3, 0.1];
/// κ once motions are told by simulated sweeps.
pub const FINE: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// So many standard deviations of a point count as one, so that noise is no outlier.
const WIDE: f64 = 3.0;
/// Most that one point can miss: 1 for each of the finer κ.
pub const MOST: f64 = FINE.len() as f64;
/// Places that cost the same but for this, a tenth of a point, are one …
const SAME: f64 = 0.1;
/// … if their coordinates are the same but for this part. Losses that stand for one another cost the same, and are not one.
const NEAR: f64 = 0.02;
/// Starting values lie within this factor of the first.
const REACH: f64 = 1.5;
/// Points that are looked at for each that is followed.
const SCREENED: usize = 16;
/// Places beside an answer.
const AROUND: usize = 8;
/// Rounds of choosing motions and fitting, for each κ.
const ROUNDS: usize = 4;

/// Where some starts led.
#[derive(Debug, Clone, PartialEq)]
pub struct Led {
    /// Coordinates of the unknowns.
    pub u: Vec<f64>,
    /// How many starts led there.
    pub starts: usize,
}

/// Follows `starts` starting points, the first from `base` itself, and gives where they led, each place once.
pub fn search(data: &Data, base: &Setting, unknowns: &[Unknown], starts: usize) -> Vec<Led> {
    let first = coordinates(base, unknowns);
    let mut screened: Vec<(f64, Vec<f64>)> = (1..=SCREENED * (starts - 1))
        .into_par_iter()
        .map(|i| {
            let u = spread(base, unknowns, i);
            (cost(data, base, unknowns, &u), u)
        })
        .collect();
    screened.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut all = vec![first];
    all.extend(screened.into_iter().take(starts - 1).map(|s| s.1));
    let one = |u: &Vec<f64>| {
        let u = follow(data, base, unknowns, u);
        (cost(data, base, unknowns, &u), Led { u, starts: 1 })
    };
    let mut led: Vec<(f64, Led)> = all.par_iter().map(one).collect();
    led.sort_by(|a, b| a.0.total_cmp(&b.0));
    led.dedup_by(|b, a| {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= NEAR * a.abs().max(b.abs());
        let same = (a.0 - b.0).abs() <= SAME && a.1.u.iter().zip(&b.1.u).all(near);
        a.1.starts += if same { b.1.starts } else { 0 };
        same
    });
    led.into_iter().map(|l| l.1).collect()
}

/// Places beside the answer `u`: losses can stand for one another, and the points hold them weakest, so they are spread anew.
pub fn around(base: &Setting, unknowns: &[Unknown], u: &[f64], turn: usize) -> Vec<Vec<f64>> {
    let lossy = |k: &Unknown| matches!(k.parameter, Parameter::Restitution | Parameter::C1 | Parameter::C2);
    if !unknowns.iter().any(lossy) {
        return Vec::new();
    }
    let place = |i: usize| {
        let fresh = spread(base, unknowns, i);
        unknowns.iter().zip(fresh).zip(u).map(|((k, fresh), u)| if lossy(k) { fresh } else { *u }).collect()
    };
    (turn * AROUND + 1..=(turn + 1) * AROUND).map(place).collect()
}

/// Starting point number `i` of Halton's sequence (1960), within [`REACH`] of the base, or two standard uncertainties of a prior.
fn spread(base: &Setting, unknowns: &[Unknown], i: usize) -> Vec<f64> {
    const PRIMES: [usize; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
    let one = |(unknown, prime): (&Unknown, usize)| {
        let part = 2.0 * radical(i, prime) - 1.0;
        let value = base.get(unknown.parameter);
        let place = |v: f64| unknown.coordinate.of(v);
        match unknown.prior {
            Some([value, std]) => place(value + 2.0 * std * part),
            // A restitution of 0.98 may be 0.9 as well: its loss is what varies.
            None if unknown.coordinate.high.is_finite() => place(value) + 1.5 * part,
            None => place(value * REACH.powf(part)),
        }
    };
    unknowns.iter().zip(PRIMES).map(one).collect()
}

/// The digits of `i` behind the point, in reverse.
fn radical(mut i: usize, base: usize) -> f64 {
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
            let next = nearest(data, &at(base, unknowns, &u), part);
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
    let n = data.steps.iter().flat_map(Step::clear).count() + unknowns.len();
    let residuals = |u: &[f64], r: &mut [f64]| residuals(data, base, unknowns, kinds, part, u, r);
    let Ok(mut minimum) = approach(residuals, n, &u, &vec![0.1; u.len()]) else { return u };
    fold(unknowns, &mut minimum.parameters);
    minimum.parameters
}

/// Σ ln (1 + z²) of all points at the coarser of the κ, each on its nearest motion, and of the priors.
fn cost(data: &Data, base: &Setting, unknowns: &[Unknown], u: &[f64]) -> f64 {
    let setting = at(base, unknowns, u);
    let one = |step: &Step| Shows::new(data, &setting, step).nearest(step, COARSE[1]).1;
    priors(unknowns, &setting) + data.steps.iter().map(one).sum::<f64>()
}

/// As [`missed`] for one point that lies so many standard deviations off, all that points share allowed for.
pub fn missed_by(seen: &Seen, deviations: f64) -> f64 {
    let z = |part: f64| deviations / (part * seen.amplitude / seen.std).hypot(WIDE);
    FINE.iter().map(|part| z(*part).powi(2).min(1.0)).sum()
}

/// What the priors add to a cost.
pub fn priors(unknowns: &[Unknown], setting: &Setting) -> f64 {
    unknowns.iter().map(|unknown| prior(unknown, setting).powi(2)).sum()
}

/// Σ min (z², 1) of a step's points over all the finer κ, where these amplitudes are shown.
pub fn missed(data: &Data, step: &Step, shown: [f64; 2]) -> f64 {
    let z = |(mass, seen): (usize, &Seen), part: f64| {
        away(seen, shown[mass], part, data.calibration).powi(2).min(1.0)
    };
    FINE.iter().flat_map(|part| step.clear().map(|point| z(point, *part))).sum()
}

fn residuals(
    data: &Data,
    base: &Setting,
    unknowns: &[Unknown],
    kinds: &[Option<Kind>],
    part: f64,
    u: &[f64],
    r: &mut [f64],
) {
    let setting = at(base, unknowns, u);
    let mut r = r.iter_mut();
    let mut put = |value: f64| {
        if let Some(place) = r.next() {
            *place = value;
        }
    };
    for (step, kind) in data.steps.iter().zip(kinds) {
        let shows = kind.map(|kind| setting.shows(kind, setting.force_at(data, step), step.frequency));
        for (mass, seen) in step.clear() {
            let z = shows.map_or(0.0, |shows| away(seen, shows[mass], part, data.calibration));
            put((z * z).ln_1p().sqrt().copysign(z));
        }
    }
    for unknown in unknowns {
        put(prior(unknown, &setting));
    }
}

fn prior(unknown: &Unknown, setting: &Setting) -> f64 {
    unknown.prior.map_or(0.0, |[value, std]| (setting.get(unknown.parameter) - value) / (WIDE * std))
}

/// z of a point; as far as can be where the motion shows nothing, or does not exist.
fn away(seen: &Seen, shown: f64, part: f64, calibration: f64) -> f64 {
    const FARTHEST: f64 = 20.0;
    let r = (seen.amplitude / shown).ln();
    let r = if r.is_finite() { r.clamp(-FARTHEST, FARTHEST) } else { FARTHEST };
    r / part.hypot(WIDE * (seen.std / seen.amplitude).hypot(calibration))
}

/// The motion nearest to each step.
fn nearest(data: &Data, setting: &Setting, part: f64) -> Vec<Option<Kind>> {
    data.steps.iter().map(|step| Some(Shows::new(data, setting, step).nearest(step, part).0)).collect()
}

/// What both motions show at a step.
struct Shows {
    impacting: [f64; 2],
    free: [f64; 2],
    gap: f64,
    calibration: f64,
}

impl Shows {
    fn new(data: &Data, setting: &Setting, step: &Step) -> Shows {
        let shows = |kind| setting.shows(kind, setting.force_at(data, step), step.frequency);
        Shows {
            impacting: shows(Kind::Impacting),
            free: shows(Kind::Free),
            gap: setting.rig.gap,
            calibration: data.calibration,
        }
    }

    /// The motion nearest to the step, and what its points cost.
    fn nearest(&self, step: &Step, part: f64) -> (Kind, f64) {
        let costs = |shown: [f64; 2]| -> f64 {
            step.clear()
                .map(|(mass, seen)| away(seen, shown[mass], part, self.calibration).powi(2).ln_1p())
                .sum()
        };
        let (impacting, free) = (costs(self.impacting), costs(self.free));
        // What should be seen and is not, speaks against a motion; without weight in the sum, since it is the same for all parameters.
        let missing = (0..2).any(|mass| {
            let limit = step.seen[mass].as_ref().and_then(|s| s.limit);
            limit.is_some_and(|limit| self.impacting[mass] > 2.0 * limit)
        });
        // No sharp border while the parameters are wrong.
        let clears = self.free[0] < 1.5 * self.gap;
        let prefers_free = missing || clears && free < impacting;
        if prefers_free { (Kind::Free, free) } else { (Kind::Impacting, impacting) }
    }
}
