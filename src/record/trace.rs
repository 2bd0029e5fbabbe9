//! Samples over time.

use super::{Axis, Meta};

/// Samples over time (or over index, where the file says nothing of its sampling).
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Time in s, or an index.
    pub axis: Axis,
    /// SI values; a missing sample is NaN, and present only where missing values were allowed.
    pub values: Vec<f64>,
}

impl Trace {
    /// Sampling rate in Hz; `None` if the axis is uneven or not time.
    pub fn rate(&self) -> Option<f64> {
        matches!(self.axis.kind, super::AxisKind::Time).then(|| self.axis.step().map(|dt| 1.0 / dt)).flatten()
    }
}
