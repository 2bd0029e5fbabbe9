//! The ladder: no more model than a scene needs.
//!
//! From the simplest model to the richest: the motion without impacts, one impact a cycle in closed form, the
//! same corrected for the duration of the contact, exact flights between impacts at once, exact flights with
//! a contact of spring and damper, contacts of curved bodies, a mass that is loose on its spring. Each rung
//! is checked by what its own theory says of it, and by how far its answer moves at the next rung and at the
//! next one that follows the motion; the lowest that passes is chosen. Time is not the argument, all rungs
//! take µs to ms: parameters that nobody can identify are. Where one is needed and not known nothing is
//! chosen, and the answer over its range is given instead.
//!
//! ```
//! use vibro_model::ladder::{Model, Question, choose};
//! use vibro_model::{Observable, Scene};
//! let scene = Scene::from_toml("[excitation]\nkind = \"sine\"\nforce = 0.3\nfrequency = 13.6")?;
//! let choice = choose(&scene, 13.6, &Question::new(Observable::Fundamental))?;
//! assert_eq!(choice.chosen, Some(Model::Linear));
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod axis;
mod climb;
mod findings;
mod motions;
mod question;
mod reading;
mod rung;
mod stage;
mod starts;

pub use axis::{MOST_POINTS, Stretch, Summary, Survey, choose_over};
pub use motions::KnownMotion;
pub use question::{Change, Question};
pub use rung::{Model, Need, Needed, Rung};
pub use starts::Followed;
pub(crate) use starts::starts;

use super::law::Law;
use super::rig::Rig;
use super::scales;
use super::scene::Scene;
use climb::Climb;
use question::Answer;
use serde::Serialize;
use stage::{DrivenScene, curved, is_curved, keys};
use vibro_record::{Error, Finding, Result};

/// The rung that is good enough for a scene, and how that was found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Choice {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// The lowest rung that is good enough; `None` where that cannot be told.
    pub chosen: Option<Model>,
    /// All rungs, the simplest first.
    pub rungs: Vec<Rung>,
    /// What must be known before a rung can be chosen.
    pub needs: Vec<Need>,
    /// The change of the chosen answer at the next rung that follows the motion.
    pub audit: Option<Change>,
    /// What curved bodies (exponent 1.5) that meet for as long and rebound alike would change, where a
    /// spring and a damper were chosen, or the correction for them, and their law was not stated.
    pub law: Option<Change>,
    /// The changes of the chosen answer where the gap is smaller or larger by its uncertainty; `None` where
    /// there is then no such answer.
    pub gap: Vec<Option<Change>>,
    /// The answer over the contact's stiffness, where that is not known and matters; empty where that cannot
    /// be computed.
    pub sensitivity: Vec<Sensitivity>,
    /// Motions that the rig can be in, as far as they are known.
    pub motions: Vec<KnownMotion>,
    /// States that others were looked for from; `None` with a history and for a loose mass.
    pub followed: Option<Followed>,
    /// What is to be known of it; why a rung is passed over stands with the rung.
    pub findings: Vec<Finding>,
}

/// The answer with one stiffness of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sensitivity {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// Part of the cycle in contact.
    pub share: f64,
    /// The answer: of x₁ and x₂; of impacts the same number twice.
    pub answer: [f64; 2],
    /// Its change, from impacts without duration.
    pub change: f64,
    /// Whether that is allowed, and the motion had settled.
    pub enough: bool,
}

impl Choice {
    /// The answer of the chosen rung: of x₁ and x₂; of impacts the same number twice.
    pub fn answer(&self) -> Option<[f64; 2]> {
        self.rung(self.chosen?).answer
    }

    /// What was found of a rung.
    pub fn rung(&self, model: Model) -> &Rung {
        // All rungs are listed in their order.
        &self.rungs[model as usize]
    }
}

