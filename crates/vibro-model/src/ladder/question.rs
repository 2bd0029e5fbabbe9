//! What is asked of a model, what it answers, and how far that is from another model's answer.

use super::Model;
use crate::least::{NumberRange, number};
use crate::observable::Observable;
use serde::Serialize;
use vibro_record::{Direction, Error, Result};

/// Readings of followed motions err by some 4e-6 of themselves, and are taken as settled at a fiftieth of the
/// tolerance.
const FINEST: f64 = 1e-4;
/// A mass that moves less than this part of what the other does is not measured by its own motion.
const STILL: f64 = 1e-3;
/// Standard errors by which a change between two rungs may be due to means over motions that do not repeat.
const SAME: f64 = 2.0;
/// Standard errors beyond which two means are of two motions. Of a normal distribution less than e^{−z²/2}
/// lies farther than z on either side; a search compares some thirty pairs, so that one motion is taken for
/// two in 1 % of the searches at most.
pub const APART: f64 = 4.0;

/// What is looked at, and how exactly it is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Question {
    /// What is looked at.
    pub observable: Observable,
    /// Relative change of it that does not matter.
    pub tolerance: f64,
    /// Change of it that does not matter, in its own unit: the noise floor of the measurement.
    pub noise: f64,
    /// Standard uncertainty of the gap in m: a motion in closed form must be farther than this from grazing.
    pub gap_std: f64,
    /// Which way the frequency came, for where several motions are possible.
    pub history: Option<Direction>,
}

impl Question {
    /// Two percent, no noise, a gap that is known, no history.
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

/// How far an answer moves at another rung.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// The other rung.
    pub at: Model,
    /// Its answer less this one, over this one: of the mass for which that is the larger against what is
    /// allowed. For a mass that moves less than a thousandth of what the other does, over the largest of
    /// all answers.
    pub change: f64,
    /// Whether that is no more than the tolerance, the noise floor or what the answers themselves are
    /// uncertain by allow; never where one of them comes from a motion that has not settled, or has a
    /// standard error above tolerance and noise floor.
    pub enough: bool,
}

/// An answer of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Of x₁ and x₂.
    pub value: [f64; 2],
    /// Its standard error.
    pub spread: [f64; 2],
    /// Whether the motion that it was read from had settled, or has means that are steady. Else the answer
    /// may be any.
    pub steady: bool,
}

impl Answer {
    /// An answer without an error of its own.
    pub fn exact(value: [f64; 2]) -> Answer {
        Answer { value, spread: [0.0; 2], steady: true }
    }

    /// The largest ratio of its standard error to the tolerance or the noise floor, whichever allows more.
    pub fn unsure(&self, question: &Question) -> f64 {
        let largest = self.value[0].abs().max(self.value[1].abs());
        let part = |i: usize| {
            let scale = self.value[i].abs().max(STILL * largest);
            let ratio = self.spread[i] / (question.tolerance * scale).max(question.noise);
            if self.spread[i] > 0.0 { ratio } else { 0.0 }
        };
        part(0).max(part(1))
    }

    /// Whether it comes from a motion that has settled, or is a mean that is known as exactly as is asked
    /// for.
    pub fn known(&self, question: &Question) -> bool {
        self.steady && self.unsure(question) <= 1.0
    }

    /// Whether `other` may be an answer of the same motion: of both masses no farther off than tolerance,
    /// noise floor or this many standard errors allow.
    pub fn agrees(&self, other: &Answer, question: &Question, errors: f64) -> bool {
        self.farthest(other, question, errors).is_none_or(|(ratio, _)| ratio <= 1.0)
    }

    /// How far it moves to `other`, the answer of the rung `at`.
    pub fn change(&self, other: &Answer, at: Model, question: &Question) -> Change {
        // What is hardly known bears nothing out. Nor does a motion on its way somewhere widen what is
        // allowed.
        let known = self.known(question) && other.known(question);
        let (ratio, change) =
            self.farthest(other, question, if known { SAME } else { 0.0 }).unwrap_or_default();
        Change { at, change, enough: known && ratio <= 1.0 }
    }

    /// The change to `other` over what is allowed, and the relative change, of the mass for which the first
    /// is larger; `None` where neither moves. So many standard errors are allowed.
    fn farthest(&self, other: &Answer, question: &Question, errors: f64) -> Option<(f64, f64)> {
        let largest = self.value.iter().chain(&other.value).fold(0.0_f64, |l, v| l.max(v.abs()));
        let far = |i: usize| {
            let (own, moved) = (self.value[i].abs(), other.value[i] - self.value[i]);
            let unsure = errors * self.spread[i].hypot(other.spread[i]);
            let allowed = (question.tolerance * own.max(STILL * largest)).max(question.noise).max(unsure);
            // Nothing is allowed where nothing moves and something should.
            let ratio = if allowed > 0.0 { moved.abs() / allowed } else { f64::INFINITY };
            (moved != 0.0).then(|| (ratio, moved / if own < STILL * largest { largest } else { own }))
        };
        [0, 1].into_iter().filter_map(far).reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}
