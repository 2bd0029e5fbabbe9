//! A scene: the rig, its excitation, and its contact.

mod curved;
mod draft;

pub use draft::Draft;

use super::excitation::Excitation;
use super::law::Law;
use super::rig::Rig;
use super::uncertainty::Uncertainty;
use serde::{Deserialize, Serialize};
use vibro_record::{Finding, Result};

/// The input of a computation of the rig's motion.
///
/// As a TOML file: the keys of [`Rig`] at the top, `[excitation]` with `kind` and the keys of that kind,
/// `[contact]` with `stiffness`, `damping`, `exponent`, or `radius`, `modulus` and `poisson` in place of
/// stiffness and exponent, `[buffer]` with `gap` and `damper_always`, `[springs]` with `cubic1` and `cubic2`,
/// and `[uncertainty]` with standard uncertainties of keys of the rig and the excitation. Keys of the rig
/// that are left out take the values of [`Rig::thesis`].
///
/// ```
/// use vibro_model::{Excitation, Scene, Sine};
/// let scene = Scene::from_toml("gap = 2e-3\n[excitation]\nkind = \"sine\"\nforce = 0.5\nfrequency = 11")?;
/// assert_eq!(scene.rig.gap, 2e-3);
/// assert_eq!(scene.excitation, Some(Excitation::Sine(Sine { force: 0.5, frequency: 11.0 })));
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// The rig.
    #[serde(flatten)]
    pub rig: Rig,
    /// Excitation of mass 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation: Option<Excitation>,
    /// A compliant contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactKeys>,
    /// Buffer of a loose mass 1: its spring and damper act only beyond a gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer: Option<Buffer>,
    /// Curvature of the springs. Only [`Duffing`](crate::Duffing) has it; the ladder checks its effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub springs: Option<Springs>,
    /// Standard uncertainties of the parameters, from which a Monte Carlo draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Uncertainty>,
}

/// Cubic coefficients k₃ in N/m³ of the springs' forces kx + k₃x³: above 0 a spring hardens, below 0 it
/// softens.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Springs {
    /// Of the spring of mass 1.
    pub cubic1: f64,
    /// Of the spring of mass 2.
    pub cubic2: f64,
}

impl Springs {
    /// Of both springs.
    pub fn cubic(&self) -> [f64; 2] {
        [self.cubic1, self.cubic2]
    }

    /// Caution that a model takes the springs as straight.
    pub fn unused(&self) -> Finding {
        Finding::caution("springs-unused").number("cubic1", self.cubic1).number("cubic2", self.cubic2)
    }
}

/// Numbers of a compliant contact; the contact law determines which of them are needed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct ContactKeys {
    /// Stiffness k of the force kδⁿ, in N/mⁿ.
    pub stiffness: Option<f64>,
    /// Damping: c in N s/m beside a linear spring, α in s/m in the Hunt–Crossley law.
    pub damping: Option<f64>,
    /// Exponent n of the force kδⁿ: 1 for a linear spring.
    pub exponent: Option<f64>,
    /// Radii in m of both bodies where they touch, `inf` for a flat one. With `modulus` and `poisson` they
    /// determine stiffness and exponent of a Hertz contact.
    pub radius: Option<[f64; 2]>,
    /// Young's moduli of both bodies, in Pa.
    pub modulus: Option<[f64; 2]>,
    /// Poisson's ratios of both bodies.
    pub poisson: Option<[f64; 2]>,
}

/// Buffer of a loose mass 1, on its side away from mass 2: spring and damper act in compression only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Buffer {
    /// Distance in m from the rest of mass 1 to the buffer: the spring acts only beyond it.
    pub gap: f64,
    /// The damper always acts, not only in compression.
    pub damper_always: bool,
}

impl Default for Buffer {
    fn default() -> Buffer {
        Buffer::thesis()
    }
}

impl Buffer {
    /// The buffer of the thesis' simulations with a loose mass: it begins 1 mm from the rest of mass 1.
    pub const fn thesis() -> Buffer {
        Buffer { gap: 1e-3, damper_always: false }
    }
}

impl Scene {
    /// Names of its tables in files; every other key is the rig's.
    pub const TABLES: [&str; 5] = ["excitation", "contact", "buffer", "springs", "uncertainty"];

    /// The rig of the thesis, without excitation.
    pub fn thesis() -> Scene {
        Scene {
            rig: Rig::thesis(),
            excitation: None,
            contact: None,
            buffer: None,
            springs: None,
            uncertainty: None,
        }
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// As [`Draft::from_toml`] and [`Draft::scene`].
    pub fn from_toml(text: &str) -> Result<Scene> {
        Draft::from_toml(text)?.scene()
    }

    /// Contact law of a spring of this stiffness (N/m) and a damper: the stated one, or the one that gives
    /// the rig's restitution.
    ///
    /// # Errors
    /// As [`Law::kelvin_voigt`] and [`Law::check`].
    pub fn spring(&self, stiffness: f64) -> Result<Law> {
        let law = match self.contact.and_then(|keys| keys.damping) {
            Some(damping) => Law::spring(stiffness, damping),
            None => Law::kelvin_voigt(stiffness, self.rig.restitution, self.rig.reduced_mass())?,
        };
        law.check().map(|()| law)
    }
}
