//! The model of a rig: `vibro model`, one file for each question; figures of its orbits, motions, sweeps,
//! maps, and of the choice of a model.

pub mod backbone;
pub mod branch;
pub mod choose;
pub mod contact;
pub mod drill;
pub mod figures;
pub mod map;
pub mod orbit;
mod pattern;
pub mod response;
pub mod simulate;
pub mod sweep;

use crate::error::{Error, Result};
use crate::model::{Draft, Excitation, Orbit, Scene};
use crate::record::Finding;
use num_complex::Complex64;
use serde::Serialize;
use std::path::PathBuf;

/// Keys of a scene: the rig, and its excitation.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct SceneKeys {
    /// Rig as a TOML file: m1 m2 k1 k2 c1 c2 gap restitution, tables excitation, contact, buffer, springs
    /// [default: the thesis' rig]
    #[cfg_attr(feature = "cli", arg(index = 1))]
    pub rig: Option<PathBuf>,
    /// Set a key of the rig, tables with a dot: gap=0.5e-3, contact.stiffness=1e5
    #[cfg_attr(feature = "cli", arg(long = "set", value_name = "KEY=VALUE"))]
    pub set: Vec<String>,
    /// Force in N: amplitude of a sine, height of a pulse
    pub force: Option<f64>,
    /// Impulse in N s, once a cycle, instead of a sine force
    #[cfg_attr(feature = "cli", arg(conflicts_with_all = ["force", "width"]))]
    pub impulse: Option<f64>,
    /// Width in s of a rectangular pulse, once a cycle, instead of a sine force
    pub width: Option<f64>,
}

/// A scene with its excitation, and findings on keys of the rig that are missing or not used.
#[derive(Debug, Clone)]
struct Driven {
    scene: Scene,
    excitation: Excitation,
    findings: Vec<Finding>,
}

impl SceneKeys {
    /// The scene for a model with straight springs, with a caution where `[springs]` is stated.
    fn driven(&self, frequency: Option<f64>) -> Result<Driven> {
        let mut driven = self.driven_with_springs(frequency)?;
        driven.findings.extend(driven.scene.springs.map(|springs| springs.unused()));
        Ok(driven)
    }

    /// The scene: the rig file, with the keys in `set` replaced, then with the keys of the excitation.
    /// `frequency` in Hz replaces that of the excitation.
    fn driven_with_springs(&self, frequency: Option<f64>) -> Result<Driven> {
        let mut draft = self.rig.as_ref().map_or_else(|| Ok(Draft::default()), Draft::from_path)?;
        let missing = if self.rig.is_some() { draft.left_out() } else { Vec::new() };
        for assignment in &self.set {
            draft.set(assignment)?;
        }
        if self.impulse.is_some() {
            draft.put("excitation.kind", "impulse");
        } else if self.width.is_some() {
            draft.put("excitation.kind", "pulse");
        }
        let given = [("force", self.force), ("impulse", self.impulse), ("width", self.width)];
        for (key, value) in given.into_iter().filter_map(|(key, value)| Some((key, value?))) {
            draft.put(&format!("excitation.{key}"), value);
        }
        let excitation_keys = ["force", "impulse", "width", "parts", "kind"];
        if let Some(frequency) = frequency
            && excitation_keys.iter().any(|key| draft.has(&format!("excitation.{key}")))
        {
            draft.put("excitation.frequency", frequency);
        }
        let scene = draft.scene()?;
        let excitation = scene.excitation.clone().ok_or_else(|| {
            let expected =
                "a force (sine), an impulse, a force with a width (pulse), or [excitation] in the rig file";
            Error::usage("nothing drives the rig", expected).setting("force").setting("impulse")
        })?;
        let findings = rig_left_out("The file", &missing).into_iter().collect();
        Ok(Driven { scene, excitation, findings })
    }
}

/// Doubt that keys of a rig are missing and were taken from the thesis' rig. What a model computes has no
/// uncertainty.
pub(in crate::analysis) fn rig_left_out(table: &str, keys: &[&str]) -> Option<Finding> {
    let found = Finding::doubt("rig-left-out").name("table", table).name("keys", keys.join(", "));
    (!keys.is_empty()).then(|| found.without_estimate())
}

/// Number of spectral lines listed for each orbit.
const LINES: u32 = 8;

/// An orbit with quantities computed from it.
#[derive(Serialize)]
struct JudgedOrbit<'a> {
    #[serde(flatten)]
    orbit: &'a Orbit,
    /// Amplitudes in m of both masses at the first multiples of 1/T, with T the period.
    lines: Vec<[f64; 2]>,
    /// Whether grazing is farther away than the uncertainty of the gap, where that is stated.
    robust: Option<bool>,
    /// Whether grazing lies within that uncertainty.
    near_grazing: Option<bool>,
}

impl JudgedOrbit<'_> {
    /// `gap_std` is the standard uncertainty of the gap in m.
    fn of(orbit: &Orbit, gap_std: Option<f64>) -> JudgedOrbit<'_> {
        let v = &orbit.validity;
        JudgedOrbit {
            orbit,
            lines: (1..=LINES).map(|n| orbit.line(n).map(Complex64::norm)).collect(),
            robust: gap_std.map(|std| orbit.robust(std)),
            near_grazing: gap_std.filter(|_| v.exists).map(|std| v.grazing_distance <= std),
        }
    }
}

/// Checks a standard uncertainty of the gap in m.
fn check_gap_std(gap_std: Option<f64>) -> Result<()> {
    match gap_std {
        Some(v) if !(v.is_finite() && v >= 0.0) => {
            Err(Error::usage(format!("gap_std is {v} m"), "a finite value of 0 or more").setting("gap_std"))
        }
        _ => Ok(()),
    }
}
