//! The change of an answer from one model to another.

use super::{Model, Question};
use serde::Serialize;

/// A mass that moves less than this part of what the other does is not measured by its own motion.
const STILL: f64 = 1e-3;

/// Standard errors by which a change between two rungs may be due to means over motions that do not repeat.
const TOLD: f64 = 2.0;

/// Standard errors beyond which two means are of two motions. Of a normal distribution less than e^{−z²/2} lies farther than z on either
/// side; a search compares some thirty pairs, so that one motion is taken for two in 1 % of the searches at most.
pub const APART: f64 = 4.0;

/// How far an answer moves at another rung.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// The other rung.
    pub at: Model,
    /// Its answer less this one, over this one: of the mass for which that is the larger against what is allowed. For a mass that moves
    /// less than a thousandth of what the other does, over the largest of all answers.
    pub change: f64,
    /// Whether that is no more than the tolerance, the noise floor or what the answers themselves are uncertain by allow; never where one of
    /// them comes from a motion that has not settled, or has a standard error above tolerance and noise floor.
    pub enough: bool,
}

/// An answer of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Of x₁ and x₂.
    pub value: [f64; 2],
    /// Its standard error.
    pub spread: [f64; 2],
    /// Whether the motion that it was read from had settled, or has means that are steady. Else the answer may be any.
    pub steady: bool,
}

impl Answer {
    /// An answer without an error of its own.
    pub fn exact(value: [f64; 2]) -> Answer {
        Answer { value, spread: [0.0; 2], steady: true }
    }

    /// The largest ratio of its standard error to the tolerance or the noise floor, whichever allows more.
    pub fn unsure(&self, question: &Question) -> f64 {
        let largest = self.value.iter().fold(0.0_f64, |l, v| l.max(v.abs()));
        let part = |i: usize| {
            let scale = self.value[i].abs().max(STILL * largest);
            if self.spread[i] > 0.0 {
                self.spread[i] / (question.tolerance * scale).max(question.noise)
            } else {
                0.0
            }
        };
        part(0).max(part(1))
    }

    /// Whether `other` may be an answer of the same motion: of both masses no farther off than tolerance, noise floor or this many standard
    /// errors allow.
    pub fn agrees(&self, other: &Answer, question: &Question, errors: f64) -> bool {
        self.farthest(other, question, errors).is_none_or(|(ratio, _)| ratio <= 1.0)
    }

    /// How far it moves to `other`, the answer of the rung `at`.
    pub fn change(&self, other: &Answer, at: Model, question: &Question) -> Change {
        // What is hardly known bears nothing out. Nor does a motion on its way somewhere widen what is allowed.
        let known = [self, other].iter().all(|answer| answer.steady && answer.unsure(question) <= 1.0);
        match self.farthest(other, question, if known { TOLD } else { 0.0 }) {
            None => Change { at, change: 0.0, enough: known },
            Some((ratio, change)) => Change { at, change, enough: known && ratio <= 1.0 },
        }
    }

    /// The change to `other` over what is allowed, and the relative change, of the mass for which the first is larger; `None` where neither
    /// moves. So many standard errors are allowed.
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
