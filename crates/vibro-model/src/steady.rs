//! The motion without impacts.

use super::body::Body;
use super::excitation::Sine;
use super::rig::Rig;
use num_complex::Complex64;
use serde::Serialize;
use vibro_record::{Error, Result};

/// Forced motion of mass 1 without impacts: x₁ = Re(X e^{iωt}) under the force F₀ cos ωt; mass 2 rests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// X = F₀ L₁(iω) in m.
    pub response: Complex64,
    /// ω in rad/s.
    pub omega: f64,
}

impl Steady {
    /// Forced motion of `rig` under `sine`.
    ///
    /// # Errors
    /// If a parameter is impossible, or mass 1 has no damper and is driven at its natural frequency.
    pub fn new(rig: &Rig, sine: &Sine) -> Result<Steady> {
        rig.check()?;
        sine.check()?;
        let omega = sine.omega();
        // k − mω² has a rounding of about 2ε of k: within that it counts as 0.
        let [Body { mass, damping, stiffness }, _] = rig.bodies();
        if damping == 0.0 && (stiffness - mass * omega * omega).abs() <= 4.0 * f64::EPSILON * stiffness {
            return Err(Error::refused(format!(
                "mass 1 has no damper and is driven at its natural frequency, {} Hz: its amplitude grows without end",
                sine.frequency
            ))
            .hint("give c1 a value above 0, or move the frequency"));
        }
        let [l1, _] = rig.receptances(omega);
        Ok(Steady { response: l1 * sine.force, omega })
    }

    /// Amplitude A in m.
    pub fn amplitude(&self) -> f64 {
        self.response.norm()
    }
}

/// Motion without impacts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoImpact {
    /// Whether it stays clear of the other mass: the largest x₁ is below the gap.
    pub possible: bool,
    /// Amplitude A of x₁ in m: half its peak-to-peak value.
    pub amplitude: f64,
    /// Largest x₁ in m from its rest; under a sine force it is the amplitude.
    pub largest: f64,
}

impl NoImpact {
    /// Motion without impacts on a rig with this `gap` in m.
    pub fn new(steady: &Steady, gap: f64) -> NoImpact {
        let amplitude = steady.amplitude();
        NoImpact { possible: amplitude < gap, amplitude, largest: amplitude }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undamped_resonance_is_refused() {
        // √(k/m) = 2π exactly as rounded.
        let omega = std::f64::consts::TAU;
        let rig = Rig { m1: 1.0, k1: omega * omega, c1: 0.0, ..Rig::thesis() };
        let text = Steady::new(&rig, &Sine { force: 1.0, frequency: 1.0 }).unwrap_err().to_string();
        assert!(text.contains("natural frequency"), "{text}");
        assert!(Steady::new(&Rig { c1: 1e-3, ..rig }, &Sine { force: 1.0, frequency: 1.0 }).is_ok());
        assert!(Steady::new(&rig, &Sine { force: 1.0, frequency: 1.001 }).is_ok());
    }

    #[test]
    fn the_linear_motion_grazes_where_it_should() {
        // From an independent calculation: A = Δ at ν = 2.168715614919 for 0.5 N.
        let rig = Rig::thesis();
        let unit = (rig.k1 / rig.m1).sqrt() / std::f64::consts::TAU;
        let possible = |nu: f64| {
            let steady = Steady::new(&rig, &Sine { force: 0.5, frequency: nu * unit }).unwrap();
            NoImpact::new(&steady, rig.gap).possible
        };
        assert!(!possible(2.168_715_614_918));
        assert!(possible(2.168_715_614_920));
    }
}
