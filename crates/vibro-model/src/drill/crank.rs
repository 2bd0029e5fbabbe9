//! Crank drive: the motion of the driving piston at a constant speed.

use super::machine::Machine;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use vibro_math::border;
use vibro_math::cis::sin_cos;

/// Crank and rod that drive the piston at a constant speed.
///
/// With the angle θ = Ωt from top dead centre the piston is at x = r(1 − cos θ) + l − √(l² − r² sin²θ).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Crank {
    /// Radius r of the crank in m.
    pub radius: f64,
    /// Length l of the rod in m; infinite for a harmonic motion.
    pub rod: f64,
    /// Turns per second, Ω/2π.
    pub frequency: f64,
}

impl Default for Crank {
    fn default() -> Crank {
        Machine::example().crank
    }
}

impl Crank {
    /// Position in m and velocity in m/s of the piston at the time `t` (s).
    #[inline]
    pub fn at(&self, t: f64) -> [f64; 2] {
        let omega = TAU * self.frequency;
        let (sin, cos) = sin_cos(omega * t);
        let (s, c) = (self.radius * sin, self.radius * cos);
        let rod = (self.rod * self.rod - s * s).sqrt();
        let lift = if self.rod == f64::INFINITY { 0.0 } else { self.rod - rod };
        [self.radius - c + lift, omega * (s + s * c / rod)]
    }

    /// Time of a turn in s.
    pub fn period(&self) -> f64 {
        1.0 / self.frequency
    }

    /// Largest velocity in m/s of the piston.
    pub fn top_speed(&self) -> f64 {
        self.at(self.fastest())[1]
    }

    /// Time in s after top dead centre at which the piston is fastest towards the bit.
    pub fn fastest(&self) -> f64 {
        // Where the acceleration r cos θ + (c² − s² + (sc/q)²)/q, q = √(l² − s²), falls to zero.
        border(0.0, 0.5 * self.period(), |t| {
            let (sin, cos) = sin_cos(TAU * self.frequency * t);
            let (s, c) = (self.radius * sin, self.radius * cos);
            let rod = (self.rod * self.rod - s * s).sqrt();
            c + (c * c - s * s + (s * c / rod).powi(2)) / rod > 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_is_the_derivative_of_the_position() {
        for rod in [0.03, 0.1, f64::INFINITY] {
            let crank = Crank { radius: 0.012, rod, frequency: 40.0 };
            let h = 1e-6;
            for t in [0.0, 1e-3, 5e-3, 0.0125, 0.02] {
                // The central difference errs by h²/6 times the third derivative, below r(Ωh)³/6h, times 4
                // for the short rod, and by rounding ε r/h.
                let scale = TAU * 40.0;
                let error = (scale * h).powi(2) + f64::EPSILON / (scale * h);
                let slope = (crank.at(t + h)[0] - crank.at(t - h)[0]) / (2.0 * h);
                assert!((slope - crank.at(t)[1]).abs() < 4.0 * error * scale * 0.012);
            }
            // Dead centres are 2r apart; the velocity is the largest where it is said to be.
            assert!((crank.at(0.0125)[0] - 0.024).abs() < 1e-15 && crank.at(0.0)[0] == 0.0);
            let [before, there, after] = [-1e-6, 0.0, 1e-6].map(|h| crank.at(crank.fastest() + h)[1]);
            assert!(there > before && there > after);
        }
        let harmonic = Crank { radius: 0.012, rod: f64::INFINITY, frequency: 40.0 };
        assert!((harmonic.fastest() - 0.25 / 40.0).abs() < 1e-15);
    }
}
