//! Motions by history and parameters by least squares, in turn until both stay.

use super::{
    Data, FINE, Motion, MotionKind, Pace, Problem, Setting, Simulated, StepAmplitude, SweepStep, distances,
    motions, reached, shown, simulated_briefly,
};
use crate::error::Result;
use crate::math::Minimum;
use crate::measure::chance::chi_squared_at;
use crate::measure::residuals::{Whiteness, student};
use crate::record::median;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Rounds before steps whose motion still changes are left out: near a fold each set of parameters has
/// another motion there.
const ROUNDS: usize = 3;
/// Rounds in all.
const MOST: usize = 6;
/// Pace of simulated sweeps on the way: parameters that are wrong by more than a disturbance leaves need no
/// long wait for it.
const BRIEF: Pace = Pace { settle: 60, measure: 36 };
/// Chance that residuals of the stated uncertainties have no larger χ².
const CHANCE: f64 = 0.999;

/// The least sum of squares with given motions.
#[derive(Debug, Clone)]
pub struct LeastSquares<'a> {
    pub problem: Problem<'a>,
    pub minimum: Minimum,
    /// χ²/ν of data and priors by their stated uncertainties; NaN without degrees of freedom.
    pub reduced: f64,
    /// Of the residuals along frequency, sweep by sweep.
    pub whiteness: Whiteness,
}

/// Parameters at the least sum of squares, with the motions that belong to them.
#[derive(Debug, Clone)]
pub struct Converged<'a> {
    pub least: LeastSquares<'a>,
    /// Amplitudes left out because their motion changed from round to round.
    pub wavering: usize,
    /// Amplitudes left out as outliers.
    pub far: usize,
    /// Whether the motions stayed the same in the last round.
    pub agreed: bool,
    /// How far all points lie from a simulated sweep, or from the motion they are taken for, and the
    /// parameters from their priors: the less the better.
    pub unexplained: f64,
}

impl Converged<'_> {
    pub fn setting(&self) -> Setting {
        self.least.problem.setting(&self.least.minimum.parameters)
    }
}

impl<'a> Problem<'a> {
    /// Settles from the coordinates `start` on.
    ///
    /// At first outliers pull little ([`super::search`]), since the motions of wrong parameters are wrong,
    /// too; in the end all count as stated.
    ///
    /// # Errors
    /// If a round leaves fewer points than parameters.
    pub fn converge(&self, start: &[f64]) -> Result<Converged<'a>> {
        let (data, pace) = (self.data, self.data.pace);
        let motions = |u: &[f64], pace: Pace| assigned(data, &self.setting(u), pace);
        let brief = Pace { settle: pace.settle.min(BRIEF.settle), measure: pace.measure.min(BRIEF.measure) };
        let mut u = start.to_vec();
        for part in FINE {
            let now = self.of(motions(&u, brief)?.kinds);
            now.enough(now.rows().0)?;
            u = now.approached(part, u);
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
            if agreed || round == MOST {
                let outlier = |i: &usize| kinds[*i].is_none() && !wavering.contains(i);
                return Ok(Converged {
                    wavering: wavering.iter().map(|i| data.steps[*i].clear().count()).sum(),
                    far: (0..n).filter(outlier).map(|i| shown(&data.steps[i], now.kinds[i]).count()).sum(),
                    agreed,
                    unexplained: least.problem.left_over(&u, &now),
                    least,
                });
            }
            if round >= ROUNDS {
                wavering.extend((0..n).filter(|i| kinds[*i] != next[*i]));
                leave_out(&mut next, &wavering);
            }
            kinds = next;
        }
    }

    /// The least sum of squares with its motions, from `start` on; weights and scale from the parameters
    /// found, twice.
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
            // A scale that the residuals had to tell is itself uncertain.
            let widened = if reduced > least { student(self.freedom()).unwrap_or(1.0) } else { 1.0 };
            self.scale = reduced.max(least) * (widened * whiteness.inflation).powi(2);
            (u, rescaled) = (minimum.parameters, rescaled + 1);
        }
    }

    /// How far all points lie from what was simulated, or nearer from the motion they are taken for: Σ min
    /// (z², 1) over all κ.
    fn left_over(&self, u: &[f64], motions: &Motions) -> f64 {
        let (data, setting) = (self.data, self.setting(u));
        let one = |((step, kind), simulated): ((&SweepStep, &Option<MotionKind>), &Option<[f64; 2]>)| {
            let far = |shows: [f64; 2]| -> f64 {
                let z = FINE.iter().flat_map(|part| distances(data, step, shows, *part));
                z.map(|z| z.powi(2).min(1.0)).sum()
            };
            let taken = kind.map_or(f64::INFINITY, |kind| far(data.shows(&setting, kind, step)));
            taken.min(far(simulated.unwrap_or([0.0; 2])))
        };
        let points: f64 = data.steps.iter().zip(&self.kinds).zip(&motions.simulated).map(one).sum();
        points + FINE.len() as f64 * self.prior_cost(&setting)
    }

    /// χ²/ν by the stated uncertainties, priors counted in, and whether the residuals of the data are noise.
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

