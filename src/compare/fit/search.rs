//! Searches from several starting points, with every step on the motion nearest to its measured amplitudes.
//!
//! Far from the truth a simulated sweep does not resemble the measured one. So no sweep is simulated here,
//! and points with other patterns of impacts are not recognised.
//!
//! A residual is z = ln (measured/predicted)/√(κ² + (3s)²), with the relative standard uncertainty s and a
//! width κ. It costs ln (1 + z²) (Cauchy's: P. J. Huber, *Robust Statistics* (1981), 4.8): the farther away
//! an outlier, the less its influence. κ falls in steps: a large κ finds the valley that most points share, a
//! small one its lowest point (graduated non-convexity: A. Blake & A. Zisserman, *Visual Reconstruction*
//! (1987), 7).

use super::{Data, MotionKind, Problem, Setting, SweepStep, Unknown};
use crate::math::minimise;
use crate::model::Parameter;
use crate::record::sort_by_number;
use rayon::prelude::*;

/// Widths κ of the search, one after another: at first as large as the relative errors of the starts, up to a
/// half.
const COARSE_KAPPA: [f64; 2] = [0.3, 0.1];
/// Widths κ after the search, one after another, with motions from simulated sweeps; the last is about the
/// noise.
pub(crate) const FINE_KAPPA: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// Factor on the relative standard uncertainty s of a point in its residual z, so that noise is no outlier.
const STD_FACTOR: f64 = 3.0;
/// Largest difference in cost between two results of the search that are one minimum: a tenth of a point's
/// cost.
const SAME_COST: f64 = 0.1;
/// Largest relative difference in each coordinate between two results that are one minimum. An equal cost
/// alone proves nothing: dampers and impact losses can replace each other at the same cost.
const SAME_PLACE: f64 = 0.02;
/// Starts lie within this factor of the stated values, since a person knows a rig about so well.
const START_FACTOR: f64 = 1.5;
/// For a parameter with two bounds, starts lie within this distance of the stated value's logit: a factor of
/// 4.5 in the loss 1 − R of the restitution R.
const START_LOGIT: f64 = 1.5;
/// Number of candidates for each start of the search: those of the lowest cost are used. A cost takes a
/// hundredth of the time of a search.
const SCREENED_PER_START: usize = 16;
/// Number of starting points around an answer in one turn ([`Problem::around`]).
const STARTS_AROUND: usize = 8;
/// A fit with given motions ends when a step reduces the cost by less than this share.
const LEAST_GAIN: f64 = 1e-3;
/// Rounds of assigning motions and fitting for each κ: motions settle after two or three.
const ROUNDS_PER_KAPPA: usize = 4;

/// Local minimum in which some starts ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalMinimum {
    /// Coordinates of the unknowns.
    pub u: Vec<f64>,
    /// Number of starts that ended there.
    pub starts: usize,
}

