//! What became of a rung, and the sentences that several rungs share.

use super::change::Answer;
use super::cost::Cost;
use super::motions::Motions;
use super::reading::{End, Reading};
use super::reasons::UNSETTLED;
use crate::Regime;
use vibro_record::Error;
use vibro_record::units::notation::significant;

/// What became of a rung.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tried {
    pub valid: bool,
    pub answer: Option<Answer>,
    pub cost: Option<Cost>,
    pub why: String,
    /// What the rig comes to from rest, where its answer is followed from elsewhere.
    pub from_rest: Option<Reading>,
}

impl Tried {
    pub fn not(why: impl Into<String>) -> Tried {
        Tried { why: why.into(), ..Tried::default() }
    }

    /// The first line of an error, as a sentence.
    pub fn refused(error: &Error) -> Tried {
        Tried::not(capital(error.to_string().lines().next().unwrap_or_default()))
    }
}

/// The motion that the rig is in, and how that is known.
pub fn into(motions: &Motions) -> String {
    let reading = &motions.reading;
    match (reading.end, motions.way.is_some()) {
        (End::Under, true) => {
            format!("coming that way it has not settled within {} cycles", reading.cycles)
        }
        (End::Under, false) => format!("from rest it has not settled within {} cycles", reading.cycles),
        (_, true) => format!("coming that way it is in {}", pattern(reading)),
        (_, false) => format!("from rest it settles into {}", pattern(reading)),
    }
}

/// The motion read, in words.
pub fn pattern(reading: &Reading) -> String {
    match reading.regime {
        _ if reading.end == End::Pressed => "a motion in which the masses stay in contact".to_owned(),
        Regime::Periodic { impacts, cycles } => {
            format!("a motion with {impacts} impact(s) in {cycles} cycle(s)")
        }
        Regime::NoImpact => "the motion without impacts".to_owned(),
        Regime::Chatter { .. } => {
            "a motion in which the masses chatter to rest against each other".to_owned()
        }
        Regime::Irregular => "a motion in which no pattern repeats".to_owned(),
    }
}

/// How the reading was made.
pub fn told(reading: &Reading) -> String {
    let cycles = reading.cycles;
    match reading.end {
        End::Settled | End::Pressed => format!("Settled within {cycles} cycles."),
        End::Steady => {
            let Answer { value, spread, .. } = reading.answer;
            let part = |i: usize| if value[i] == 0.0 { 0.0 } else { spread[i] / value[i].abs() };
            format!(
                "The answer is the mean over the second half of {cycles} cycles, with a standard error of {} %.",
                significant(100.0 * part(0).max(part(1)), 2)
            )
        }
        End::Under => {
            format!(
                "{UNSETTLED} within {cycles} cycles: the answer is a mean on the way, and may be any in the end."
            )
        }
    }
}

/// As a sentence.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect::<String>() + ".")
}
