//! F = kδⁿ(1 + αδ̇): damping grows with the indentation (Hunt & Crossley 1975).

use super::{HERTZ, Law, LawDamping, LawForm, conversion};
use crate::least::{NumberRange, number};
use vibro_record::Result;

pub(super) const FORM: LawForm = LawForm {
    name: "hunt-crossley",
    linear: false,
    exponent: HERTZ,
    any_exponent: true,
    damping: LawDamping::Stated,
    damping_unit: "s/m",
    force,
};

/// The root is faster than the power, and 1.5 is the exponent of nearly all contacts.
fn force(law: &Law, indentation: f64, rate: f64) -> f64 {
    let loss = 1.0 + law.damping * rate;
    if law.exponent == HERTZ {
        return law.stiffness * (indentation * indentation.sqrt()) * loss;
    }
    law.stiffness * indentation.powf(law.exponent) * loss
}

impl Law {
    /// Hunt–Crossley contact with a stiffness (N/mⁿ), an exponent n of 1 or more, and a damping α (s/m).
    pub const fn curved(stiffness: f64, exponent: f64, damping: f64) -> Law {
        FORM.law(stiffness, exponent, damping)
    }

    /// Hunt–Crossley contact that gives `restitution` at the approach speed `speed` (m/s).
    ///
    /// # Errors
    /// If the stiffness or the speed is not above 0, the exponent is below 1, or the restitution is outside 0
    /// < R ≤ 1.
    pub fn hunt_crossley(stiffness: f64, exponent: f64, restitution: f64, speed: f64) -> Result<Law> {
        number("approach speed", speed, "m/s", NumberRange::AboveZero)?;
        let law = Law::curved(stiffness, exponent, conversion::loss(restitution)? / speed);
        law.check().map(|()| law)
    }
}
