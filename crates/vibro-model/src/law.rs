//! Contact laws: the force from the indentation and its rate. A law is a form with its numbers; each form is
//! a module here and a row of [`FORMS`].

pub mod conversion;
mod form;
mod hertz;
mod hunt_crossley;
mod kelvin_voigt;

pub use form::{LawDamping, LawForm};
pub use hertz::HertzRebound;

use crate::least::{NumberRange, number};
use vibro_record::{Error, Result};

/// All forms of contact laws.
pub const FORMS: &[LawForm] = &[kelvin_voigt::FORM, hertz::FORM, hunt_crossley::FORM];

/// Exponent of curved elastic bodies, whose radii and elastic constants give a stiffness (Hertz 1882).
pub(crate) const HERTZ: f64 = 1.5;

/// Contact law: force from the indentation δ in m and its rate δ̇ in m/s; it never pulls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Form of the force.
    pub form: LawForm,
    /// Stiffness in N/mⁿ.
    pub stiffness: f64,
    /// Exponent n of the indentation.
    pub exponent: f64,
    /// Damping, in the unit of the form.
    pub damping: f64,
}

impl Law {
    /// Checks that the numbers are possible.
    ///
    /// # Errors
    /// If a stiffness is not above 0, a damping is negative, an exponent is outside 1 to 10, a value is not
    /// finite, or the form has another exponent or no damping.
    pub fn check(&self) -> Result<()> {
        let Law { form, stiffness, exponent, damping } = *self;
        number("contact stiffness", stiffness, form.stiffness_unit(), NumberRange::AboveZero)?;
        number("contact damping", damping, form.damping_unit, NumberRange::Zero)?;
        if !(1.0..=10.0).contains(&exponent) {
            return Err(Error::usage(format!("contact exponent is {exponent}"), "a value from 1 to 10"));
        }
        if exponent != form.exponent && !form.any_exponent {
            let found = format!("contact exponent is {exponent} for {}", form.name);
            return Err(Error::usage(found, form.exponent.to_string()));
        }
        if damping != 0.0 && matches!(form.damping, LawDamping::Lossless) {
            return Err(Error::usage(format!("contact damping is {damping} for {}", form.name), "none"));
        }
        Ok(())
    }

    /// Whether the force is linear in the indentation and its rate: motions in contact then have a closed
    /// form.
    pub fn is_linear(&self) -> bool {
        self.form.linear
    }

    /// Force in N at an indentation (m) and its rate (m/s); 0 where the masses are apart, or where the law
    /// would pull.
    #[inline]
    pub fn force(&self, indentation: f64, rate: f64) -> f64 {
        if indentation <= 0.0 {
            return 0.0;
        }
        (self.form.force)(self, indentation, rate).max(0.0)
    }
}

/// A law of every form, with losses where the form has them: the masses of the thesis' rig rebound from it.
#[cfg(test)]
pub(crate) fn samples() -> impl Iterator<Item = Law> {
    FORMS.iter().map(|form| {
        let stiffness = if form.linear { 3e4 } else { 1e7 };
        let damping = match form.damping {
            LawDamping::Lossless => 0.0,
            _ => 0.5,
        };
        form.law(stiffness, form.exponent, damping)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_values_are_named() {
        let cases = [
            (Law::spring(0.0, 1.0), "contact stiffness is 0 N/m"),
            (Law::spring(1e5, -1.0), "contact damping is -1 N s/m"),
            (Law::spring(f64::NAN, 1.0), "contact stiffness is NaN N/m"),
            (Law::hertz(f64::INFINITY), "contact stiffness is inf N/mⁿ"),
            (Law::curved(1e8, 0.5, 1.0), "contact exponent is 0.5"),
            (Law::curved(1e8, f64::NAN, 1.0), "contact exponent is NaN"),
        ];
        for (law, start) in cases {
            let text = law.check().unwrap_err().to_string();
            assert!(text.starts_with(start), "{text}");
        }
        assert!(Law::kelvin_voigt(1e5, 0.0, 0.05).is_err() && Law::kelvin_voigt(1e5, 0.7, 0.0).is_err());
        assert!(Law::hunt_crossley(1e8, 1.5, 0.7, 0.0).is_err());
    }

    #[test]
    fn no_contact_pulls() {
        for law in samples().chain([Law::curved(1e8, 1.3, 0.5)]) {
            assert_eq!(law.force(-1e-9, 1.0), 0.0);
            assert_eq!(law.force(0.0, 1.0), 0.0);
            assert!(law.force(1e-4, -100.0) >= 0.0 && law.force(1e-4, 0.0) > 0.0);
        }
    }
}
