//! Table of the parameters that can be varied: the values of the rig and of its excitation.

use super::excitation::{Excitation, Sine};
use super::least::{NumberRange, number};
use super::rig::Rig;
use serde::{Deserialize, Serialize};
use vibro_record::{Error, Result};

/// A parameter of the rig or of its excitation. Maps vary them; fits determine those that a campaign can
/// name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Parameter {
    /// The excited mass.
    M1,
    /// The passive mass.
    M2,
    /// Stiffness of the excited mass' spring.
    K1,
    /// Stiffness of the passive mass' spring.
    K2,
    /// Damping of the excited mass.
    C1,
    /// Damping of the passive mass.
    C2,
    /// Gap at rest Δ.
    Gap,
    /// Coefficient of restitution R.
    Restitution,
    /// Frequency of the excitation.
    #[serde(skip_deserializing)]
    Frequency,
    /// Force amplitude F₀. Where each point has its own measured force, the median of these forces; a change
    /// scales them all.
    Force,
    /// Impulse of each blow.
    #[serde(skip_deserializing)]
    Impulse,
    /// Duration of each pulse.
    #[serde(skip_deserializing)]
    Width,
}

/// A parameter's name, unit, range of values, the mass that it belongs to (0 or 1; `None` for the contact and
/// the excitation), and its place in a rig.
type Row = (Parameter, &'static str, &'static str, NumberRange, Option<u8>, Option<fn(&mut Rig) -> &mut f64>);

/// One row for each parameter, in the order of the variants.
const TABLE: [Row; 12] = [
    (Parameter::M1, "m1", "kg", NumberRange::AboveZero, Some(0), Some(|rig| &mut rig.m1)),
    (Parameter::M2, "m2", "kg", NumberRange::AboveZero, Some(1), Some(|rig| &mut rig.m2)),
    (Parameter::K1, "k1", "N/m", NumberRange::AboveZero, Some(0), Some(|rig| &mut rig.k1)),
    (Parameter::K2, "k2", "N/m", NumberRange::AboveZero, Some(1), Some(|rig| &mut rig.k2)),
    (Parameter::C1, "c1", "N s/m", NumberRange::Zero, Some(0), Some(|rig| &mut rig.c1)),
    (Parameter::C2, "c2", "N s/m", NumberRange::Zero, Some(1), Some(|rig| &mut rig.c2)),
    (Parameter::Gap, "gap", "m", NumberRange::Any, None, Some(|rig| &mut rig.gap)),
    (Parameter::Restitution, "restitution", "1", NumberRange::Part, None, Some(|rig| &mut rig.restitution)),
    (Parameter::Frequency, "frequency", "Hz", NumberRange::AboveZero, None, None),
    (Parameter::Force, "force", "N", NumberRange::Zero, None, None),
    (Parameter::Impulse, "impulse", "N s", NumberRange::Any, None, None),
    (Parameter::Width, "width", "s", NumberRange::AboveZero, None, None),
];

impl Parameter {
    /// All parameters.
    pub fn all() -> impl Iterator<Item = Parameter> {
        TABLE.iter().map(|row| row.0)
    }

    /// The parameters of the rig.
    pub fn of_rig() -> impl Iterator<Item = Parameter> {
        TABLE.iter().filter(|row| row.5.is_some()).map(|row| row.0)
    }

    /// Whether a parameter of the rig has this name.
    pub fn is_of_rig(name: &str) -> bool {
        Parameter::of_rig().any(|p| p.name() == name)
    }

