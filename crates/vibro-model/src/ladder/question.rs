//! The question to a model, its answer, and the change from one model's answer to another's.

use super::Model;
use crate::least::{NumberRange, number};
use crate::observable::Observable;
use serde::Serialize;
use vibro_record::{Direction, Error, Result};

/// Smallest tolerance. Readings of simulated motions have relative errors of about 4e-6, and motions count as
/// settled at a fiftieth of the tolerance.
const FINEST: f64 = 1e-4;
/// Amplitude, relative to the largest, below which changes of a mass are related to the largest amplitude
/// instead of its own.
const STILL: f64 = 1e-3;
/// Change between two rungs that may be chance, in standard errors of means over motions that do not repeat.
const SAME: f64 = 2.0;
/// Distance, in standard errors, beyond which two means belong to two motions. A normal deviate lies outside
/// ±z with a probability below e^{−z²/2}. A search compares some thirty pairs, so one motion is taken for two
/// in at most 1 % of the searches.
pub const APART: f64 = 4.0;

/// The observable that models are compared by, and the accuracy that is needed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Question {
    /// The observable.
    pub observable: Observable,
    /// Relative change of the observable that does not matter.
    pub tolerance: f64,
    /// Change that does not matter, in the unit of the observable: the noise floor of the measurement.
    pub noise: f64,
    /// Standard uncertainty of the gap in m: a motion in closed form must be farther than this from grazing.
    pub gap_std: f64,
    /// Direction of the sweep that led to the frequency; it selects one of several coexisting motions.
    pub history: Option<Direction>,
}

impl Question {
    /// A question with a tolerance of 2 %, no noise, an exactly known gap, and no history.
    pub fn new(observable: Observable) -> Question {
        Question { observable, tolerance: 0.02, noise: 0.0, gap_std: 0.0, history: None }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// If the tolerance is outside 1e-4 to 1, or noise or uncertainty are negative or not finite.
    pub fn check(&self) -> Result<()> {
        if !(FINEST..=1.0).contains(&self.tolerance) {
            let expected = format!("a part from {FINEST} (models that are followed are not read finer) to 1");
            let error = Error::usage(format!("a tolerance of {}", self.tolerance), expected);
            return Err(error.hint("2 % is 0.02"));
        }
        number("the noise floor", self.noise, self.observable.unit(), NumberRange::Zero)?;
        number("the uncertainty of the gap", self.gap_std, "m", NumberRange::Zero)
    }
}

/// Change of an answer from one rung to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// The other rung.
    pub at: Model,
    /// Relative change, (other − this)/this, of the mass with the larger change over its allowance. For a
    /// mass with less than a thousandth of the largest answer it is relative to that answer.
    pub change: f64,
    /// Whether the change is within the tolerance, the noise floor or the standard errors of the answers.
    /// Never where one motion has not settled, or has a standard error above tolerance and noise floor.
    pub enough: bool,
    /// Number of the mass of the change; 1 where neither changes.
    #[serde(skip)]
    pub mass: u8,
}

/// An answer of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The observable of x₁ and of x₂.
    pub value: [f64; 2],
    /// Standard errors of the values.
    pub spread: [f64; 2],
    /// Whether the simulated motion had settled, or has steady means. Else the answer is not reliable.
    pub steady: bool,
}

impl Answer {
    /// An answer without a standard error.
    pub fn exact(value: [f64; 2]) -> Answer {
        Answer { value, spread: [0.0; 2], steady: true }
    }

    /// Standard error over the tolerance or the noise floor, whichever allows more; the larger ratio of both
    /// masses.
    pub fn unsure(&self, question: &Question) -> f64 {
        let largest = self.value[0].abs().max(self.value[1].abs());
        let part = |i: usize| {
            let scale = self.value[i].abs().max(STILL * largest);
            let ratio = self.spread[i] / (question.tolerance * scale).max(question.noise);
            if self.spread[i] > 0.0 { ratio } else { 0.0 }
        };
        part(0).max(part(1))
    }

    /// Whether the motion was steady and the standard error is within tolerance or noise floor.
    pub fn known(&self, question: &Question) -> bool {
        self.steady && self.unsure(question) <= 1.0
    }

    /// Whether `other` may be an answer of the same motion: for both masses the difference is within the
    /// tolerance, the noise floor or this many standard errors.
    pub fn agrees(&self, other: &Answer, question: &Question, errors: f64) -> bool {
        self.farthest(other, question, errors).is_none_or(|(ratio, ..)| ratio <= 1.0)
    }

    /// Change to `other`, the answer of the rung `at`.
    pub fn change(&self, other: &Answer, at: Model, question: &Question) -> Change {
        // An uncertain answer confirms nothing. The standard error of a motion that has not settled does not
        // widen the allowance.
        let known = self.known(question) && other.known(question);
        let (ratio, change, mass) =
            self.farthest(other, question, if known { SAME } else { 0.0 }).unwrap_or((0.0, 0.0, 1));
        Change { at, change, enough: known && ratio <= 1.0, mass }
    }

    /// Ratio of the change to its allowance, the relative change, and its mass, for the mass with the larger
    /// ratio; `None` where neither mass changes. The allowance includes `errors` standard errors.
    fn farthest(&self, other: &Answer, question: &Question, errors: f64) -> Option<(f64, f64, u8)> {
        let largest = self.value.iter().chain(&other.value).fold(0.0_f64, |l, v| l.max(v.abs()));
        let far = |i: usize| {
            let (own, moved) = (self.value[i].abs(), other.value[i] - self.value[i]);
            let unsure = errors * self.spread[i].hypot(other.spread[i]);
            let allowed = (question.tolerance * own.max(STILL * largest)).max(question.noise).max(unsure);
            // Without an allowance any change is too large.
            let ratio = if allowed > 0.0 { moved.abs() / allowed } else { f64::INFINITY };
            let change = moved / if own < STILL * largest { largest } else { own };
            (moved != 0.0).then_some((ratio, change, i as u8 + 1))
        };
        [0, 1].into_iter().filter_map(far).reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}
