//! One mode as a pole of the response.

use num_complex::Complex64;
use std::f64::consts::TAU;

/// A mode of viscous damping: receptance A/(ωᵣ² − ω² + 2iζωᵣω).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Undamped natural frequency in Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub zeta: f64,
    /// Modal constant A, 1/kg for a response over a force.
    pub constant: Complex64,
}

impl Pole {
    /// Its part of the response at `f`, whose kind is a receptance times (iω)^`power`.
    pub fn at(&self, f: f64, power: i32) -> Complex64 {
        let (omega, own) = (TAU * f, TAU * self.frequency);
        let factor = Complex64::new(0.0, omega).powi(power);
        factor * self.constant / Complex64::new(own * own - omega * omega, 2.0 * self.zeta * own * omega)
    }

    /// The mode without a decay σ in 1/s that an exponential window added to a response of (iω)^`power` times the receptance.
    ///
    /// The window moves the pole s = −ζωᵣ ± iωᵣ√(1 − ζ²) by −σ and leaves its residue, which is `s^power` A/(2iωᵣ√(1 − ζ²)).
    /// `None` where it decays by less than σ, or does not oscillate (ζ of 1 and more).
    pub(crate) fn without_decay(&self, decay: f64, power: i32) -> Option<Pole> {
        if self.zeta.is_nan() || self.zeta.abs() >= 1.0 {
            return None;
        }
        let own = TAU * self.frequency;
        let with = Complex64::new(-self.zeta * own, own * (1.0 - self.zeta * self.zeta).sqrt());
        let pole = with + decay;
        let zeta = -pole.re / pole.norm();
        let constant = self.constant * (with / pole).powi(power);
        (zeta > 0.0).then(|| Pole { frequency: pole.norm() / TAU, zeta, constant })
    }
}
