//! Assigns motions by simulated sweeps and fits parameters by least squares, in turn until both stay the
//! same.

use super::{
    Data, FINE_KAPPA, Motion, MotionKind, Pace, Problem, Setting, Simulated, StepAmplitude, SweepStep,
    distances, motions, reached, shown, simulated_briefly,
};
use crate::error::Result;
use crate::math::Minimum;
use crate::measure::chance::chi_squared_at;
use crate::measure::residuals::{Whiteness, student};
use crate::record::median;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// From this round on, steps whose motion still changes are left out: near a fold each new set of parameters
/// may have another motion.
const ROUNDS_TO_EXCLUSION: usize = 3;
/// Largest number of rounds.
const MOST_ROUNDS: usize = 6;
/// Cycles at each point of the simulated sweeps of the search, fewer than at the end: errors of the
/// parameters are still larger than a residual transient.
const SEARCH_PACE: Pace = Pace { settle: 60, measure: 36 };
/// χ² is too large for chance above this quantile of its distribution for a correct model and correct stated
/// uncertainties.
const CHI_SQUARED_QUANTILE: f64 = 0.999;

/// Minimum of the sum of squares with given motions.
#[derive(Debug, Clone)]
pub struct LeastSquares<'a> {
    pub problem: Problem<'a>,
    pub minimum: Minimum,
    /// χ²/ν of data and priors by their stated uncertainties; NaN without degrees of freedom.
    pub reduced: f64,
    /// Whiteness of the residuals along frequency, sweep by sweep.
    pub whiteness: Whiteness,
}

/// Parameters at the minimum of the sum of squares, with the motions assigned for them.
#[derive(Debug, Clone)]
pub struct Converged<'a> {
    pub least: LeastSquares<'a>,
    /// Amplitudes left out because their motion changed from round to round.
    pub wavering: usize,
    /// Amplitudes left out as outliers.
    pub far: usize,
    /// Whether the motions stayed the same in the last round.
    pub agreed: bool,
    /// Distance of all points from the simulated sweep, or from their assigned motion where nearer, plus that
    /// of the parameters from their priors. The smallest is the best fit.
    pub unexplained: f64,
}

impl Converged<'_> {
    pub fn setting(&self) -> Setting {
        self.least.problem.setting(&self.least.minimum.parameters)
    }
}

