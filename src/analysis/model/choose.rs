//! The simplest adequate model: `vibro model choose`.

use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::compare::Overlay;
use crate::error::{Error, Result};
use crate::model::Observable;
use crate::model::ladder::{
    Choice, Curvature, MassChange, Model, Need, Question, Rung, Sensitivity, Stretch, Summary, Survey,
    choose, choose_over,
};
use crate::record::{Direction, Finding, Severity};
use crate::report::files::Names;
use crate::report::layout::table;
use crate::report::words::{Voice, sentence, sentences};
use crate::report::{Cell, Table};
use crate::units::notation::significant;
use serde::Serialize;
use serde_json::{Value, json};

/// Keys of `vibro model choose`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Excitation frequency in Hz
    #[cfg_attr(feature = "cli", arg(conflicts_with_all = ["from", "to", "points"]))]
    pub frequency: Option<f64>,
    /// Lowest frequency of a range, in Hz, instead of one frequency
    #[cfg_attr(feature = "cli", arg(requires = "to"))]
    pub from: Option<f64>,
    /// Highest frequency of the range, in Hz
    #[cfg_attr(feature = "cli", arg(requires = "from"))]
    pub to: Option<f64>,
    /// Number of frequencies of the range
    #[cfg_attr(feature = "cli", arg(default_value_t = 100))]
    pub points: usize,
    /// Observable: fundamental, the amplitude of both masses at the excitation frequency; peak, half of
    /// peak-to-peak; impact-speed; impulse
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<Observable>, default_value = "fundamental"))]
    pub observable: Observable,
    /// Relative change of the answer that does not matter
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.02))]
    pub tolerance: f64,
    /// Noise floor of the measurement, in the unit of the observable: smaller changes do not matter
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.0))]
    pub noise_floor: f64,
    /// Standard uncertainty of the gap in m: a closed form nearer to grazing is not valid
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.0))]
    pub gap_std: f64,
    /// Direction of the sweep, up or down, where several motions coexist
    #[cfg_attr(feature = "cli", arg(value_name = "WAY", value_parser = crate::campaign::word::<Direction>))]
    pub history: Option<Direction>,
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names =
        Names::Numbered(&["rungs", "springs", "sensitivity", "stretches", "points", "ladder"]);

    /// The chosen rung, at one frequency or over a range of frequencies, with its reasons.
    ///
    /// # Errors
    /// If the scene or a key is impossible, or nothing drives the rig.
    pub fn answer(&self) -> Result<Answer> {
        let question = Question {
            observable: self.observable,
            tolerance: self.tolerance,
            noise: self.noise_floor,
            gap_std: self.gap_std,
            history: self.history,
        };
        question.check()?;
        let Driven { scene, excitation, findings } =
            self.scene.driven_with_springs(self.frequency.or(self.from))?;
        let mut answer = Answer::of(&json!({ "scene": scene }))?;
        if let Value::Object(asked) = json!(question) {
            answer.result.extend(asked);
        }
        answer.add("", findings);
        if let Some((from, to)) = self.from.zip(self.to) {
            over_range(&choose_over(&scene, from, to, self.points, &question)?, &question, &mut answer)?;
            return Ok(answer);
        }
        let frequency = self.frequency.unwrap_or(excitation.frequency());
        if frequency.is_nan() {
            let expected = "a frequency, or from and to for an axis";
            return Err(Error::usage("no frequency", expected).setting("frequency"));
        }
        at_one_frequency(&choose(&scene, frequency, &question)?, &question, &mut answer)?;
        Ok(answer)
    }
}

/// Adds the choice at one frequency to an answer.
fn at_one_frequency(choice: &Choice, question: &Question, answer: &mut Answer) -> Result<()> {
    answer.result.extend(Answer::of(&WordedChoice::of(choice))?.result);
    answer.add("", &choice.findings);
    answer.table("rungs", rungs(choice, question));
    if !choice.springs.is_empty() {
        answer.table("springs", springs(&choice.springs, choice.springs_together));
    }
    if !choice.sensitivity.is_empty() {
        answer.table("sensitivity", sensitivity(&choice.sensitivity, question));
    }
    answer.tables.push(table(
        "Reasons",
        verdicts(choice),
        &[
            ("model", "", &|(names, ..)| names.as_str().into()),
            ("result", "", &|(_, verdict, _)| (*verdict).into()),
            ("reason", "", &|(.., why)| why.as_str().into()),
        ],
    ));
    Ok(())
}

