//! Chooses the simplest adequate model: models of rising order are judged by points that they were not
//! fitted to.

use super::{Converged, Data, MotionKind, Problem, Setting, assigned};
use crate::measure::residuals::aicc;
use crate::measure::response::Response;
use crate::model::Parameter;
use crate::record::sort_by_number;
use rayon::prelude::*;
use serde::Serialize;
use std::ops::RangeInclusive;

/// Number of steps on each side of a feature that are held out with it, since they would reveal its height.
const STEPS_BESIDE: usize = 2;
/// Relative difference in frequency up to which steps of two sweeps are the same.
const SAME_STEP: f64 = 1e-3;
/// No model is chosen if the mean error of the best reaches this: half of the amplitudes.
const LARGEST_ERROR: f64 = 0.5;

/// Steps that were held out together, and the error of their prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Block {
    /// Resonance, antiresonance, jump, or `amplitude` for steps away from all of these.
    pub feature: String,
    /// Its frequency in Hz.
    pub frequency: f64,
    /// Mean of |ln (measured/predicted)|, each at most 1, over all amplitudes held out: about the relative
    /// error.
    pub error: f64,
}

/// A model, and how well it predicts points held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rung {
    /// Model: `linear`, without impacts; `closed form`, with rigid impacts; `soft-corrected closed form`,
    /// corrected to first order for the compliance of the contact.
    pub model: &'static str,
    /// Parameters fitted with this model.
    pub parameters: Vec<Parameter>,
    /// Their values by this model, in SI units.
    pub values: Vec<f64>,
    /// Mean error of the blocks held out; `None` with fewer than two.
    pub held_out: Option<f64>,
    /// Standard error of that mean, by the scatter of the blocks.
    pub held_out_std: Option<f64>,
    /// Akaike's criterion of the weighted residuals of all amplitudes of the answer, corrected for their
    /// number (Hurvich & Tsai 1989).
    pub aicc: Option<f64>,
    /// Probability that white noise shows as much correlation along frequency as its residuals.
    pub whiteness: Option<f64>,
    /// Whether it is the simplest model within one standard error of the best.
    pub chosen: bool,
    /// Errors block by block.
    pub blocks: Vec<Block>,
}

/// Judges the models from the fit with rigid contacts and, where it exists, the one with compliance.
///
/// Steps around each resonance, antiresonance and jump, and stretches away from these, are held out in turn
/// in all sweeps. The rest is fitted and predicts them (blocked cross-validation: D. R. Roberts et al.,
/// *Ecography* 40 (2017) 913). The motion of a held-out step is that of a simulated sweep of the fitted
/// rig. The simplest model within one standard error of the best is chosen (L. Breiman et al.,
/// *Classification and Regression Trees* (1984), 3.4.3).
pub fn rungs(rigid: &Converged<'_>, soft: Option<&Converged<'_>>, responses: &[Response]) -> Vec<Rung> {
    let full = &rigid.least.problem;
    let mut linear = full.clone();
    for (kind, step) in linear.kinds.iter_mut().zip(&full.data.steps) {
        *kind = kind.filter(|_| step.clear().any(|(mass, _)| mass == 0)).map(|_| MotionKind::Free);
    }
    linear.unknowns.retain(|u| !u.parameter.needs_impacts());
    let blocks = blocks(full.data, responses);
    let answer = &soft.unwrap_or(rigid).least.problem;
    let climbed = [
        rung("linear", false, &linear, &rigid.setting(), answer, &blocks),
        rung("closed form", true, full, &rigid.setting(), answer, &blocks),
        soft.and_then(|soft| {
            rung("soft-corrected closed form", true, answer, &soft.setting(), answer, &blocks)
        }),
    ];
    let mut rungs: Vec<Rung> = climbed.into_iter().flatten().collect();
    let means = rungs.iter().filter_map(|r| Some((r.held_out?, r.held_out_std?)));
    let best = means.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|best| best.0 < LARGEST_ERROR);
    let is_near = |r: &&mut Rung| best.zip(r.held_out).is_some_and(|((mean, std), own)| own <= mean + std);
    if let Some(chosen) = rungs.iter_mut().find(is_near) {
        chosen.chosen = true;
    }
    rungs
}

