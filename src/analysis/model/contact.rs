//! The contact law of a scene.

use crate::error::{Error, Result};
use crate::model::{
    Buffer, Compliant, Excitation, FORMS, Law, LawDamping, LawForm, Motion, Scene, Simulation, State,
};
use crate::record::{Finding, Kind};

/// Models of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// Instantaneous, with the rig's restitution.
    Restitution,
    /// It gives way, with a law of this form.
    Law(LawForm),
    /// A mass that is loose on its spring.
    LooseMass,
}

/// Names of the models of the contact: the forms of laws between the first and the last.
const NAMES: [&str; FORMS.len() + 2] = {
    let mut names = ["restitution"; FORMS.len() + 2];
    let mut k = 0;
    while k < FORMS.len() {
        names[k + 1] = FORMS[k].name;
        k += 1;
    }
    names[k + 1] = "loose-mass";
    names
};

impl Contact {
    /// The model of this name.
    ///
    /// # Errors
    /// With the names of all, if it is none of them.
    pub fn named(name: &str) -> std::result::Result<Contact, Kind> {
        match name {
            "restitution" => Ok(Contact::Restitution),
            "loose-mass" => Ok(Contact::LooseMass),
            _ => {
                let form = FORMS.iter().find(|form| form.name == name);
                form.map(|form| Contact::Law(*form)).ok_or(Kind::Names(&NAMES))
            }
        }
    }

    /// Whether it is a law without losses.
    pub fn is_lossless(self) -> bool {
        matches!(self, Contact::Law(LawForm { damping: LawDamping::Lossless, .. }))
    }
}

/// Help of the option for the contact law.
#[cfg(feature = "cli")]
pub(super) fn help() -> String {
    format!("Contact law: {}", NAMES.join(", "))
}

/// A motion with any contact law.
pub(super) type Moving = Box<dyn Motion>;

/// The contact law of a scene, `None` for instantaneous impacts.
fn contact_law(scene: &Scene, wanted: Contact) -> Result<Option<Law>> {
    // A loose mass strikes a contact that is linear, or rebounds at once where none is stated.
    let form = match wanted {
        Contact::Restitution => return Ok(None),
        Contact::Law(form) => form,
        Contact::LooseMass if scene.contact.is_none() => return Ok(None),
        Contact::LooseMass => Law::spring(1.0, 0.0).form,
    };
    let keys = scene.contact.unwrap_or_default();
    // A key that the law does not use is an error: the law decides whether a stiffness is in N/m or
    // N/m^1.5.
    let exponent = keys.exponent.filter(|n| *n != form.exponent);
    let given = [
        ("radius", keys.radius.map(|[first, _]| first)),
        ("stiffness", keys.stiffness),
        ("exponent", exponent),
        ("damping", keys.damping),
    ];
    let unused = |(key, value): &(&'static str, Option<f64>)| {
        value.filter(|_| !form.keys().contains(key)).map(|value| (*key, value))
    };
    if let Some((key, value)) = given.iter().find_map(unused) {
        let expected = format!("what this law takes: {}", form.keys().join(", "));
        let takes = FORMS.iter().filter(|form| form.keys().contains(&key));
        let takes: Vec<&str> = takes.map(|form| form.name).collect();
        let hint = format!("remove the key, or choose a law that takes it: {}", takes.join(", "));
        return Err(Error::usage(format!("contact.{key} = {value} for this law"), expected).hint(hint));
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
    let stiffness = stated(keys.stiffness, "stiffness", "N/m, or N/mⁿ")?;
    let exponent = keys.exponent.unwrap_or(form.exponent);
    let damping = match form.damping {
        LawDamping::Lossless => 0.0,
        LawDamping::Stated => stated(keys.damping, "damping", form.damping_unit)?,
        LawDamping::OrRestitution(law) => match keys.damping {
            Some(damping) => damping,
            None => return law(stiffness, scene.rig.restitution, scene.rig.reduced_mass()).map(Some),
        },
    };
    let law = form.law(stiffness, exponent, damping);
    law.check().map(|()| Some(law))
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
