//! Periodic Green's function: the steady motion of one oscillator that receives a unit impulse once a period.

use vibro_math::Oscillator;
use vibro_record::{Error, Result};

/// χ(t) = e^{−bt}[sin λt + e^{−bT} sin λ(T − t)] / (mλ(1 + e^{−2bT} − 2e^{−bT} cos λT)) for 0 ≤ t ≤ T, in
/// m/(N s), with the decay rate b in 1/s and the damped natural frequency λ in rad/s.
///
/// Babitsky, *Theory of Vibro-Impact Systems* (1998); Rosenwasser (1969). Computed here as the free motion
/// that returns after T to its start, with a velocity lower by 1/m: (χ, χ̇)(0⁺) = (I − Φ(T))⁻¹(0, 1/m),
/// where Φ is the matrix of the free motion. This form holds at any damping. Where T is short against the
/// natural period 2π/Ω, its relative error is about ε/(ΩT)².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Green {
    pub(crate) oscillator: Oscillator,
    /// Period T in s.
    pub(crate) period: f64,
    /// χ(0) in m/(N s).
    pub start: f64,
    /// χ̇ just after the impulse, in 1/kg.
    pub slope_after: f64,
    /// χ̇ just before the impulse, in 1/kg: lower than after it by 1/m.
    pub slope_before: f64,
}

impl Green {
    /// Periodic response of the oscillator of mass `m` (kg) to a unit impulse every `period` seconds; 0 for
    /// an infinite mass.
    ///
    /// # Errors
    /// If the oscillator is undamped and its natural frequency is a harmonic of the impulses.
    pub fn new(m: f64, oscillator: Oscillator, period: f64) -> Result<Green> {
        if m == f64::INFINITY {
            return Ok(Green { oscillator, period, start: 0.0, slope_after: 0.0, slope_before: 0.0 });
        }
        let (_, sine) = oscillator.kernels(period);
        let (less, determinant) = oscillator.closing(period);
        let turn = oscillator.omega2().sqrt() * period;
        // Without damping the determinant is 4 sin²(λT/2), and λT is only known to a few ε.
        if oscillator.decay() == 0.0 && determinant <= (4.0 * f64::EPSILON * turn).powi(2) {
            return Err(Error::refused(format!(
                "a mass without a damper receives an impact every {period} s, a whole multiple ({:.0}) of its own \
                 period: its motion grows without end",
                turn / std::f64::consts::TAU
            ))
            .hint("give the mass some damping, or move the frequency"));
        }
        let b = oscillator.decay();
        let scale = 1.0 / (m * determinant);
        // 1 − C, with C = e^{−bT} cos λT, and 1 − e^{−2bT} are computed directly, without cancellation: near
        // a lightly damped resonance C and e^{−bT} are both near 1.
        let lost_twice = -(-2.0 * b * period).exp_m1();
        Ok(Green {
            oscillator,
            period,
            start: sine * scale,
            slope_after: (less - b * sine) * scale,
            slope_before: (lost_twice - less - b * sine) * scale,
        })
    }

    /// χ(t) and χ̇(t) for 0 ≤ t ≤ T (s); χ̇(0) is the slope just after the impulse.
    pub fn at(&self, t: f64) -> (f64, f64) {
        self.oscillator.free(self.start, self.slope_after, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slow reference: the sum of the impulse responses S(t + nT)/m to all past impulses, until they have
    /// decayed.
    fn sum(m: f64, oscillator: Oscillator, period: f64, t: f64) -> (f64, f64) {
        let mut total = (0.0, 0.0);
        for n in (0..40_000).rev() {
            let (x, v) = oscillator.free(0.0, 1.0 / m, t + f64::from(n) * period);
            total = (total.0 + x, total.1 + v);
        }
        total
    }

    #[test]
    fn it_is_the_sum_of_all_impulse_responses() {
        let (m, k) = (0.125, 135.0);
        let critical = 2.0 * f64::sqrt(m * k);
        for c in [0.02, 0.1, 1.0, critical * (1.0 - 1e-12), critical, critical * 1.01, 20.0] {
            let oscillator = Oscillator::new(m, c, k);
            for period in [0.05, 0.1911, 0.6] {
                let green = Green::new(m, oscillator, period).unwrap();
                // About 1/(bT) impulses contribute, each rounded to ε of 1/m (velocity); t itself is also
                // rounded to ε.
                let count = 1.0 + 1.0 / (oscillator.decay() * period);
                let tolerance = 32.0 * f64::EPSILON * count * count / m;
                for part in [0.0, 0.3, 0.5, 0.99] {
                    let (x, v) = green.at(part * period);
                    let (xs, vs) = sum(m, oscillator, period, part * period);
                    let omega = (k / m).sqrt();
                    assert!((v - vs).abs() < tolerance, "c {c} T {period} {part}: {v} {vs}");
                    assert!((x - xs).abs() * omega < tolerance, "c {c} T {period} {part}: {x} {xs}");
                }
            }
        }
    }

    #[test]
    fn it_returns_to_its_start_and_jumps_by_the_inverse_mass() {
        for c in [0.0, 0.1, 15.0] {
            let green = Green::new(0.125, Oscillator::new(0.125, c, 135.0), 0.17).unwrap();
            let (x, v) = green.at(0.17);
            let scale = 64.0 * f64::EPSILON * (green.slope_after.abs() + green.slope_before.abs() + 8.0);
            assert!((x - green.start).abs() * 33.0 < scale);
            assert!((v - green.slope_before).abs() < scale);
            assert!((green.slope_after - green.slope_before - 8.0).abs() < scale);
        }
    }

    #[test]
    fn undamped_resonance_is_refused_and_its_neighbour_is_not() {
        let omega = std::f64::consts::TAU;
        let undamped = Oscillator::new(1.0, 0.0, omega * omega);
        for n in 1..4 {
            assert!(Green::new(1.0, undamped, f64::from(n)).is_err());
            assert!(Green::new(1.0, undamped, f64::from(n) * 1.001).is_ok());
        }
        assert!(Green::new(1.0, Oscillator::new(1.0, 1e-6, omega * omega), 1.0).is_ok());
    }
}