    /// The parameter with this name.
    pub fn named(name: &str) -> Option<Parameter> {
        Parameter::all().find(|p| p.name() == name)
    }

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// Name as in files.
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        self.row().2
    }

    /// Smallest and largest possible value.
    pub fn limits(self) -> (f64, f64) {
        match self.row().3 {
            NumberRange::Any => (f64::NEG_INFINITY, f64::INFINITY),
            NumberRange::Zero | NumberRange::AboveZero => (0.0, f64::INFINITY),
            NumberRange::Part => (0.0, 1.0),
        }
    }

    /// Whether it is one of the masses.
    pub fn is_mass(self) -> bool {
        self.unit() == "kg"
    }

    /// Whether only motions with impacts depend on it.
    pub fn needs_impacts(self) -> bool {
        self.row().5.is_some() && self.row().4 != Some(0)
    }

    /// Whether a fit can determine it: the rig's values, and the force.
    pub fn can_be_fitted(self) -> bool {
        self.row().5.is_some() || self == Parameter::Force
    }

    /// Its place in a rig; `None` where it belongs to the excitation.
    pub fn place(self, rig: &mut Rig) -> Option<&mut f64> {
        self.row().5.map(|place| place(rig))
    }

    /// Its value in a rig under a sine force; NaN for parameters of other excitations.
    pub fn of(self, rig: &Rig, sine: &Sine) -> f64 {
        match self {
            Parameter::Frequency => sine.frequency,
            Parameter::Force => sine.force,
            other => other.place(&mut rig.clone()).map_or(f64::NAN, |place| *place),
        }
    }

    /// Its value in a rig; `None` for the excitation's parameters, and for those of a wall, which have no
    /// effect.
    pub(crate) fn counting(self, rig: &Rig) -> Option<f64> {
        let counts = self.row().4 != Some(1) || !rig.has_wall();
        self.place(&mut rig.clone()).map(|value| *value).filter(|_| counts)
    }

    /// Checks that a value is possible.
    pub(crate) fn check(self, value: f64) -> Result<()> {
        number(self.name(), value, if self.unit() == "1" { "" } else { self.unit() }, self.row().3)
    }

    /// Sets its value; `None` where the excitation has no such parameter.
    pub(crate) fn set(self, rig: &mut Rig, excitation: &mut Excitation, value: f64) -> Option<()> {
        if self == Parameter::Frequency {
            *excitation = excitation.at_frequency(value);
            return Some(());
        }
        *self.place_in(rig, excitation)? = value;
        Some(())
    }

    /// Its place in a rig or its excitation; `None` for the frequency, and where the excitation has no such
    /// parameter.
    pub(crate) fn place_in<'a>(
        self,
        rig: &'a mut Rig,
        excitation: &'a mut Excitation,
    ) -> Option<&'a mut f64> {
        match (self, excitation) {
            (Parameter::Force, Excitation::Sine(sine)) => Some(&mut sine.force),
            (Parameter::Force, Excitation::Pulse(pulses)) => Some(&mut pulses.force),
            (Parameter::Impulse, Excitation::Impulse(impulses)) => Some(&mut impulses.impulse),
            (Parameter::Width, Excitation::Pulse(pulses)) => Some(&mut pulses.width),
            _ => self.place(rig),
        }
    }
}

impl Rig {
    /// Checks that the numbers are possible.
    ///
    /// # Errors
    /// If a mass or stiffness is not above 0, a damping is negative, the restitution is outside 0 to 1, or a
    /// value is not finite; `m2` may be infinite.
    pub fn check(&self) -> Result<()> {
        self.fault().map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The first impossible value: its key, and the error.
    pub fn fault(&self) -> Option<(&'static str, Error)> {
        Parameter::of_rig().find_map(|p| Some((p.name(), p.check(p.counting(self)?).err()?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_has_its_row_its_name_and_its_place() {
        let keys = toml::Table::try_from(Rig::thesis()).unwrap();
        assert_eq!(Parameter::of_rig().count(), keys.len());
        for (i, parameter) in Parameter::all().enumerate() {
            assert_eq!((parameter as usize, Parameter::named(parameter.name())), (i, Some(parameter)));
            assert_eq!(serde_json::to_value(parameter).unwrap(), parameter.name());
            let mut rig = Rig::thesis();
            if let Some(place) = parameter.place(&mut rig) {
                *place = 0.25;
                let changed = toml::Table::try_from(rig).unwrap();
                let differ = keys.iter().filter(|(key, value)| changed[*key] != **value);
                assert_eq!(differ.map(|(key, _)| key).collect::<Vec<_>>(), [parameter.name()]);
            }
        }
    }
}
