//! The ladder of models as tables.

use crate::compare::{Overlay, Rungs};
use crate::model::ladder::{Choice, Known, Need, Question, Rung, Sensitivity, Stretch, Summary, Survey};
use crate::report::layout::table;
use crate::report::words::{Voice, sentence};
use crate::report::{Cell, Table};

fn word(yes: bool) -> Cell {
    Cell::from(if yes { "yes" } else { "no" })
}

fn percent(part: Option<f64>) -> Cell {
    part.map(|p| 100.0 * p).into()
}

/// Heads of an answer: one for both masses, or one for each.
fn heads(question: &Question) -> &'static [(&'static str, usize)] {
    if question.observable.is_of_impacts() {
        &[("answer", 0)]
    } else {
        &[("answer, x1", 0), ("answer, x2", 1)]
    }
}

/// Adds the columns of an answer to a table that has a row for each of these.
fn answered(mut table: Table, question: &Question, answers: impl Iterator<Item = Option<[f64; 2]>>) -> Table {
    for (name, _) in heads(question) {
        table = table.column(*name, question.observable.unit());
    }
    for (row, answer) in table.rows.iter_mut().zip(answers) {
        row.extend(heads(question).iter().map(|(_, mass)| Cell::from(answer.map(|a| a[*mass]))));
    }
    table
}

/// What was found of each rung.
pub fn rungs(choice: &Choice, question: &Question) -> Table {
    let worst = |r: &Rung| r.changes.iter().copied().max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()));
    let found = table(
        "Rungs",
        &choice.rungs,
        &[
            ("rung", "", &|r| Cell::from(r.model.name())),
            ("valid", "", &|r| word(r.valid)),
            ("moves by", "%", &|r| percent(worst(r).map(|c| c.change))),
            ("at", "", &|r| worst(r).map_or(Cell::Missing, |c| Cell::from(c.at.name()))),
            ("good enough", "", &|r| word(r.sufficient)),
            ("chosen", "", &|r| word(choice.chosen == Some(r.model))),
            ("time in µs", "", &|r| Cell::from(r.cost_ns.map(|t| t / 1000.0))),
        ],
    );
    answered(found, question, choice.rungs.iter().map(|r| r.answer))
}

/// Why a rung answers for its scene, or does not.
pub fn why(rung: &Rung, voice: Voice) -> String {
    let refused = rung.refused.as_ref().map(|why| format!("Not computed: {why}."));
    let reasons = rung.reasons.iter().map(|reason| sentence(reason, voice));
    refused.into_iter().chain(reasons).collect::<Vec<String>>().join(" ")
}

/// The motions that are possible at one excitation.
pub fn motions(motions: &[Known], question: &Question) -> Table {
    let found = table(
        "Motions",
        motions,
        &[
            ("impacts/cycles", "", &|m| Cell::from(m.pattern.to_string())),
            ("known by", "", &|m| Cell::from(m.model.name())),
            ("stable", "", &|m| word(m.stable)),
        ],
    );
    answered(found, question, motions.iter().map(|m| Some(m.answer)))
}

/// The answer over an unknown stiffness of the contact.
pub fn sensitivity(rows: &[Sensitivity], question: &Question) -> Table {
    let found = table(
        "Over the stiffness of the contact",
        rows,
        &[
            ("contact stiffness in N/m", "", &|r| Cell::from(r.stiffness)),
            ("in contact", "% of the cycle", &|r| percent(Some(r.share))),
            ("moves by", "%", &|r| percent(Some(r.change))),
            ("within", "", &|r| word(r.enough)),
        ],
    );
    answered(found, question, rows.iter().map(|r| Some(r.answer)))
}

/// Which rung is chosen where.
pub fn stretches(stretches: &[Stretch]) -> Table {
    table(
        "Chosen along the axis, from and to points that were asked",
        stretches,
        &[
            ("from", "Hz", &|s| Cell::from(s.from)),
            ("to", "Hz", &|s| Cell::from(s.to)),
            ("points", "", &|s| Cell::from(s.points)),
            ("chosen", "", &|s| s.chosen.map_or(Cell::Missing, |m| Cell::from(m.name()))),
            ("needs", "", &|s| {
                if s.needs.is_empty() { Cell::Missing } else { Cell::from(Need::names(&s.needs)) }
            }),
            ("moves at most by", "%", &|s| percent(s.audit.map(|a| a.change))),
            ("at rung", "", &|s| s.audit.map_or(Cell::Missing, |a| Cell::from(a.at.name()))),
            ("at", "Hz", &|s| Cell::from(s.worst_at)),
        ],
    )
}

/// Which model is good enough where along the sweeps of a campaign.
pub(crate) fn climbed(overlay: &Overlay) -> Table {
    let rows: Vec<(&Rungs, &Stretch)> =
        overlay.rungs.iter().flat_map(|r| r.stretches.iter().map(move |s| (r, s))).collect();
    table(
        "The simplest model that is good enough, from and to frequencies that were asked",
        &rows,
        &[
            ("force", "N", &|(r, _)| Cell::from(r.force)),
            ("direction", "", &|(r, _)| Cell::from(r.direction.name())),
            ("from", "Hz", &|(_, s)| Cell::from(s.from)),
            ("to", "Hz", &|(_, s)| Cell::from(s.to)),
            ("model", "", &|(_, s)| s.chosen.map_or(Cell::Missing, |m| Cell::from(m.name()))),
            ("needs", "", &|(_, s)| {
                if s.needs.is_empty() { Cell::Missing } else { Cell::from(Need::names(&s.needs)) }
            }),
            ("moves at most by", "%", &|(_, s)| percent(s.audit.map(|a| a.change))),
            ("at rung", "", &|(_, s)| s.audit.map_or(Cell::Missing, |a| Cell::from(a.at.name()))),
        ],
    )
}

/// Where a rung is valid and chosen.
pub(crate) fn where_chosen(rung: &Summary, points: usize) -> String {
    format!("Valid at {} and chosen at {} of {points} points.", rung.valid_at, rung.chosen_at)
}

/// Each rung over the whole axis.
pub(crate) fn summaries(survey: &Survey) -> Table {
    table(
        "Rungs",
        &survey.rungs,
        &[
            ("rung", "", &|r| Cell::from(r.model.name())),
            ("valid everywhere", "", &|r| word(r.valid)),
            ("moves at most by", "%", &|r| percent(r.error)),
            ("median time in µs", "", &|r| Cell::from(r.cost_ns.map(|t| t / 1000.0))),
            ("where", "", &|r| Cell::from(where_chosen(r, survey.points.len()))),
        ],
    )
}

/// The choice at each point.
pub fn chosen(points: &[Choice], question: &Question) -> Table {
    let found = table(
        "Points",
        points,
        &[
            ("frequency", "Hz", &|c| Cell::from(c.frequency)),
            ("chosen", "", &|c| c.chosen.map_or(Cell::Missing, |m| Cell::from(m.name()))),
            ("needs", "", &|c| {
                if c.needs.is_empty() { Cell::Missing } else { Cell::from(Need::names(&c.needs)) }
            }),
            ("moves by", "%", &|c| percent(c.audit.map(|a| a.change))),
            ("at rung", "", &|c| c.audit.map_or(Cell::Missing, |a| Cell::from(a.at.name()))),
        ],
    );
    answered(found, question, points.iter().map(Choice::answer))
}
