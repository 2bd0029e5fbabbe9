//! Which motion each step shows.

use super::super::forcing::median;
use super::super::pair::reached;
use super::super::prediction::{Kind, Motion, motions};
use super::super::simulated::{Pace, Simulated, simulated_briefly};
use super::data::{Data, Reading, Step};
use super::problem::Problem;
use super::setting::Setting;
use crate::error::Result;
use rayon::prelude::*;

/// Motions of all steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Motions {
    /// `None` where it is none of the closed form.
    pub kinds: Vec<Option<Kind>>,
    /// The same by the simulated sweep alone, whatever was measured.
    pub history: Vec<Option<Kind>>,
    /// Amplitudes of both masses in m of the simulated sweep; `None` where it has no answer.
    pub simulated: Vec<Option<[f64; 2]>>,
}

/// The motion of each step, as a sweep simulated through all steps of its sequence reaches it; `None` where that is none of the closed
/// form. Where the measured amplitudes lie nearer to another stable motion, it is that one: on which of several a sweep settles may hang on
/// less than can be known.
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
            // A mass that moves is not free; of two impacting motions the closed form of a fit is the upper one.
            let upper = motions.first().filter(|m| m.kind == Kind::Impacting);
            let kind = history.and(nearest).map(|m| m.kind).filter(|kind| match kind {
                Kind::Free => step.readings[1].as_ref().is_none_or(|r| r.upper_limit.is_some()),
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
fn away(step: &Step, motion: &Motion) -> f64 {
    let above = |(mass, limit): (usize, f64)| (motion.amplitude[mass] / limit).ln().max(0.0);
    let moves = |(mass, reading): (usize, &Reading)| reading.log_ratio(motion.amplitude[mass]).abs();
    step.clear().map(moves).sum::<f64>() + step.faint().map(above).sum::<f64>()
}

/// A step farther from its motion than so many standard deviations is an outlier: noise alone takes one of a million there.
const FAR: f64 = 5.0;
/// Median of the larger of two absolute normal deviates: erf² (x/√2) = 1/2.
const MEDIAN: f64 = 1.052;
/// At most this part of the steps is looked at as outliers: with a tenth the answer is doubted.
const OUTLIERS: f64 = 0.25;

/// Motions without those of outliers: a point of another motion, or of a sweep that had not settled.
///
/// They are left out one after the other, the farthest first, since it moves what the points share. Where the points scatter more than they
/// should, by the median, that counts for a standard deviation.
pub fn without_outliers(data: &Data, setting: &Setting, mut kinds: Vec<Option<Kind>>) -> Vec<Option<Kind>> {
    for _ in 0..(OUTLIERS * kinds.len() as f64) as usize {
        let mut problem = Problem::new(data, setting, Vec::new()).of(kinds.clone());
        problem.weigh(&[]);
        let mut away = vec![None::<f64>; kinds.len()];
        for ((step, ..), r) in problem.used().zip(problem.at(&[])) {
            away[step] = Some(away[step].unwrap_or(0.0).max(r.abs()));
        }
        let limit = FAR * (median(away.iter().flatten().copied()).unwrap_or(0.0) / MEDIAN).max(1.0);
        let far = away.iter().enumerate().filter_map(|(i, away)| Some((i, away.filter(|a| *a > limit)?)));
        let Some((farthest, _)) = far.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        kinds[farthest] = None;
    }
    kinds
}
