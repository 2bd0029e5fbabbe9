//! F = k₃δ + c₃δ̇: a spring and a damper in parallel. The contact ends where the force falls to zero, not
//! where δ = 0.

use super::{Law, LawDamping, LawForm, conversion};
use crate::least::{NumberRange, number};
use vibro_record::Result;

pub(super) const FORM: LawForm = LawForm {
    name: "kelvin-voigt",
    linear: true,
    exponent: 1.0,
    any_exponent: false,
    damping: LawDamping::OrRestitution(Law::kelvin_voigt),
    damping_unit: "N s/m",
    force: |law, indentation, rate| law.stiffness * indentation + law.damping * rate,
};

impl Law {
    /// Kelvin–Voigt contact of a spring (N/m) and a damper (N s/m).
    pub const fn spring(stiffness: f64, damping: f64) -> Law {
        FORM.law(stiffness, 1.0, damping)
    }

    /// Kelvin–Voigt contact with `stiffness` (N/m) that gives `restitution` for the reduced mass `mass` (kg)
    /// without other forces: c₃ = 2ζ√(k₃M).
    ///
    /// # Errors
    /// If the stiffness or the mass is not above 0, or the restitution is outside 0 < R ≤ 1.
    pub fn kelvin_voigt(stiffness: f64, restitution: f64, mass: f64) -> Result<Law> {
        Law::spring(stiffness, 0.0).check()?;
        number("reduced mass", mass, "kg", NumberRange::AboveZero)?;
        let ratio = conversion::damping_ratio(restitution)?;
        Ok(Law::spring(stiffness, 2.0 * ratio * (stiffness * mass).sqrt()))
    }
}
