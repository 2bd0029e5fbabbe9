//! Number of random cases in a test: a few in the quick tests, all in the long ones.

use std::ops::RangeInclusive;

/// Cases of a quick test.
const FEW: u64 = 4;

/// Limit of the errors of a few cases, in standard uncertainties: one error of two million exceeds it.
const FAR: f64 = 5.0;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Draws {
    /// A few cases: every truth lies within [`FAR`] standard uncertainties.
    Few,
    /// All cases: the share of intervals that hold the truth.
    All,
}

impl Draws {
    /// Number of cases to draw of `all`.
    pub fn of(self, all: u64) -> u64 {
        match self {
            Draws::Few => all.min(FEW),
            Draws::All => all,
        }
    }

    /// Half-width of the tested intervals in standard uncertainties.
    pub fn reach(self) -> f64 {
        match self {
            Draws::Few => FAR,
            Draws::All => 1.96,
        }
    }

    /// Allowed share of these intervals that hold the truth; `all` is the share for 95 % intervals.
    pub fn part(self, all: RangeInclusive<f64>) -> RangeInclusive<f64> {
        match self {
            Draws::Few => 1.0..=1.0,
            Draws::All => all,
        }
    }
}

/// Fails if the largest error of a few cases exceeds [`FAR`] standard uncertainties.
pub fn none_far(what: &str, worst: f64) {
    assert!(worst <= FAR, "{what}: {worst} standard uncertainties off");
}