fn rung(
    model: &'static str,
    impacts: bool,
    problem: &Problem<'_>,
    from: &Setting,
    answer: &Problem<'_>,
    blocks: &[HeldOut],
) -> Option<Rung> {
    let (own, u) = fitted(problem.clone(), from)?;
    let setting = own.setting(&u);
    // All models have the weights of the answer: sums of squares with different weights cannot be compared.
    let off = answer.off(|step, kind| {
        let kind = if impacts { kind } else { MotionKind::Free };
        let shows = answer.data.shows(&setting, kind, step);
        if std::ptr::eq(problem.data, answer.data) {
            return shows;
        }
        // A rigid model is compared with the amplitudes as measured, not as corrected for compliance.
        [0, 1].map(|mass: usize| shows[mass] / step.readings[mass].as_ref().map_or(1.0, |r| r.compliance))
    });
    let sum = off.iter().map(|r| r * r).sum();
    let (_, whiteness) = own.goodness(&own.at(&u));
    let judged = |held: &HeldOut| {
        let mut rest = problem.clone();
        for i in &held.steps {
            rest.kinds[*i] = None;
        }
        let (rest, u) = fitted(rest, from)?;
        let error = error(problem.data, &rest.setting(&u), impacts, &held.steps)?;
        Some(Block { feature: held.feature.clone(), frequency: held.frequency, error })
    };
    let blocks: Vec<Block> = blocks.par_iter().filter_map(judged).collect();
    let n = blocks.len() as f64;
    let mean = blocks.iter().map(|b| b.error).sum::<f64>() / n;
    let variance = blocks.iter().map(|b| (b.error - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let several = blocks.len() > 1;
    Some(Rung {
        model,
        parameters: problem.unknowns.iter().map(|u| u.parameter).collect(),
        values: problem.unknowns.iter().map(|u| setting.get(u.parameter)).collect(),
        held_out: several.then_some(mean),
        held_out_std: several.then(|| (variance / n).sqrt()),
        aicc: Some(aicc(sum, off.len(), problem.unknowns.len() as f64)).filter(|a| a.is_finite()),
        whiteness: whiteness.p_value,
        chosen: false,
        blocks,
    })
}

/// Fits a model over its steps, with weights of its own, from the setting `from`. Returns it with its
/// coordinates.
fn fitted<'a>(mut problem: Problem<'a>, from: &Setting) -> Option<(Problem<'a>, Vec<f64>)> {
    let mut u = problem.coordinates(from);
    for _ in 0..2 {
        problem.weigh(&u);
        if !u.is_empty() {
            u = problem.solve(&u).ok()?.parameters;
        }
    }
    Some((problem, u))
}

/// Mean of |ln (measured/predicted)|, each at most 1, over all amplitudes at these steps; `None` without
/// amplitudes.
fn error(data: &Data, setting: &Setting, impacts: bool, steps: &[usize]) -> Option<f64> {
    let motions = if impacts { Some(assigned(data, setting, data.pace).ok()?) } else { None };
    let one = |i: &usize| {
        let step = &data.steps[*i];
        let of = |kind| data.shows(setting, kind, step);
        let predicted = motions.as_ref().map_or_else(
            || of(MotionKind::Free),
            |motions| motions.history[*i].map(of).or(motions.simulated[*i]).unwrap_or([f64::NAN; 2]),
        );
        step.clear().map(move |(mass, reading)| reading.log_ratio(predicted[mass]).abs().min(1.0))
    };
    let errors: Vec<f64> = steps.iter().flat_map(one).collect();
    (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
}

/// Steps that are held out together.
struct HeldOut {
    feature: String,
    frequency: f64,
    steps: Vec<usize>,
}

/// Features, each with its frequency and the steps of all sweeps around it. Between features: blocks of the
/// same number of steps.
fn blocks(data: &Data, responses: &[Response]) -> Vec<HeldOut> {
    let at = |i: &usize| data.steps[*i].frequency;
    let mut used: Vec<usize> = (0..data.steps.len()).filter(|i| data.steps[*i].clear().count() > 0).collect();
    sort_by_number(&mut used, |a| at(a));
    let (mut blocks, mut ranges) = (Vec::<HeldOut>::new(), Vec::<(String, RangeInclusive<f64>)>::new());
    for sequence in &data.sequences {
        let own: Vec<usize> = used.iter().copied().filter(|i| sequence.contains(i)).collect();
        let readings = || sequence.iter().flat_map(|i| data.steps[*i].readings.iter().flatten());
        let is_measured = |r: &&Response| readings().any(|reading| data.sweeps[reading.sweep].0 == r.name);
        for (feature, frequency) in responses.iter().filter(is_measured).flat_map(features) {
            let away = |k: &usize| (at(&own[*k]) - frequency).abs();
            let Some(k) = (0..own.len()).min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
            if ranges.iter().any(|(name, range)| *name == feature && range.contains(&frequency)) {
                continue;
            }
            let (low, high) = (k.saturating_sub(STEPS_BESIDE), (k + STEPS_BESIDE).min(own.len() - 1));
            let range = at(&own[low]) * (1.0 - SAME_STEP)..=at(&own[high]) * (1.0 + SAME_STEP);
            let steps: Vec<usize> = used.iter().copied().filter(|i| range.contains(&at(i))).collect();
            // Two features in the same steps are one block.
            let shared = |b: &HeldOut| steps.iter().filter(|i| b.steps.contains(i)).count();
            if blocks.iter().all(|b| 2 * shared(b) <= steps.len()) {
                blocks.push(HeldOut { feature: feature.clone(), frequency, steps });
            }
            ranges.push((feature, range));
        }
    }
    let is_open = |i: &usize| !ranges.iter().any(|r| r.1.contains(&at(i)));
    let piece = (2 * STEPS_BESIDE + 1) * data.sequences.len();
    for open in used.chunk_by(|a, b| is_open(a) == is_open(b)).filter(|open| is_open(&open[0])) {
        blocks.extend(open.chunks_exact(piece).map(|steps| HeldOut {
            feature: "amplitude".to_owned(),
            frequency: at(&steps[piece / 2]),
            steps: steps.to_vec(),
        }));
    }
    blocks
}

/// Resonances, antiresonances and jumps of a response, with their frequencies in Hz.
fn features(response: &Response) -> impl Iterator<Item = (String, f64)> {
    let named = response.resonances.iter().map(|r| (r.kind.name().to_owned(), r.frequency));
    named.chain(response.jumps.iter().map(|j| ("jump".to_owned(), j.frequency)))
}
