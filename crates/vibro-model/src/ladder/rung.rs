//! A rung of the ladder and what was found of it.

use super::question::{Answer, Change};
use super::reading::{Reading, Settling};
use super::stage::keys;
use crate::scene::Scene;
use serde::Serialize;
use vibro_record::{Error, Finding};

/// A model of the rig, from the least to the most that it knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The motion without impacts, of mass 1 alone.
    #[default]
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

    /// The name of each, and the parameters that it needs beside those of mass 1, the gap and the excitation;
    /// in their order.
    const TABLE: [(&'static str, &'static [Need]); 7] = [
        ("linear", &[]),
        ("closed-form", &[Need::Mass2, Need::Restitution]),
        ("soft-corrected", &[Need::Mass2, Need::Rebound, Need::Stiffness]),
        ("restitution", &[Need::Mass2, Need::Restitution]),
        ("kelvin-voigt", &[Need::Mass2, Need::Rebound, Need::Stiffness]),
        ("hunt-crossley", &[Need::Mass2, Need::Rebound, Need::Stiffness, Need::Exponent]),
        ("loose-mass", &[Need::Mass2, Need::Restitution, Need::Buffer]),
    ];

    /// `linear`, `closed-form`, `soft-corrected`, `restitution`, `kelvin-voigt`, `hunt-crossley` or
    /// `loose-mass`.
    pub fn name(self) -> &'static str {
        Model::TABLE[self as usize].0
    }

    /// Parameters that it needs beside those of mass 1, the gap and the excitation.
    pub fn needs(self) -> &'static [Need] {
        Model::TABLE[self as usize].1
    }
}

/// What a model needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(into = "&'static str")]
pub enum Need {
    /// Mass, stiffness and damping of mass 2.
    Mass2,
    /// The coefficient of restitution.
    Restitution,
    /// That, or the contact's damping: what the rebound loses.
    Rebound,
    /// The contact's stiffness.
    Stiffness,
    /// The contact's damping.
    Damping,
    /// The exponent of the contact's law.
    Exponent,
    /// The gap of the buffer behind mass 1.
    Buffer,
    /// The way the frequency came.
    History,
}

/// Whether a scene has something.
type Known = fn(&Scene) -> bool;

impl Need {
    /// Its key, or what it is, and whether a scene has it; in the order of the parameters.
    const TABLE: [(&'static str, Known); 8] = [
        ("mass 2", |_| true),
        ("restitution", |_| true),
        ("restitution or contact.damping", |s| keys(s).damping.is_some() || s.rig.restitution > 0.0),
        ("contact.stiffness", |scene| keys(scene).stiffness.is_some()),
        ("contact.damping", |scene| keys(scene).damping.is_some()),
        ("contact.exponent", |scene| keys(scene).exponent.is_some()),
        ("buffer.gap", |scene| scene.buffer.is_some()),
        ("history", |_| false),
    ];

    /// Its key, or what it is.
    pub fn name(self) -> &'static str {
        Need::TABLE[self as usize].0
    }

    /// The names of several, with commas.
    pub fn names(needs: &[Need]) -> String {
        needs.iter().map(|need| need.name()).collect::<Vec<_>>().join(", ")
    }

    /// Whether a scene has it.
    pub(super) fn known(self, scene: &Scene) -> bool {
        Need::TABLE[self as usize].1(scene)
    }
}

impl From<Need> for &'static str {
    fn from(need: Need) -> &'static str {
        need.name()
    }
}

/// A parameter that a model needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Needed {
    /// What it is.
    pub parameter: Need,
    /// Whether the scene has it.
    pub known: bool,
}

/// What was found of a rung.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Rung {
    /// The model.
    pub model: Model,
    /// Time in ns that its answer took on this machine; of models that are followed until they settle, all
    /// of it. `None` without an answer.
    pub cost_ns: Option<f64>,
    /// Largest change of its answer at the rungs above that answer, over the answer: at the next one, and at
    /// the next one that follows the motion. `None` where there is none.
    pub error: Option<f64>,
    /// Whether its own checks pass.
    pub valid: bool,
    /// Whether it is good enough: valid, its answer known as exactly as is asked for, and within what is
    /// allowed at the rungs above, or over all stiffnesses of a contact of which nothing is known.
    pub sufficient: bool,
    /// Whether its answer comes from a motion that has settled, or is a mean over one that does not repeat.
    pub settled: bool,
    /// Why.
    pub reasons: Vec<Finding>,
    /// The error that left it without an answer.
    pub refused: Option<String>,
    /// Parameters it needs beside those of mass 1, the gap and the excitation, and whether the scene has
    /// them.
    pub needs: Vec<Needed>,
    /// Its answer: of x₁ and x₂; of impacts the same number twice.
    pub answer: Option<[f64; 2]>,
    /// Standard error of the answer, where it is a mean over a motion that does not repeat; else 0.
    pub spread: [f64; 2],
    /// The changes that `error` is the largest of.
    pub changes: Vec<Change>,
}

/// A rung, its model left out, or why it has no answer.
pub(super) type Found = Result<Rung, Miss>;

/// Why a rung has no answer: for a reason, or since it cannot be computed.
pub(super) enum Miss {
    Reason(Finding),
    Refused(String),
}

impl From<Finding> for Miss {
    fn from(reason: Finding) -> Miss {
        Miss::Reason(reason)
    }
}

impl From<Error> for Miss {
    fn from(error: Error) -> Miss {
        Miss::from(&error)
    }
}

impl From<&Error> for Miss {
    fn from(error: &Error) -> Miss {
        Miss::Refused(error.to_string().lines().next().unwrap_or_default().to_owned())
    }
}

impl Rung {
    /// The rung of a model.
    pub(super) fn of(model: Model, found: Found) -> Rung {
        let rung = found.unwrap_or_else(|miss| match miss {
            Miss::Reason(reason) => Rung { reasons: vec![reason], ..Rung::default() },
            Miss::Refused(text) => Rung { refused: Some(text), ..Rung::default() },
        });
        Rung { model, ..rung }
    }

    /// One with an answer, which took this time in ns.
    pub(super) fn answering(answer: Answer, cost: f64, valid: bool, reasons: Vec<Finding>) -> Rung {
        let Answer { value, spread, steady } = answer;
        let (answer, cost_ns) = (Some(value), Some(cost));
        Rung { valid, answer, spread, settled: steady, cost_ns, reasons, ..Rung::default() }
    }

    /// What was read of a motion, with how it was read after other reasons.
    pub(super) fn read(reading: &Reading, cost: f64, mut reasons: Vec<Finding>) -> Rung {
        let Answer { value, spread, .. } = reading.answer;
        let part = |i: usize| if value[i] == 0.0 { 0.0 } else { spread[i] / value[i].abs() };
        let how = match reading.end {
            Settling::Settled | Settling::Pressed => Finding::note("settled"),
            Settling::Under => Finding::caution("not-settled"),
            Settling::Steady => Finding::note("mean-of-cycles").number("error", part(0).max(part(1))),
        };
        reasons.push(how.count("cycles", reading.cycles as usize));
        Rung::answering(reading.answer, cost, true, reasons)
    }

    /// Its answer with all that is known of it.
    pub(super) fn full(&self) -> Option<Answer> {
        Some(Answer { value: self.answer?, spread: self.spread, steady: self.settled })
    }
}
