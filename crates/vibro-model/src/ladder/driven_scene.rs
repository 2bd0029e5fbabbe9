//! A scene at one excitation, and the contact law that its keys state.

use super::question::Question;
use crate::excitation::Excitation;
use crate::law::{HERTZ, Law};
use crate::scene::{ContactKeys, Scene};
use std::time::Instant;
use vibro_record::{Error, Result};

/// Result of `work` and its computing time in ns; NaN on WebAssembly, which has no clock.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = (!cfg!(target_family = "wasm")).then(Instant::now);
    let done = work();
    (done, begun.map_or(f64::NAN, |begun| begun.elapsed().as_nanos() as f64))
}

/// A scene at one excitation.
#[derive(Debug, Clone, Copy)]
pub struct DrivenScene<'a> {
    pub scene: &'a Scene,
    pub excitation: &'a Excitation,
    pub question: &'a Question,
}

/// Keys of the contact; all are unknown where the scene has no contact.
pub fn keys(scene: &Scene) -> ContactKeys {
    scene.contact.unwrap_or_default()
}

/// Whether the contact states an exponent other than 1: its force is then not linear.
pub fn is_curved(scene: &Scene) -> bool {
    keys(scene).exponent.is_some_and(|n| n != 1.0)
}

/// The Hunt–Crossley law of curved bodies with the numbers of the scene. A missing damping is replaced by the
/// one that gives the rig's restitution at the approach speed `speed` (m/s).
///
/// # Errors
/// If the stiffness is missing, or a number is impossible.
pub fn curved(scene: &Scene, speed: f64) -> Result<Law> {
    let keys = keys(scene);
    let exponent = keys.exponent.unwrap_or(HERTZ);
    let stiffness = keys.stiffness.ok_or_else(|| Error::refused("contact.stiffness is not known"))?;
    let law = match keys.damping {
        Some(damping) => Law::curved(stiffness, exponent, damping),
        None => Law::hunt_crossley(stiffness, exponent, scene.rig.restitution, speed)?,
    };
    law.check().map(|()| law)
}
