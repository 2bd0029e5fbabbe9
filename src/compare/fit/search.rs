//! Searches from several starting points, with every step on the motion nearest to its measured amplitudes.
//!
//! Far from the truth a simulated sweep does not resemble the measured one. History is therefore ignored
//! here, and points of other patterns are not recognised. A residual z is ln (measured/predicted) over
//! √(κ² + (3s)²), with s the relative standard uncertainty. It costs ln (1 + z²) (Cauchy's: P. J. Huber,
//! *Robust Statistics* (1981), 4.8): the farther off an outlier lies, the less it pulls. κ falls in steps, so
//! that the valley that most points share is found before its lowest point (graduated non-convexity:
//! A. Blake & A. Zisserman, *Visual Reconstruction* (1987), 7).

use super::{Data, MotionKind, Problem, Setting, SweepStep, Unknown};
use crate::math::minimise;
use crate::model::Parameter;
use rayon::prelude::*;

/// κ of the search, in turn: as large as the starts are wrong, up to a half.
const COARSE: [f64; 2] = [0.3, 0.1];
/// κ once motions are those of simulated sweeps, in turn, down to the level of noise.
pub(crate) const FINE: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// Factor on the standard deviation of a point in the scale of its z, so that noise is no outlier.
const WIDE: f64 = 3.0;
/// Largest difference in cost between two ends of the search that are one place: a tenth of a point.
const SAME_COST: f64 = 0.1;
/// Largest relative difference of their coordinates. An equal cost alone is no proof: losses that replace
/// each other cost the same.
const SAME_PLACE: f64 = 0.02;
/// Factor on the stated values within which starts lie: the accuracy of what a person knows of a rig.
const REACH: f64 = 1.5;
/// Range of starts on each side of a stated value between two bounds, in its logit: a factor of 4.5 in the
/// loss 1 − R.
const LOGIT: f64 = 1.5;
/// Starting points screened by their cost for each that is followed: the cost takes a hundredth of the
/// time.
const SCREENED: usize = 16;
/// Starting points around an answer in one turn.
const AROUND: usize = 8;
/// A fit with given motions ends where a step reduces the cost by less than this part.
const GAIN: f64 = 1e-3;
/// Rounds of assigning motions and fitting for each κ: motions settle after two or three.
const ROUNDS: usize = 4;

/// Local minimum in which some starts ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalMinimum {
    /// Coordinates of the unknowns.
    pub u: Vec<f64>,
    /// Number of starts that ended there.
    pub starts: usize,
}

