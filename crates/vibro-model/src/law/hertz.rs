//! F = kδ^{3/2}: two curved elastic bodies (Hertz 1882).

use super::{Law, LawDamping, LawForm, conversion};
use serde::Serialize;

pub(super) const FORM: LawForm = LawForm {
    name: "hertz",
    linear: false,
    exponent: 1.5,
    any_exponent: false,
    damping: LawDamping::Lossless,
    damping_unit: "s/m",
    force: |law, indentation, _| law.stiffness * indentation * indentation.sqrt(),
};

impl Law {
    /// Hertz contact with a stiffness in N/m^{3/2}.
    pub const fn hertz(stiffness: f64) -> Law {
        FORM.law(stiffness, 1.5, 0.0)
    }
}

/// Rebound of a Hertz contact without other forces, at one approach speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HertzRebound {
    /// Stiffness k of F = kδ^{3/2}, in N/m^{3/2}.
    pub stiffness: f64,
    /// Reduced mass in kg.
    pub mass: f64,
    /// Approach speed in m/s.
    pub speed: f64,
    /// Largest indentation in m.
    pub indentation: f64,
    /// Largest force in N.
    pub force: f64,
    /// Duration in s.
    pub duration: f64,
}

impl HertzRebound {
    /// Rebound of the stiffness (N/m^{3/2}) for a reduced mass (kg) at an approach speed (m/s), all above 0.
    pub fn new(stiffness: f64, mass: f64, speed: f64) -> HertzRebound {
        let indentation = conversion::hertz_depth(stiffness, mass, speed);
        let force = Law::hertz(stiffness).force(indentation, 0.0);
        let duration = conversion::hertz_duration(stiffness, mass, speed);
        HertzRebound { stiffness, mass, speed, indentation, force, duration }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against m δ̈ = −kδ^{3/2} in small steps (leapfrog): its errors are of the order of the step squared.
    #[test]
    fn a_hertz_rebound_is_that_of_small_steps() {
        for (stiffness, mass, speed) in [(1e10, 0.093, 7.5), (3e7, 0.05, 0.3), (2e11, 4.0, 1e-3)] {
            let found = HertzRebound::new(stiffness, mass, speed);
            let step = found.duration * 1e-5;
            let (mut depth, mut rate, mut deepest, mut steps) = (0.0_f64, speed, 0.0_f64, 0.0_f64);
            while steps == 0.0 || depth > 0.0 {
                let half = rate - 0.5 * step * stiffness * depth.powf(1.5) / mass;
                depth += step * half;
                rate = half - 0.5 * step * stiffness * depth.max(0.0).powf(1.5) / mass;
                deepest = deepest.max(depth);
                steps += 1.0;
            }
            assert!((steps * 1e-5 - 1.0).abs() < 2e-5, "the end is known to a step: {steps}");
            assert!((found.indentation / deepest - 1.0).abs() < 1e-8, "{found:?}");
            assert!((found.force / (stiffness * deepest.powf(1.5)) - 1.0).abs() < 2e-8);
        }
    }
}
