//! One turn, resampled.

/// The velocity of one turn at the phases of the average.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle<'a> {
    /// Turn, counted from 0 among the whole turns.
    pub number: usize,
    /// Time of its first edge from the first sample, in s.
    pub time: f64,
    /// Turns a second.
    pub speed: f64,
    /// Velocity in m/s at equal steps of the phase from 0 on, smoothed as the average is; NaN where it was not measured.
    pub velocity: &'a [f64],
}

/// What is done with each turn.
pub(super) type Each<'e> = dyn FnMut(&Cycle<'_>) -> vibro_record::Result<()> + 'e;