/// Adds the choices over a range of frequencies to an answer.
fn over_range(survey: &Survey, question: &Question, answer: &mut Answer) -> Result<()> {
    let points = survey.points.len();
    let why =
        |of: &Summary| format!("Valid at {} and chosen at {} of {points} points.", of.valid_at, of.chosen_at);
    let rungs: Vec<_> = survey.rungs.iter().map(|rung| RungReason { rung, why: why(rung) }).collect();
    let worded: Vec<WordedChoice> = survey.points.iter().map(WordedChoice::of).collect();
    let found = json!({
        "chosen": survey.chosen, "rungs": rungs, "stretches": survey.stretches, "points": worded,
    });
    answer.result.extend(Answer::of(&found)?.result);
    // Each code once: with its first frequency and its number of frequencies.
    let all = || survey.points.iter().flat_map(|c| c.findings.iter().map(move |f| (c.frequency, f)));
    let mut seen: Vec<&str> = Vec::new();
    for (first, finding) in all().filter(|(_, f)| f.severity() != Severity::Note) {
        if !seen.contains(&finding.code.as_ref()) {
            seen.push(finding.code.as_ref());
            let n = all().filter(|(_, f)| f.code == finding.code).count();
            let first = significant(first, 6);
            answer.add(&format!("At {n} of {points} frequencies, first at {first} Hz"), [finding]);
        }
    }
    answer.add(
        "",
        [match survey.chosen {
            Some(model) => Finding::note("rung-for-all").name("model", model.name()),
            None => Finding::note("no-rung-for-all"),
        }],
    );
    answer.table("stretches", stretches(&survey.stretches));
    answer.table("rungs", summaries(survey));
    answer.csv("points", &chosen(&survey.points, question));
    answer.figure("ladder", figures::ladder(survey, question)?);
    Ok(())
}

/// Reasons why a rung is valid for its scene, or not.
fn why(rung: &Rung) -> String {
    let refused = rung.refused.as_ref().map(|why| format!("Not computed: {why}."));
    let reasons = rung.reasons.iter().map(|reason| sentence(reason, Voice::Command));
    refused.into_iter().chain(reasons).collect::<Vec<String>>().join(" ")
}

/// Rungs up to the chosen one, grouped by equal result and reason: names, result, reason.
fn verdicts(choice: &Choice) -> Vec<(String, &'static str, String)> {
    let top = choice.chosen.map_or(choice.rungs.len(), |model| model as usize + 1);
    let groups = choice.rungs[..top].chunk_by(|a, b| (a.valid, why(a)) == (b.valid, why(b)));
    groups
        .map(|rungs| {
            let names: Vec<&str> = rungs.iter().map(|r| r.model.name()).collect();
            let verdict = match rungs[0].valid {
                _ if choice.chosen == Some(rungs[0].model) => "chosen",
                true => "valid",
                false => "not valid",
            };
            (names.join(", "), verdict, why(&rungs[0]))
        })
        .collect()
}

/// A rung with the reasons why it is valid or not, in words.
#[derive(Serialize)]
struct RungReason<'a, T> {
    #[serde(flatten)]
    rung: &'a T,
    why: String,
}

/// A choice with its reasons in words. Its `rungs` replace those of `choice`, which have no words.
#[derive(Serialize)]
struct WordedChoice<'a> {
    #[serde(flatten)]
    choice: &'a Choice,
    rungs: Vec<RungReason<'a, Rung>>,
    reasons: Vec<String>,
}

impl WordedChoice<'_> {
    /// The choice with its reasons.
    fn of(choice: &Choice) -> WordedChoice<'_> {
        let rungs =
            verdicts(choice).into_iter().map(|(names, verdict, why)| format!("{names}: {verdict}. {why}"));
        let found: Vec<_> = choice.findings.iter().map(|f| (String::new(), f.clone())).collect();
        WordedChoice {
            choice,
            rungs: choice.rungs.iter().map(|rung| RungReason { rung, why: why(rung) }).collect(),
            reasons: rungs.chain(sentences(&found, Voice::Command, true)).collect(),
        }
    }
}

/// A ratio in %.
fn percent(part: Option<f64>) -> Cell {
    part.map(|p| 100.0 * p).into()
}

/// Adds columns with the answer of each row: one column for both masses, or one for each.
fn answered(mut table: Table, question: &Question, answers: impl Iterator<Item = Option<[f64; 2]>>) -> Table {
    let heads: &[&str] =
        if question.observable.is_of_impacts() { &["answer"] } else { &["answer, x1", "answer, x2"] };
    for name in heads {
        table = table.column(*name, question.observable.unit());
    }
    for (row, answer) in table.rows.iter_mut().zip(answers) {
        row.extend((0..heads.len()).map(|mass| Cell::from(answer.map(|a| a[mass]))));
    }
    table
}

