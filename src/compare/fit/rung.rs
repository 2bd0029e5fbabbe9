//! No more model than the points ask for: models of rising order, each judged by points that it was not fitted to.

use super::super::prediction::Kind;
use super::data::{Data, Step};
use super::problem::{Problem, counts};
use super::settle::{Settled, left};
use crate::campaign::Parameter;
use crate::measure::residuals::aicc;
use crate::measure::response::Response;
use rayon::prelude::*;
use serde::Serialize;

/// Steps on both sides of a feature that are held out with it.
const BESIDE: usize = 2;

/// A stretch of steps that was held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Block {
    /// Resonance, antiresonance, jump, or `amplitude` for steps away from all of these.
    pub feature: String,
    /// Its frequency in Hz.
    pub frequency: f64,
    /// Mean of |ln (measured/predicted)| over the amplitudes held out, each 1 at most: about the relative error.
    pub error: f64,
}

/// A model, and how well it predicts what it was not shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rung {
    /// `linear` (no impacts), `closed form`, or `soft-corrected closed form`.
    pub model: &'static str,
    /// Parameters that it was fitted with.
    pub parameters: Vec<Parameter>,
    /// Mean error of the blocks held out; `None` with fewer than two.
    pub held_out: Option<f64>,
    /// Standard error of that mean, by the scatter of the blocks.
    pub held_out_std: Option<f64>,
    /// Akaike's criterion of the logarithms of measured over predicted, corrected for their number (Hurvich & Tsai 1989).
    pub aicc: Option<f64>,
    /// Probability that white noise shows as much correlation along frequency as its residuals.
    pub whiteness: Option<f64>,
    /// Whether it is the simplest within one standard error of the best.
    pub chosen: bool,
    /// Block by block.
    pub blocks: Vec<Block>,
}

/// Judges the rungs; `contact` (N/m) is the stiffness of the contact, where it is known.
///
/// Blocks of steps around each resonance, antiresonance and jump, and away from them, are left out in turn, the rest is fitted, and what was
/// left out predicted (blocked cross-validation: D. R. Roberts et al., *Ecography* 40 (2017) 913). The simplest model within one standard
/// error of the best is chosen (L. Breiman et al., *Classification and Regression Trees* (1984), 3.4.3).
pub fn rungs(settled: &Settled<'_>, responses: &[Response], contact: Option<f64>) -> Vec<Rung> {
    let full = &settled.problem;
    let blocks = blocks(full, responses);
    let mut linear = full.clone();
    for (kind, step) in linear.kinds.iter_mut().zip(&full.data.steps) {
        *kind = kind.filter(|_| step.clear().any(|(mass, _)| mass == 0)).map(|_| Kind::Free);
    }
    linear.unknowns.retain(|u| matches!(u.parameter, Parameter::Force | Parameter::C1 | Parameter::K1));
    let mut models = vec![("linear", linear), ("closed form", full.clone())];
    if contact.is_some() {
        let mut soft = full.clone();
        soft.base.contact = contact;
        models.push(("soft-corrected closed form", soft));
    }
    let mut rungs: Vec<Rung> =
        models.iter().filter_map(|(name, problem)| rung(name, problem, settled, &blocks)).collect();
    let best =
        rungs.iter().filter_map(|r| Some((r.held_out?, r.held_out_std?))).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((mean, std)) = best
        && let Some(chosen) = rungs.iter_mut().find(|r| r.held_out.is_some_and(|h| h <= mean + std))
    {
        chosen.chosen = true;
    }
    rungs
}

