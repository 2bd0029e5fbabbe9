//! What became of a rung, and what is said of a motion that was followed.

use super::change::Answer;
use super::motions::Motions;
use super::reading::{End, Reading};
use crate::Regime;
use vibro_record::{Error, Finding};

/// What became of a rung.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    pub valid: bool,
    pub answer: Option<Answer>,
    /// Time in ns that it took.
    pub cost: Option<f64>,
    /// The error that left it without an answer.
    pub refused: Option<String>,
    pub reasons: Vec<Finding>,
    /// What the rig comes to from rest, where its answer is followed from elsewhere.
    pub from_rest: Option<Reading>,
}

impl Outcome {
    /// A rung that says nothing about the scene.
    pub fn not(reason: Finding) -> Outcome {
        Outcome { reasons: vec![reason], ..Outcome::default() }
    }

    /// A rung that cannot be computed.
    pub fn refused(error: &Error) -> Outcome {
        Outcome { refused: error.to_string().lines().next().map(str::to_owned), ..Outcome::default() }
    }

    /// What was read of a motion, with how it was read after other reasons.
    pub fn read(reading: &Reading, cost: f64, mut reasons: Vec<Finding>) -> Outcome {
        reasons.push(how(reading));
        let (answer, cost) = (Some(reading.answer), Some(cost));
        Outcome { valid: true, answer, cost, reasons, ..Outcome::default() }
    }
}

/// The motion that the rig is in, and how that is known.
pub fn into(motions: &Motions) -> Finding {
    let reading = &motions.reading;
    let found = match (reading.end, motions.way.is_some()) {
        (End::Under, true) => Finding::caution("way-not-settled"),
        (End::Under, false) => Finding::caution("rest-not-settled"),
        (_, true) => Finding::note("way-leads-to"),
        (_, false) => Finding::note("rest-leads-to"),
    };
    found.name("motion", pattern(reading)).count("cycles", reading.cycles as usize)
}

/// The motion read: its regime, or `lasting contact`.
pub fn pattern(reading: &Reading) -> String {
    match reading.end {
        End::Pressed => "lasting contact".to_owned(),
        _ if reading.regime == Regime::NoImpact => "no impact".to_owned(),
        _ => reading.regime.to_string(),
    }
}

/// How the reading was made.
fn how(reading: &Reading) -> Finding {
    let found = match reading.end {
        End::Settled | End::Pressed => Finding::note("settled"),
        End::Under => Finding::caution("not-settled"),
        End::Steady => {
            let Answer { value, spread, .. } = reading.answer;
            let part = |i: usize| if value[i] == 0.0 { 0.0 } else { spread[i] / value[i].abs() };
            Finding::note("mean-of-cycles").number("error", part(0).max(part(1)))
        }
    };
    found.count("cycles", reading.cycles as usize)
}
