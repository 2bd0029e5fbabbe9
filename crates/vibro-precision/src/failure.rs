//! What methods do at the borders of what they can.

use super::Family;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use vibro_record::{Error, Result};

/// What a method did at a border, told with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The answer agrees with the truth within what the method states, or what the check allows.
    Right,
    /// No answer, or none that claims to be one, and the reason is told.
    Refused,
    /// An answer further off than it allows for, without a word on what is wrong.
    Wrong,
    /// No answer within the budget of steps or time.
    Stalled,
    /// It panicked.
    Crashed,
    /// The scene is not asked of it, or its truth is not known; the reason is told.
    #[serde(rename = "not asked")]
    NotAsked,
}

impl Outcome {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Right => "right",
            Outcome::Refused => "refused",
            Outcome::Wrong => "wrong",
            Outcome::Stalled => "stalled",
            Outcome::Crashed => "crashed",
            Outcome::NotAsked => "not asked",
        }
    }
}

/// One method at one scene of a border.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Which kind of method.
    pub family: Family,
    /// Name of the method.
    pub method: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// The border, such as `grazing`, of estimators behind the quantity and a colon.
    pub border: String,
    /// The scene at it, such as `1e-9 m`.
    pub scene: String,
    /// What came.
    pub outcome: Outcome,
    /// By what that was decided, in a sentence.
    pub why: String,
    /// Of estimators the answers that were held to the uncertainty that they state, and those that lie beyond three of it.
    #[serde(skip)]
    pub held: [usize; 2],
}

/// What each method did at each border, border by border.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FailureMap {
    /// The cells.
    pub cells: Vec<Cell>,
}

/// What came of a question.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    pub outcome: Outcome,
    pub why: String,
    pub held: [usize; 2],
}

impl Found {
    pub fn new(outcome: Outcome, why: impl Into<String>) -> Found {
        Found { outcome, why: why.into(), held: [0; 2] }
    }

    /// Right where `kept`, wrong otherwise.
    pub fn right_if(kept: bool, why: String) -> Found {
        Found::new(if kept { Outcome::Right } else { Outcome::Wrong }, why)
    }
}

impl From<Error> for Found {
    fn from(error: Error) -> Found {
        Found::new(Outcome::Refused, error.to_string().lines().next().unwrap_or_default())
    }
}

impl From<Found> for Error {
    fn from(found: Found) -> Error {
        Error::refused(found.why)
    }
}

/// One cell of a map, still to be asked for.
pub(crate) struct Question {
    pub method: &'static str,
    pub ours: bool,
    pub border: &'static str,
    pub scene: String,
    pub ask: Box<dyn FnOnce() -> Found + Send>,
}

/// Time that a cell may take, on a machine that does other things, too: right ones take less than a tenth of it.
const PATIENCE: Duration = Duration::from_secs(60);

impl FailureMap {
    /// Asks every question, as many side by side as there are cores.
    pub(crate) fn asked(family: Family, questions: Vec<Question>) -> Result<FailureMap> {
        // Not the global pool: a method may use that itself while a thread here waits for it.
        let pool = rayon::ThreadPoolBuilder::new().build().map_err(|e| Error::refused(e.to_string()))?;
        let cell = |question: Question| {
            let Question { method, ours, border, scene, ask } = question;
            let Found { outcome, why, held } = watched(ask, PATIENCE);
            let (method, border) = (method.to_owned(), border.to_owned());
            Cell { family, method, ours, border, scene, outcome, why, held }
        };
        Ok(FailureMap { cells: pool.install(|| questions.into_par_iter().map(cell).collect()) })
    }

    /// Whether nothing was asked.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cells of one family.
    pub fn of(&self, family: Family) -> FailureMap {
        FailureMap { cells: self.cells.iter().filter(|c| c.family == family).cloned().collect() }
    }

    /// The map of each quantity, which its borders name before a colon, with that name; the whole where none does.
    pub fn parts(&self) -> Vec<(&str, FailureMap)> {
        let mut parts: Vec<(&str, FailureMap)> = Vec::new();
        for cell in &self.cells {
            let (quantity, border) = cell.border.split_once(": ").unwrap_or(("", &cell.border));
            let cell = Cell { border: border.to_owned(), ..cell.clone() };
            match parts.last_mut() {
                Some(part) if part.0 == quantity => part.1.cells.push(cell),
                _ => parts.push((quantity, FailureMap { cells: vec![cell] })),
            }
        }
        parts
    }

    /// Names of the methods, in the order in which they come.
    pub fn methods(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for cell in &self.cells {
            if !names.contains(&cell.method.as_str()) {
                names.push(&cell.method);
            }
        }
        names
    }

    /// The cells of this library's methods that should not be: wrong, stalled or crashed.
    pub fn broken(&self) -> impl Iterator<Item = &Cell> {
        let bad = [Outcome::Wrong, Outcome::Stalled, Outcome::Crashed];
        self.cells.iter().filter(move |c| c.ours && bad.contains(&c.outcome))
    }
}

/// What a question comes to on a thread of its own; one that does not end is left to itself.
fn watched(ask: Box<dyn FnOnce() -> Found + Send>, patience: Duration) -> Found {
    let (send, receive) = channel();
    std::thread::spawn(move || send.send(ask()));
    receive.recv_timeout(patience).unwrap_or_else(|ended| match ended {
        RecvTimeoutError::Timeout => Found::new(Outcome::Stalled, format!("no answer within {patience:?}")),
        RecvTimeoutError::Disconnected => {
            Found::new(Outcome::Crashed, "it panicked, with its message printed")
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_panics_and_what_does_not_end_are_told_apart() {
        let outcome =
            |ask: Box<dyn FnOnce() -> Found + Send>, ms: u64| watched(ask, Duration::from_millis(ms)).outcome;
        let right = || Found::new(Outcome::Right, "");
        assert_eq!(outcome(Box::new(right), 10_000), Outcome::Right);
        assert_eq!(outcome(Box::new(|| panic!("on purpose")), 10_000), Outcome::Crashed);
        let wait = move || {
            std::thread::sleep(Duration::from_secs(1));
            right()
        };
        assert_eq!(outcome(Box::new(wait), 10), Outcome::Stalled);
    }

    #[test]
    fn what_is_watched_may_use_the_threads_that_the_map_does_not_hold() {
        let question = |i: usize| Question {
            method: "sum",
            ours: true,
            border: "threads",
            scene: i.to_string(),
            ask: Box::new(move || {
                let sum = (0..1000_u64).into_par_iter().sum::<u64>();
                Found::right_if(sum == 499_500, String::new())
            }),
        };
        let map = FailureMap::asked(Family::Models, (0..20).map(question).collect()).unwrap();
        assert_eq!(map.cells.len(), 20);
        assert!(
            map.cells
                .iter()
                .enumerate()
                .all(|(i, c)| c.scene == i.to_string() && c.outcome == Outcome::Right)
        );
    }
}
