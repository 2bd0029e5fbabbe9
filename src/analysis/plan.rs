//! What a test will tell before it is made: `vibro plan`.
//!
//! A plan names an instrument and guesses of the truth. Each guess gives the expected uncertainty of every
//! answer by the fit of its estimator ([`crate::measure::expected`]), the pairs of parameters that the record
//! tells apart badly, and the changes of the test that help most.

mod decay;
mod drill;
mod drop;
pub mod figures;
mod instrument;
mod knob;
mod pulse;
mod rehearsed;
mod sweep;
mod tables;

use super::answer::Answer;
use super::progress::Progress;
use crate::campaign::{Campaign, KeyRange};
use crate::error::{Error, Result};
use crate::math::Noise;
use crate::measure::Estimate;
use crate::measure::expected::{Expected, Heard, Rehearsal, Tie};
use crate::read::Folder;
use crate::record::Finding;
use crate::report::files::Names;
use instrument::Instrument;
use knob::Knob;
use serde::de::DeserializeOwned;
use serde_json::{Map, json};
use std::path::Path;

/// Names of the files in its answer.
pub const FILES: Names = Names::Numbered(&["plan", "plan_points"]);

/// Tables of a plan beside those that all records of a campaign share.
const SECTIONS: [&str; 6] = [
    Instrument::SECTION,
    decay::Guess::SECTION,
    pulse::Guess::SECTION,
    drop::Guess::SECTION,
    drill::Guess::SECTION,
    sweep::Guess::SECTION,
];

/// What is guessed of one test: a table of the plan.
trait Guess: DeserializeOwned + Clone + 'static {
    /// Name of the table.
    const SECTION: &'static str;
    /// Heading in tables and figures.
    const TITLE: &'static str;
    /// Ranges of its keys.
    const RANGES: &'static [KeyRange];
    /// What of the guess can be changed to know more.
    const KNOBS: &'static [Knob<Self>];

    /// Command whose estimator measures the records.
    const COMMAND: &'static str;

    /// What the tests will tell, all records together.
    ///
    /// # Errors
    /// If a key is impossible or missing, or the record allows no answer.
    fn expected(&self, instrument: &Instrument) -> Result<Expected>;

    /// What one record will tell, and how it is drawn and measured.
    ///
    /// # Errors
    /// As [`Guess::expected`].
    fn rehearsal(&self, instrument: &Instrument) -> Result<Planned>;
}

/// What one record will tell, and how such a record is drawn and measured.
type Planned = (Expected, Box<dyn Fn(&mut Noise) -> Result<Heard> + Sync>);

/// The change of a test, and what it makes of the uncertainties.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// What is changed.
    pub what: String,
    /// Mean factor on the uncertainties of the answers, on a logarithmic scale.
    pub factor: f64,
    /// The answers after the change.
    pub answers: Vec<(String, Estimate)>,
}

/// Uncertainty over the factor on one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The key in words.
    pub key: &'static str,
    /// Factor on the key, and mean factor on the uncertainties.
    pub points: Vec<(f64, f64)>,
}

/// What is expected of one table of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Section and name of the table.
    pub section: &'static str,
    /// Heading.
    pub title: String,
    /// Answers as planned.
    pub answers: Vec<(String, Estimate)>,
    /// Pairs of parameters that are told apart badly.
    pub ties: Vec<Tie>,
    /// Changes that help by more than a hundredth, the best first.
    pub changes: Vec<Change>,
    /// Uncertainty over each key.
    pub courses: Vec<Course>,
    /// What the estimator makes of drawn records; `None` for a test that is not rehearsed.
    pub rehearsal: Option<Rehearsal>,
    /// Findings.
    pub findings: Vec<Finding>,
}

/// Least part by which a change must lower the uncertainties to be listed.
const WORTH: f64 = 0.01;
/// Factors on a key in the figure, as powers of two.
const POWERS: std::ops::RangeInclusive<i32> = -4..=4;

/// Reads a plan, and gives what each of its tests will tell.
///
/// # Errors
/// If the plan cannot be read, has an impossible key, or a test allows no answer.
pub fn answer(folder: &Folder, path: &Path, progress: &dyn Progress) -> Result<Answer> {
    if folder.read(path).is_ok_and(|bytes| bytes.trim_ascii().is_empty()) {
        return Err(without_test().in_file(path));
    }
    of(&Campaign::from_path(folder, path, &SECTIONS)?, progress)
}

fn without_test() -> Error {
    let tables = SECTIONS[1..].iter().map(|section| format!("[[{section}]]")).collect::<Vec<_>>().join(", ");
    Error::usage("a plan without a test", format!("one of the tables {tables}"))
        .hint("docs/commands.md shows a plan under `vibro plan`")
}

