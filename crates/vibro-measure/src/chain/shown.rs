//! What the average turn of a record shows of a known motion.

use super::body::Body;
use crate::drill::value;
use vibro_record::Result;

/// Instants of a known motion to a sample of the record. Turns of a record begin anywhere between two
/// samples, so that its average has them all.
const INSTANTS: usize = 4;
/// Standard deviations at which the scatter of the impacts' phase ends.
const FAR: f64 = 5.0;

impl Body {
    /// Even instants of a turn at which [`Body::shown`] is to know the motion.
    pub fn instants(&self) -> usize {
        INSTANTS * self.samples()
    }

    /// Samples of a turn of the record.
    fn samples(&self) -> usize {
        ((self.rate / self.speed[0]).round() as usize).max(2)
    }

    /// Mean velocity (m/s) at the phases of the average if the body moved through these positions (m), at
    /// even instants of a turn, the first of them `ahead` turns before the pulse of the crank.
    ///
    /// The velocity is sampled, smoothed and averaged like the record. Impacts whose phase scatters from turn
    /// to turn blur the average; as many turns as were measured show all of that scatter.
    ///
    /// # Errors
    /// If the turn is too short for the smoothing.
    pub fn shown(&self, positions: &[f64], ahead: f64) -> Result<Vec<f64>> {
        let (n, all) = (self.samples(), self.instants());
        let position = |i: usize| {
            let at = (i % all) as f64 / all as f64 * positions.len() as f64;
            let (k, part) = (at as usize, at.fract());
            positions[k] + part * (positions[(k + 1) % positions.len()] - positions[k])
        };
        // Means between two instants: an impact between them is exact.
        let velocity = |i: usize| (position(i + 1) - position(i)) * all as f64 * self.speed[0];
        let mut mean = vec![0.0; self.phase.len()];
        for first in 0..INSTANTS {
            // Three turns, so that the smoothing of the middle one sees its neighbours.
            let turns: Vec<f64> = (0..3 * n).map(|k| velocity(first + INSTANTS * k)).collect();
            let rate = n as f64 * self.speed[0];
            let smooth = self.smoothing.map(|corner| corner.smooth(&turns, rate)).transpose()?;
            let smooth = smooth.as_deref().unwrap_or(&turns);
            let offset = (first as f64 + 0.5) / INSTANTS as f64;
            for (mean, phase) in mean.iter_mut().zip(&self.phase) {
                let at = (phase + ahead).rem_euclid(1.0) + 1.0;
                *mean += value(smooth, at * n as f64 - offset).unwrap_or(f64::NAN) / INSTANTS as f64;
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
        let positions: Vec<f64> = (0..all).map(|i| (TAU * i as f64 / all as f64).sin()).collect();
        let shown = body.shown(&positions, 0.3).unwrap();
        for (phase, v) in body.phase.iter().zip(&shown) {
            let expected = TAU * 45.0 * (TAU * (phase + 0.3)).cos();
            // The slope of straight lines between 9000 positions errs by half the angle between two of them.
            assert!((v - expected).abs() < TAU * 45.0 * 0.5 * TAU / all as f64, "{phase}: {v} {expected}");
        }
    }
}
