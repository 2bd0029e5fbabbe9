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
    pub fn get(&self, parameter: Parameter) -> f64 {
        parameter.of(&self.rig, self.force)
    }

    pub fn with(mut self, parameter: Parameter, value: f64) -> Setting {
        parameter.set(&mut self.rig, &mut self.force, value);
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
