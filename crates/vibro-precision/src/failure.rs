//! Failure maps: the outcome of each method at the borders of its domain, such as grazing or no damping.

use super::Family;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use vibro_record::Error;

/// Outcome of a method at a border, by comparison with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The answer agrees with the truth within what the method states, or what the check allows.
    Right,
    /// No answer, or one that the method itself withholds or doubts; with the reason.
    Refused,
    /// An answer with an error beyond what it states or the check allows, without a warning.
    Wrong,
    /// No answer within the budget of steps.
    Stalled,
    /// It panicked.
    Crashed,
    /// Not tested: the method answers another kind of question, or the truth is unknown; with the reason.
    #[serde(rename = "not asked")]
    NotAsked,
}

impl Outcome {
    /// Its name.
    pub fn name(self) -> &'static str {
        ["right", "refused", "wrong", "stalled", "crashed", "not asked"][self as usize]
    }
}

/// The outcome of one method at one scene of a border.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BorderCell {
    /// Kind of method.
    pub family: Family,
    /// Name of the method.
    pub method: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// The border, such as `grazing`; for estimators after the quantity and a colon.
    pub border: String,
    /// The scene at the border, such as `1e-9 m`.
    pub scene: String,
    /// Outcome.
    pub outcome: Outcome,
    /// Reason for the outcome, in a sentence.
    pub why: String,
    /// For estimators: number of answers with a stated uncertainty, and number of those with an error beyond
    /// three times this uncertainty.
    #[serde(skip)]
    pub stated: [usize; 2],
}

/// The outcome of each method at each border, border by border.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FailureMap {
    /// The cells.
    pub cells: Vec<BorderCell>,
}

/// Outcome of a method at a scene of a border, with its reason.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OutcomeWithReason {
    pub outcome: Outcome,
    pub why: String,
    /// As [`BorderCell::stated`].
    pub stated: [usize; 2],
}

impl OutcomeWithReason {
    /// An outcome with its reason.
    pub fn new(outcome: Outcome, why: impl Into<String>) -> OutcomeWithReason {
        OutcomeWithReason { outcome, why: why.into(), stated: [0; 2] }
    }

    /// Right if the check `passed`, else wrong.
    pub fn right_if(passed: bool, why: String) -> OutcomeWithReason {
        OutcomeWithReason::new(if passed { Outcome::Right } else { Outcome::Wrong }, why)
    }
}

impl From<Error> for OutcomeWithReason {
    fn from(error: Error) -> OutcomeWithReason {
        OutcomeWithReason::new(Outcome::Refused, error.to_string().lines().next().unwrap_or_default())
    }
}

impl From<OutcomeWithReason> for Error {
    fn from(found: OutcomeWithReason) -> Error {
        Error::refused(found.why)
    }
}

/// One cell of a map, with the question that is still to be answered.
pub(crate) struct BorderQuestion {
    pub method: &'static str,
    pub ours: bool,
    pub border: &'static str,
    pub scene: String,
    /// Runs the method and judges its answer.
    pub answer: Box<dyn FnOnce() -> OutcomeWithReason + Send>,
}

impl FailureMap {
    /// Answers every question, in parallel on all cores.
    pub(crate) fn answered(family: Family, questions: Vec<BorderQuestion>) -> FailureMap {
        let cell = |BorderQuestion { method, ours, border, scene, answer }: BorderQuestion| {
            let panicked =
                |_| OutcomeWithReason::new(Outcome::Crashed, "it panicked, with its message printed");
            let OutcomeWithReason { outcome, why, stated } =
                catch_unwind(AssertUnwindSafe(answer)).unwrap_or_else(panicked);
            let (method, border) = (method.to_owned(), border.to_owned());
            BorderCell { family, method, ours, border, scene, outcome, why, stated }
        };
        FailureMap { cells: questions.into_par_iter().map(cell).collect() }
    }

    /// Whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cells of one family.
    pub fn of(&self, family: Family) -> FailureMap {
        FailureMap { cells: self.cells.iter().filter(|c| c.family == family).cloned().collect() }
    }

    /// One map for each quantity, which its borders name before a colon, with that name; the whole map where
    /// none does.
    pub fn parts(&self) -> Vec<(&str, FailureMap)> {
        fn split(cell: &BorderCell) -> (&str, &str) {
            cell.border.split_once(": ").unwrap_or(("", &cell.border))
        }
        let part = |cells: &[BorderCell]| {
            let short = |cell: &BorderCell| BorderCell { border: split(cell).1.to_owned(), ..cell.clone() };
            FailureMap { cells: cells.iter().map(short).collect() }
        };
        let parts = self.cells.chunk_by(|a, b| split(a).0 == split(b).0);
        parts.map(|cells| (split(&cells[0]).0, part(cells))).collect()
    }

    /// Names of the methods, in the order of their first cells.
    pub fn methods(&self) -> Vec<&str> {
        let mut seen = HashSet::new();
        self.cells.iter().map(|c| c.method.as_str()).filter(|name| seen.insert(*name)).collect()
    }

    /// The cells of this library's methods with a forbidden outcome: wrong, stalled or crashed.
    pub fn broken(&self) -> impl Iterator<Item = &BorderCell> {
        let bad = [Outcome::Wrong, Outcome::Stalled, Outcome::Crashed];
        self.cells.iter().filter(move |c| c.ours && bad.contains(&c.outcome))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_cell() {
        let question = |scene: &str, answer: Box<dyn FnOnce() -> OutcomeWithReason + Send>| BorderQuestion {
            method: "one",
            ours: true,
            border: "panics",
            scene: scene.to_owned(),
            answer,
        };
        let right = question("answers", Box::new(|| OutcomeWithReason::new(Outcome::Right, "")));
        let wrong = question("panics", Box::new(|| panic!("on purpose")));
        let map = FailureMap::answered(Family::Models, vec![right, wrong]);
        let outcomes: Vec<_> = map.cells.iter().map(|c| c.outcome).collect();
        assert_eq!(outcomes, [Outcome::Right, Outcome::Crashed]);
        assert_eq!(map.broken().count(), 1);
    }
}
