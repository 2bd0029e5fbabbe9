//! The answer of each rung at one excitation of a scene, and whether the rung's own checks pass.

use super::driven_scene::{DrivenScene, curved, is_curved, keys, timed};
use super::motions::{CurrentMotion, Motions};
use super::question::Answer;
use super::reading::{BRIEF, MotionReader, Reading, Settling};
use super::rung::{Found, Model, Rung};
use crate::contact::Compliant;
use crate::law::{HERTZ, Law, conversion};
use crate::motion::Motion;
use crate::observable::Observable;
use crate::orbit::{Compliance, Orbit, Softened, no_impact, orbits_of, softened};
use crate::rig::Rig;
use crate::simulate::Simulation;
use std::f64::consts::TAU;
use vibro_record::{Finding, Result};

/// The contact of two curved bodies with the duration and the restitution of this spring and damper at the
/// approach speed `speed` (m/s).
///
/// Its duration without losses is 2.9432 (5Mv²/4k)^{2/5}/v, which gives k.
fn as_long(rig: &Rig, law: Law, speed: f64) -> Result<Law> {
    if !law.is_linear() {
        return Ok(law);
    }
    let Law { stiffness, damping, .. } = law;
    let mass = rig.reduced_mass();
    let ratio = damping / (2.0 * (stiffness * mass).sqrt());
    let lasts = conversion::duration(ratio, stiffness, mass);
    // hertz_duration falls with the stiffness as k^{−2/5}.
    let curved = (conversion::hertz_duration(1.0, mass, speed) / lasts).powf(2.5);
    Law::hunt_crossley(curved, HERTZ, conversion::restitution(ratio), speed)
}

/// Finding on the motion that the simulation reached, from rest or along the rig's history.
fn into(motions: &Motions) -> Finding {
    let reading = &motions.reading;
    let found = match reading.end {
        Settling::Under => Finding::caution("rest-not-settled"),
        _ => Finding::note("rest-leads-to"),
    };
    let motion = match (reading.end, reading.regime) {
        (Settling::Pressed, _) => "lasting contact".to_owned(),
        (_, regime) => regime.to_string(),
    };
    found.name("motion", motion).count("cycles", reading.cycles as usize)
}

