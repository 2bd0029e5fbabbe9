//! `vibro model`: what the motion of a rig should be.

mod choose;
mod contact;
mod map;
mod orbit;
mod response;
mod simulate;
mod sweep;

use super::args::{self, ModelCommand};
use crate::error::{Error, Result};
use crate::model::{Draft, Orbit, Scene};
use serde::Serialize;

pub fn run(typed: &args::Model, json: bool) -> Result<()> {
    match &typed.command {
        ModelCommand::Orbit(typed) => orbit::run(typed, json),
        ModelCommand::Simulate(typed) => simulate::run(typed, json),
        ModelCommand::Response(typed) => response::run(typed, json),
        ModelCommand::Sweep(typed) => sweep::run(typed, json),
        ModelCommand::Choose(typed) => choose::run(typed, json),
        ModelCommand::Map(typed) => map::run(typed, json),
    }
}

/// The scene that is meant, and sentences about it: the file, then `--set`, then the options of the excitation.
///
/// `frequency` in Hz replaces that of the excitation, where there is an excitation.
///
/// # Errors
/// As [`Draft::from_path`], [`Draft::set`] and [`Draft::scene`].
pub fn scene(typed: &args::Scene, frequency: Option<f64>) -> Result<(Scene, Vec<String>)> {
    let mut draft = match &typed.rig {
        Some(path) => Draft::from_path(path)?,
        None => Draft::default(),
    };
    let mut doubts = Vec::new();
    let missing = draft.left_out();
    if typed.rig.is_some() && !missing.is_empty() {
        doubts.push(format!(
            "The file does not give {}: the values of the thesis' rig are used.",
            missing.join(", ")
        ));
    }
    for assignment in &typed.set {
        draft.set(assignment)?;
    }
    let kind = match (typed.impulse, typed.width) {
        (Some(_), _) => Some("impulse"),
        (_, Some(_)) => Some("pulse"),
        _ => None,
    };
    if let Some(kind) = kind {
        draft.drive(kind);
    }
    let driven = ["force", "impulse", "width", "parts", "kind"].map(|key| format!("excitation.{key}"));
    for (key, value) in [("force", typed.force), ("impulse", typed.impulse), ("width", typed.width)] {
        if let Some(value) = value {
            draft.put(&format!("excitation.{key}"), value);
        }
    }
    if let Some(frequency) = frequency.filter(|_| driven.iter().any(|key| draft.has(key))) {
        draft.put("excitation.frequency", frequency);
    }
    Ok((draft.scene()?, doubts))
}

/// The excitation of a scene that needs one.
///
/// # Errors
/// If it has none.
pub fn excitation(scene: &Scene) -> Result<&crate::model::Excitation> {
    scene.excitation.as_ref().ok_or_else(|| {
        Error::usage("nothing drives the rig", "an excitation")
            .hint("give --force N (a sine), --impulse NS, --force N --width S, or [excitation] in the file")
    })
}

/// An orbit with what the uncertainty of the gap leaves of it.
#[derive(Serialize)]
struct Judged<'a> {
    #[serde(flatten)]
    orbit: &'a Orbit,
    /// Amplitudes of x1 and x2 at the first multiples of 1/T.
    lines: Vec<[f64; 2]>,
    robust: Option<bool>,
    near_grazing: Option<bool>,
}

/// Lines that are listed of each motion.
const LINES: u32 = 8;

fn judged(orbit: &Orbit, gap_std: Option<f64>) -> Judged<'_> {
    let v = &orbit.validity;
    Judged {
        orbit,
        lines: (1..=LINES).map(|n| orbit.line(n).map(num_complex::Complex::norm)).collect(),
        robust: gap_std.map(|std| orbit.robust(std)),
        near_grazing: gap_std.filter(|_| v.exists).map(|std| v.grazing_distance <= std),
    }
}

/// Checks an uncertainty of the gap.
fn gap_std(typed: Option<f64>) -> Result<Option<f64>> {
    match typed {
        Some(v) if !(v.is_finite() && v >= 0.0) => {
            Err(Error::usage(format!("--gap-std is {v} m"), "a finite value of 0 or more"))
        }
        typed => Ok(typed),
    }
}
