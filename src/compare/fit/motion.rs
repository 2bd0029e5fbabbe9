//! Which motion each step shows.

use super::super::forcing::median;
use super::super::observable::Observable;
use super::super::pair::came_to;
use super::super::prediction::{Kind, Motion, motions};
use super::super::simulated::{Pace, simulated_plain};
use super::data::{Data, Step};
use super::problem::{Problem, counts};
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
    /// What the simulated sweep shows of both masses in m; `None` where it has no answer.
    pub came: Vec<Option<[f64; 2]>>,
}

impl Motions {
    /// Amplitudes that motions of the closed form show.
    pub fn amplitudes(&self, data: &Data) -> usize {
        (0..data.steps.len()).map(|i| self.amplitudes_at(data, i)).sum()
    }

    /// The same at one step.
    pub fn amplitudes_at(&self, data: &Data, step: usize) -> usize {
        let kind = self.kinds[step];
        data.steps[step].clear().filter(|(mass, _)| kind.is_some() && counts(kind, *mass)).count()
    }
}

/// The motion of each step, as a sweep simulated through all steps of its sequence comes to it; `None` where that is none of the closed
/// form. Where the measured amplitudes lie nearer to another motion that can be seen there, it is that one: which of several a sweep
/// falls into may hang on less than can be known. A step far from all of them shows none.
///
/// # Errors
/// If the rig is impossible.
pub fn assigned(data: &Data, setting: &Setting, pace: Pace) -> Result<Motions> {
    type One = (usize, [Option<Kind>; 2], Option<[f64; 2]>);
    let sequence = |sequence: &Vec<usize>| -> Result<Vec<One>> {
        let points: Vec<(f64, f64)> = sequence
            .iter()
            .map(|i| (data.steps[*i].frequency, setting.force_at(data, &data.steps[*i])))
            .collect();
        let came = simulated_plain(&setting.rig, &points, pace);
        let one = |((i, (frequency, force)), came): ((&usize, &(f64, f64)), &Result<_>)| {
            let motions = motions(&setting.rig, *force, *frequency, Observable::Fundamental)?;
            let history = came.as_ref().ok().and_then(|came| came_to(came, &motions));
            let step = &data.steps[*i];
            let seen = motions.iter().filter(|m| m.is_seen());
            let nearest = seen.min_by(|a, b| away(step, a).total_cmp(&away(step, b)));
            let kind = history.and(nearest).map(|m| m.kind);
            // A mass that moves is not free; a second motion of the same kind is not the one that fits go by.
            let upper = motions.first().filter(|m| m.kind == Kind::Impacting);
            let kind = kind.filter(|kind| match kind {
                Kind::Free => step.seen[1].as_ref().is_none_or(|s| s.limit.is_some()),
                _ => upper.is_some_and(Motion::is_seen),
            });
            Ok((*i, [kind, history.map(|m| m.kind)], came.as_ref().ok().map(|came| came.amplitude)))
        };
        sequence.iter().zip(&points).zip(&came).map(one).collect()
    };
    let all: Vec<_> = data.sequences.par_iter().map(sequence).collect::<Result<_>>()?;
    let n = data.steps.len();
    let mut motions = Motions { kinds: vec![None; n], history: vec![None; n], came: vec![None; n] };
    for (i, [kind, history], came) in all.into_iter().flatten() {
        (motions.kinds[i], motions.history[i], motions.came[i]) = (kind, history, came);
    }
    Ok(motions)
}

/// A step farther from its motion than so many standard deviations shows another one: noise alone takes one of a million there.
const FAR: f64 = 5.0;
/// Median of the larger of two absolute normal deviates: erf² (x/√2) = 1/2.
const MEDIAN: f64 = 1.052;

/// Motions without those of steps that lie far from them, whatever the simulated sweep came to. Where the points scatter more than they
/// should, by the median, that is what counts for a standard deviation.
pub fn without_far(data: &Data, setting: &Setting, kinds: Vec<Option<Kind>>) -> Vec<Option<Kind>> {
    let one = |(step, kind): (&Step, &Option<Kind>)| {
        let (kind, force) = ((*kind)?, setting.force_at(data, step));
        let shows = setting.shows(kind, force, step.frequency);
        // As far as frequency and force may err, so may the amplitude.
        let moved = setting.shows(kind, force, step.frequency + step.frequency_std);
        let forced = setting.shows(kind, force * (1.0 + step.force_std / step.force), step.frequency);
        let clear = step.clear().filter(|(mass, _)| counts(Some(kind), *mass));
        let away = |(mass, seen): (usize, &super::data::Seen)| {
            // Both errors of a calibration.
            let calibration = data.calibration * shows[mass] * std::f64::consts::SQRT_2;
            (seen.amplitude - shows[mass]).abs()
                / seen
                    .std
                    .hypot(moved[mass] - shows[mass])
                    .hypot(forced[mass] - shows[mass])
                    .hypot(calibration)
        };
        clear.map(away).max_by(f64::total_cmp)
    };
    let away: Vec<Option<f64>> = data.steps.iter().zip(&kinds).map(one).collect();
    let limit = limit(&away);
    let near =
        kinds.into_iter().zip(away).map(|(kind, away)| kind.filter(|_| away.is_none_or(|a| a <= limit)));
    without_lone(data, setting, near.collect())
}

/// How far a step may lie from its motion where the others lie so far from theirs.
fn limit(away: &[Option<f64>]) -> f64 {
    let mut sorted: Vec<f64> = away.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    FAR * (median(&sorted).unwrap_or(0.0) / MEDIAN).max(1.0)
}

/// Motions without those of steps that lie far from them once the calibrations' errors are allowed for as errors that all points share:
/// one after the other, the farthest first, since it moves what is shared.
fn without_lone(data: &Data, setting: &Setting, mut kinds: Vec<Option<Kind>>) -> Vec<Option<Kind>> {
    if data.calibration == 0.0 {
        return kinds;
    }
    for _ in 0..kinds.len() / 4 {
        let mut problem = Problem::new(data, setting, &[], &kinds);
        problem.weigh(&[]);
        let mut away = vec![None::<f64>; kinds.len()];
        for ((step, _), r) in problem.used().zip(problem.at(&[])) {
            away[step] = Some(away[step].unwrap_or(0.0).max(r.abs()));
        }
        let limit = limit(&away);
        let farthest =
            (0..away.len()).max_by(|a, b| away[*a].unwrap_or(0.0).total_cmp(&away[*b].unwrap_or(0.0)));
        match farthest.filter(|i| away[*i].is_some_and(|a| a > limit)) {
            Some(i) => kinds[i] = None,
            None => break,
        }
    }
    kinds
}

/// Sum of the logarithms of measured over shown; a mass that rests where it was seen to move is as far as can be.
fn away(step: &Step, motion: &Motion) -> f64 {
    let moves =
        |(mass, seen): (usize, &super::data::Seen)| (seen.amplitude / motion.amplitude[mass]).ln().abs();
    let faint = (0..2).filter_map(|mass| Some((mass, step.seen[mass].as_ref()?.limit?)));
    let above: f64 = faint.map(|(mass, limit)| (motion.amplitude[mass] / limit).ln().max(0.0)).sum();
    step.clear().map(moves).sum::<f64>() + above
}
