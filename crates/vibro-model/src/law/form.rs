//! Form of a contact law: what it is called, the numbers that it takes, and its force.

use super::{HERTZ, Law};
use vibro_record::Result;

/// Form of a contact law.
#[derive(Debug, Clone, Copy)]
pub struct LawForm {
    /// Name in files and on the command line.
    pub name: &'static str,
    /// Whether the force is linear in the indentation and its rate.
    pub linear: bool,
    /// Exponent of the indentation, unless stated.
    pub exponent: f64,
    /// Whether another exponent may be stated.
    pub any_exponent: bool,
    /// Where the damping comes from.
    pub damping: LawDamping,
    /// Unit of the damping.
    pub damping_unit: &'static str,
    /// Force in N of a law of this form at an indentation (m) above 0 and its rate (m/s); it may pull.
    pub force: fn(&Law, f64, f64) -> f64,
}

/// Where the damping of a contact law comes from.
#[derive(Debug, Clone, Copy)]
pub enum LawDamping {
    /// The form has no losses.
    Lossless,
    /// It must be stated.
    Stated,
    /// It is stated, or the law follows from stiffness (N/m), restitution and reduced mass (kg).
    OrRestitution(fn(f64, f64, f64) -> Result<Law>),
}

/// Forms are equal if their names are.
impl PartialEq for LawForm {
    fn eq(&self, other: &LawForm) -> bool {
        self.name == other.name
    }
}

impl LawForm {
    /// The law of this form with a stiffness (N/mⁿ), an exponent n, and a damping in its unit.
    pub const fn law(self, stiffness: f64, exponent: f64, damping: f64) -> Law {
        Law { form: self, stiffness, exponent, damping }
    }

    /// Unit of the stiffness.
    pub fn stiffness_unit(&self) -> &'static str {
        if self.linear { "N/m" } else { "N/mⁿ" }
    }

    /// Keys of `[contact]` that the form takes.
    pub fn keys(&self) -> Vec<&'static str> {
        let all = [
            ("stiffness", true),
            ("exponent", self.any_exponent),
            ("damping", !matches!(self.damping, LawDamping::Lossless)),
            ("radius", self.any_exponent || self.exponent == HERTZ),
        ];
        all.into_iter().filter_map(|(key, taken)| taken.then_some(key)).collect()
    }
}
