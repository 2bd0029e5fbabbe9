//! What rings on behind a pulse, and so may have swung within it.

use std::f64::consts::PI;

/// A swing within the contact larger than this, in units of what is left there, would show in it.
const SHOWS: f64 = 1.2;

/// What a record does behind its pulse.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ringing {
    rms: f64,
    /// Samples of half a swing.
    half: f64,
}

impl Ringing {
    /// From what is left behind the pulse: half a swing lasts from one side of the root of the mean square to
    /// the other, without end where it stays on one.
    pub fn of(left: &[f64], mean: f64, rms: f64) -> Ringing {
        let (mut side, mut turns) = (0.0, Vec::new());
        for (i, v) in left.iter().map(|v| v - mean).enumerate().filter(|(_, v)| v.abs() > rms) {
            if v.signum() != side {
                side = v.signum();
                turns.push(i);
            }
        }
        let half = match turns[..] {
            [first, .., last] => (last - first) as f64 / (turns.len() - 1) as f64,
            _ => f64::INFINITY,
        };
        Ringing { rms, half }
    }

    /// Factor of the variance of what `n` samples in a contact state, of which noise leaves this `variance`.
    /// Half a swing adds up to 2√2/π of its root mean square, noise to the root of n; a swing that is
    /// larger than what is left would show in it.
    pub fn widening(&self, n: f64, variance: f64) -> f64 {
        let sum = 2.0 * f64::sqrt(2.0) / PI * self.half.min(0.5 * n);
        1.0 + sum * sum / n * (self.rms * self.rms / variance).min(SHOWS * SHOWS)
    }
}
