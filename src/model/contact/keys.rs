//! Contact laws and loose masses from the keys of a scene.

use super::{Compliant, Law};
use crate::error::{Error, Result};
use crate::model::{ContactKeys, Excitation, Loose, Scene, State};

impl Law {
    /// Kelvin–Voigt contact of a scene: `contact.stiffness` (N/m), and `contact.damping` (N s/m) or else the damping that
    /// rebounds with the rig's restitution.
    ///
    /// # Errors
    /// If the stiffness is missing, or as [`Law::kelvin_voigt`] and [`Law::check`].
    pub fn kelvin_voigt_of(scene: &Scene) -> Result<Law> {
        let (stiffness, keys) = stiffness(scene)?;
        let Some(damping) = keys.damping else {
            return Law::kelvin_voigt(stiffness, scene.rig.restitution, scene.rig.reduced_mass());
        };
        let law = Law::KelvinVoigt { stiffness, damping };
        law.check().map(|()| law)
    }

    /// Hertz contact of a scene: `contact.stiffness` (N/m^{3/2}).
    ///
    /// # Errors
    /// If the stiffness is missing or not above 0, or a damping or an exponent other than 3/2 is given.
    pub fn hertz_of(scene: &Scene) -> Result<Law> {
        let (stiffness, keys) = stiffness(scene)?;
        if keys.damping.is_some_and(|d| d != 0.0) || keys.exponent.is_some_and(|n| n != 1.5) {
            return Err(Error::usage(
                "a Hertz contact with a damping or an exponent of its own",
                "contact.stiffness alone; a Hunt–Crossley contact has both",
            ));
        }
        let law = Law::Hertz { stiffness };
        law.check().map(|()| law)
    }

    /// Hunt–Crossley contact of a scene: `contact.stiffness` (N/mⁿ), `contact.damping` α (s/m) and `contact.exponent` n (3/2
    /// where it is left out).
    ///
    /// # Errors
    /// If stiffness or damping are missing, or as [`Law::check`].
    pub fn hunt_crossley_of(scene: &Scene) -> Result<Law> {
        let (stiffness, keys) = stiffness(scene)?;
        let Some(damping) = keys.damping else {
            return Err(Error::usage(
                "a Hunt–Crossley contact without contact.damping",
                "α in s/m; a restitution alone does not fix it: it falls with the approach speed",
            ));
        };
        let law = Law::HuntCrossley { stiffness, damping, exponent: keys.exponent.unwrap_or(1.5) };
        law.check().map(|()| law)
    }
}

impl Compliant {
    /// The motion of a scene with one of its contact laws, from `state` and `phase`.
    ///
    /// # Errors
    /// If the scene has no excitation, or as [`Compliant::new`].
    pub fn of(scene: &Scene, law: Law, state: State, phase: f64) -> Result<Compliant> {
        Compliant::new(&scene.rig, excitation(scene)?, law, state, phase)
    }
}

impl Loose {
    /// The loose mass of a scene (`buffer.gap`, 0 where it is left out), from `state` and `phase`: with a Kelvin–Voigt contact
    /// where `contact.stiffness` is given, else with rebounds at once.
    ///
    /// # Errors
    /// If the scene has no excitation, or as [`Loose::new`], [`Loose::with_law`] and [`Law::kelvin_voigt_of`].
    pub fn of(scene: &Scene, state: State, phase: f64) -> Result<Loose> {
        let gap = scene.buffer.map_or(0.0, |buffer| buffer.gap);
        let excitation = excitation(scene)?;
        if scene.contact.is_none_or(|keys| keys.stiffness.is_none()) {
            return Loose::new(&scene.rig, excitation, gap, state, phase);
        }
        Loose::with_law(&scene.rig, excitation, gap, Law::kelvin_voigt_of(scene)?, state, phase)
    }
}

fn stiffness(scene: &Scene) -> Result<(f64, ContactKeys)> {
    let keys = scene.contact.unwrap_or_default();
    keys.stiffness.map(|stiffness| (stiffness, keys)).ok_or_else(|| {
        Error::usage("a contact that gives way without its stiffness", "contact.stiffness, a value above 0")
    })
}

fn excitation(scene: &Scene) -> Result<&Excitation> {
    scene.excitation.as_ref().ok_or_else(|| {
        Error::usage("a scene without an excitation", "[excitation] with kind, force and frequency")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(more: &str) -> Scene {
        let text = format!("{more}\n[excitation]\nkind = \"sine\"\nforce = 0.5\nfrequency = 11.0\n");
        Scene::from_toml(&text).unwrap()
    }

    #[test]
    fn laws_come_from_their_keys() {
        let both = scene("[contact]\nstiffness = 1e5\ndamping = 15.0");
        assert_eq!(Law::kelvin_voigt_of(&both).unwrap(), Law::KelvinVoigt { stiffness: 1e5, damping: 15.0 });
        let expected = Law::HuntCrossley { stiffness: 1e5, exponent: 1.5, damping: 15.0 };
        assert_eq!(Law::hunt_crossley_of(&both).unwrap(), expected);
        assert!(Law::hertz_of(&both).unwrap_err().to_string().contains("Hertz"));
        let stiff = scene("[contact]\nstiffness = 1e5");
        let rig = stiff.rig;
        let expected = Law::kelvin_voigt(1e5, rig.restitution, rig.reduced_mass()).unwrap();
        assert_eq!(Law::kelvin_voigt_of(&stiff).unwrap(), expected);
        assert_eq!(Law::hertz_of(&stiff).unwrap(), Law::Hertz { stiffness: 1e5 });
        assert!(Law::hunt_crossley_of(&stiff).unwrap_err().to_string().contains("contact.damping"));
        let none = scene("");
        for law in [Law::kelvin_voigt_of(&none), Law::hertz_of(&none), Law::hunt_crossley_of(&none)] {
            assert!(law.unwrap_err().to_string().contains("stiffness"));
        }
    }

    #[test]
    fn motions_come_from_their_scenes() {
        let loose = Loose::of(&scene("[buffer]\ngap = 1e-3"), State::REST, 0.0).unwrap();
        let same = Loose::new(loose.rig(), scene("").excitation.as_ref().unwrap(), 1e-3, State::REST, 0.0);
        assert_eq!(loose, same.unwrap());
        let text = "[buffer]\ngap = 1e-3\n[contact]\nstiffness = 1e5";
        assert_ne!(Loose::of(&scene(text), State::REST, 0.0).unwrap(), loose);
        let law = Law::Hertz { stiffness: 1e8 };
        assert_eq!(Compliant::of(&scene(""), law, State::REST, 0.0).unwrap().law(), law);
        assert!(Compliant::of(&Scene::thesis(), law, State::REST, 0.0).is_err());
    }
}
