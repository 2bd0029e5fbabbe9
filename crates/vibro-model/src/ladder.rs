//! The model ladder: the simplest model that answers a question about a scene well enough.
//!
//! From the simplest model to the richest: the motion without impacts, one impact a cycle in closed form,
//! the same corrected for the duration of the contact, exact flights between rigid impacts, exact flights
//! with a contact of spring and damper, contacts of curved bodies, a mass that is loose on its spring. A
//! rung must pass the validity checks of its own theory. Its answer is compared with the next rung and with
//! the next one that follows the motion in time; the lowest that passes is chosen.
//!
//! Computing time is no criterion (all rungs take µs to ms); unknown parameters are. Where a rung needs a
//! parameter that is unknown, nothing is chosen, and the answer over the range of that parameter is given
//! instead.
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
mod curvature;
mod driven_scene;
mod findings;
mod motions;
mod question;
mod reading;
mod rung;
mod stage;
mod starts;

pub use axis::{MOST_POINTS, Stretch, Summary, Survey, choose_over};
pub use curvature::{Curvature, MassChange};
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
use driven_scene::{DrivenScene, curved, is_curved, keys};
use question::Answer;
use serde::Serialize;
use vibro_record::{Error, Finding, Result};

/// The lowest rung that is good enough for a scene, with the answers and checks that led to it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Choice {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// The lowest rung that is good enough; `None` where something unknown leaves it open, or no rung is.
    pub chosen: Option<Model>,
    /// All rungs, the simplest first.
    pub rungs: Vec<Rung>,
    /// Parameters that must be known before a rung can be chosen.
    pub needs: Vec<Need>,
    /// Change of the chosen answer to that of the next rung that follows the motion in time.
    pub audit: Option<Change>,
    /// Change of the answer with curved bodies (exponent 1.5) of the same contact duration and restitution,
    /// where a contact of spring and damper, or the correction for one, was chosen.
    pub law: Option<Change>,
    /// Changes of the chosen answer where the gap is smaller or larger by its uncertainty; `None` where the
    /// chosen model has no answer with that gap.
    pub gap: Vec<Option<Change>>,
    /// Effect of each curved spring on the answer; empty where the springs are straight or the motion is
    /// open.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<Curvature>,
    /// Change of the answer by the curvature of both springs together, where both are curved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub springs_together: Option<MassChange>,
    /// The answers over a range of contact stiffnesses, where the stiffness is unknown and no rung is good
    /// enough without it; empty where they cannot be computed.
    pub sensitivity: Vec<Sensitivity>,
    /// Known motions that the rig can have at this excitation, coexisting ones included.
    pub motions: Vec<KnownMotion>,
    /// Start states from which other motions were searched; `None` with a history and for a loose mass.
    pub followed: Option<Followed>,
    /// Findings on the choice; the reasons against a rung are with the rung.
    pub findings: Vec<Finding>,
}

/// The answer with one stiffness of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sensitivity {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// Contact duration as a fraction of the cycle.
    pub share: f64,
    /// The answer for x₁ and x₂; for impact quantities the same number twice.
    pub answer: [f64; 2],
    /// Its relative change from the answer with rigid impacts.
    pub change: f64,
    /// Whether the change is allowed, and the motion had settled.
    pub enough: bool,
}

impl Choice {
    /// The answer of the chosen rung for x₁ and x₂; for impact quantities the same number twice.
    pub fn answer(&self) -> Option<[f64; 2]> {
        self.rung(self.chosen?).answer
    }

    /// Checks and answer of the rung of a model.
    pub fn rung(&self, model: Model) -> &Rung {
        // All rungs are listed in the order of `Model`.
        &self.rungs[model as usize]
    }
}

/// The contact law that a scene states for a model; `None` for rigid impacts.
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
            let key = if keys.radius.is_some() { "radius" } else { "exponent" };
            Err(Error::usage(format!("{} with contact.{key}", model.name()), "a spring, exponent 1"))
        }
        Model::SoftCorrected | Model::KelvinVoigt => scene.spring(stiffness()?).map(Some),
        Model::HuntCrossley => {
            keys.damping.ok_or_else(|| missing("damping"))?;
            stiffness()?;
            // The speed is not used: a stated damping does not depend on it.
            curved(scene, 1.0).map(Some)
        }
        Model::LooseMass => {
            Err(Error::refused("a loose mass has another law of its spring, not of its contact"))
        }
    }
}

/// Most swings of a mass in an excitation cycle for which motions are followed; it bounds the computing time.
const MOST_SWINGS: f64 = 1000.0;

/// The lowest rung that answers `question` for `scene` at `frequency` (Hz), which replaces the frequency of
/// the excitation.
///
/// # Errors
/// If a parameter or the question is impossible, nothing drives the rig, an undamped mass is driven at
/// resonance, or the excitation is so slow that the masses swing more than 1000 times in a cycle.
pub fn choose(scene: &Scene, frequency: f64, question: &Question) -> Result<Choice> {
    chosen(scene, frequency, question, true)
}

/// As [`choose`]. With `bend`, a chosen contact of spring and damper is compared with curved bodies, and the
/// chosen answer with the answers at both ends of the gap's uncertainty.
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
    let climb = Climb::new(stage)?;
    let settled = scene.springs.and_then(|_| climb.settled());
    let mut choice = climb.choose(bend);
    if bend && question.gap_std > 0.0 {
        choice.gap = gaps(&choice, &stage);
    }
    choice.findings = findings::findings(&choice, question);
    if scene.springs.is_some() {
        let effects = curvature::effects(&choice, &stage, settled)?;
        (choice.springs, choice.springs_together) = (effects.each, effects.together);
        choice.findings.extend(curvature::findings(&choice, question));
    }
    Ok(choice)
}

/// Changes of the chosen answer at the lower and the upper end of the gap's standard uncertainty.
fn gaps(choice: &Choice, stage: &DrivenScene<'_>) -> Vec<Option<Change>> {
    let Some(model) = choice.chosen else { return Vec::new() };
    let rig = stage.scene.rig;
    let at = |std: f64| elsewhere(choice, model, stage, Rig { gap: rig.gap + std, ..rig });
    [-1.0, 1.0].map(|sign| at(sign * stage.question.gap_std)).to_vec()
}

/// Change of the answer of a model on another rig; `None` where the model has no answer there.
fn elsewhere(choice: &Choice, model: Model, stage: &DrivenScene<'_>, rig: Rig) -> Option<Change> {
    let rung = choice.rung(model);
    let here = Answer { spread: rung.spread, ..Answer::exact(rung.answer?) };
    let question = Question { gap_std: 0.0, ..*stage.question };
    let scene = Scene { rig, ..stage.scene.clone() };
    let there = Climb::new(DrivenScene { scene: &scene, question: &question, ..*stage }).ok()?;
    Some(here.change(&there.answer(model)?, model, &question))
}

#[cfg(test)]
mod tests;
