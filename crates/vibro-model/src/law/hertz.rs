//! F = kδ^{3/2}: two curved elastic bodies (Hertz 1882).

use super::{HERTZ, Law, LawDamping, LawForm, conversion};
use serde::Serialize;
use std::f64::consts::PI;

pub(super) const FORM: LawForm = LawForm {
    name: "hertz",
    linear: false,
    exponent: HERTZ,
    any_exponent: false,
    damping: LawDamping::Lossless,
    damping_unit: "s/m",
    force: |law, indentation, _| law.stiffness * indentation * indentation.sqrt(),
};

impl Law {
    /// Hertz contact with a stiffness in N/m^{3/2}.
    pub const fn hertz(stiffness: f64) -> Law {
        FORM.law(stiffness, HERTZ, 0.0)
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
    /// Largest pressure between the bodies in Pa; `None` where their radii are not known.
    pub pressure: Option<f64>,
    /// Radius R in m, 1/R = 1/R₁ + 1/R₂.
    #[serde(skip)]
    radius: Option<f64>,
}

impl HertzRebound {
    /// Rebound of the stiffness (N/m^{3/2}) for a reduced mass (kg) at an approach speed (m/s), all above 0,
    /// between bodies of the radius R, 1/R = 1/R₁ + 1/R₂ (m), where it is known.
    ///
    /// The pressure is 3F/(2πa²) at the centre of the circle of contact, a² = Rδ (Johnson 1985, 4.22 to
    /// 4.24).
    pub fn new(stiffness: f64, mass: f64, speed: f64, radius: Option<f64>) -> HertzRebound {
        let indentation = conversion::hertz_depth(stiffness, mass, speed);
        let force = Law::hertz(stiffness).force(indentation, 0.0);
        let duration = conversion::hertz_duration(stiffness, mass, speed);
        let pressure = radius.map(|radius| 1.5 * force / (PI * radius * indentation));
        HertzRebound { stiffness, mass, speed, indentation, force, duration, pressure, radius }
    }

    /// Largest pressure over E*, which is 3k/(4√R); `None` where the radii are not known.
    ///
    /// A ball yields at 1.6 times the yield stress (Johnson 1985, 6.1), and the hardest steels yield at a
    /// fiftieth of E*: metals bear 3 % at most.
    pub fn strain(&self) -> Option<f64> {
        Some(self.pressure? * self.radius?.sqrt() / (0.75 * self.stiffness))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against m δ̈ = −kδ^{3/2} in small steps (leapfrog): its errors are of the order of the step squared.
    #[test]
    fn a_hertz_rebound_is_that_of_small_steps() {
        for (stiffness, mass, speed) in [(1e10, 0.093, 7.5), (3e7, 0.05, 0.3), (2e11, 4.0, 1e-3)] {
            let found = HertzRebound::new(stiffness, mass, speed, None);
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

    /// A sphere of steel of 10 mm on a plane under 100 N: a = (3FR/4E*)^{1/3}, p = 3F/(2πa²), in other words
    /// (6FE*²/π³R²)^{1/3} (Johnson 1985, 4.24).
    #[test]
    fn the_largest_pressure_is_that_of_the_force() {
        let (radius, modulus) = (0.01, 1.153_846e11);
        let stiffness = 4.0 / 3.0 * modulus * f64::sqrt(radius);
        let found = HertzRebound::new(stiffness, 0.1, 0.5, Some(radius));
        let expected = (6.0 * found.force * modulus.powi(2) / (PI.powi(3) * radius.powi(2))).cbrt();
        assert!((found.pressure.unwrap() / expected - 1.0).abs() < 1e-13, "{found:?} {expected}");
        let strain = found.pressure.unwrap() / modulus;
        assert!((found.strain().unwrap() / strain - 1.0).abs() < 1e-13);
    }
}
