//! Compares the answer of each rung with those above, and chooses the lowest that is good enough.

use super::driven_scene::{DrivenScene, is_curved, keys};
use super::motions::{CurrentMotion, Motions};
use super::question::{Answer, Change};
use super::reading::Settling;
use super::rung::{Model, Need, Needed, Rung};
use super::{Choice, Sensitivity};
use crate::law::conversion;
use crate::simulate::Simulation;
use std::f64::consts::PI;
use vibro_record::{Finding, Result};

/// Longest and shortest contact, as fractions of the cycle, for which stiffnesses are tried. With much
/// softer contacts the masses would hardly part; the shortest contacts act like rigid impacts.
const SHARES: (f64, f64) = (0.1, 1e-4);
/// Most decades of stiffness tried.
const DECADES: i32 = 7;

/// All rungs of a scene before the choice.
pub struct Climb<'a> {
    stage: DrivenScene<'a>,
    /// `None` for a mass that is loose on its spring: it is only simulated.
    motions: Option<Motions>,
    rungs: Vec<Rung>,
}

impl<'a> Climb<'a> {
    pub fn new(stage: DrivenScene<'a>) -> Result<Climb<'a>> {
        if stage.scene.buffer.is_some() {
            let stiffness = keys(stage.scene).stiffness.filter(|_| !is_curved(stage.scene));
            let rung = |model| match model {
                Model::LooseMass => Rung::of(model, stage.loose_mass(stiffness)),
                _ => Rung::of(model, Err(Finding::note("spring-loose").into())),
            };
            return Ok(Climb { stage, motions: None, rungs: Model::ALL.map(rung).into() });
        }
        let mut motions = Motions::new(&stage)?;
        let mut rungs: Vec<Rung> = Vec::new();
        for model in Model::ALL {
            let closed = rungs.iter().any(|rung| rung.model == Model::ClosedForm && rung.valid);
            rungs.push(stage.rung(model, &mut motions, closed));
        }
        Ok(Climb { stage, motions: Some(motions), rungs })
    }

    fn of(&self, model: Model) -> &Rung {
        &self.rungs[model as usize]
    }

    /// The motion with rigid impacts after its transients; `None` where several coexist, and for a loose
    /// mass.
    pub fn settled(&self) -> Option<Simulation> {
        self.motions.as_ref().filter(|m| m.on != CurrentMotion::Open).map(|m| m.end.clone())
    }

    /// The answer of a rung.
    pub fn answer(&self, model: Model) -> Option<Answer> {
        self.of(model).full()
    }

    /// Rungs that check the answer of `model`: the next more detailed one, and the next one that follows the
    /// motion.
    fn above(&self, model: Model) -> Vec<Model> {
        let valid = |model: &Model| self.of(*model).valid;
        let soft = Some(Model::SoftCorrected).filter(valid);
        let followed = [Model::KelvinVoigt, Model::HuntCrossley].into_iter().find(valid);
        match model {
            Model::Linear => vec![Model::Restitution],
            Model::ClosedForm => soft.into_iter().chain(followed).collect(),
            Model::SoftCorrected | Model::Restitution => followed.into_iter().collect(),
            Model::KelvinVoigt => vec![Model::HuntCrossley],
            Model::HuntCrossley | Model::LooseMass => Vec::new(),
        }
    }

    /// A rung with the changes to the answers of the rungs above, and whether it is good enough.
    fn rung(&self, model: Model) -> Rung {
        let (scene, question) = (self.stage.scene, self.stage.question);
        let mut rung = self.of(model).clone();
        let answer = self.answer(model);
        let moved = |at: Model| Some(answer?.change(&self.answer(at)?, at, question));
        rung.changes = self.above(model).into_iter().filter_map(moved).collect();
        rung.error = rung.changes.iter().map(|c| c.change.abs()).reduce(f64::max);
        let needed = |parameter: &Need| Needed { parameter: *parameter, known: parameter.known(scene) };
        rung.needs = model.needs().iter().map(needed).collect();
        let unsure = answer.map_or(0.0, |a| a.unsure(question));
        let still = rung.changes.iter().all(|c| c.enough);
        rung.sufficient = rung.valid
            && self.is_known(model)
            && match model {
                Model::Linear => still,
                Model::ClosedForm | Model::SoftCorrected | Model::Restitution => {
                    still && (!rung.changes.is_empty() || self.is_lawless())
                }
                // The rung above differs only in its contact law. The scene states this law, so that answer
                // does not decide.
                Model::KelvinVoigt | Model::HuntCrossley => true,
                Model::LooseMass => keys(scene).stiffness.is_some(),
            };
        // The choice reports the effect of curved contact surfaces.
        let audited = rung.changes.iter().filter(|c| c.at != Model::HuntCrossley).map(|c| {
            let found = if c.enough { Finding::note("answer-holds") } else { Finding::note("answer-moves") };
            found.number("change", c.change).name("rung", c.at.name())
        });
        let audited: Vec<Finding> = match rung.valid {
            false => Vec::new(),
            true if unsure > 1.0 => vec![Finding::caution("mean-not-known").number("ratio", unsure)],
            true if rung.changes.is_empty() && !rung.sufficient => {
                vec![Finding::caution("answer-not-checked")]
            }
            true => audited.collect(),
        };
        rung.reasons.extend(audited);
        rung
    }

    /// Whether the contact law does not matter: the masses stay in contact and no stiffness is stated, or a
    /// curved contact is stated and there are no impacts.
    fn is_lawless(&self) -> bool {
        self.motions.as_ref().is_some_and(|Motions { reading, .. }| match keys(self.stage.scene).stiffness {
            None => reading.end == Settling::Pressed,
            Some(_) => is_curved(self.stage.scene) && reading.speed == 0.0,
        })
    }

    fn is_known(&self, model: Model) -> bool {
        self.answer(model).is_some_and(|a| a.known(self.stage.question))
    }

    /// Chooses the lowest rung that is good enough. With `bend`, a chosen contact of spring and damper is
    /// compared with curved bodies of the same contact duration.
    pub fn choose(mut self, bend: bool) -> Choice {
        let mut choice = Choice {
            frequency: self.stage.excitation.frequency(),
            rungs: Model::ALL.iter().map(|model| self.rung(*model)).collect(),
            ..Choice::default()
        };
        if let Some(motions) = &self.motions {
            (choice.motions, choice.followed) = (motions.known.clone(), motions.followed);
        }
        if self.motions.as_ref().is_some_and(|m| m.on == CurrentMotion::Open) {
            choice.needs.push(Need::History);
            return choice;
        }
        choice.chosen = choice.rungs.iter().find(|r| r.sufficient).map(|r| r.model);
        if choice.chosen.is_none() && keys(self.stage.scene).stiffness.is_none() {
            self.without_stiffness(&mut choice);
        }
        match choice.chosen {
            None => {
                let (scene, rebounds) = (self.stage.scene, self.stage.scene.rig.restitution > 0.0);
                let missing = |need: &Need| !(need.known(scene) || *need == Need::Damping && rebounds);
                choice.needs = [Need::Stiffness, Need::Damping].into_iter().filter(missing).collect();
            }
            Some(model @ (Model::KelvinVoigt | Model::SoftCorrected)) if bend => {
                self.bend(model, &mut choice);
            }
            Some(_) => {}
        }
        choice.audit = choice.chosen.and_then(|model| choice.rung(model).changes.last().copied());
        choice
    }

    /// Compares the chosen contact of spring and damper with curved bodies.
    fn bend(&mut self, chosen: Model, choice: &mut Choice) {
        let Some(motions) = &self.motions else { return };
        let curved = Rung::of(Model::HuntCrossley, self.stage.curved_alike(motions));
        self.rungs[Model::HuntCrossley as usize] = curved;
        for model in [Model::KelvinVoigt, Model::HuntCrossley] {
            choice.rungs[model as usize] = self.rung(model);
        }
        if let (Some(own), Some(curved)) = (self.answer(chosen), self.answer(Model::HuntCrossley)) {
            choice.law = Some(own.change(&curved, Model::HuntCrossley, self.stage.question));
        }
    }

    /// Computes the answers over a range of stiffnesses, and chooses the lowest valid rung if all of them
    /// agree.
    fn without_stiffness(&self, choice: &mut Choice) {
        let lowest = [Model::ClosedForm, Model::Restitution, Model::LooseMass];
        let base = lowest.into_iter().find(|model| self.of(*model).valid).filter(|m| self.is_known(*m));
        let Some((model, answer)) = base.and_then(|m| Some((m, self.answer(m)?))) else { return };
        choice.sensitivity = self.sensitivity(&answer).unwrap_or_default();
        if !choice.sensitivity.is_empty() && choice.sensitivity.iter().all(|row| row.enough) {
            choice.chosen = Some(model);
            choice.rungs[model as usize].sufficient = true;
        }
    }

    /// Answers over the stiffnesses, one a decade, with contact durations from 10 % to 0.01 % of the cycle.
    /// `None` if no spring and damper has the scene's restitution, or an answer cannot be computed.
    fn sensitivity(&self, base: &Answer) -> Option<Vec<Sensitivity>> {
        let (scene, frequency) = (self.stage.scene, self.stage.excitation.frequency());
        let mass = scene.rig.reduced_mass();
        // `half`/√k is the undamped contact duration π√(M/k) as a fraction of the cycle.
        let half = PI * mass.sqrt() * frequency;
        let [low, high] = [SHARES.0, SHARES.1].map(|s| 2.0 * (half / s).log10());
        let low = low.ceil() as i32;
        let row = |decade: i32| {
            let stiffness = 10_f64.powi(decade);
            let law = scene.spring(stiffness).ok().filter(|_| !is_curved(scene))?;
            let damping = law.damping;
            let answer = match &self.motions {
                Some(motions) => self.stage.with(motions, law).ok()?.0.answer,
                None => self.stage.loose_mass(Some(stiffness)).ok()?.full()?,
            };
            let ratio = damping / (2.0 * (stiffness * mass).sqrt());
            let Change { change, enough, .. } = base.change(&answer, Model::KelvinVoigt, self.stage.question);
            let share = conversion::duration(ratio, stiffness, mass) * frequency;
            Some(Sensitivity { stiffness, share, answer: answer.value, change, enough })
        };
        (low..=(high.floor() as i32).min(low + DECADES - 1)).map(row).collect()
    }
}
