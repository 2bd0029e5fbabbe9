//! A rung of the ladder: a model with its checks and its answer.

use super::driven_scene::keys;
use super::question::{Answer, Change};
use super::reading::{Reading, Settling};
use crate::scene::Scene;
use serde::Serialize;
use vibro_record::{Error, Finding};

/// A model of the rig, from the simplest to the most detailed.
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
    /// Exact flights, and contacts of a spring and a damper.
    KelvinVoigt,
    /// A contact whose force is not linear in the indentation: Hertz, Hunt–Crossley.
    HuntCrossley,
    /// A mass 1 that is loose on its spring.
    LooseMass,
}

impl Model {
    /// All models, the simplest first.
    pub const ALL: [Model; 7] = [
        Model::Linear,
        Model::ClosedForm,
        Model::SoftCorrected,
        Model::Restitution,
        Model::KelvinVoigt,
        Model::HuntCrossley,
        Model::LooseMass,
    ];

    /// In the order of the variants: name, and parameters needed beside those of mass 1, the gap and the
    /// excitation.
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

    /// Parameters needed beside those of mass 1, the gap and the excitation.
    pub fn needs(self) -> &'static [Need] {
        Model::TABLE[self as usize].1
    }
}

/// A parameter that a model needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(into = "&'static str")]
pub enum Need {
    /// Mass, stiffness and damping of mass 2.
    Mass2,
    /// The coefficient of restitution.
    Restitution,
    /// The coefficient of restitution or the contact's damping: either sets the loss of the rebound.
    Rebound,
    /// The contact's stiffness.
    Stiffness,
    /// The contact's damping.
    Damping,
    /// The exponent of the contact's law.
    Exponent,
    /// The gap of the buffer on which mass 1 rests loosely.
    Buffer,
    /// The direction of the sweep that led to the frequency.
    History,
}

/// Whether a scene states a parameter.
type Known = fn(&Scene) -> bool;

impl Need {
    /// In the order of the variants: key or name, and whether a scene states it.
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

    /// Its key, or its name where it has none.
    pub fn name(self) -> &'static str {
        Need::TABLE[self as usize].0
    }

    /// The names of several, with commas.
    pub fn names(needs: &[Need]) -> String {
        needs.iter().map(|need| need.name()).collect::<Vec<_>>().join(", ")
    }

    /// Whether a scene states it.
    pub(super) fn known(self, scene: &Scene) -> bool {
        Need::TABLE[self as usize].1(scene)
    }
}

impl From<Need> for &'static str {
    fn from(need: Need) -> &'static str {
        need.name()
    }
}

/// A parameter that a model needs, and whether it is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Needed {
    /// The parameter.
    pub parameter: Need,
    /// Whether the scene states it.
    pub known: bool,
}

/// A model with its checks and its answer at one excitation.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Rung {
    /// The model.
    pub model: Model,
    /// Computing time in ns of its answer on this machine, for simulated motions until they settle. `None`
    /// without an answer.
    pub cost_ns: Option<f64>,
    /// Largest relative change from its answer to those of two rungs above: the next one with an answer, and
    /// the next one that follows the motion in time. `None` where there is none.
    pub error: Option<f64>,
    /// Whether the validity checks of its own theory pass.
    pub valid: bool,
    /// Whether it is good enough: valid, with an answer that is known as accurately as required. The rungs
    /// above change this answer by no more than allowed, nor do all stiffnesses tried where the stiffness is
    /// unknown.
    pub sufficient: bool,
    /// Whether its answer comes from a motion that has settled, or is a mean over one that does not repeat.
    pub settled: bool,
    /// Findings on its validity and its answer.
    pub reasons: Vec<Finding>,
    /// The error because of which it has no answer.
    pub refused: Option<String>,
    /// Parameters needed beside those of mass 1, the gap and the excitation, and whether the scene states
    /// them.
    pub needs: Vec<Needed>,
    /// Its answer for x₁ and x₂; for impact quantities the same number twice.
    pub answer: Option<[f64; 2]>,
    /// Standard error of the answer, where it is a mean over a motion that does not repeat; else 0.
    pub spread: [f64; 2],
    /// Changes from its answer to those of the rungs above; `error` is the largest.
    pub changes: Vec<Change>,
}

/// A rung before its model is set, or why it has no answer.
pub(super) type Found = Result<Rung, Miss>;

/// Why a rung has no answer: it does not apply, or its computation failed.
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

    /// A rung with an answer, which took `cost` ns to compute.
    pub(super) fn answering(answer: Answer, cost: f64, valid: bool, reasons: Vec<Finding>) -> Rung {
        let Answer { value, spread, steady } = answer;
        let (answer, cost_ns) = (Some(value), Some(cost));
        Rung { valid, answer, spread, settled: steady, cost_ns, reasons, ..Rung::default() }
    }

    /// A rung with the answer of a simulated motion; whether it settled is added to the reasons.
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

    /// Its answer with standard error and whether it is settled.
    pub(super) fn full(&self) -> Option<Answer> {
        Some(Answer { value: self.answer?, spread: self.spread, steady: self.settled })
    }
}
