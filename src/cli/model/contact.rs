//! The contact law of a scene.

use crate::cli::args;
use crate::error::{Error, Result};
use crate::model::{Law, Scene};

/// The law that `[contact]` of the scene describes. A spring and a damper without a stated damping rebound with the rig's restitution.
///
/// # Errors
/// If a number is missing that nothing else gives, or is impossible.
pub fn law(scene: &Scene, wanted: args::Law) -> Result<Law> {
    let keys = scene.contact.unwrap_or_default();
    let missing = |key: &str, unit: &str| {
        Error::usage(format!("a contact without {key}"), format!("contact.{key} in {unit}"))
            .hint(format!("give --set contact.{key}=…: no value fits all contacts, and results depend on it"))
    };
    // A key that the law has no place for is no detail: N/m and N/m^1.5 are different things.
    let other = |key: &str, value: f64, expected: &str| {
        Error::usage(format!("contact.{key} = {value} for this law"), expected)
            .hint("--model hunt-crossley takes stiffness, exponent and damping; hertz the stiffness alone; kelvin-voigt stiffness and damping")
    };
    let exponent = |law: f64| keys.exponent.filter(|n| *n != law);
    match (wanted, keys.damping) {
        (args::Law::HuntCrossley, _) => {}
        (args::Law::Hertz, Some(damping)) => {
            return Err(other("damping", damping, "none: Hertz has no losses"));
        }
        (args::Law::Hertz, None) => {
            if let Some(n) = exponent(1.5) {
                return Err(other("exponent", n, "1.5"));
            }
        }
        _ => {
            if let Some(n) = exponent(1.0) {
                return Err(other("exponent", n, "1: a spring"));
            }
        }
    }
    let stiffness = keys.stiffness.ok_or_else(|| missing("stiffness", "N/m, or N/mⁿ"))?;
    let law = match wanted {
        args::Law::Hertz => Law::Hertz { stiffness },
        args::Law::HuntCrossley => Law::HuntCrossley {
            stiffness,
            exponent: keys.exponent.unwrap_or(1.5),
            damping: keys.damping.ok_or_else(|| missing("damping", "s/m"))?,
        },
        _ => scene.spring(stiffness)?,
    };
    law.check()?;
    Ok(law)
}

/// A sentence where the scene's `[buffer]` and the model do not belong together.
pub fn buffer(scene: &Scene, wanted: args::Law) -> Option<String> {
    match (scene.buffer, wanted) {
        (Some(_), args::Law::LooseMass) => None,
        (Some(buffer), _) => Some(format!(
            "[buffer] gap = {} m is not used: the spring of mass 1 holds both ways in this model; --model loose-mass lets it push alone.",
            buffer.gap
        )),
        (None, args::Law::LooseMass) => Some(
            "Nothing states [buffer] gap: the loose mass is taken to touch its spring at rest (gap 0)."
                .to_owned(),
        ),
        (None, _) => None,
    }
}
