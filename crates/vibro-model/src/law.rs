//! Contact laws: the force from the indentation and its rate.

pub mod conversion;

use crate::least::{NumberRange, number};
use serde::Serialize;
use vibro_record::{Error, Result};

/// Contact law: force from the indentation δ in m and its rate δ̇ in m/s; it never pulls.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Law {
    /// F = k₃δ + c₃δ̇: a spring and a damper in parallel. The contact ends where the force falls to zero, not
    /// where δ = 0.
    KelvinVoigt {
        /// Stiffness k₃ in N/m.
        stiffness: f64,
        /// Damping c₃ in N s/m.
        damping: f64,
    },
    /// F = kδ^{3/2}: two curved elastic bodies (Hertz 1882).
    Hertz {
        /// Stiffness k in N/m^{3/2}.
        stiffness: f64,
    },
    /// F = kδⁿ(1 + αδ̇): damping grows with the indentation (Hunt & Crossley 1975).
    HuntCrossley {
        /// Stiffness k in N/mⁿ.
        stiffness: f64,
        /// Exponent n, 1 or more.
        exponent: f64,
        /// Damping α in s/m.
        damping: f64,
    },
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
        let force = Law::Hertz { stiffness }.force(indentation, 0.0);
        let duration = conversion::hertz_duration(stiffness, mass, speed);
        HertzRebound { stiffness, mass, speed, indentation, force, duration }
    }
}

impl Law {
    /// Kelvin–Voigt contact with `stiffness` (N/m) that gives `restitution` for the reduced mass `mass` (kg)
    /// without other forces: c₃ = 2ζ√(k₃M).
    ///
    /// # Errors
    /// If the stiffness or the mass is not above 0, or the restitution is outside 0 < R ≤ 1.
    pub fn kelvin_voigt(stiffness: f64, restitution: f64, mass: f64) -> Result<Law> {
        Law::KelvinVoigt { stiffness, damping: 0.0 }.check()?;
        number("reduced mass", mass, "kg", NumberRange::AboveZero)?;
        let ratio = conversion::damping_ratio(restitution)?;
        Ok(Law::KelvinVoigt { stiffness, damping: 2.0 * ratio * (stiffness * mass).sqrt() })
    }

    /// Hunt–Crossley contact that gives `restitution` at the approach speed `speed` (m/s).
    ///
    /// # Errors
    /// If the stiffness or the speed is not above 0, the exponent is below 1, or the restitution is outside 0
    /// < R ≤ 1.
    pub fn hunt_crossley(stiffness: f64, exponent: f64, restitution: f64, speed: f64) -> Result<Law> {
        number("approach speed", speed, "m/s", NumberRange::AboveZero)?;
        let law = Law::HuntCrossley { stiffness, exponent, damping: conversion::loss(restitution)? / speed };
        law.check().map(|()| law)
    }

    /// Checks that the numbers are possible.
    ///
    /// # Errors
    /// If a stiffness is not above 0, a damping is negative, an exponent is outside 1 to 10, or a value is
    /// not finite.
    pub fn check(&self) -> Result<()> {
        let (stiffness, exponent, damping) = self.numbers();
        let linear = matches!(self, Law::KelvinVoigt { .. });
        let (unit, damping_unit) = if linear { ("N/m", "N s/m") } else { ("N/mⁿ", "s/m") };
        number("contact stiffness", stiffness, unit, NumberRange::AboveZero)?;
        number("contact damping", damping, damping_unit, NumberRange::Zero)?;
        if !(1.0..=10.0).contains(&exponent) {
            return Err(Error::usage(format!("contact exponent is {exponent}"), "a value from 1 to 10"));
        }
        Ok(())
    }

    /// Stiffness, exponent and damping, in the units of the law.
    pub(super) fn numbers(&self) -> (f64, f64, f64) {
        match *self {
            Law::KelvinVoigt { stiffness, damping } => (stiffness, 1.0, damping),
            Law::Hertz { stiffness } => (stiffness, 1.5, 0.0),
            Law::HuntCrossley { stiffness, exponent, damping } => (stiffness, exponent, damping),
        }
    }

    /// Force in N at an indentation (m) and its rate (m/s); 0 where the masses are apart, or where the law
    /// would pull.
    #[inline]
    pub fn force(&self, indentation: f64, rate: f64) -> f64 {
        if indentation <= 0.0 {
            return 0.0;
        }
        let (stiffness, exponent, damping) = self.numbers();
        let force = match self {
            Law::KelvinVoigt { .. } => stiffness * indentation + damping * rate,
            Law::Hertz { .. } => stiffness * indentation * indentation.sqrt(),
            Law::HuntCrossley { .. } if exponent == 1.5 => {
                stiffness * (indentation * indentation.sqrt()) * (1.0 + damping * rate)
            }
            Law::HuntCrossley { .. } => stiffness * indentation.powf(exponent) * (1.0 + damping * rate),
        };
        force.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_values_are_named() {
        let cases = [
            (Law::KelvinVoigt { stiffness: 0.0, damping: 1.0 }, "contact stiffness is 0 N/m"),
            (Law::KelvinVoigt { stiffness: 1e5, damping: -1.0 }, "contact damping is -1 N s/m"),
            (Law::KelvinVoigt { stiffness: f64::NAN, damping: 1.0 }, "contact stiffness is NaN N/m"),
            (Law::Hertz { stiffness: f64::INFINITY }, "contact stiffness is inf N/mⁿ"),
            (Law::HuntCrossley { stiffness: 1e8, exponent: 0.5, damping: 1.0 }, "contact exponent is 0.5"),
            (
                Law::HuntCrossley { stiffness: 1e8, exponent: f64::NAN, damping: 1.0 },
                "contact exponent is NaN",
            ),
        ];
        for (law, start) in cases {
            let text = law.check().unwrap_err().to_string();
            assert!(text.starts_with(start), "{text}");
        }
        assert!(Law::kelvin_voigt(1e5, 0.0, 0.05).is_err() && Law::kelvin_voigt(1e5, 0.7, 0.0).is_err());
        assert!(Law::hunt_crossley(1e8, 1.5, 0.7, 0.0).is_err());
    }

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

    #[test]
    fn no_contact_pulls() {
        let laws = [
            Law::KelvinVoigt { stiffness: 1e5, damping: 10.0 },
            Law::Hertz { stiffness: 1e8 },
            Law::HuntCrossley { stiffness: 1e8, exponent: 1.3, damping: 0.5 },
        ];
        for law in laws {
            assert_eq!(law.force(-1e-9, 1.0), 0.0);
            assert_eq!(law.force(0.0, 1.0), 0.0);
            assert!(law.force(1e-4, -100.0) >= 0.0 && law.force(1e-4, 0.0) > 0.0);
        }
    }
}