/// The law of the contact that a scene states for a model; `None` where impacts take no time.
///
/// # Errors
/// If the model needs a number that the scene does not state, or one is impossible.
pub fn law(scene: &Scene, model: Model) -> Result<Option<Law>> {
    let keys = keys(scene);
    let missing = |key: &str| {
        Error::usage(format!("{} without contact.{key}", model.name()), format!("{key} in [contact]"))
            .hint("measure it: no value fits all contacts, and results depend on it")
    };
    let stiffness = || keys.stiffness.ok_or_else(|| missing("stiffness"));
    match model {
        Model::Linear | Model::ClosedForm | Model::Restitution => Ok(None),
        Model::SoftCorrected | Model::KelvinVoigt if is_curved(scene) => {
            Err(Error::usage(format!("{} with contact.exponent", model.name()), "a spring, exponent 1"))
        }
        Model::SoftCorrected | Model::KelvinVoigt => scene.spring(stiffness()?).map(Some),
        Model::HuntCrossley => {
            keys.damping.ok_or_else(|| missing("damping"))?;
            stiffness()?;
            // A damping that is stated does not depend on the speed.
            curved(scene, 1.0).map(Some)
        }
        Model::LooseMass => {
            Err(Error::refused("a loose mass has another law of its spring, not of its contact"))
        }
    }
}

/// Swings of a mass in a cycle of the excitation up to which motions are followed.
const MOST_SWINGS: f64 = 1000.0;

/// The lowest rung that answers `question` for `scene` at `frequency` (Hz), which replaces that of the
/// excitation.
///
/// # Errors
/// If a parameter or the question is impossible, nothing drives the rig, an undamped mass is driven at
/// resonance, or the excitation is so slow that the masses swing more than 1000 times in a cycle.
pub fn choose(scene: &Scene, frequency: f64, question: &Question) -> Result<Choice> {
    chosen(scene, frequency, question, true)
}

/// As [`choose`]; `bend` says whether a contact of spring and damper that is chosen is compared with curved
/// bodies, and the answer with those at both ends of the gap's uncertainty.
fn chosen(scene: &Scene, frequency: f64, question: &Question, bend: bool) -> Result<Choice> {
    question.check()?;
    let Some(excitation) = &scene.excitation else {
        return Err(Error::usage("nothing drives the rig", "an excitation"));
    };
    let excitation = excitation.at_frequency(frequency);
    scales::check(&scene.rig, &excitation)?;
    if excitation.size() == 0.0 {
        return Err(Error::usage(
            "nothing drives the rig: its excitation is 0",
            "a force or impulse above 0",
        ));
    }
    scales::check_swings(&scene.rig, frequency, MOST_SWINGS)?;
    scales::check_slow(&scene.rig, frequency, reading::MOST_CYCLES)?;
    let stage = DrivenScene { scene, excitation: &excitation, question };
    let mut choice = Climb::new(stage)?.choose(bend);
    if bend && question.gap_std > 0.0 {
        choice.gap = gaps(&choice, &stage);
    }
    choice.findings = findings::findings(&choice, question);
    Ok(choice)
}

/// The changes of the chosen answer at both ends of the gap's uncertainty.
fn gaps(choice: &Choice, stage: &DrivenScene<'_>) -> Vec<Option<Change>> {
    let (Some(model), Some(value)) = (choice.chosen, choice.answer()) else { return Vec::new() };
    let here = Answer { spread: choice.rung(model).spread, ..Answer::exact(value) };
    let question = Question { gap_std: 0.0, ..*stage.question };
    let at = |std: f64| {
        let rig = Rig { gap: stage.scene.rig.gap + std, ..stage.scene.rig };
        let scene = Scene { rig, ..stage.scene.clone() };
        let there = Climb::new(DrivenScene { scene: &scene, question: &question, ..*stage }).ok()?;
        Some(here.change(&there.answer(model)?, model, &question))
    };
    [-1.0, 1.0].map(|sign| at(sign * stage.question.gap_std)).to_vec()
}

#[cfg(test)]
mod tests;
