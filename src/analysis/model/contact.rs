//! The contact law of a scene.

use crate::error::{Error, Result};
use crate::model::{Compliant, Excitation, Law, Scene, State};
use crate::record::Finding;
use serde::Deserialize;

/// Models of the contact by their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contact {
    /// Instantaneous, with the rig's restitution.
    Restitution,
    /// Spring and damper that do not pull.
    KelvinVoigt,
    /// Spheres.
    Hertz,
    /// Spheres with losses.
    HuntCrossley,
    /// A mass that is loose on its spring.
    LooseMass,
}

/// The law that `[contact]` of the scene describes. A spring and a damper without a stated damping rebound with the rig's restitution.
///
/// # Errors
/// If a number is missing that nothing else gives, or is impossible.
fn law(scene: &Scene, wanted: Contact) -> Result<Law> {
    let keys = scene.contact.unwrap_or_default();
    let missing = |key: &str, unit: &str| {
        Error::usage(format!("a contact without {key}"), format!("contact.{key} in {unit}"))
            .hint(format!("state contact.{key}; no value fits all contacts, and the result depends on it"))
            .setting("set")
    };
    // A key that the law has no place for is no detail: N/m and N/m^1.5 are different things.
    let exponent = |law: f64| ("exponent", keys.exponent.filter(|n| *n != law), format!("{law}"));
    let wrong = match wanted {
        Contact::HuntCrossley => vec![],
        Contact::Hertz => {
            vec![exponent(1.5), ("damping", keys.damping, "none: Hertz has no losses".to_owned())]
        }
        _ => vec![exponent(1.0)],
    };
    if let Some((key, Some(value), expected)) = wrong.into_iter().find(|(_, value, _)| value.is_some()) {
        return Err(Error::usage(format!("contact.{key} = {value} for this law"), expected)
            .hint("hunt-crossley takes stiffness, exponent and damping; hertz the stiffness alone; kelvin-voigt stiffness and damping"));
    }
    let stiffness = keys.stiffness.ok_or_else(|| missing("stiffness", "N/m, or N/mⁿ"))?;
    let law = match wanted {
        Contact::Hertz => Law::Hertz { stiffness },
        Contact::HuntCrossley => Law::HuntCrossley {
            stiffness,
            exponent: keys.exponent.unwrap_or(1.5),
            damping: keys.damping.ok_or_else(|| missing("damping", "s/m"))?,
        },
        _ => scene.spring(stiffness)?,
    };
    law.check()?;
    Ok(law)
}

/// Makes motions of a contact that gives way, or of a loose mass, from an excitation, a state and a phase (rad). A loose mass has impacts, or
/// a spring and a damper where the scene has a contact.
///
/// # Errors
/// As [`law`].
pub(super) fn compliant(
    scene: &Scene,
    wanted: Contact,
) -> Result<impl Fn(&Excitation, State, f64) -> Result<Compliant>> {
    let loose = wanted == Contact::LooseMass;
    let law = if loose && scene.contact.is_none() { None } else { Some(law(scene, wanted)?) };
    let (rig, gap) = (&scene.rig, scene.buffer.map_or(0.0, |b| b.gap));
    Ok(move |excitation: &Excitation, state, phase| match law {
        Some(law) if !loose => Compliant::new(rig, excitation, law, state, phase),
        law => Compliant::loose(rig, excitation, gap, law, state, phase),
    })
}

/// The finding that the scene's `[buffer]` and the model do not belong together.
pub(super) fn buffer(scene: &Scene, wanted: Contact) -> Option<Finding> {
    match scene.buffer {
        Some(_) if wanted == Contact::LooseMass => None,
        Some(buffer) => Some(Finding::caution("buffer-unused").number("gap", buffer.gap)),
        None => (wanted == Contact::LooseMass).then(|| Finding::caution("buffer-assumed")),
    }
}
