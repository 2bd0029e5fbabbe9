//! What the average turn of a record shows of a known motion.

use super::body::Body;
use crate::drill::{Corner, value};
use vibro_record::Result;

/// Instants of a known motion to a sample of the record. Turns of a record begin anywhere between two
/// samples, so that its average has them all.
const INSTANTS: usize = 4;
/// Most instants at which a motion is to be known: a fiftieth of a degree between two of them.
const MOST: usize = 20_000;
/// Standard deviations at which the scatter of the impacts' phase ends.
const FAR: f64 = 5.0;

impl Body {
    /// Even instants of a turn at which [`Body::shown`] is to know the motion.
    pub fn instants(&self) -> usize {
        (INSTANTS * self.samples()).min(MOST)
    }

    /// Samples of a turn of the record.
    fn samples(&self) -> usize {
        ((self.rate / self.speed[0]).round() as usize).max(2)
    }

    /// Mean velocity (m/s) at the phases of the average if the body moved through these positions (m), at
    /// even instants from the beginning of a turn, `ahead` turns before the pulse of the crank, to its end.
    /// The end need not be where the turn began: a mean over turns may drift.
    ///
    /// The velocity is sampled, smoothed and averaged like the record. A low-pass without delay stands for
    /// the band of the instrument, where it is known and below half the sampling rate. Impacts whose phase
    /// scatters from turn to turn blur the average; as many turns as were measured show all of that scatter.
    ///
    /// # Errors
    /// If the turn is too short for the smoothing.
    pub fn shown(&self, positions: &[f64], ahead: f64) -> Result<Vec<f64>> {
        let (n, all) = (self.samples(), INSTANTS * self.samples());
        let last = positions.len().saturating_sub(2);
        let position = |i: usize| {
            let at = i as f64 / all as f64 * (last + 1) as f64;
            let k = (at as usize).min(last);
            positions[k] + (at - k as f64) * (positions[k + 1] - positions[k])
        };
        // Means between two instants: an impact between them is exact to their distance.
        let velocity = |i: usize| (position(i % all + 1) - position(i % all)) * all as f64 * self.speed[0];
        let mut mean = vec![0.0; self.phase.len()];
        for first in 0..INSTANTS {
            // Three turns, so that the smoothing of the middle one sees its neighbours.
            let turns: Vec<f64> = (0..3 * n).map(|k| velocity(first + INSTANTS * k)).collect();
            let rate = n as f64 * self.speed[0];
            let band = self.instrument.filter(|highest| *highest < 0.5 * rate).map(Corner::ZeroPhaseLowPass);
            let smooth = |turns: Vec<f64>, corner: Corner| corner.smooth(&turns, rate);
            let turns = [band, self.smoothing].into_iter().flatten().try_fold(turns, smooth)?;
            let offset = (first as f64 + 0.5) / INSTANTS as f64;
            for (mean, phase) in mean.iter_mut().zip(&self.phase) {
                let at = (phase + ahead).rem_euclid(1.0) + 1.0;
                *mean += value(&turns, at * n as f64 - offset).unwrap_or(f64::NAN) / INSTANTS as f64;
            }
        }
        Ok(self.blurred(&mean))
    }

    /// Mean of turns whose phase scatters normally as that of the strongest impacts does.
    fn blurred(&self, turn: &[f64]) -> Vec<f64> {
        let (n, std) = (turn.len(), self.hits.first().map_or(0.0, |hits| hits.phase[1]));
        let std = std * n as f64;
        let reach = ((FAR * std) as usize).min(n / 2);
        let weights: Vec<f64> = (0..=2 * reach)
            .map(|k| (k as f64 - reach as f64) / std.max(f64::MIN_POSITIVE))
            .map(|z| (-0.5 * z * z).exp())
            .collect();
        let sum: f64 = weights.iter().sum();
        let blurred = |i: usize| {
            weights.iter().enumerate().map(|(k, w)| w * turn[(i + n + k - reach) % n]).sum::<f64>() / sum
        };
        (0..n).map(blurred).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_smooth_motion_is_shown_as_it_is() {
        let n = 720;
        let body = Body {
            record: String::new(),
            name: String::new(),
            mass: None,
            speed: [45.0, 0.0],
            crank: true,
            rate: 1e5,
            instrument: None,
            smoothing: None,
            turns: 30,
            hits: Vec::new(),
            phase: (0..n).map(|i| f64::from(i) / f64::from(n)).collect(),
            mean: Vec::new(),
            std: Vec::new(),
            displacement: Vec::new(),
        };
        // The instants of another record: they need not be those of this one.
        let all = body.instants() + 7;
        // A mean of turns drifts by what the last of them is ahead of the first.
        let drift = 2.0;
        let position = |i: usize| {
            let part = i as f64 / all as f64;
            (TAU * part).sin() + drift * part
        };
        let positions: Vec<f64> = (0..=all).map(position).collect();
        // An instrument that passes half of 135 Hz passes 1/(1 + (45/135)⁴) of 45 Hz.
        for (instrument, gain) in [(None, 1.0), (Some(135.0), 81.0 / 82.0), (Some(1e6), 1.0)] {
            let body = Body { instrument, ..body.clone() };
            let shown = body.shown(&positions, 0.3).unwrap();
            for (phase, v) in body.phase.iter().zip(&shown) {
                let expected = 45.0 * (gain * TAU * (TAU * (phase + 0.3)).cos() + drift);
                // The slope of straight lines between 9000 positions errs by half the angle between two.
                assert!(
                    (v - expected).abs() < TAU * 45.0 * 0.5 * TAU / all as f64,
                    "{phase}: {v} {expected}"
                );
            }
        }
    }
}