impl Problem<'_> {
    /// Follows `starts` starting points, the first the stated rig itself. Returns the minima where they
    /// ended, each once, lowest cost first.
    pub fn search(&self, starts: usize) -> Vec<LocalMinimum> {
        let ranked = |places: Vec<Vec<f64>>| {
            let mut costs: Vec<_> = places.into_par_iter().map(|u| (self.cost(&u), u)).collect();
            costs.sort_by(|a, b| a.0.total_cmp(&b.0));
            costs
        };
        let screened = ranked((1..=SCREENED * (starts - 1)).map(|i| self.spread(i)).collect());
        let mut all = vec![self.coordinates(&self.base)];
        all.extend(screened.into_iter().take(starts - 1).map(|s| s.1));
        let mut ends: Vec<(f64, LocalMinimum)> = Vec::new();
        for (cost, u) in ranked(all.par_iter().map(|u| self.follow(u)).collect()) {
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_PLACE * a.abs().max(b.abs());
            match ends.last_mut() {
                Some((least, end)) if cost - *least <= SAME_COST && end.u.iter().zip(&u).all(near) => {
                    end.starts += 1;
                }
                _ => ends.push((cost, LocalMinimum { u, starts: 1 })),
            }
        }
        ends.into_iter().map(|end| end.1).collect()
    }

    /// Starting point number `i` of Halton's sequence (1960), within [`REACH`] or [`LOGIT`] of the stated
    /// value, or within two standard uncertainties of a prior.
    fn spread(&self, i: usize) -> Vec<f64> {
        const PRIMES: [usize; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
        let one = |(unknown, prime): (&Unknown, usize)| {
            let part = 2.0 * radical_inverse(i, prime) - 1.0;
            let value = self.base.get(unknown.parameter);
            let place = |v: f64| unknown.coordinate.of(v);
            match unknown.prior {
                Some([value, std]) => place(value + 2.0 * std * part),
                None if unknown.coordinate.high.is_finite() => place(value) + LOGIT * part,
                None => place(value * REACH.powf(part)),
            }
        };
        self.unknowns.iter().zip(PRIMES).map(one).collect()
    }

    /// Starting points around the answer `u` with other losses: these replace one another, and the points
    /// determine them worst. None where no loss is fitted.
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
        (turn * AROUND + 1..=(turn + 1) * AROUND).map(place).collect()
    }

    fn follow(&self, start: &[f64]) -> Vec<f64> {
        let (mut at, mut u) = (self.clone(), start.to_vec());
        for part in COARSE {
            at.kinds.fill(None);
            for _ in 0..ROUNDS {
                let setting = self.setting(&u);
                let next: Vec<_> =
                    self.data.steps.iter().map(|step| Some(self.nearest(&setting, step, part).0)).collect();
                if next == at.kinds {
                    break;
                }
                at.kinds = next;
                u = at.approached(part, u);
            }
        }
        u
    }

    /// Reduces Σ ln (1 + z²) from `u` with the assigned motions; steps without one cost nothing.
    pub fn approached(&self, part: f64, u: Vec<f64>) -> Vec<f64> {
        let residuals = |u: &[f64], r: &mut [f64]| {
            let setting = self.setting(u);
            let points = self.data.steps.iter().zip(&self.kinds).flat_map(|(step, kind)| {
                let shows = kind.map_or([f64::NAN; 2], |kind| self.data.shows(&setting, kind, step));
                let counts = f64::from(u8::from(kind.is_some()));
                let z = distances(self.data, step, shows, part);
                z.map(move |z| counts * (z * z).ln_1p().sqrt().copysign(z))
            });
            r.iter_mut().zip(points.chain(self.priors(&setting))).for_each(|(r, value)| *r = value);
        };
        let n = self.data.clear() + self.unknowns.len();
        let found = minimise(residuals, n, &u, &vec![0.1; u.len()], Some(GAIN));
        found.map_or(u, |minimum| self.folded(minimum).parameters)
    }

    /// Σ ln (1 + z²) of all points at the smaller κ of [`COARSE`], each on its nearest motion, plus Σ z² of
    /// the priors.
    fn cost(&self, u: &[f64]) -> f64 {
        let setting = self.setting(u);
        let one = |step: &SweepStep| self.nearest(&setting, step, COARSE[1]).1;
        self.prior_cost(&setting) + self.data.steps.iter().map(one).sum::<f64>()
    }

    /// Distances z from the priors, in three standard uncertainties.
    fn priors(&self, setting: &Setting) -> impl Iterator<Item = f64> {
        let known = self.unknowns.iter().map(|k| (setting.get(k.parameter), k.prior));
        known.map(|(value, prior)| prior.map_or(0.0, |[known, std]| (value - known) / (WIDE * std)))
    }

    /// Cost of the priors, Σ z².
    pub fn prior_cost(&self, setting: &Setting) -> f64 {
        self.priors(setting).map(|z| z * z).sum()
    }

    /// The motion nearest to a step, and the cost of its points.
    fn nearest(&self, setting: &Setting, step: &SweepStep, part: f64) -> (MotionKind, f64) {
        let [impacting, free] =
            [MotionKind::Impacting, MotionKind::Free].map(|kind| self.data.shows(setting, kind, step));
        // An amplitude below the noise floor excludes impacts that would lift it to twice its limit. It
        // adds no cost, since that would be the same for all parameters.
        let silent = step.faint().any(|(mass, limit)| impacting[mass] > 2.0 * limit);
        // Free motion may exceed the gap by half, since the parameters are still wrong.
        let clears = free[0] < REACH * setting.rig.gap;
        let [impacting, free] = [impacting, free]
            .map(|shows| distances(self.data, step, shows, part).map(|z| z.powi(2).ln_1p()).sum::<f64>());
        if silent || clears && free < impacting {
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

/// z of a step's points above the noise floor, for predicted amplitudes `shows` in m and κ = `part`.
pub fn distances(data: &Data, step: &SweepStep, shows: [f64; 2], part: f64) -> impl Iterator<Item = f64> {
    step.clear().map(move |(mass, reading)| {
        let own = WIDE * (reading.std / reading.amplitude).hypot(data.calibration);
        reading.log_ratio(shows[mass]) / part.hypot(own)
    })
}
