//! What is asked of a model.

use crate::Observable;
use serde::Serialize;
use vibro_record::{Direction, Error, Result};

/// Readings of followed motions err by some 4e-6 of themselves, and are taken as settled at a fiftieth of the tolerance.
const FINEST: f64 = 1e-4;

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
            return Err(
                Error::usage(format!("a tolerance of {}", self.tolerance), expected).hint("2 % is 0.02")
            );
        }
        for (name, value, unit) in [
            ("a noise floor", self.noise, self.observable.unit()),
            ("an uncertainty of the gap", self.gap_std, "m"),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                let found = format!("{name} of {value} {unit}");
                return Err(Error::usage(found, "a finite value of 0 or more"));
            }
        }
        Ok(())
    }
}