impl<'a> Problem<'a> {
    /// Searches from the coordinates `start` until motions and parameters agree.
    ///
    /// At first outliers have little weight ([`super::search`]), since wrong parameters give wrong motions.
    /// In the end all points have their stated weights.
    ///
    /// # Errors
    /// If a round leaves fewer points than parameters.
    pub fn converge(&self, start: &[f64]) -> Result<Converged<'a>> {
        let (data, pace) = (self.data, self.data.pace);
        let motions = |u: &[f64], pace: Pace| assigned(data, &self.setting(u), pace);
        let search_pace = Pace {
            settle: pace.settle.min(SEARCH_PACE.settle),
            measure: pace.measure.min(SEARCH_PACE.measure),
        };
        let mut u = start.to_vec();
        for kappa in FINE_KAPPA {
            let now = self.of(motions(&u, search_pace)?.kinds);
            now.enough(now.rows().0)?;
            u = now.approached(kappa, u);
        }
        let n = data.steps.len();
        let mut wavering = BTreeSet::new();
        let mut kinds = without_outliers(data, &self.setting(&u), motions(&u, pace)?.kinds);
        let mut round = 0;
        loop {
            round += 1;
            let least = self.of(kinds.clone()).least(&u)?;
            u.clone_from(&least.minimum.parameters);
            let now = motions(&u, pace)?;
            let mut next = without_outliers(data, &self.setting(&u), now.kinds.clone());
            leave_out(&mut next, &wavering);
            let agreed = next == kinds;
            if agreed || round == MOST_ROUNDS {
                let outlier = |i: &usize| kinds[*i].is_none() && !wavering.contains(i);
                return Ok(Converged {
                    wavering: wavering.iter().map(|i| data.steps[*i].clear().count()).sum(),
                    far: (0..n).filter(outlier).map(|i| shown(&data.steps[i], now.kinds[i]).count()).sum(),
                    agreed,
                    unexplained: least.problem.left_over(&u, &now),
                    least,
                });
            }
            if round >= ROUNDS_TO_EXCLUSION {
                wavering.extend((0..n).filter(|i| kinds[*i] != next[*i]));
                leave_out(&mut next, &wavering);
            }
            kinds = next;
        }
    }

    /// Minimises the sum of squares with the assigned motions from `start`. Weights and scale are updated
    /// twice from the parameters found.
    ///
    /// # Errors
    /// If there are fewer points than parameters.
    pub fn least(mut self, start: &[f64]) -> Result<LeastSquares<'a>> {
        self.enough(self.rows().0)?;
        let mut rescaled = 0;
        let mut u = start.to_vec();
        loop {
            self.weigh(&u);
            let minimum = self.solve(&u)?;
            let (reduced, whiteness) = self.goodness(&minimum.residuals);
            if rescaled == 2 {
                return Ok(LeastSquares { problem: self, minimum, reduced, whiteness });
            }
            let least = if self.data.guessed && self.freedom() > 0 { f64::MIN_POSITIVE } else { 1.0 };
            // A scale estimated from the residuals is itself uncertain: Student's factor widens it.
            let widened = if reduced > least { student(self.freedom()).unwrap_or(1.0) } else { 1.0 };
            self.scale = reduced.max(least) * (widened * whiteness.inflation).powi(2);
            (u, rescaled) = (minimum.parameters, rescaled + 1);
        }
    }

    /// Distance of all points from the simulated sweep, or from their assigned motion where nearer: Σ min(z²,
    /// 1), summed over all κ of [`FINE_KAPPA`].
    fn left_over(&self, u: &[f64], motions: &Motions) -> f64 {
        let (data, setting) = (self.data, self.setting(u));
        let one = |((step, kind), simulated): ((&SweepStep, &Option<MotionKind>), &Option<[f64; 2]>)| {
            let far = |shows: [f64; 2]| -> f64 {
                let z = FINE_KAPPA.iter().flat_map(|kappa| distances(data, step, shows, *kappa));
                z.map(|z| z.powi(2).min(1.0)).sum()
            };
            let taken = kind.map_or(f64::INFINITY, |kind| far(data.shows(&setting, kind, step)));
            taken.min(far(simulated.unwrap_or([0.0; 2])))
        };
        let points: f64 = data.steps.iter().zip(&self.kinds).zip(&motions.simulated).map(one).sum();
        points + FINE_KAPPA.len() as f64 * self.prior_cost(&setting)
    }

    /// χ²/ν by the stated uncertainties with priors, and the whiteness of the residuals of the data.
    pub fn goodness(&self, residuals: &[f64]) -> (f64, Whiteness) {
        let (data, priors) = residuals.split_at(self.rows().0.min(residuals.len()));
        let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); self.data.sweeps.len()];
        self.used().zip(data).for_each(|((.., reading), r)| rows[reading.sweep].push(*r));
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let freedom = if self.freedom() == 0 { f64::NAN } else { self.freedom() as f64 };
        ((self.scale * sum(data) + sum(priors)) / freedom, Whiteness::of(&rows))
    }
}

/// Removes the motion of these `steps`, so that they do not count in the fit.
fn leave_out(kinds: &mut [Option<MotionKind>], steps: &BTreeSet<usize>) {
    for i in steps {
        kinds[*i] = None;
    }
}

impl LeastSquares<'_> {
    /// Whether χ² is larger than chance explains.
    pub(crate) fn beyond_chance(&self) -> bool {
        let free = self.problem.freedom();
        self.reduced * free as f64 > chi_squared_at(CHI_SQUARED_QUANTILE, free)
    }
}

/// Motions of all steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Motions {
    /// Assigned motion; `None` where the motion has no closed form.
    pub kinds: Vec<Option<MotionKind>>,
    /// Motion of the simulated sweep, independent of the measured amplitudes.
    pub history: Vec<Option<MotionKind>>,
    /// Amplitudes of both masses in m of the simulated sweep; `None` where the simulation fails.
    pub simulated: Vec<Option<[f64; 2]>>,
}

