//! Allowed ranges of the numbers of a rig or an excitation, and their check.

use vibro_record::{Error, Result};

/// Allowed range of a finite number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberRange {
    Any,
    Zero,
    AboveZero,
    /// From 0 to 1.
    Part,
}

/// Checks that a number is finite and in its range.
///
/// # Errors
/// If it is not; the error gives `name`, value and `unit`.
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
