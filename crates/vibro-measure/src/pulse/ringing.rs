//! Ringing of a structure after a pulse, which may have disturbed the pulse itself.

use std::f64::consts::PI;

/// Largest ringing assumed within the contact, in standard deviations of its residuals: a larger one would
/// show in them.
const SHOWS: f64 = 1.2;

/// Ringing of a record after its pulse.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ringing {
    rms: f64,
    /// Half a period of the ringing, in samples.
    half: f64,
}

impl Ringing {
    /// From the residuals `left` after the pulse, with their mean and root mean square. Half a period is the
    /// mean time between excursions beyond the root mean square on opposite sides; infinite where all are on
    /// one side.
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

    /// Factor on the variances of parameters from `n` samples in a contact whose residuals have this
    /// `variance`. Over half a period, ringing adds up to 2√2/π times its root mean square for each sample;
    /// noise of n samples adds up to √n. Ringing above [`SHOWS`] times the residuals would show in them.
    pub fn widening(&self, n: f64, variance: f64) -> f64 {
        let sum = 2.0 * f64::sqrt(2.0) / PI * self.half.min(0.5 * n);
        1.0 + sum * sum / n * (self.rms * self.rms / variance).min(SHOWS * SHOWS)
    }
}
