//! Turns of a drill one by one: a row for each turn, a column for each phase.

use crate::measure::drill::Cycle;
use std::fmt::Write as _;

/// The head of the table of turns resampled to `points` phases.
pub fn head(points: usize) -> String {
    let mut head = "cycle,time (s),speed (Hz)".to_owned();
    for k in 0..points {
        let _ = write!(head, ",velocity at phase {:.6} (m/s)", k as f64 / points as f64);
    }
    head.push('\n');
    head
}

/// The row of a turn; a phase without a measured value is empty. Seven significant digits resolve 24-bit
/// samples.
pub fn row(cycle: &Cycle<'_>) -> String {
    let mut row = format!("{},{},{}", cycle.number, cycle.time, cycle.speed);
    for v in cycle.velocity {
        row.push(',');
        if v.is_finite() {
            let _ = write!(row, "{v:.6e}");
        }
    }
    row.push('\n');
    row
}
