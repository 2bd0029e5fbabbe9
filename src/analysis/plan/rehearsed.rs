//! A plan beside what the estimator makes of drawn records.

use super::instrument::Instrument;
use super::{Forecast, Guess, tables};
use crate::error::Result;
use crate::math::Noise;
use crate::measure::Estimate;
use crate::measure::expected::{Heard, Refusal, Rehearsal};
use crate::record::{Finding, Uncertain};
use crate::report::words::{Voice, sentence};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

/// First seed of the drawn records.
const SEED: u64 = 9000;
/// Most reasons that are told, the most frequent first.
const MOST_REASONS: usize = 3;
/// Factor on an uncertainty from which it is reported: the bound predicts the scatter of records to 20 %.
const WIDER: f64 = 1.2;

/// Rehearses a test: draws records, and gives them to the estimator. Where they show a larger uncertainty
/// than expected, that counts; what most of them lack is not promised.
///
/// # Errors
/// If the guess is impossible.
pub fn rehearsed<G: Guess>(mut told: Forecast, guess: &G, instrument: &Instrument) -> Result<Forecast> {
    let n = instrument.rehearsals();
    if n == 0 {
        return Ok(told);
    }
    let (one, draw) = guess.rehearsal(instrument)?;
    let heard: Vec<Result<Heard>> =
        (0..n).into_par_iter().map(|k| draw(&mut Noise::new(SEED + k as u64))).collect();
    let rehearsal = Rehearsal::of(&one, &heard);
    let shown = |name: &str| rehearsal.answers.iter().find(|answer| answer.name == name)?.shown;
    let of_one = |name: &str| one.answers.iter().find(|(known, _)| known == name)?.1.std;
    let mut lost: Vec<&mut Estimate> = Vec::new();
    let changed = told.changes.iter_mut().flat_map(|change| &mut change.answers);
    for (name, answer) in told.answers.iter_mut().chain(changed) {
        match shown(name).zip(of_one(name)) {
            // The mean of several records keeps the bias of each.
            Some((shown, one)) => {
                answer.std = answer.std.map(|std| (std * shown.scatter).hypot(one * shown.bias));
            }
            None => lost.push(answer),
        }
    }
    let mut numbers: Vec<&mut dyn Uncertain> =
        lost.into_iter().map(|answer| answer as &mut dyn Uncertain).collect();
    let none = (Refusal::Refused("answers without an uncertainty".to_owned()), n);
    let without = (rehearsal.refusals.is_empty() && !numbers.is_empty()).then_some(&none);
    for (refusal, count) in rehearsal.refusals.iter().take(MOST_REASONS).chain(without) {
        let why = match refusal {
            Refusal::Refused(why) => why.clone(),
            Refusal::Doubted(doubt) => sentence(doubt, Voice::Command),
        };
        let why = why.trim_end_matches('.').to_owned();
        // The most frequent reason comes first.
        let finding = if numbers.is_empty() {
            let some = Finding::caution("plan-refused").count("n", *count).count("all", n);
            some.name("command", G::COMMAND).name("why", why)
        } else {
            let most = Finding::doubt("plan-unanswered").count("n", *count).count("all", n);
            most.name("command", G::COMMAND).name("why", why).of(&mut std::mem::take(&mut numbers))
        };
        told.findings.push(finding);
    }
    let wider = rehearsal.answers.iter().filter_map(|answer| Some((answer, answer.shown?.factor())));
    let wider = wider.filter(|(_, factor)| *factor > WIDER);
    let wider: Vec<String> =
        wider.map(|(answer, factor)| format!("{} ×{factor:.1}", tables::words(&answer.name))).collect();
    if !wider.is_empty() {
        let finding = Finding::caution("plan-wider").count("all", n).name("command", G::COMMAND);
        told.findings.push(finding.name("answers", wider.join(", ")));
    }
    told.rehearsal = Some(rehearsal);
    Ok(told)
}

/// A rehearsal in a JSON answer: how many records have each answer, and the factor on its uncertainty.
pub fn json(rehearsal: &Rehearsal) -> Value {
    let all = |of: &dyn Fn(usize) -> Value| -> Map<String, Value> {
        rehearsal.answers.iter().enumerate().map(|(i, answer)| (answer.name.clone(), of(i))).collect()
    };
    json!({
        "records": rehearsal.records,
        "answered": all(&|i| json!(rehearsal.answers[i].answered)),
        "factor": all(&|i| json!(rehearsal.answers[i].shown.map(|shown| shown.factor()))),
    })
}
