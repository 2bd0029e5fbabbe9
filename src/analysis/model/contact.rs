//! The contact law of a scene.

use crate::error::{Error, Result};
use crate::model::{Buffer, Compliant, Excitation, Law, Motion, Scene, Simulation, State};
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
    /// Hertzian contact of spheres, without losses.
    Hertz,
    /// Nonlinear contact with losses; exponent 1.5 (spheres) unless stated.
    HuntCrossley,
    /// A mass that is loose on its spring.
    LooseMass,
}

/// Help of the option for the contact law.
pub(super) const HELP: &str = "Contact law: restitution, kelvin-voigt, hertz, hunt-crossley, loose-mass";

/// A motion with any contact law.
pub(super) type Moving = Box<dyn Motion>;

/// The contact law of a scene, `None` for instantaneous impacts. A spring and a damper without a stated
/// damping rebound with the rig's restitution.
fn contact_law(scene: &Scene, wanted: Contact) -> Result<Option<Law>> {
    let keys = scene.contact.unwrap_or_default();
    // Keys of `[contact]` that the law uses, and the exponent that it implies.
    let (used_keys, implied_exponent): (&[&str], _) = match wanted {
        Contact::Restitution | Contact::HuntCrossley => {
            (&["stiffness", "exponent", "damping", "radius"], None)
        }
        Contact::KelvinVoigt | Contact::LooseMass => (&["stiffness", "damping"], Some(1.0)),
        Contact::Hertz => (&["stiffness", "radius"], Some(1.5)),
    };
    // A key that the law does not use is an error: the law decides whether a stiffness is in N/m or
    // N/m^1.5.
    let exponent = keys.exponent.filter(|n| Some(*n) != implied_exponent);
    let given = [
        ("radius", keys.radius.map(|[first, _]| first)),
        ("stiffness", keys.stiffness),
        ("exponent", exponent),
        ("damping", keys.damping),
    ];
    if let Some((key, value)) =
        given.iter().find_map(|(k, v)| v.filter(|_| !used_keys.contains(k)).map(|v| (k, v)))
    {
        let expected = format!("what this law takes: {}", used_keys.join(", "));
        return Err(Error::usage(format!("contact.{key} = {value} for this law"), expected)
            .hint("remove the key, or choose the law that has it: hunt-crossley takes stiffness, exponent and damping"));
    }
    let stated = |value: Option<f64>, key: &str, unit: &str| {
        value.ok_or_else(|| {
            Error::usage(format!("a contact without {key}"), format!("contact.{key} in {unit}"))
                .hint(format!(
                    "state contact.{key}; no value fits all contacts, and the result depends on it"
                ))
                .setting("set")
        })
    };
    let stiffness = || stated(keys.stiffness, "stiffness", "N/m, or N/mⁿ");
    Ok(match wanted {
        Contact::Restitution => None,
        Contact::KelvinVoigt => Some(scene.spring(stiffness()?)?),
        Contact::Hertz => Some(Law::Hertz { stiffness: stiffness()? }),
        Contact::HuntCrossley => Some(Law::HuntCrossley {
            stiffness: stiffness()?,
            exponent: keys.exponent.unwrap_or(1.5),
            damping: stated(keys.damping, "damping", "s/m")?,
        }),
        Contact::LooseMass => scene.contact.map(|_| scene.spring(stiffness()?)).transpose()?,
    })
}

/// Returns a function that starts motions of a scene from an excitation, a state and a phase (rad). Where
/// impacts are instantaneous, those slower than `grazing` (m/s) count as grazing.
///
/// # Errors
/// If a number that the contact law needs is missing, or one is impossible.
pub(super) fn motions(
    scene: &Scene,
    wanted: Contact,
    grazing: f64,
) -> Result<impl Fn(&Excitation, State, f64) -> Result<Moving>> {
    let (rig, buffer) = (&scene.rig, scene.buffer.unwrap_or(Buffer::thesis()));
    let law = contact_law(scene, wanted)?;
    Ok(move |excitation: &Excitation, state, phase| -> Result<Moving> {
        Ok(match law {
            _ if wanted == Contact::LooseMass => {
                Box::new(Compliant::loose(rig, excitation, buffer, law, state, phase)?)
            }
            Some(law) => Box::new(Compliant::new(rig, excitation, law, state, phase)?),
            None => Box::new(Simulation::from_state(rig, excitation, state, phase)?.grazing_below(grazing)),
        })
    })
}

/// Caution where a stated `[buffer]` is not used, or a model assumes one that is not stated.
pub(super) fn buffer(scene: &Scene, wanted: Contact) -> Option<Finding> {
    match scene.buffer {
        Some(_) if wanted == Contact::LooseMass => None,
        Some(buffer) => Some(Finding::caution("buffer-unused").number("gap", buffer.gap)),
        None => (wanted == Contact::LooseMass)
            .then(|| Finding::caution("buffer-assumed").number("gap", Buffer::thesis().gap)),
    }
}
