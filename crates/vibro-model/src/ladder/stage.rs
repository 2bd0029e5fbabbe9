//! What each rung answers at one excitation of a scene, and whether its own checks pass.

use super::Question;
use super::change::Answer;
use super::laws;
use super::motions::{Motions, On};
use super::outcome::{Outcome, into};
use super::reading::{End, Reader, Reading};
use crate::{
    Compliance, Compliant, Excitation, Law, Loose, Observable, Orbit, Rig, Scene, Simulation, no_impact,
    softened,
};
use std::f64::consts::{PI, TAU};
use std::time::Instant;
use vibro_record::{Finding, Result};

/// What `work` gives, and the time in ns that it takes; NaN where there is no clock.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = (!cfg!(target_family = "wasm")).then(Instant::now);
    let done = work();
    (done, begun.map_or(f64::NAN, |begun| begun.elapsed().as_nanos() as f64))
}

/// A scene at one excitation.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    pub scene: &'a Scene,
    pub excitation: &'a Excitation,
    pub question: &'a Question,
}

impl Stage<'_> {
    fn rig(&self) -> &Rig {
        &self.scene.rig
    }

    /// Mass 1 alone.
    pub fn linear(&self, motions: &Motions) -> Outcome {
        let (found, cost) = timed(|| {
            let found = no_impact(self.rig(), self.excitation)?;
            let value = match self.question.observable {
                Observable::Fundamental => [self.alone(), 0.0],
                other => other.of_no_impact(&found),
            };
            Ok((found, value))
        });
        let (found, value) = match found {
            Ok(found) => found,
            Err(error) => return Outcome::refused(&error),
        };
        let (gap, std) = (self.rig().gap, self.question.gap_std);
        let clear = gap - found.largest;
        let sized = |reason: Finding| reason.number("largest", found.largest).number("gap", gap);
        let met = sized(Finding::note("masses-stay-clear"));
        let (valid, reasons) = match motions.on {
            _ if !found.possible => (false, vec![sized(Finding::note("masses-meet"))]),
            _ if clear <= std => {
                let unsure = sized(Finding::note("clearance-not-sure"));
                (false, vec![unsure.number("clearance", clear).number("std", std)])
            }
            On::Free => (true, vec![met, into(motions)]),
            On::Open => (true, vec![met]),
            On::Orbit(_) | On::Other => (false, vec![met, Finding::note("other-motion"), into(motions)]),
        };
        let answer = Some(Answer::exact(value));
        Outcome { valid, answer, cost: Some(cost), reasons, ..Outcome::default() }
    }

    /// Amplitude in m of mass 1 alone at the excitation frequency: |F L₁(iω)|, F being the force's own line, 2J/T of impulses and
    /// (2F/π) sin(πw/T) of pulses of width w.
    fn alone(&self) -> f64 {
        let force = match *self.excitation {
            Excitation::Sine(sine) => sine.force,
            Excitation::Impulse(train) => 2.0 * train.impulse.abs() * train.frequency,
            Excitation::Pulse(train) => {
                2.0 / PI * train.force.abs() * (PI * train.width * train.frequency).sin()
            }
            Excitation::Sines(_) => f64::NAN,
        };
        let [l1, _] = self.rig().receptances(TAU * self.excitation.frequency());
        force * l1.norm()
    }

    /// One impact a cycle.
    pub fn closed_form(&self, motions: &Motions) -> Outcome {
        let orbit = match motions.orbit() {
            Err(error) => return Outcome::refused(error),
            Ok(None) => return Outcome::not(Finding::note("orbit-missing")),
            Ok(Some(orbit)) => orbit,
        };
        let v = &orbit.validity;
        let radius = orbit.spectral_radius().unwrap_or(f64::NAN);
        let std = self.question.gap_std;
        let mut reasons = vec![if !v.admissible {
            Finding::note("orbit-overlaps").number("depth", v.min_gap.abs())
        } else if v.stable != Some(true) {
            Finding::note("orbit-not-stable").name("stability", v.stability.name()).number("radius", radius)
        } else if v.grazing_distance <= std {
            Finding::note("orbit-near-grazing").number("distance", v.grazing_distance).number("std", std)
        } else if !orbit.robust(std) {
            Finding::note("orbit-not-robust").number("std", std)
        } else {
            Finding::note("orbit-real").number("radius", radius).number("distance", v.grazing_distance)
        }];
        let real = reasons[0].code == "orbit-real";
        match motions.on {
            On::Orbit(_) if real => reasons.push(into(motions)),
            On::Free | On::Other if real => reasons.extend([Finding::note("other-motion"), into(motions)]),
            _ => {}
        }
        let valid = real && matches!(motions.on, On::Orbit(_) | On::Open);
        let answer = Some(Answer::exact(self.question.observable.of_orbit(orbit)));
        Outcome { valid, answer, cost: Some(motions.closed_cost), reasons, ..Outcome::default() }
    }

    /// The same with the contact's duration.
    pub(crate) fn soft_corrected(&self, motions: &Motions, closed: &Outcome) -> Outcome {
        if laws::is_curved(self.scene) {
            return Outcome::not(Finding::note("spring-needed"));
        }
        let Some(stiffness) = laws::keys(self.scene).stiffness else {
            return Outcome::not(Finding::note("stiffness-unknown"));
        };
        let orbit = match motions.orbit() {
            Ok(Some(orbit)) if closed.valid => orbit,
            _ => return Outcome::not(Finding::note("nothing-to-correct")),
        };
        let (soft, cost) = timed(|| self.soften(orbit, stiffness));
        match soft {
            Err(error) => Outcome { cost: Some(cost), ..Outcome::refused(&error) },
            Ok(None) => {
                Outcome { cost: Some(cost), ..Outcome::not(Finding::note("corrected-motion-missing")) }
            }
            Ok(Some((answer, share, restitution))) => {
                let mut reasons = vec![Finding::note("contact-short-enough").number("share", share)];
                let stated = self.rig().restitution;
                if (restitution - stated).abs() > 1e-3 {
                    let other = Finding::note("damper-sets-restitution");
                    reasons.push(other.number("restitution", restitution).number("stated", stated));
                }
                let answer = Some(answer);
                Outcome { valid: true, answer, cost: Some(cost), reasons, ..Outcome::default() }
            }
        }
    }

    /// Answer, part of the cycle in contact, restitution.
    fn soften(&self, orbit: &Orbit, stiffness: f64) -> Result<Option<(Answer, f64, f64)>> {
        let contact = Compliance::new(self.rig(), stiffness, laws::keys(self.scene).damping)?;
        let rig = Rig { restitution: contact.restitution, ..*self.rig() };
        let found = crate::orbits_of(&rig, self.excitation, 1)?;
        let soft = softened(&rig, self.excitation, &found, &contact)?;
        let same = orbit.continued(&found.orbits);
        let own = found.orbits.iter().zip(soft).find(|(o, _)| Some(*o) == same).and_then(|(_, soft)| soft);
        Ok(own.map(|soft| {
            (Answer::exact(self.question.observable.of_softened(&soft)), soft.share, contact.restitution)
        }))
    }

    /// Impacts at once.
    pub fn restitution(motions: &Motions) -> Outcome {
        Outcome::read(&motions.reading, motions.cost, vec![into(motions)])
    }

    /// Spring and damper.
    pub fn kelvin_voigt(&self, motions: &Motions) -> Outcome {
        if laws::is_curved(self.scene) {
            return Outcome::not(Finding::note("spring-needed"));
        }
        let Some(stiffness) = laws::keys(self.scene).stiffness else {
            return Outcome::not(Finding::note("stiffness-unknown"));
        };
        let known = Finding::note("stiffness-known").number("stiffness", stiffness);
        let law = self.scene.spring(stiffness);
        law.and_then(|law| self.contact(motions, law, known)).unwrap_or_else(|e| Outcome::refused(&e))
    }

    /// A curved contact that is stated.
    pub fn hunt_crossley(&self, motions: &Motions) -> Outcome {
        if !laws::is_curved(self.scene) {
            return Outcome::not(Finding::note("exponent-unknown"));
        }
        if motions.reading.speed <= 0.0 {
            return Outcome::not(Finding::note("impacts-missing"));
        }
        laws::curved(self.scene, motions.reading.speed)
            .and_then(|law| self.contact(motions, law, Finding::note("law-known")))
            .unwrap_or_else(|e| Outcome::refused(&e))
    }

    /// Curved bodies that meet for as long as the spring that is stated and rebound alike, in place of an exponent that is not stated.
    pub(crate) fn curved_alike(&self, motions: &Motions) -> Outcome {
        let speed = motions.reading.speed;
        let Some(stiffness) = laws::keys(self.scene).stiffness.filter(|_| speed > 0.0) else {
            return Outcome::not(Finding::note("impacts-missing"));
        };
        let law = self.scene.spring(stiffness).and_then(|law| laws::alike(self.rig(), law, speed));
        match law.and_then(|law| self.with(motions, law)) {
            Err(error) => Outcome::refused(&error),
            Ok((reading, cost)) => Outcome {
                answer: Some(reading.answer),
                cost: Some(cost),
                ..Outcome::not(Finding::note("exponent-assumed").number("exponent", laws::HERTZ))
            },
        }
    }

    /// A contact whose law is known: followed the way the rig came, else from where the motion with impacts at once had settled and from rest.
    fn contact(&self, motions: &Motions, law: Law, known: Finding) -> Result<Outcome> {
        if let Some(way) = &motions.way {
            let (reading, cost) = self.follow(motions, &way.with(law)?)?;
            return Ok(Outcome::read(&reading, cost, vec![known]));
        }
        let (reading, cost) = self.with(motions, law)?;
        let rest = Simulation::at_rest(self.rig());
        let mut rest = Compliant::new(self.rig(), self.excitation, law, rest, 0.0)?;
        let rest = self.watching(motions, law).read(&mut rest)?;
        let mut found = Outcome::read(&reading, cost, vec![known]);
        if rest.end == End::Under {
            found.reasons.push(Finding::caution("rest-unclear").count("cycles", rest.cycles as usize));
        }
        Ok(Outcome { from_rest: Some(rest), ..found })
    }

    /// What a spring and damper of this stiffness (N/m) gives, from where the motion with impacts at once had settled.
    pub(crate) fn with_spring(&self, motions: &Motions, stiffness: f64) -> Result<Answer> {
        Ok(self.with(motions, self.scene.spring(stiffness)?)?.0.answer)
    }

    fn with(&self, motions: &Motions, law: Law) -> Result<(Reading, f64)> {
        let end = &motions.end;
        self.follow(motions, &Compliant::new(self.rig(), self.excitation, law, end.state(), end.phase())?)
    }

    fn follow(&self, motions: &Motions, start: &Compliant) -> Result<(Reading, f64)> {
        let reader = self.watching(motions, start.law());
        let (reading, cost) = timed(|| reader.read(&mut start.clone()));
        Ok((reading?, cost))
    }

    /// How motions with this contact are read.
    fn watching(&self, motions: &Motions, law: Law) -> Reader {
        let reader = self.reader().clear_by(motions.clearance);
        if matches!(law, Law::KelvinVoigt { .. }) { reader } else { reader.brief() }
    }

    fn reader(&self) -> Reader {
        Reader::new(self.rig(), self.excitation.frequency(), self.question)
    }

    /// A mass 1 loose on its spring, from rest; with the contact's spring and damper where they are known.
    pub(crate) fn loose_mass(&self, stiffness: Option<f64>) -> Outcome {
        let Some(buffer) = self.scene.buffer else {
            return Outcome::not(Finding::note("buffer-missing"));
        };
        let run = || -> Result<(Reading, f64)> {
            let (rig, rest) = (self.rig(), Simulation::at_rest(self.rig()));
            let mut motion = match stiffness {
                Some(k) => {
                    let law = self.scene.spring(k)?;
                    Loose::with_law(rig, self.excitation, buffer.gap, law, rest, 0.0)?
                }
                None => Loose::new(rig, self.excitation, buffer.gap, rest, 0.0)?,
            };
            let (reading, cost) = timed(|| self.reader().read(&mut motion));
            Ok((reading?, cost))
        };
        match run() {
            Err(error) => Outcome::refused(&error),
            Ok((reading, cost)) => {
                let mut reasons = vec![Finding::note("spring-only-pushes").number("gap", buffer.gap)];
                if self.question.history.is_some() {
                    reasons.push(Finding::caution("history-not-followed"));
                }
                Outcome::read(&reading, cost, reasons)
            }
        }
    }
}
