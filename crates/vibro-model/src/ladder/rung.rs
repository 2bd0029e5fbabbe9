//! A rung of the ladder and what was found of it.

use super::Change;
use serde::Serialize;
use vibro_record::Finding;

/// A model of the rig, from the least to the most that it knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The motion without impacts, of mass 1 alone.
    Linear,
    /// One impact a cycle, in closed form.
    ClosedForm,
    /// The same, corrected for the duration of the contact.
    SoftCorrected,
    /// Exact flights between impacts without duration, chatter and sticking included.
    Restitution,
    /// Exact flights with a contact of spring and damper.
    KelvinVoigt,
    /// A contact whose force is no straight line: Hertz, Hunt and Crossley.
    HuntCrossley,
    /// A mass 1 that is loose on its spring.
    LooseMass,
}

impl Model {
    /// All, the simplest first.
    pub const ALL: [Model; 7] = [
        Model::Linear,
        Model::ClosedForm,
        Model::SoftCorrected,
        Model::Restitution,
        Model::KelvinVoigt,
        Model::HuntCrossley,
        Model::LooseMass,
    ];

    /// `linear`, `closed-form`, `soft-corrected`, `restitution`, `kelvin-voigt`, `hunt-crossley` or `loose-mass`.
    pub fn name(self) -> &'static str {
        match self {
            Model::Linear => "linear",
            Model::ClosedForm => "closed-form",
            Model::SoftCorrected => "soft-corrected",
            Model::Restitution => "restitution",
            Model::KelvinVoigt => "kelvin-voigt",
            Model::HuntCrossley => "hunt-crossley",
            Model::LooseMass => "loose-mass",
        }
    }

    /// Parameters that it needs beside those of mass 1, the gap and the excitation.
    pub fn needs(self) -> &'static [&'static str] {
        match self {
            Model::Linear => &[],
            Model::ClosedForm | Model::Restitution => &["mass 2", "restitution"],
            Model::SoftCorrected | Model::KelvinVoigt => {
                &["mass 2", "restitution or contact.damping", "contact.stiffness"]
            }
            Model::HuntCrossley => {
                &["mass 2", "restitution or contact.damping", "contact.stiffness", "contact.exponent"]
            }
            Model::LooseMass => &["mass 2", "restitution", "buffer.gap"],
        }
    }
}

/// What was found of a rung.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rung {
    /// The model.
    pub model: Model,
    /// Time in ns that its answer took on this machine; of models that are followed until they settle, all of it. `None` where it was
    /// not asked.
    pub cost_ns: Option<f64>,
    /// Largest change of its answer at the rungs above that answer, over the answer: at the next one, and at the next one that follows
    /// the motion. `None` where there is none.
    pub error: Option<f64>,
    /// Whether its own checks pass.
    pub valid: bool,
    /// Whether it is good enough: valid, its answer known as exactly as is asked for, and within what is allowed at the rungs above, or over all
    /// stiffnesses of a contact of which nothing is known.
    pub sufficient: bool,
    /// Whether its answer comes from a motion that has settled, or is a mean over one that does not repeat.
    pub settled: bool,
    /// Why.
    pub reasons: Vec<Finding>,
    /// The error that left it without an answer.
    pub refused: Option<String>,
    /// Parameters it needs beside those of mass 1, the gap and the excitation, and whether the scene has them.
    pub needs: Vec<Need>,
    /// Its answer: of x₁ and x₂; of impacts the same number twice.
    pub answer: Option<[f64; 2]>,
    /// Standard error of the answer, where it is a mean over a motion that does not repeat; else 0.
    pub spread: [f64; 2],
    /// The changes that `error` is the largest of.
    pub changes: Vec<Change>,
}

/// A parameter that a model needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Need {
    /// Its key, or what it is.
    pub parameter: &'static str,
    /// Whether the scene has it.
    pub known: bool,
}