fn rung(
    model: &'static str,
    problem: &Problem<'_>,
    settled: &Settled<'_>,
    blocks: &[(String, f64, Vec<usize>)],
) -> Option<Rung> {
    let start: Vec<f64> =
        problem.unknowns.iter().map(|u| u.coordinate.of(settled.setting().get(u.parameter))).collect();
    let fitted = |problem: &Problem<'_>| -> Option<Vec<f64>> {
        if start.is_empty() { Some(Vec::new()) } else { Some(problem.solve(&start).ok()?.parameters) }
    };
    let kinds = &settled.problem.kinds;
    let all: Vec<usize> = (0..kinds.len()).collect();
    let u = fitted(problem)?;
    let errors = errors(problem, &u, kinds, &all);
    let sum = errors.iter().map(|e| e * e).sum();
    let (_, whiteness) = left(problem, &problem.at(&u));
    let judged: Vec<Block> = blocks
        .par_iter()
        .filter_map(|(feature, frequency, steps)| {
            let mut rest = problem.clone();
            for i in steps {
                rest.kinds[*i] = None;
            }
            let u = fitted(&rest)?;
            let errors = self::errors(problem, &u, kinds, steps);
            let error = errors.iter().sum::<f64>() / errors.len() as f64;
            error.is_finite().then(|| Block { feature: feature.clone(), frequency: *frequency, error })
        })
        .collect();
    let n = judged.len() as f64;
    let mean = judged.iter().map(|b| b.error).sum::<f64>() / n;
    let variance = judged.iter().map(|b| (b.error - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let several = judged.len() > 1;
    Some(Rung {
        model,
        parameters: problem.unknowns.iter().map(|u| u.parameter).collect(),
        held_out: several.then_some(mean),
        held_out_std: several.then(|| (variance / n).sqrt()),
        aicc: Some(aicc(sum, errors.len(), problem.unknowns.len())).filter(|a| a.is_finite()),
        whiteness: whiteness.p_value,
        chosen: false,
        blocks: judged,
    })
}

/// |ln (measured/predicted)|, 1 at most, of the amplitudes that the motions `of` show at these steps, whatever a model takes part of.
fn errors(problem: &Problem<'_>, u: &[f64], of: &[Option<Kind>], steps: &[usize]) -> Vec<f64> {
    let setting = problem.setting(u);
    let one = |i: &usize| -> Vec<f64> {
        let step = &problem.data.steps[*i];
        let (Some(own), Some(kind)) = (of[*i], problem.kinds[*i].or(of[*i])) else { return Vec::new() };
        let shows = setting.shows(kind, setting.force_at(problem.data, step), step.frequency);
        let error = |(mass, seen): (usize, &super::data::Seen)| {
            let r = (seen.amplitude / shows[mass]).ln().abs();
            if r.is_finite() { r.min(1.0) } else { 1.0 }
        };
        step.clear().filter(|(mass, _)| counts(Some(own), *mass)).map(error).collect()
    };
    steps.iter().flat_map(one).collect()
}

/// Features with their frequency and the steps around them.
fn blocks(problem: &Problem<'_>, responses: &[Response]) -> Vec<(String, f64, Vec<usize>)> {
    let data = problem.data;
    let mut found: Vec<(String, f64, Vec<usize>)> = Vec::new();
    for sequence in &data.sequences {
        let used: Vec<usize> = sequence.iter().copied().filter(|i| problem.kinds[*i].is_some()).collect();
        let mine =
            |r: &&Response| sequence.iter().any(|i| sweeps(data, &data.steps[*i]).any(|name| name == r.name));
        let mut taken = vec![false; used.len()];
        for response in responses.iter().filter(mine) {
            let named = response.resonances.iter().map(|r| (r.kind.clone(), r.frequency));
            let jumps = response.jumps.iter().map(|j| ("jump".to_owned(), j.frequency));
            for (feature, frequency) in named.chain(jumps) {
                let away = |i: &usize| (data.steps[used[*i]].frequency - frequency).abs();
                let Some(at) = (0..used.len()).min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
                let range = at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(used.len());
                taken[range.clone()].fill(true);
                let steps = used[range].to_vec();
                if !found.iter().any(|f| f.2 == steps) {
                    found.push((feature, frequency, steps));
                }
            }
        }
        let open: Vec<usize> = (0..used.len()).filter(|i| !taken[*i]).collect();
        let stretches = open.chunk_by(|a, b| b - a == 1);
        if let Some(longest) = stretches.max_by_key(|s| s.len()).filter(|s| s.len() > 2 * BESIDE) {
            let middle = longest.len() / 2;
            let steps: Vec<usize> =
                longest[middle - BESIDE..=middle + BESIDE].iter().map(|i| used[*i]).collect();
            found.push(("amplitude".to_owned(), data.steps[steps[BESIDE]].frequency, steps));
        }
    }
    found
}

/// Names of the sweeps of a step.
fn sweeps<'a>(data: &'a Data, step: &'a Step) -> impl Iterator<Item = &'a str> {
    step.seen.iter().flatten().map(|s| data.sweeps[s.sweep].0.as_str())
}