fn leave_out(kinds: &mut [Option<MotionKind>], steps: &BTreeSet<usize>) {
    for i in steps {
        kinds[*i] = None;
    }
}

impl LeastSquares<'_> {
    /// Whether χ²/ν is larger than chance makes it.
    pub(crate) fn beyond_chance(&self) -> bool {
        let free = self.problem.freedom();
        self.reduced * free as f64 > chi_squared_at(CHANCE, free)
    }
}

/// Motions of all steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Motions {
    /// `None` where it is none of the closed form.
    pub kinds: Vec<Option<MotionKind>>,
    /// The same by the simulated sweep alone, whatever was measured.
    pub history: Vec<Option<MotionKind>>,
    /// Amplitudes of both masses in m of the simulated sweep; `None` where it has no answer.
    pub simulated: Vec<Option<[f64; 2]>>,
}

/// The motion of each step, as a sweep simulated through all steps of its sequence reaches it; `None` where
/// that is none of the closed form. Where the measured amplitudes lie nearer to another stable motion, it is
/// that one: on which of several a sweep settles may hang on less than can be known.
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
            let nearest = seen.min_by(|a, b| away(step, a).total_cmp(&away(step, b)));
            // A mass that moves is not free; of two impacting motions the closed form of a fit is the upper
            // one.
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

/// Sum of |ln (measured/predicted)|; a mass that rests where it was seen to move is as far as can be.
fn away(step: &SweepStep, motion: &Motion) -> f64 {
    let above = |(mass, limit): (usize, f64)| (motion.amplitude[mass] / limit).ln().max(0.0);
    let moves = |(mass, reading): (usize, &StepAmplitude)| reading.log_ratio(motion.amplitude[mass]).abs();
    step.clear().map(moves).sum::<f64>() + step.faint().map(above).sum::<f64>()
}

/// A step farther from its motion than so many standard deviations is an outlier: noise alone takes one of a
/// million there.
const FAR: f64 = 5.0;
/// Median of the larger of two absolute normal deviates: erf² (x/√2) = 1/2.
const MEDIAN: f64 = 1.052;
/// At most this part of the steps is looked at as outliers: with a tenth the answer is doubted.
const OUTLIERS: f64 = 0.25;

/// Motions without those of outliers: a point of another motion, or of a sweep that had not settled.
///
/// They are left out one after the other, the farthest first, since it moves what the points share. Where the
/// points scatter more than they should, by the median, that counts for a standard deviation.
pub fn without_outliers(
    data: &Data,
    setting: &Setting,
    mut kinds: Vec<Option<MotionKind>>,
) -> Vec<Option<MotionKind>> {
    for _ in 0..(OUTLIERS * kinds.len() as f64) as usize {
        let mut problem = Problem::new(data, setting, Vec::new()).of(kinds.clone());
        problem.weigh(&[]);
        let mut away = vec![None::<f64>; kinds.len()];
        for ((step, ..), r) in problem.used().zip(problem.at(&[])) {
            away[step] = Some(away[step].unwrap_or(0.0).max(r.abs()));
        }
        let limit = FAR * (median(away.iter().flatten()) / MEDIAN).max(1.0);
        let far = away.iter().enumerate().filter_map(|(i, away)| Some((i, away.filter(|a| *a > limit)?)));
        let Some((farthest, _)) = far.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        kinds[farthest] = None;
    }
    kinds
}