/// Assigns a motion to each step. A sweep simulated through all steps of its sequence shows which motion a
/// step reaches; a step whose motion has no closed form gets `None`. Else the step gets the stable motion
/// nearest to its measured amplitudes, since which of several a sweep reaches may depend on unknown details.
///
/// # Errors
/// If the rig is impossible.
pub fn assigned(data: &Data, setting: &Setting, pace: Pace) -> Result<Motions> {
    let sequence = |sequence: &Vec<usize>| -> Result<Vec<_>> {
        let steps = sequence.iter().map(|i| &data.steps[*i]);
        let points: Vec<(f64, f64)> = steps.map(|s| (s.frequency, data.force_at(setting, s))).collect();
        let simulated = simulated_briefly(&setting.rig, &points, pace);
        let one = |((i, (frequency, force)), simulated): ((&usize, &(f64, f64)), Result<Simulated>)| {
            let (step, simulated) = (&data.steps[*i], simulated.ok());
            let motions = motions(&setting.rig, *force, *frequency)?;
            let history = simulated.as_ref().and_then(|simulated| reached(simulated, &motions));
            let seen = motions.iter().filter(|m| m.is_seen());
            let nearest = seen.min_by(|a, b| log_distance(step, a).total_cmp(&log_distance(step, b)));
            // A step where mass 2 measurably moves is not a free motion. The closed form of a fit gives the
            // upper of two impacting motions, so an impacting step counts only if that one can be observed.
            let upper = motions.first().filter(|m| m.kind == MotionKind::Impacting);
            let kind = history.and(nearest).map(|m| m.kind).filter(|kind| match kind {
                MotionKind::Free => step.readings[1].as_ref().is_none_or(|r| r.upper_limit.is_some()),
                _ => upper.is_some_and(Motion::is_seen),
            });
            Ok((*i, kind, history.map(|m| m.kind), simulated.map(|s| s.amplitude)))
        };
        sequence.iter().zip(&points).zip(simulated).map(one).collect()
    };
    let all: Vec<_> = data.sequences.par_iter().map(sequence).collect::<Result<_>>()?;
    let n = data.steps.len();
    let mut motions = Motions { kinds: vec![None; n], history: vec![None; n], simulated: vec![None; n] };
    for (i, kind, history, simulated) in all.into_iter().flatten() {
        (motions.kinds[i], motions.history[i], motions.simulated[i]) = (kind, history, simulated);
    }
    Ok(motions)
}

/// Distance of the amplitudes from a motion: Σ |ln (measured/predicted)|, at most 20 for each mass. An
/// amplitude below the noise floor counts only if predicted above its upper limit.
fn log_distance(step: &SweepStep, motion: &Motion) -> f64 {
    let above = |(mass, limit): (usize, f64)| (motion.amplitude[mass] / limit).ln().max(0.0);
    let moves = |(mass, reading): (usize, &StepAmplitude)| reading.log_ratio(motion.amplitude[mass]).abs();
    step.clear().map(moves).sum::<f64>() + step.faint().map(above).sum::<f64>()
}

/// A step farther from its motion than this many standard deviations is an outlier: noise alone exceeds this
/// in one step of a million.
const OUTLIER_DEVIATIONS: f64 = 5.0;
/// Median x of the larger of two absolute normal deviates: erf²(x/√2) = 1/2. The median distance of the steps
/// divided by this is their scatter.
const MEDIAN_OF_LARGER: f64 = 1.052;
/// Largest share of steps that are left out as outliers. The answer is in doubt from a tenth on.
const MOST_OUTLIERS: f64 = 0.25;

/// Removes the motions of outliers: steps with another motion, or in a sweep that had not settled.
///
/// Outliers are removed one by one, the farthest first, since each also shifts the shared errors of the other
/// points. If the median scatter exceeds the stated standard deviation, distances are measured by the
/// scatter.
pub fn without_outliers(
    data: &Data,
    setting: &Setting,
    mut kinds: Vec<Option<MotionKind>>,
) -> Vec<Option<MotionKind>> {
    for _ in 0..(MOST_OUTLIERS * kinds.len() as f64) as usize {
        let mut problem = Problem::new(data, setting, Vec::new()).of(kinds.clone());
        problem.weigh(&[]);
        let mut away = vec![None::<f64>; kinds.len()];
        for ((step, ..), r) in problem.used().zip(problem.at(&[])) {
            away[step] = Some(away[step].unwrap_or(0.0).max(r.abs()));
        }
        let limit = OUTLIER_DEVIATIONS * (median(away.iter().flatten()) / MEDIAN_OF_LARGER).max(1.0);
        let far = away.iter().enumerate().filter_map(|(i, away)| Some((i, away.filter(|a| *a > limit)?)));
        let Some((farthest, _)) = far.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        kinds[farthest] = None;
    }
    kinds
}