/// Comparison of the rungs.
fn rungs(choice: &Choice, question: &Question) -> Table {
    let worst = |r: &Rung| r.changes.iter().copied().max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()));
    let found = table(
        "Models compared",
        &choice.rungs,
        &[
            ("model", "", &|r| r.model.name().into()),
            ("valid", "", &|r| r.valid.into()),
            ("a richer model changes the answer by", "%", &|r| percent(worst(r).map(|c| c.change))),
            ("against model", "", &|r| worst(r).map(|c| c.at.name()).into()),
            ("chosen", "", &|r| (choice.chosen == Some(r.model)).into()),
            ("time in µs", "", &|r| r.cost_ns.map(|t| t / 1000.0).into()),
        ],
    );
    answered(found, question, choice.rungs.iter().map(|r| r.answer))
}

/// Effect of the curvature of the springs.
fn springs(all: &[Curvature], together: Option<MassChange>) -> Table {
    let change = |change: Option<MassChange>| percent(change.map(|c| c.change.change));
    let mass = |change: Option<MassChange>| Cell::from(change.and_then(|c| c.mass).map(usize::from));
    let enough = |change: Option<MassChange>| Cell::from(change.map(|c| c.change.enough));
    let mut table = table(
        "Curvature of the springs",
        all,
        &[
            ("spring", "", &|s| usize::from(s.spring).into()),
            ("amplitude", "m", &|s| s.amplitude.into()),
            ("natural frequency shifts by", "%", &|s| percent(s.shift)),
            ("answer changes by", "%", &|s| change(s.change)),
            ("of mass", "", &|s| mass(s.change)),
            ("within the tolerance", "", &|s| enough(s.change)),
        ],
    );
    if together.is_some() {
        let none = || Cell::from(None::<f64>);
        table.push(["1 and 2".into(), none(), none(), change(together), mass(together), enough(together)]);
    }
    table
}

/// The answer as a function of an unknown contact stiffness.
fn sensitivity(rows: &[Sensitivity], question: &Question) -> Table {
    let found = table(
        "Answer over the contact stiffness",
        rows,
        &[
            ("contact stiffness in N/m", "", &|r| r.stiffness.into()),
            ("in contact", "% of the cycle", &|r| percent(Some(r.share))),
            ("answer changes by", "%", &|r| percent(Some(r.change))),
            ("within the tolerance", "", &|r| r.enough.into()),
        ],
    );
    answered(found, question, rows.iter().map(|r| Some(r.answer)))
}

/// What a choice needs, in words.
fn needed(needs: &[Need]) -> Cell {
    (!needs.is_empty()).then(|| Need::names(needs)).into()
}

/// Chosen rung by frequency range.
fn stretches(stretches: &[Stretch]) -> Table {
    table(
        "Simplest adequate model, by frequency range",
        stretches,
        &[
            ("from", "Hz", &|s| s.from.into()),
            ("to", "Hz", &|s| s.to.into()),
            ("frequencies tried", "", &|s| s.points.into()),
            ("simplest model", "", &|s| s.chosen.map(Model::name).into()),
            ("needs", "", &|s| needed(&s.needs)),
            ("a richer model changes the answer by up to", "%", &|s| percent(s.audit.map(|a| a.change))),
            ("against model", "", &|s| s.audit.map(|a| a.at.name()).into()),
            ("largest change at", "Hz", &|s| s.worst_at.into()),
        ],
    )
}

/// Explanation of the table of a campaign.
const NOTE: &str = "The models are compared at evenly spaced frequencies, not at the measured points. No model (–): state what it needs.";

/// Adequate model by frequency range along the sweeps of a campaign.
pub(crate) fn climbed(overlay: &Overlay) -> Table {
    let mut all = stretches(&[]).column("force", "N").column("direction", "");
    for rungs in &overlay.rungs {
        for mut row in stretches(&rungs.stretches).rows {
            row.extend([rungs.force.into(), rungs.direction.name().into()]);
            all.rows.push(row);
        }
    }
    all.note(NOTE)
}

/// Each rung over the whole range of frequencies.
fn summaries(survey: &Survey) -> Table {
    table(
        "Models compared",
        &survey.rungs,
        &[
            ("model", "", &|r| r.model.name().into()),
            ("valid everywhere", "", &|r| r.valid.into()),
            ("a richer model changes the answer by up to", "%", &|r| percent(r.error)),
            ("median time in µs", "", &|r| r.cost_ns.map(|t| t / 1000.0).into()),
            ("valid at", "points", &|r| r.valid_at.into()),
            ("chosen at", "points", &|r| r.chosen_at.into()),
        ],
    )
}

/// The choice at each point.
fn chosen(points: &[Choice], question: &Question) -> Table {
    let found = table(
        "Points",
        points,
        &[
            ("frequency", "Hz", &|c| c.frequency.into()),
            ("chosen", "", &|c| c.chosen.map(Model::name).into()),
            ("needs", "", &|c| needed(&c.needs)),
            ("a richer model changes the answer by", "%", &|c| percent(c.audit.map(|a| a.change))),
            ("against model", "", &|c| c.audit.map(|a| a.at.name()).into()),
        ],
    );
    answered(found, question, points.iter().map(Choice::answer))
}
