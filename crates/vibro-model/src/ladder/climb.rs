//! From rung to rung.

use super::change::{Answer, Change};
use super::motions::{Motions, On};
use super::sensitivity::sensitivity;
use super::stage::{Stage, restitution};
use super::tried::Tried;
use super::{Choice, Model, Need, Rung, laws, reasons};
use vibro_record::Result;

/// All rungs tried for a scene.
pub struct Climb<'a> {
    stage: Stage<'a>,
    /// `None` for a mass that is loose on its spring, of which no motion is known before.
    motions: Option<Motions>,
    tried: [Tried; 7],
    stiffness: Option<f64>,
}

impl<'a> Climb<'a> {
    pub fn new(stage: Stage<'a>) -> Result<Climb<'a>> {
        let stiffness = laws::keys(stage.scene).stiffness;
        if stage.scene.buffer.is_some() {
            let held = || Tried::not("The spring of mass 1 only pushes; this rung lets it hold both ways.");
            let mut tried = [(); 7].map(|()| held());
            let spring = stiffness.filter(|_| !laws::is_curved(stage.scene));
            tried[Model::LooseMass as usize] = stage.loose_mass(spring);
            return Ok(Climb { stage, motions: None, tried, stiffness: spring });
        }
        let mut motions = Motions::new(&stage)?;
        let closed = stage.closed_form(&motions);
        let soft = stage.soft_corrected(&motions, &closed);
        let tried = [
            stage.linear(&motions),
            closed,
            soft,
            restitution(&motions),
            stage.kelvin_voigt(&motions),
            if laws::is_curved(stage.scene) {
                stage.hunt_crossley(&motions)
            } else {
                Tried::not("The scene states no exponent of the contact.")
            },
            stage.loose_mass(None),
        ];
        for model in [Model::KelvinVoigt, Model::HuntCrossley] {
            motions.differs(&tried[model as usize], model, stage.question);
        }
        Ok(Climb { stage, motions: Some(motions), tried, stiffness })
    }

    fn of(&self, model: Model) -> &Tried {
        &self.tried[model as usize]
    }

    /// Rungs at which the answer of `model` is looked at again: the next one that knows more, and the next one that follows the motion.
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

    fn changes(&self, model: Model) -> Vec<Change> {
        let Some(answer) = &self.of(model).answer else { return Vec::new() };
        let changed = |at: Model| {
            let other = self.of(at).answer.as_ref()?;
            Some(answer.change(other, at, self.stage.question))
        };
        self.above(model).into_iter().filter_map(changed).collect()
    }

    fn needs(&self, model: Model) -> Vec<Need> {
        let keys = laws::keys(self.stage.scene);
        let known = |parameter: &str| match parameter {
            "contact.stiffness" => keys.stiffness.is_some(),
            "contact.exponent" => keys.exponent.is_some(),
            "buffer.gap" => self.stage.scene.buffer.is_some(),
            "restitution or contact.damping" => {
                keys.damping.is_some() || self.stage.scene.rig.restitution > 0.0
            }
            _ => true,
        };
        model.needs().iter().map(|parameter| Need { parameter, known: known(parameter) }).collect()
    }

    fn rung(&self, model: Model) -> Rung {
        let tried = self.of(model);
        let changes = self.changes(model);
        let mut rung = Rung {
            model,
            cost_ns: tried.cost.map(|c| c.ns),
            cost_runs: tried.cost.map(|c| c.runs),
            error: changes.iter().map(|c| c.change.abs()).reduce(f64::max),
            valid: tried.valid,
            why: tried.why.clone(),
            needs: self.needs(model),
            answer: tried.answer.map(|a| a.value),
            spread: tried.answer.map_or([0.0; 2], |a| a.spread),
            changes,
            sufficient: false,
        };
        rung.sufficient = self.is_enough(&rung);
        rung
    }

    /// Whether a curved contact is stated, but there are no impacts for its law to act in.
    fn is_lawless(&self) -> bool {
        let curved = self.stiffness.is_some() && laws::is_curved(self.stage.scene);
        curved && self.motions.as_ref().is_some_and(|m| m.reading.speed == 0.0)
    }

    /// Whether the answer of a rung comes from a motion that has settled, or is a mean that is known as exactly as is asked for.
    fn is_known(&self, model: Model) -> bool {
        self.answer(model).is_some_and(|a| a.steady && a.unsure(self.stage.question) <= 1.0)
    }

    /// Whether a rung is good enough.
    fn is_enough(&self, rung: &Rung) -> bool {
        let still = rung.changes.iter().all(|c| c.enough);
        rung.valid
            && self.is_known(rung.model)
            && match rung.model {
                Model::Linear => still,
                Model::ClosedForm | Model::SoftCorrected | Model::Restitution => {
                    still && (!rung.changes.is_empty() || self.is_lawless())
                }
                // What lies above a law that is stated is another law.
                Model::KelvinVoigt | Model::HuntCrossley => true,
                Model::LooseMass => self.stiffness.is_some(),
            }
    }

    /// Holds a spring that was chosen against curved bodies that meet for as long.
    fn bend(&mut self, choice: &mut Choice) {
        let Some(motions) = &self.motions else { return };
        self.tried[Model::HuntCrossley as usize] = self.stage.hunt_crossley(motions);
        for model in [Model::KelvinVoigt, Model::HuntCrossley] {
            choice.rungs[model as usize] = self.rung(model);
        }
        let answers = (choice.chosen.and_then(|m| self.answer(m)), self.answer(Model::HuntCrossley));
        if let (Some(own), Some(curved)) = answers {
            choice.law = Some(own.change(&curved, Model::HuntCrossley, self.stage.question));
        }
    }

    /// What a rung answers.
    pub fn answer(&self, model: Model) -> Option<Answer> {
        self.of(model).answer
    }

    /// Chooses; a contact of spring and damper that is chosen is held against curved bodies where `bend` says so.
    pub fn choose(mut self, bend: bool) -> Choice {
        let rungs: Vec<Rung> = Model::ALL.iter().map(|model| self.rung(*model)).collect();
        let open = self.motions.as_ref().is_some_and(|m| m.on == On::Open);
        let mut choice = Choice {
            frequency: self.stage.excitation.frequency(),
            chosen: None,
            needs: Vec::new(),
            audit: None,
            law: None,
            gap: Vec::new(),
            sensitivity: Vec::new(),
            sensitivity_failed: Vec::new(),
            motions: self.motions.as_ref().map_or_else(Vec::new, |m| m.known.clone()),
            followed: self.motions.as_ref().and_then(|m| m.followed),
            reasons: Vec::new(),
            rungs,
        };
        if open {
            choice.needs.push("history");
        } else {
            choice.chosen = choice.rungs.iter().find(|r| r.sufficient).map(|r| r.model);
            if choice.chosen.is_none() {
                self.without_stiffness(&mut choice);
            }
            if choice.chosen.is_none() {
                choice.needs = self.missing();
            }
        }
        if bend && matches!(choice.chosen, Some(Model::KelvinVoigt | Model::SoftCorrected)) {
            self.bend(&mut choice);
        }
        choice.audit = choice.chosen.and_then(|model| choice.rung(model).changes.last().copied());
        choice.reasons = reasons::sentences(&choice, self.stage.question);
        choice
    }

    /// The answer over the stiffness, and the rung that holds whatever it is.
    fn without_stiffness(&self, choice: &mut Choice) {
        if self.stiffness.is_some() {
            return;
        }
        let lowest = [Model::ClosedForm, Model::Restitution, Model::LooseMass];
        let base = lowest.into_iter().find(|model| self.of(*model).valid).filter(|m| self.is_known(*m));
        let Some((model, answer)) = base.and_then(|m| Some((m, self.of(m).answer?))) else {
            return;
        };
        let (rows, failed) = sensitivity(&self.stage, self.motions.as_ref(), &answer);
        let all = !rows.is_empty() && failed.is_empty() && rows.iter().all(|row| row.enough);
        if all {
            choice.chosen = Some(model);
            choice.rungs[model as usize].sufficient = true;
        }
        (choice.sensitivity, choice.sensitivity_failed) = (rows, failed);
    }

    /// What the scene lacks.
    fn missing(&self) -> Vec<&'static str> {
        let keys = laws::keys(self.stage.scene);
        let mut missing = Vec::new();
        if keys.stiffness.is_none() {
            missing.push("contact.stiffness");
        }
        if keys.damping.is_none() && self.stage.scene.rig.restitution == 0.0 {
            missing.push("contact.damping");
        }
        missing
    }
}
