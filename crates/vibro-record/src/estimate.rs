//! A number and how far it can be trusted.

use serde::Serialize;

/// Value, standard uncertainty, unit, method, and how many samples it rests on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Best value, in `unit`; NaN (null in JSON) where there is none.
    pub value: f64,
    /// Standard uncertainty, in `unit`; `None` where it is not known.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// Number of samples, lines or points behind it.
    pub n: usize,
    /// How it was found.
    pub method: String,
}

impl Estimate {
    /// A value with its standard uncertainty. An uncertainty that is not finite is not known.
    pub fn new(
        value: f64,
        std: Option<f64>,
        unit: &'static str,
        n: usize,
        method: impl Into<String>,
    ) -> Estimate {
        Estimate { value, std: std.filter(|s| s.is_finite()), unit, n, method: method.into() }
    }
}
