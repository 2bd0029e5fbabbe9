//! Where to begin: from several starting points, with every step on that motion which lies nearest to what was measured.
//!
//! Far from the truth a simulated sweep says little of the measured one, so here no history is asked. A residual is the logarithm of
//! measured over predicted, bounded (S. Geman and D. `McClure`, *Bull. Int. Stat. Inst.* 52 (1987) 5), so that a point of another pattern
//! pulls no more than others, and none can be gained by leaving points out.

use super::super::prediction::Kind;
use super::data::{Data, Step};
use super::setting::Setting;
use super::unknown::{Unknown, at, coordinates};
use crate::math::minimise;
use rayon::prelude::*;

/// Bound of a residual: three tenths of the amplitude.
const BOUND: f64 = 0.3;
/// What counts as one standard deviation here, beside a prior's.
const TYPICAL: f64 = 0.05;
/// Starting values lie within this factor of the first.
const REACH: f64 = 1.5;
/// Points that are looked at for each that is followed.
const SCREENED: usize = 16;
/// Rounds of choosing motions and fitting.
const ROUNDS: usize = 6;

/// Where one start led.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Coordinates of the unknowns.
    pub u: Vec<f64>,
    /// Sum of squared bounded residuals.
    pub cost: f64,
}

/// Follows `starts` starting points, the first from `base` itself, and gives where they led, the best first.
pub fn search(data: &Data, base: &Setting, unknowns: &[Unknown], starts: usize) -> Vec<Found> {
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
    let mut found: Vec<Found> = all.par_iter().map(|u| follow(data, base, unknowns, u)).collect();
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found
}

/// Starting point number `i` of Halton's sequence (1960), within [`REACH`] of the base, or two standard uncertainties of a prior.
fn spread(base: &Setting, unknowns: &[Unknown], i: usize) -> Vec<f64> {
    const PRIMES: [usize; 7] = [2, 3, 5, 7, 11, 13, 17];
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

fn follow(data: &Data, base: &Setting, unknowns: &[Unknown], start: &[f64]) -> Found {
    let mut u = start.to_vec();
    let mut kinds = nearest(data, &at(base, unknowns, &u));
    let n = data.steps.iter().flat_map(Step::clear).count() + unknowns.len();
    for _ in 0..ROUNDS {
        let residuals = |u: &[f64], r: &mut [f64]| residuals(data, base, unknowns, &kinds, u, r);
        let Ok(minimum) = minimise(residuals, n, &u, &vec![0.1; u.len()]) else { break };
        u = minimum.parameters;
        let next = nearest(data, &at(base, unknowns, &u));
        if next == kinds {
            break;
        }
        kinds = next;
    }
    Found { cost: cost(data, base, unknowns, &u), u }
}

fn cost(data: &Data, base: &Setting, unknowns: &[Unknown], u: &[f64]) -> f64 {
    let setting = at(base, unknowns, u);
    let priors = unknowns.iter().map(|unknown| prior(unknown, &setting).powi(2)).sum::<f64>();
    priors + data.steps.iter().map(|step| near(data, &setting, step).1).sum::<f64>()
}

fn residuals(data: &Data, base: &Setting, unknowns: &[Unknown], kinds: &[Kind], u: &[f64], r: &mut [f64]) {
    let setting = at(base, unknowns, u);
    let mut r = r.iter_mut();
    let mut put = |value: f64| {
        if let Some(place) = r.next() {
            *place = value;
        }
    };
    for (step, kind) in data.steps.iter().zip(kinds) {
        let shows = setting.shows(*kind, setting.force_at(data, step), step.frequency);
        for (mass, seen) in step.clear() {
            put(bounded(seen.amplitude, shows[mass]));
        }
    }
    for unknown in unknowns {
        put(prior(unknown, &setting));
    }
}

fn prior(unknown: &Unknown, setting: &Setting) -> f64 {
    unknown.prior.map_or(0.0, |[value, std]| TYPICAL * (setting.get(unknown.parameter) - value) / std)
}

fn bounded(measured: f64, shown: f64) -> f64 {
    let r = (measured / shown).ln();
    if r.is_finite() { r / (1.0 + (r / BOUND).powi(2)).sqrt() } else { BOUND }
}

/// The motion nearest to each step.
fn nearest(data: &Data, setting: &Setting) -> Vec<Kind> {
    data.steps.iter().map(|step| near(data, setting, step).0).collect()
}

/// The motion nearest to a step, and the sum of its squared bounded residuals.
fn near(data: &Data, setting: &Setting, step: &Step) -> (Kind, f64) {
    let force = setting.force_at(data, step);
    let away = |kind: Kind| {
        let shows = setting.shows(kind, force, step.frequency);
        let clear: f64 = step.clear().map(|(mass, seen)| bounded(seen.amplitude, shows[mass]).powi(2)).sum();
        (clear, shows)
    };
    let (impacting, shows) = away(Kind::Impacting);
    let (free, alone) = away(Kind::Free);
    // What should be seen and is not, speaks against a motion; without weight in the sum, since it is the same for all parameters.
    let missing = |shows: [f64; 2]| {
        (0..2).any(|mass| {
            let limit = step.seen[mass].as_ref().and_then(|s| s.limit);
            limit.is_some_and(|limit| shows[mass] > 2.0 * limit)
        })
    };
    // No sharp border while the parameters are wrong.
    let clears = alone[0] < 1.5 * setting.rig.gap;
    let prefers_free = match (missing(shows), clears) {
        (true, _) => true,
        (false, true) => free < impacting,
        (false, false) => false,
    };
    if prefers_free { (Kind::Free, free) } else { (Kind::Impacting, impacting) }
}

/// What of the steps is explained to a twentieth by the motions `kinds`: sum of squared logarithms over that, 1 at most for each point, 1
/// where there is none.
pub fn unexplained(data: &Data, setting: &Setting, kinds: &[Option<Kind>]) -> f64 {
    let one = |(step, kind): (&Step, &Option<Kind>)| {
        let shows = kind.map(|kind| setting.shows(kind, setting.force_at(data, step), step.frequency));
        let point = |(mass, seen): (usize, &super::data::Seen)| {
            let r = shows.map_or(f64::INFINITY, |s| (seen.amplitude / s[mass]).ln() / TYPICAL);
            if r.is_finite() { (r * r).min(1.0) } else { 1.0 }
        };
        step.clear().map(point).sum::<f64>()
    };
    data.steps.iter().zip(kinds).map(one).sum()
}
