//! What a number of a rig or an excitation may be.

use vibro_record::{Error, Result};

/// What a number may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberRange {
    Any,
    Zero,
    AboveZero,
    /// From 0 to 1.
    Part,
}

/// Checks that a number is finite, and not too small.
///
/// # Errors
/// If it is not.
pub fn number(name: &str, value: f64, unit: &str, least: NumberRange) -> Result<()> {
    let (fine, expected) = match least {
        NumberRange::Any => (true, "a finite value"),
        NumberRange::Zero => (value >= 0.0, "a finite value of 0 or more"),
        NumberRange::AboveZero => (value > 0.0, "a finite value above 0"),
        NumberRange::Part => ((0.0..=1.0).contains(&value), "a value from 0 to 1"),
    };
    if fine && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{name} is {value} {unit}").trim_end(), expected))
}
