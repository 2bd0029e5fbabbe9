//! An orbit as it is listed: all verdicts and amplitudes beside each other.

use super::{Orbit, Orbits};
use crate::NoImpact;
use crate::validity::{Loss, Stability};
use serde::ser::{Serialize, Serializer};

#[derive(serde::Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "verdicts, each on its own")]
struct Listed {
    frequency: f64,
    cycles: u32,
    impulse: f64,
    timing: f64,
    timing_unit: &'static str,
    force_phase: f64,
    approach_velocity: f64,
    min_gap: f64,
    clearance: Option<f64>,
    multipliers: Option<[[f64; 2]; 4]>,
    spectral_radius: Option<f64>,
    exists: bool,
    admissible: bool,
    stable: bool,
    stability: Stability,
    instability: Option<Loss>,
    energy_rule: bool,
    grazing_distance: f64,
    peak_to_peak: [f64; 2],
    fundamental: [f64; 2],
    fundamental_phase: [f64; 2],
}

impl Serialize for Orbit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let v = &self.validity;
        Listed {
            frequency: self.frequency,
            cycles: self.cycles,
            impulse: self.impulse,
            timing: self.timing,
            timing_unit: self.timing_unit(),
            force_phase: self.force_phase,
            approach_velocity: self.approach_velocity,
            min_gap: v.min_gap,
            clearance: v.clearance,
            multipliers: self.multipliers.map(|all| all.map(|z| [z.re, z.im])),
            spectral_radius: self.spectral_radius(),
            exists: v.exists,
            admissible: v.admissible,
            // Neutral is not stable.
            stable: v.stable == Some(true),
            stability: v.stability,
            instability: v.instability,
            energy_rule: v.energy_rule,
            grazing_distance: v.grazing_distance,
            peak_to_peak: self.peak_to_peak,
            fundamental: self.fundamental.map(num_complex::Complex::norm),
            fundamental_phase: self.fundamental.map(num_complex::Complex::arg),
        }
        .serialize(serializer)
    }
}

#[derive(serde::Serialize)]
struct All<'a> {
    orbits: &'a [Orbit],
    no_impact: &'a NoImpact,
}

impl Serialize for Orbits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        All { orbits: &self.orbits, no_impact: &self.no_impact }.serialize(serializer)
    }
}
