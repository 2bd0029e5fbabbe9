//! How many random cases a test draws: a few in the quick ones, all in the long ones.

use std::ops::RangeInclusive;

/// Cases of a quick test.
const FEW: u64 = 4;

/// Standard uncertainties that no error of a few cases may exceed: one of two million does.
const FAR: f64 = 5.0;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Draws {
    /// That no truth lies far outside.
    Few,
    /// The statistic.
    All,
}

impl Draws {
    /// How many of so many cases.
    pub fn of(self, all: u64) -> u64 {
        match self {
            Draws::Few => all.min(FEW),
            Draws::All => all,
        }
    }

    /// Half the width of the interval that is looked at, in standard uncertainties.
    pub fn reach(self) -> f64 {
        match self {
            Draws::Few => FAR,
            Draws::All => 1.96,
        }
    }

    /// The part of these intervals that must hold the truth, where it is `all` of the narrow ones.
    pub fn part(self, all: RangeInclusive<f64>) -> RangeInclusive<f64> {
        match self {
            Draws::Few => 1.0..=1.0,
            Draws::All => all,
        }
    }
}

/// Fails where the largest error of a few cases is far outside of its uncertainty.
pub fn none_far(what: &str, worst: f64) {
    assert!(worst <= FAR, "{what}: {worst} standard uncertainties off");
}