impl DrivenScene<'_> {
    fn rig(&self) -> &Rig {
        &self.scene.rig
    }

    /// The answer of a rung; `closed` is whether the closed form is valid.
    pub fn rung(&self, model: Model, motions: &mut Motions, closed: bool) -> Rung {
        let found = match model {
            Model::Linear => self.linear(motions),
            Model::ClosedForm => self.closed_form(motions),
            Model::SoftCorrected => self.soft_corrected(motions, closed),
            Model::Restitution => Ok(Rung::read(&motions.reading, motions.cost, vec![into(motions)])),
            Model::KelvinVoigt => self.kelvin_voigt(motions),
            Model::HuntCrossley => self.hunt_crossley(motions),
            Model::LooseMass => self.loose_mass(None),
        };
        Rung::of(model, found)
    }

    /// Motion of mass 1 alone, without impacts.
    fn linear(&self, motions: &Motions) -> Found {
        let (found, cost) = timed(|| no_impact(self.rig(), self.excitation));
        let found = found?;
        let value = match self.question.observable {
            Observable::Fundamental => {
                let [l1, _] = self.rig().receptances(TAU * self.excitation.frequency());
                [(self.excitation.harmonic(1, 0.0) * l1).norm(), 0.0]
            }
            other => other.of_no_impact(&found),
        };
        let (gap, std) = (self.rig().gap, self.question.gap_std);
        let sized = |code| Finding::note(code).number("largest", found.largest).number("gap", gap);
        let clear = gap - found.largest;
        let stays_clear = || sized("masses-stay-clear");
        let (valid, reasons) = match motions.on {
            _ if !found.possible => (false, vec![sized("masses-meet")]),
            _ if clear <= std => {
                let unsure = Finding::note("clearance-not-sure").number("clearance", clear);
                (false, vec![unsure.number("std", std)])
            }
            CurrentMotion::Open => (true, vec![stays_clear()]),
            CurrentMotion::Free => (true, vec![stays_clear(), into(motions)]),
            CurrentMotion::Orbit(_) | CurrentMotion::Other => {
                (false, vec![stays_clear(), Finding::note("other-motion"), into(motions)])
            }
        };
        Ok(Rung::answering(Answer::exact(value), cost, valid, reasons))
    }

    /// Motion with one rigid impact per cycle, in closed form.
    fn closed_form(&self, motions: &Motions) -> Found {
        let orbit = motions.orbit()?.ok_or_else(|| Finding::note("orbit-missing"))?;
        let v = &orbit.validity;
        let radius = orbit.spectral_radius().unwrap_or(f64::NAN);
        let std = self.question.gap_std;
        let real = v.real() && orbit.robust(std);
        let mut reasons = vec![if !v.admissible {
            Finding::note("orbit-overlaps").number("depth", v.min_gap.abs())
        } else if v.stable != Some(true) {
            Finding::note("orbit-not-stable").name("stability", v.stability()).number("radius", radius)
        } else if !real {
            Finding::note("orbit-near-grazing").number("distance", v.grazing_distance).number("std", std)
        } else {
            Finding::note("orbit-real").number("radius", radius).number("distance", v.grazing_distance)
        }];
        match motions.on {
            CurrentMotion::Orbit(_) if real => reasons.push(into(motions)),
            CurrentMotion::Free | CurrentMotion::Other if real => {
                reasons.extend([Finding::note("other-motion"), into(motions)]);
            }
            _ => {}
        }
        let valid = real && matches!(motions.on, CurrentMotion::Orbit(_) | CurrentMotion::Open);
        let answer = Answer::exact(self.question.observable.of_orbit(orbit));
        Ok(Rung::answering(answer, motions.closed_cost, valid, reasons))
    }

    /// Stiffness in N/m of the contact, which must be a linear spring.
    fn stiffness(&self) -> std::result::Result<f64, Finding> {
        match keys(self.scene).stiffness {
            _ if is_curved(self.scene) => Err(Finding::note("spring-needed")),
            None => Err(Finding::note("stiffness-unknown")),
            Some(stiffness) => Ok(stiffness),
        }
    }

    /// The closed form corrected for the duration of the contact, where it is `valid`.
    fn soft_corrected(&self, motions: &Motions, valid: bool) -> Found {
        let stiffness = self.stiffness()?;
        let orbit = motions.orbit().ok().flatten().filter(|_| valid);
        let orbit = orbit.ok_or_else(|| Finding::note("nothing-to-correct"))?;
        let (soft, cost) = timed(|| self.soften(orbit, stiffness));
        let soft = soft?.ok_or_else(|| Finding::note("corrected-motion-missing"))?;
        let reason = Finding::note("contact-short-enough").number("share", soft.share);
        let answer = Answer::exact(self.question.observable.of_softened(&soft));
        Ok(Rung::answering(answer, cost, true, vec![reason]))
    }

    fn soften(&self, orbit: &Orbit, stiffness: f64) -> Result<Option<Softened>> {
        let contact = Compliance::new(self.rig(), stiffness, keys(self.scene).damping)?;
        let rig = Rig { restitution: contact.restitution, ..*self.rig() };
        let found = orbits_of(&rig, self.excitation, 1)?;
        let soft = softened(&rig, self.excitation, &found, &contact)?;
        let same = orbit.continued(&found.orbits);
        Ok(found.orbits.iter().zip(soft).find(|(o, _)| Some(*o) == same).and_then(|(_, soft)| soft))
    }

    /// Contact of spring and damper.
    fn kelvin_voigt(&self, motions: &mut Motions) -> Found {
        let law = self.scene.spring(self.stiffness()?)?;
        self.contact(Model::KelvinVoigt, motions, law)
    }

    /// Contact of curved bodies, as stated.
    fn hunt_crossley(&self, motions: &mut Motions) -> Found {
        if !is_curved(self.scene) {
            return Err(Finding::note("exponent-unknown").into());
        }
        let speed = motions.speed()?;
        self.contact(Model::HuntCrossley, motions, curved(self.scene, speed)?)
    }

    /// Contact of curved bodies with the duration and the restitution of the stated spring. It shows how
    /// much the exponent matters where none is stated.
    pub fn curved_alike(&self, motions: &Motions) -> Found {
        let speed = motions.speed()?;
        let stiffness = keys(self.scene).stiffness.ok_or_else(|| Finding::note("impacts-missing"))?;
        let law = as_long(self.rig(), self.scene.spring(stiffness)?, speed)?;
        let (reading, cost) = self.with(motions, law)?;
        let reason = Finding::note("exponent-assumed").number("exponent", HERTZ);
        Ok(Rung::answering(reading.answer, cost, false, vec![reason]))
    }

    /// Simulation with a known contact law: along the stated history, or else from the settled state of the
    /// motion with rigid impacts and also from rest.
    fn contact(&self, model: Model, motions: &mut Motions, law: Law) -> Found {
        if let Some(way) = &motions.way {
            let (reading, cost) = self.follow(motions, way.with(law)?)?;
            return Ok(Rung::read(&reading, cost, Vec::new()));
        }
        let (reading, cost) = self.with(motions, law)?;
        let mut found = Rung::read(&reading, cost, Vec::new());
        let rest = Simulation::at_rest(self.rig());
        let rest = Compliant::new(self.rig(), self.excitation, law, rest, 0.0)?;
        let (rest, _) = self.follow(motions, rest)?;
        if rest.end == Settling::Under {
            found.reasons.push(Finding::caution("rest-unclear").count("cycles", rest.cycles as usize));
        }
        motions.differs(&reading.answer, &rest, model, self.question);
        Ok(found)
    }

    /// Reading with this contact law, from the settled state of the motion with rigid impacts, and the
    /// computing time in ns.
    pub fn with(&self, motions: &Motions, law: Law) -> Result<(Reading, f64)> {
        let end = &motions.end;
        self.follow(motions, Compliant::new(self.rig(), self.excitation, law, end.state(), end.phase())?)
    }

    fn follow(&self, motions: &Motions, mut start: Compliant) -> Result<(Reading, f64)> {
        let mut reader = MotionReader { clearance: motions.clearance, ..self.reader() };
        if start.integrates() {
            reader.blocks = reader.blocks.min(BRIEF);
        }
        let (reading, cost) = timed(|| reader.read(&mut start));
        Ok((reading?, cost))
    }

    fn reader(&self) -> MotionReader {
        MotionReader::new(self.rig(), self.excitation.frequency(), self.question)
    }

    /// Simulation from rest of a mass 1 that is loose on its spring; with spring and damper of the contact if
    /// its `stiffness` (N/m) is given.
    pub fn loose_mass(&self, stiffness: Option<f64>) -> Found {
        let buffer = self.scene.buffer.ok_or_else(|| Finding::note("buffer-missing"))?;
        let (rig, rest) = (self.rig(), Simulation::at_rest(self.rig()));
        let law = stiffness.map(|k| self.scene.spring(k)).transpose()?;
        let mut motion = Compliant::loose(rig, self.excitation, buffer, law, rest, 0.0)?;
        let (reading, cost) = timed(|| self.reader().read(&mut motion));
        let mut reasons = vec![Finding::note("spring-only-pushes").number("gap", buffer.gap)];
        if self.question.history.is_some() {
            reasons.push(Finding::caution("history-not-followed"));
        }
        Ok(Rung::read(&reading?, cost, reasons))
    }
}
