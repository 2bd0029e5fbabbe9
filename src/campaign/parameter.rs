//! Parameters of the rig and its excitation that a fit can find.

use crate::error::{Error, Result};
use crate::model::Rig;
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

    /// Name as in a campaign.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Force => "force",
            Parameter::Restitution => "restitution",
            Parameter::C1 => "c1",
            Parameter::C2 => "c2",
            Parameter::Gap => "gap",
            Parameter::K1 => "k1",
            Parameter::K2 => "k2",
            Parameter::M1 => "m1",
            Parameter::M2 => "m2",
        }
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Force => "N",
            Parameter::Restitution => "1",
            Parameter::C1 | Parameter::C2 => "N s/m",
            Parameter::Gap => "m",
            Parameter::K1 | Parameter::K2 => "N/m",
            Parameter::M1 | Parameter::M2 => "kg",
        }
    }

    /// The parameter of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn from_name(name: &str) -> Result<Parameter> {
        Parameter::ALL.into_iter().find(|p| p.name() == name).ok_or_else(|| {
            let known: Vec<&str> = Parameter::ALL.into_iter().map(Parameter::name).collect();
            let error = Error::usage(format!("no parameter of a fit is named {name:?}"), known.join(", "));
            if name.contains("contact") {
                error.hint("state it as `stiffness` in [contact]: a model corrected for it is then judged")
            } else {
                error
            }
        })
    }

    /// Where it can lie: R from 0 to 1, all others above 0.
    pub fn range(self) -> (f64, f64) {
        if self == Parameter::Restitution { (0.0, 1.0) } else { (0.0, f64::INFINITY) }
    }

    /// Whether it is one of the masses.
    pub fn is_mass(self) -> bool {
        matches!(self, Parameter::M1 | Parameter::M2)
    }

    /// Its value on this rig under this force (N).
    pub fn of(self, rig: &Rig, force: f64) -> f64 {
        match self {
            Parameter::Force => force,
            Parameter::Restitution => rig.restitution,
            Parameter::C1 => rig.c1,
            Parameter::C2 => rig.c2,
            Parameter::Gap => rig.gap,
            Parameter::K1 => rig.k1,
            Parameter::K2 => rig.k2,
            Parameter::M1 => rig.m1,
            Parameter::M2 => rig.m2,
        }
    }

    /// Gives it this value.
    pub fn set(self, rig: &mut Rig, force: &mut f64, value: f64) {
        let place = match self {
            Parameter::Force => force,
            Parameter::Restitution => &mut rig.restitution,
            Parameter::C1 => &mut rig.c1,
            Parameter::C2 => &mut rig.c2,
            Parameter::Gap => &mut rig.gap,
            Parameter::K1 => &mut rig.k1,
            Parameter::K2 => &mut rig.k2,
            Parameter::M1 => &mut rig.m1,
            Parameter::M2 => &mut rig.m2,
        };
        *place = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_has_its_place() {
        for parameter in Parameter::ALL {
            let (mut rig, mut force) = (Rig::thesis(), 0.1);
            parameter.set(&mut rig, &mut force, 0.25);
            for other in Parameter::ALL {
                let expected = if other == parameter { 0.25 } else { other.of(&Rig::thesis(), 0.1) };
                assert_eq!(other.of(&rig, force), expected, "{parameter:?} {other:?}");
            }
            assert_eq!(Parameter::from_name(parameter.name()).unwrap(), parameter);
        }
        let text = Parameter::from_name("mass").unwrap_err().to_string();
        assert!(text.contains("\"mass\"") && text.contains("restitution"), "{text}");
    }
}
