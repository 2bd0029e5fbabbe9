//! What methods do at the borders of what they can.

use serde::Serialize;

use super::Family;

/// What a method did at a border, told with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The answer agrees with the truth within what the method states, or what the check allows.
    Right,
    /// No answer, and the reason is told.
    Refused,
    /// An answer that is wrong without a word.
    Wrong,
    /// No answer within the budget of steps or time.
    Stalled,
    /// It panicked.
    Crashed,
}

/// One method at one scene of a border.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
