//! From rung to rung: what each answers, how far that moves at the rungs above, and which one is good enough.

use super::change::{Answer, Change};
use super::motions::{Motions, On};
use super::outcome::Outcome;
use super::reading::End;
use super::sensitivity::sensitivity;
use super::stage::Stage;
use super::{Choice, Model, Need, Rung, laws};
use vibro_record::{Finding, Result};

/// All rungs of a scene.
pub struct Climb<'a> {
    stage: Stage<'a>,
    /// `None` for a mass that is loose on its spring, of which no motion is known before.
    motions: Option<Motions>,
    outcomes: [Outcome; 7],
    stiffness: Option<f64>,
}

impl<'a> Climb<'a> {
    pub fn new(stage: Stage<'a>) -> Result<Climb<'a>> {
        let stiffness = laws::keys(stage.scene).stiffness;
        if stage.scene.buffer.is_some() {
            let stiffness = stiffness.filter(|_| !laws::is_curved(stage.scene));
            let mut outcomes = [(); 7].map(|()| Outcome::not(Finding::note("spring-loose")));
            outcomes[Model::LooseMass as usize] = stage.loose_mass(stiffness);
            return Ok(Climb { stage, motions: None, outcomes, stiffness });
        }
        let mut motions = Motions::new(&stage)?;
        let closed = stage.closed_form(&motions);
        let soft = stage.soft_corrected(&motions, &closed);
        let outcomes = [
            stage.linear(&motions),
            closed,
            soft,
            Stage::restitution(&motions),
            stage.kelvin_voigt(&motions),
            stage.hunt_crossley(&motions),
            stage.loose_mass(None),
        ];
        for model in [Model::KelvinVoigt, Model::HuntCrossley] {
            motions.differs(&outcomes[model as usize], model, stage.question);
        }
        Ok(Climb { stage, motions: Some(motions), outcomes, stiffness })
    }

    fn of(&self, model: Model) -> &Outcome {
        &self.outcomes[model as usize]
    }

    /// What a rung answers.
    pub fn answer(&self, model: Model) -> Option<Answer> {
        self.of(model).answer
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
        let Some(answer) = self.answer(model) else { return Vec::new() };
        let changed = |at: Model| Some(answer.change(&self.answer(at)?, at, self.stage.question));
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
        let outcome = self.of(model);
        let changes = self.changes(model);
        let mut rung = Rung {
            model,
            cost_ns: outcome.cost,
            error: changes.iter().map(|c| c.change.abs()).reduce(f64::max),
            valid: outcome.valid,
            settled: outcome.answer.is_some_and(|a| a.steady),
            reasons: outcome.reasons.clone(),
            refused: outcome.refused.clone(),
            needs: self.needs(model),
            answer: outcome.answer.map(|a| a.value),
            spread: outcome.answer.map_or([0.0; 2], |a| a.spread),
            changes,
            sufficient: false,
        };
        rung.sufficient = self.is_enough(&rung);
        if rung.valid {
            rung.reasons.extend(self.audit(&rung));
        }
        rung
    }

    /// What the rungs above say of the answer of a rung that is valid.
    fn audit(&self, rung: &Rung) -> Vec<Finding> {
        let unsure = self.answer(rung.model).map_or(0.0, |a| a.unsure(self.stage.question));
        if unsure > 1.0 {
            return vec![Finding::caution("mean-not-known").number("ratio", unsure)];
        }
        if rung.changes.is_empty() && !rung.sufficient {
            return vec![Finding::caution("answer-not-checked")];
        }
        let moved = |c: &Change| {
            let found = if c.enough { Finding::note("answer-holds") } else { Finding::note("answer-moves") };
            found.number("change", c.change).name("rung", c.at.name())
        };
        // What curved bodies change is said of the choice.
        rung.changes.iter().filter(|c| c.at != Model::HuntCrossley).map(moved).collect()
    }

    /// Whether no law of the contact matters: masses stay in contact, and no spring between them is stated, or a curved contact is stated and
    /// nothing strikes.
    fn is_lawless(&self) -> bool {
        let Some(reading) = self.motions.as_ref().map(|m| &m.reading) else { return false };
        match self.stiffness {
            None => reading.end == End::Pressed,
            Some(_) => laws::is_curved(self.stage.scene) && reading.speed == 0.0,
        }
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

    /// Chooses. Where `bend` says so, a contact of spring and damper that is chosen is compared with curved bodies that meet for as long.
    pub fn choose(mut self, bend: bool) -> Choice {
        let (motions, followed) =
            self.motions.as_ref().map_or((Vec::new(), None), |m| (m.known.clone(), m.followed));
        let mut choice = Choice {
            frequency: self.stage.excitation.frequency(),
            chosen: None,
            rungs: Model::ALL.iter().map(|model| self.rung(*model)).collect(),
            needs: Vec::new(),
            audit: None,
            law: None,
            gap: Vec::new(),
            sensitivity: Vec::new(),
            sensitivity_failed: Vec::new(),
            motions,
            followed,
            findings: Vec::new(),
        };
        if self.motions.as_ref().is_some_and(|m| m.on == On::Open) {
            choice.needs.push("history");
            return choice;
        }
        choice.chosen = choice.rungs.iter().find(|r| r.sufficient).map(|r| r.model);
        if choice.chosen.is_none() && self.stiffness.is_none() {
            self.without_stiffness(&mut choice);
        }
        match choice.chosen {
            None => choice.needs = self.missing(),
            Some(Model::KelvinVoigt | Model::SoftCorrected) if bend => self.bend(&mut choice),
            Some(_) => {}
        }
        choice.audit = choice.chosen.and_then(|model| choice.rung(model).changes.last().copied());
        choice
    }

    /// Compares a spring that was chosen with curved bodies.
    fn bend(&mut self, choice: &mut Choice) {
        let Some(motions) = &self.motions else { return };
        self.outcomes[Model::HuntCrossley as usize] = self.stage.curved_alike(motions);
        for model in [Model::KelvinVoigt, Model::HuntCrossley] {
            choice.rungs[model as usize] = self.rung(model);
        }
        let answers = (choice.chosen.and_then(|m| self.answer(m)), self.answer(Model::HuntCrossley));
        if let (Some(own), Some(curved)) = answers {
            choice.law = Some(own.change(&curved, Model::HuntCrossley, self.stage.question));
        }
    }

    /// The answer over the stiffness, and the rung that holds whatever it is.
    fn without_stiffness(&self, choice: &mut Choice) {
        let lowest = [Model::ClosedForm, Model::Restitution, Model::LooseMass];
        let base = lowest.into_iter().find(|model| self.of(*model).valid).filter(|m| self.is_known(*m));
        let Some((model, answer)) = base.and_then(|m| Some((m, self.answer(m)?))) else { return };
        let (rows, failed) = sensitivity(&self.stage, self.motions.as_ref(), &answer);
        if !rows.is_empty() && failed.is_empty() && rows.iter().all(|row| row.enough) {
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