/// What each test of a plan will tell.
fn of(plan: &Campaign, progress: &dyn Progress) -> Result<Answer> {
    let instrument = Instrument::of(plan)?;
    let mut all = Vec::new();
    of_kind::<decay::Guess>(plan, &instrument, &mut all, progress)?;
    of_kind::<pulse::Guess>(plan, &instrument, &mut all, progress)?;
    of_kind::<drop::Guess>(plan, &instrument, &mut all, progress)?;
    of_kind::<drill::Guess>(plan, &instrument, &mut all, progress)?;
    let mut suggested = Vec::new();
    for (entry, checked) in
        plan.entries::<sweep::Guess>(sweep::Guess::SECTION, false, sweep::Guess::RANGES)?
    {
        let planned = checked.and_then(|()| sweep::planned(plan, &entry.keys, &instrument, entry.number));
        let (forecast, points) = planned.map_err(|error| plan.fault(&entry, error))?;
        suggested.push((forecast.title.clone(), points));
        all.push(forecast);
    }
    if all.is_empty() {
        return Err(without_test().in_file(plan.path()));
    }
    let mut answer = Answer::default();
    for forecast in &all {
        let one = json!({
            "name": forecast.title,
            "answers": forecast.answers.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
            "ties": forecast.ties.iter().map(|tie| json!({ "of": tie.of, "correlation": tie.correlation })).collect::<Vec<_>>(),
            "changes": forecast.changes.iter().map(changed).collect::<Vec<_>>(),
            "rehearsal": forecast.rehearsal.as_ref().map(rehearsed::json),
        });
        let list = answer.result.entry(format!("{}s", forecast.section)).or_insert_with(|| json!([]));
        list.as_array_mut().into_iter().for_each(|list| list.push(one.clone()));
        answer.add(&forecast.title, &forecast.findings);
        answer.tables.push(tables::forecast(forecast));
    }
    for (k, (title, points)) in suggested.iter().enumerate() {
        let name = if k == 0 { "plan_points".to_owned() } else { format!("plan_points_{}", k + 1) };
        answer.table(&name, tables::points(title, points));
        answer.figure(&name, figures::points(title, points));
    }
    if !suggested.is_empty() {
        let suggested = suggested.iter().map(|(_, points)| points).collect::<Vec<_>>();
        answer.result.insert("suggested".to_owned(), json!(suggested));
    }
    answer.csv("plan", &tables::all(&all));
    answer.figure("plan", figures::courses(&all));
    Ok(answer)
}

fn changed(change: &Change) -> serde_json::Value {
    let std: Map<String, serde_json::Value> =
        change.answers.iter().map(|(name, answer)| (name.clone(), json!(answer.std))).collect();
    json!({ "change": change.what, "factor": change.factor, "std": std })
}

/// Adds the forecasts of all tables of a kind.
fn of_kind<G: Guess>(
    plan: &Campaign,
    instrument: &Instrument,
    all: &mut Vec<Forecast>,
    progress: &dyn Progress,
) -> Result<()> {
    let entries = plan.entries::<G>(G::SECTION, false, G::RANGES)?;
    progress.start(G::TITLE, entries.len());
    for (entry, checked) in entries {
        let name = (G::SECTION, format!("{} {}", G::TITLE, entry.number));
        let knobs = [&Instrument::knobs()[..], G::KNOBS].concat();
        let expected = |instrument: &Instrument, guess: &G| guess.expected(instrument);
        let forecast = checked
            .and_then(|()| forecast(name, &entry.keys, instrument, &knobs, &expected))
            .and_then(|told| rehearsed::rehearsed(told, &entry.keys, instrument));
        all.push(forecast.map_err(|error| plan.fault(&entry, error))?);
        progress.step();
    }
    Ok(())
}

/// What a test will tell, and which changes would tell more; its name is that of its section, and its
/// heading.
fn forecast<G: Clone>(
    (section, title): (&'static str, String),
    guess: &G,
    instrument: &Instrument,
    knobs: &[Knob<G>],
    expected: &dyn Fn(&Instrument, &G) -> Result<Expected>,
) -> Result<Forecast> {
    let planned = expected(instrument, guess)?;
    let after = |knob: &Knob<G>, factor: f64| {
        if factor == 1.0 {
            return knob.turned(instrument, guess, factor).map(|_| (1.0, planned.answers.clone()));
        }
        let (instrument, guess) = knob.turned(instrument, guess, factor)?;
        let answers = expected(&instrument, &guess).ok()?.answers;
        Some((ratio(&planned.answers, &answers)?, answers))
    };
    let (mut changes, mut courses) = (Vec::new(), Vec::new());
    for knob in knobs {
        let better = after(knob, knob.better);
        let course =
            |by: f64| if by == knob.better { better.as_ref() } else { None }.map(|(factor, _)| *factor);
        let point = |by: f64| Some((by, course(by).or_else(|| Some(after(knob, by)?.0))?));
        let factors = POWERS.map(|power| 2f64.powf(0.5 * f64::from(power)));
        let points: Vec<(f64, f64)> = factors.filter_map(point).collect();
        if points.iter().any(|(_, factor)| (factor - 1.0).abs() > WORTH) {
            courses.push(Course { key: knob.key, points });
        }
        if let Some((factor, answers)) = better.filter(|(factor, _)| *factor < 1.0 - WORTH) {
            changes.push(Change { what: knob.change.to_owned(), factor, answers });
        }
    }
    crate::record::sort_by_number(&mut changes, |change| change.factor);
    Ok(Forecast {
        section,
        title,
        answers: planned.answers,
        ties: planned.ties,
        changes,
        courses,
        rehearsal: None,
        findings: planned.findings,
    })
}

/// Geometric mean of the ratios of the relative uncertainties of the same answers; `None` where none can be
/// compared.
fn ratio(before: &[(String, Estimate)], after: &[(String, Estimate)]) -> Option<f64> {
    let relative =
        |answer: &Estimate| Some(answer.std? / if answer.value == 0.0 { 1.0 } else { answer.value.abs() });
    let both = before.iter().filter_map(|(name, old)| {
        let (_, new) = after.iter().find(|(known, _)| known == name)?;
        let logarithm = (relative(new)? / relative(old)?).ln();
        logarithm.is_finite().then_some(logarithm)
    });
    let all: Vec<f64> = both.collect();
    (!all.is_empty()).then(|| (all.iter().sum::<f64>() / all.len() as f64).exp())
}

#[cfg(test)]
mod tests;
