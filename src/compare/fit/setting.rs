//! A rig with the force on it, and what each step shows of its motions.

use super::super::prediction::Kind;
use crate::campaign::Parameter;
use crate::model::{Rig, Sine, Steady, shown};

/// A rig and the reference force on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    pub rig: Rig,
    /// In N.
    pub force: f64,
}

impl Setting {
    fn place(&mut self, parameter: Parameter) -> &mut f64 {
        match parameter {
            Parameter::Force => &mut self.force,
            Parameter::Restitution => &mut self.rig.restitution,
            Parameter::C1 => &mut self.rig.c1,
            Parameter::C2 => &mut self.rig.c2,
            Parameter::Gap => &mut self.rig.gap,
            Parameter::K1 => &mut self.rig.k1,
            Parameter::K2 => &mut self.rig.k2,
            Parameter::M1 => &mut self.rig.m1,
            Parameter::M2 => &mut self.rig.m2,
        }
    }

    pub fn get(mut self, parameter: Parameter) -> f64 {
        *self.place(parameter)
    }

    pub fn with(mut self, parameter: Parameter, value: f64) -> Setting {
        *self.place(parameter) = value;
        self
    }

    /// What a spectrum shows of both masses in m, of the motion of this kind at this force and frequency; NaN where it cannot be.
    pub fn shows(&self, kind: Kind, force: f64, frequency: f64) -> [f64; 2] {
        let sine = Sine { force, frequency };
        match kind {
            Kind::Impacting => shown(&self.rig, &sine).map_or([f64::NAN; 2], |s| s.amplitude),
            Kind::Free => Steady::new(&self.rig, &sine).map_or([f64::NAN; 2], |s| [s.amplitude(), 0.0]),
            Kind::Pattern | Kind::Irregular => [f64::NAN; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_has_its_place() {
        let setting = Setting { rig: Rig::thesis(), force: 0.1 };
        for parameter in Parameter::ALL {
            let changed = setting.with(parameter, 0.25);
            for other in Parameter::ALL {
                let expected = if other == parameter { 0.25 } else { setting.get(other) };
                assert_eq!(changed.get(other), expected, "{parameter:?} {other:?}");
            }
        }
    }
}