impl Problem<'_> {
    /// Searches from `starts` starting points, the first of them the stated rig. Returns the minima found,
    /// each once, by rising cost.
    pub fn search(&self, starts: usize) -> Vec<LocalMinimum> {
        let ranked = |places: Vec<Vec<f64>>| {
            let mut costs: Vec<_> = places.into_par_iter().map(|u| (self.cost(&u), u)).collect();
            sort_by_number(&mut costs, |a| a.0);
            costs
        };
        let screened = ranked((1..=SCREENED_PER_START * (starts - 1)).map(|i| self.spread(i)).collect());
        let mut all = vec![self.coordinates(&self.base)];
        all.extend(screened.into_iter().take(starts - 1).map(|s| s.1));
        let mut minima: Vec<(f64, LocalMinimum)> = Vec::new();
        for (cost, u) in ranked(all.par_iter().map(|u| self.search_from(u)).collect()) {
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_PLACE * a.abs().max(b.abs());
            match minima.last_mut() {
                Some((least, minimum))
                    if cost - *least <= SAME_COST && minimum.u.iter().zip(&u).all(near) =>
                {
                    minimum.starts += 1;
                }
                _ => minima.push((cost, LocalMinimum { u, starts: 1 })),
            }
        }
        minima.into_iter().map(|minimum| minimum.1).collect()
    }

    /// Starting point number `i` of Halton's sequence (1960), within [`START_FACTOR`] or [`START_LOGIT`] of
    /// the stated value, or within two standard uncertainties of a prior.
    fn spread(&self, i: usize) -> Vec<f64> {
        const PRIMES: [usize; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
        let one = |(unknown, prime): (&Unknown, usize)| {
            let part = 2.0 * radical_inverse(i, prime) - 1.0;
            let value = self.base.get(unknown.parameter);
            let place = |v: f64| unknown.coordinate.of(v);
            match unknown.prior {
                Some([value, std]) => place(value + 2.0 * std * part),
                None if unknown.coordinate.high.is_finite() => place(value) + START_LOGIT * part,
                None => place(value * START_FACTOR.powf(part)),
            }
        };
        self.unknowns.iter().zip(PRIMES).map(one).collect()
    }

    /// Starting points around the answer `u` with other dampers and restitutions: these can replace one
    /// another, so the points determine them worst. Empty if none of them is fitted.
    pub fn around(&self, u: &[f64], turn: usize) -> Vec<Vec<f64>> {
        let is_loss =
            |k: &Unknown| matches!(k.parameter, Parameter::Restitution | Parameter::C1 | Parameter::C2);
        if !self.unknowns.iter().any(is_loss) {
            return Vec::new();
        }
        let place = |i: usize| {
            let both = self.unknowns.iter().zip(self.spread(i)).zip(u);
            both.map(|((k, new), u)| if is_loss(k) { new } else { *u }).collect()
        };
        (turn * STARTS_AROUND + 1..=(turn + 1) * STARTS_AROUND).map(place).collect()
    }

    /// Assigns each step its nearest motion and fits the parameters, in turn, for each κ of [`COARSE_KAPPA`].
    fn search_from(&self, start: &[f64]) -> Vec<f64> {
        let (mut at, mut u) = (self.clone(), start.to_vec());
        for kappa in COARSE_KAPPA {
            at.kinds.fill(None);
            for _ in 0..ROUNDS_PER_KAPPA {
                let setting = self.setting(&u);
                let next: Vec<_> =
                    self.data.steps.iter().map(|step| Some(self.nearest(&setting, step, kappa).0)).collect();
                if next == at.kinds {
                    break;
                }
                at.kinds = next;
                u = at.approached(kappa, u);
            }
        }
        u
    }

    /// Reduces Σ ln (1 + z²) from `u` with the assigned motions; steps without one cost nothing.
    pub fn approached(&self, kappa: f64, u: Vec<f64>) -> Vec<f64> {
        let residuals = |u: &[f64], r: &mut [f64]| {
            let setting = self.setting(u);
            let points = self.data.steps.iter().zip(&self.kinds).flat_map(|(step, kind)| {
                let shows = kind.map_or([f64::NAN; 2], |kind| self.data.shows(&setting, kind, step));
                let counts = f64::from(u8::from(kind.is_some()));
                let z = distances(self.data, step, shows, kappa);
                z.map(move |z| counts * (z * z).ln_1p().sqrt().copysign(z))
            });
            r.iter_mut().zip(points.chain(self.priors(&setting))).for_each(|(r, value)| *r = value);
        };
        let n = self.data.clear() + self.unknowns.len();
        let found = minimise(residuals, n, &u, &vec![0.1; u.len()], Some(LEAST_GAIN));
        found.map_or(u, |minimum| self.folded(minimum).parameters)
    }

    /// Σ ln (1 + z²) of all points at the smaller κ of [`COARSE_KAPPA`], each on its nearest motion, plus Σ
    /// z² of the priors.
    fn cost(&self, u: &[f64]) -> f64 {
        let setting = self.setting(u);
        let one = |step: &SweepStep| self.nearest(&setting, step, COARSE_KAPPA[1]).1;
        self.prior_cost(&setting) + self.data.steps.iter().map(one).sum::<f64>()
    }

    /// Distances z from the priors, in three standard uncertainties.
    fn priors(&self, setting: &Setting) -> impl Iterator<Item = f64> {
        let known = self.unknowns.iter().map(|k| (setting.get(k.parameter), k.prior));
        known.map(|(value, prior)| prior.map_or(0.0, |[known, std]| (value - known) / (STD_FACTOR * std)))
    }

    /// Cost of the priors, Σ z².
    pub fn prior_cost(&self, setting: &Setting) -> f64 {
        self.priors(setting).map(|z| z * z).sum()
    }

    /// The motion nearest to a step, and the cost of its points.
    fn nearest(&self, setting: &Setting, step: &SweepStep, kappa: f64) -> (MotionKind, f64) {
        let [impacting, free] =
            [MotionKind::Impacting, MotionKind::Free].map(|kind| self.data.shows(setting, kind, step));
        // A mass below the noise floor excludes an impacting motion that is predicted above twice its upper
        // limit. It adds no cost.
        let excludes_impacts = step.faint().any(|(mass, limit)| impacting[mass] > 2.0 * limit);
        // A free motion may be predicted up to 1.5 times the gap, since the parameters are still wrong.
        let may_be_free = free[0] < START_FACTOR * setting.rig.gap;
        let [impacting, free] = [impacting, free]
            .map(|shows| distances(self.data, step, shows, kappa).map(|z| z.powi(2).ln_1p()).sum::<f64>());
        if excludes_impacts || may_be_free && free < impacting {
            (MotionKind::Free, free)
        } else {
            (MotionKind::Impacting, impacting)
        }
    }
}

/// The digits of `i` in `base` after the point, in reverse.
fn radical_inverse(i: usize, base: usize) -> f64 {
    if i == 0 { 0.0 } else { ((i % base) as f64 + radical_inverse(i / base, base)) / base as f64 }
}

/// Residuals z of a step's points above the noise floor, for predicted amplitudes `shows` in m.
pub fn distances(data: &Data, step: &SweepStep, shows: [f64; 2], kappa: f64) -> impl Iterator<Item = f64> {
    step.clear().map(move |(mass, reading)| {
        let uncertainty = STD_FACTOR * (reading.std / reading.amplitude).hypot(data.calibration);
        reading.log_ratio(shows[mass]) / kappa.hypot(uncertainty)
    })
}
