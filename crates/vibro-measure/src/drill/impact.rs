//! An impact of a drill.

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Impact {
    /// Turn, counted from 0 among the whole turns.
    pub cycle: usize,
    /// Its place among the groups of the result, the strongest 0.
    pub group: usize,
    /// Time from the first sample, in s.
    pub time: f64,
    /// Part of the turn after its first edge, 0 to 1.
    pub phase: f64,
    /// Standard uncertainty of the phase.
    pub phase_std: f64,
    /// Velocity before, in m/s.
    pub before: f64,
    /// Its standard uncertainty.
    pub before_std: f64,
    /// Velocity after, in m/s.
    pub after: f64,
    /// Its standard uncertainty.
    pub after_std: f64,
    /// Whether samples of the fits or of the contact are over-range: then the speeds are too small, and the impact is in no mean.
    pub clipped: bool,
}
