//! What methods do at the borders of what they can.

use serde::{Deserialize, Serialize};

use super::Family;

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

/// One method at one scene of a border.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the method.
    pub method: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// The border, such as `grazing velocity`.
    pub border: String,
    /// The scene at it, such as `1e-9 m`.
    pub scene: String,
    /// What came.
    pub outcome: Outcome,
    /// By what that was decided, in a sentence.
    pub why: String,
}

/// What each method did at each border.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailureMap {
    /// Which kind of method.
    pub family: Family,
    /// The cells, border by border.
    pub cells: Vec<Cell>,
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

impl FailureMap {
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

    /// The map of each quantity, which its borders name before a colon, with that name; the whole where none does.
    pub fn parts(&self) -> Vec<(&str, FailureMap)> {
        let mut parts: Vec<(&str, FailureMap)> = Vec::new();
        for cell in &self.cells {
            let (quantity, border) = cell.border.split_once(": ").unwrap_or(("", &cell.border));
            let cell = Cell { border: border.to_owned(), ..cell.clone() };
            match parts.iter_mut().find(|p| p.0 == quantity) {
                Some(part) => part.1.cells.push(cell),
                None => parts.push((quantity, FailureMap { family: self.family, cells: vec![cell] })),
            }
        }
        parts
    }

    /// The cells of this library's methods that should not be: wrong, stalled or crashed.
    pub fn broken(&self) -> impl Iterator<Item = &Cell> {
        let bad = [Outcome::Wrong, Outcome::Stalled, Outcome::Crashed];
        self.cells.iter().filter(move |c| c.ours && bad.contains(&c.outcome))
    }
}
