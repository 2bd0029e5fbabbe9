//! Parameters of the rig and its excitation that a fit can find.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// A parameter that measured responses may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Parameter {
    /// Force amplitude F₀; where each point has its own measured force, their median, all scaled together.
    Force,
    /// Coefficient of restitution R.
    Restitution,
    /// Damping of the excited mass.
    C1,
    /// Damping of the passive mass.
    C2,
    /// Gap at rest Δ.
    Gap,
    /// Stiffness of the excited mass' spring.
    K1,
    /// Stiffness of the passive mass' spring.
    K2,
    /// The excited mass; only beside what is known of it, since motion tells the ratios of force, stiffness and damping to it.
    M1,
    /// The passive mass; likewise.
    M2,
}

impl Parameter {
    /// All, in the order of their printing.
    pub const ALL: [Parameter; 9] = [
        Parameter::Force,
        Parameter::Restitution,
        Parameter::C1,
        Parameter::C2,
        Parameter::Gap,
        Parameter::K1,
        Parameter::K2,
        Parameter::M1,
        Parameter::M2,
    ];

    fn label(self) -> (&'static str, &'static str) {
        match self {
            Parameter::Force => ("force", "N"),
            Parameter::Restitution => ("restitution", "1"),
            Parameter::C1 => ("c1", "N s/m"),
            Parameter::C2 => ("c2", "N s/m"),
            Parameter::Gap => ("gap", "m"),
            Parameter::K1 => ("k1", "N/m"),
            Parameter::K2 => ("k2", "N/m"),
            Parameter::M1 => ("m1", "kg"),
            Parameter::M2 => ("m2", "kg"),
        }
    }

    /// Name as in a campaign.
    pub fn name(self) -> &'static str {
        self.label().0
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        self.label().1
    }

    /// The parameter of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn from_name(name: &str) -> Result<Parameter> {
        Parameter::ALL.into_iter().find(|p| p.name() == name).ok_or_else(|| {
            let known = Parameter::ALL.map(Parameter::name).join(", ");
            let error = Error::usage(format!("no parameter of a fit is named {name:?}"), known);
            if name.contains("contact") {
                error.hint("state it as `stiffness` in [contact]: a model corrected for it is then judged")
            } else {
                error
            }
        })
    }

    /// Where it can lie: R from 0 to 1, all others above 0.
    pub(crate) fn range(self) -> (f64, f64) {
        if self == Parameter::Restitution { (0.0, 1.0) } else { (0.0, f64::INFINITY) }
    }

    /// Whether only motions with impacts depend on it.
    pub(crate) fn needs_impacts(self) -> bool {
        !matches!(self, Parameter::Force | Parameter::C1 | Parameter::K1 | Parameter::M1)
    }

    /// Whether it is one of the masses.
    pub fn is_mass(self) -> bool {
        matches!(self, Parameter::M1 | Parameter::M2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_has_its_name() {
        for parameter in Parameter::ALL {
            assert_eq!(Parameter::from_name(parameter.name()).unwrap(), parameter);
        }
        let text = Parameter::from_name("mass").unwrap_err().to_string();
        assert!(text.contains("\"mass\"") && text.contains("restitution"), "{text}");
    }
}
