//! The laws of the contact that a scene states, or that stand for one it does not state.

use crate::contact::conversion;
use crate::{ContactKeys, Law, Rig, Scene};
use vibro_record::{Error, Result};

/// Exponent of two curved bodies.
pub(crate) const HERTZ: f64 = 1.5;

/// Keys of the contact; all unknown where there is none.
pub fn keys(scene: &Scene) -> ContactKeys {
    scene.contact.unwrap_or_default()
}

/// Whether the contact is stated to be other than a spring.
pub(crate) fn is_curved(scene: &Scene) -> bool {
    keys(scene).exponent.is_some_and(|n| n != 1.0)
}

/// The curved law that the scene states; losses that are not stated rebound with the rig's restitution at `speed` (m/s).
///
/// # Errors
/// If the stiffness is missing, or a number is impossible.
pub fn curved(scene: &Scene, speed: f64) -> Result<Law> {
    let keys = keys(scene);
    let exponent = keys.exponent.unwrap_or(HERTZ);
    let stiffness = keys.stiffness.ok_or_else(|| Error::refused("contact.stiffness is not known"))?;
    let law = match keys.damping {
        Some(damping) => Law::HuntCrossley { stiffness, exponent, damping },
        None => Law::hunt_crossley(stiffness, exponent, scene.rig.restitution, speed)?,
    };
    law.check().map(|()| law)
}

/// The contact of two curved bodies that lasts as long as this spring and damper where it is met at `speed` (m/s), and rebounds alike.
///
/// Without losses it lasts 2.9432 (5Mv²/4k)^{2/5}/v, which gives k.
///
/// # Errors
/// If the spring and damper do not rebound.
pub fn alike(rig: &Rig, law: Law, speed: f64) -> Result<Law> {
    let Law::KelvinVoigt { stiffness, damping } = law else { return Ok(law) };
    let mass = rig.reduced_mass();
    let ratio = damping / (2.0 * (stiffness * mass).sqrt());
    let lasts = conversion::duration(ratio, stiffness, mass);
    // hertz_duration falls with the stiffness as k^{−2/5}.
    let curved = (conversion::hertz_duration(1.0, mass, speed) / lasts).powf(2.5);
    Law::hunt_crossley(curved, HERTZ, conversion::restitution(ratio), speed)
}
