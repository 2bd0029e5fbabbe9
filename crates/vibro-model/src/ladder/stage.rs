//! What each rung answers at one excitation of a scene, and whether its own checks pass.

use super::Question;
use super::change::Answer;
use super::cost::{self, Cost};
use super::laws;
use super::motions::{Motions, On};
use super::reading::{End, Reader, Reading};
use super::tried::{Tried, capital, into, pattern, told};
use crate::{
    Compliance, Compliant, Excitation, Law, Loose, Observable, Orbit, Rig, Scene, Simulation, no_impact,
    softened,
};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use vibro_record::Result;
use vibro_record::units::notation::quantity;

/// A scene at one excitation.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    pub scene: &'a Scene,
    pub excitation: &'a Excitation,
    pub question: &'a Question,
    /// Whether answers are timed more than once.
    pub repeat: bool,
}

impl Stage<'_> {
    /// What `work` gives and the time it takes.
    pub fn timed<T>(&self, work: impl FnMut() -> T) -> (T, Cost) {
        cost::timed(self.repeat, work)
    }

    fn rig(&self) -> &Rig {
        &self.scene.rig
    }

    /// Mass 1 alone.
    pub fn linear(&self, motions: &Motions) -> Tried {
        let (found, cost) = self.timed(|| {
            let found = no_impact(self.rig(), self.excitation)?;
            let value = match self.question.observable {
                Observable::Fundamental => [self.alone(), 0.0],
                other => other.of_no_impact(&found),
            };
            Ok((found, value))
        });
        let (found, value) = match found {
            Ok(found) => found,
            Err(error) => return Tried::refused(&error),
        };
        let (gap, sure) = (self.rig().gap, self.question.gap_std);
        let [size, width] = [found.largest, gap].map(|v| quantity(v, "m", 4));
        let way = if found.largest == 0.0 {
            "Nothing moves mass 1".to_owned()
        } else {
            format!("Mass 1 alone moves up to {size}")
        };
        let (valid, why) = match motions.on {
            _ if !found.possible => (false, format!("{way}, the gap is {width}: the masses meet.")),
            _ if gap - found.largest <= sure => {
                let left = quantity(gap - found.largest, "m", 2);
                let clear =
                    format!("{way}, the gap is {width}: the masses stay clear by {left}, no more than");
                (false, format!("{clear} the gap's uncertainty of {}.", quantity(sure, "m", 2)))
            }
            On::Free => {
                (true, format!("{way}, the gap is {width}: the masses do not meet, and {}.", into(motions)))
            }
            On::Open => (true, format!("{way}, the gap is {width}: the masses need not meet.")),
            On::Orbit(_) | On::Other => (
                false,
                format!(
                    "{way} and need not meet mass 2, but the rig is not in this motion: {}.",
                    into(motions)
                ),
            ),
        };
        Tried { valid, answer: Some(Answer::exact(value)), cost: Some(cost), why, from_rest: None }
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
    pub fn closed_form(&self, motions: &Motions) -> Tried {
        let orbit = match motions.orbit() {
            Err(error) => return Tried::refused(error),
            Ok(None) => {
                return Tried::not(
                    "There is no motion with one impact a cycle: no impulse above 0 satisfies its equations.",
                );
            }
            Ok(Some(orbit)) => orbit,
        };
        let v = &orbit.validity;
        let radius = orbit.spectral_radius().unwrap_or(f64::NAN);
        let (valid, why) = if !v.admissible {
            let deep = 1e3 * v.min_gap.abs();
            (
                false,
                format!(
                    "The masses would pass through each other by {deep:.3} mm between the impacts of the solution with one impact a cycle."
                ),
            )
        } else if v.stable != Some(true) {
            (
                false,
                format!(
                    "The motion with one impact a cycle is {} (largest multiplier {radius:.4}).",
                    v.stability
                ),
            )
        } else if !orbit.robust(self.question.gap_std) {
            let why = if v.grazing_distance <= self.question.gap_std {
                format!("is {} from grazing, no more than", quantity(v.grazing_distance, "m", 2))
            } else {
                "is not stable at all gaps within".to_owned()
            };
            (
                false,
                format!(
                    "The motion with one impact a cycle {why} the gap's uncertainty of {}.",
                    quantity(self.question.gap_std, "m", 2)
                ),
            )
        } else {
            let real = format!(
                "The motion with one impact a cycle exists, is admissible, stable (largest multiplier {radius:.4}) and to first order {} from grazing",
                quantity(v.grazing_distance, "m", 2)
            );
            match motions.on {
                On::Orbit(_) => (true, format!("{real}; {}.", into(motions))),
                On::Open => (true, format!("{real}.")),
                On::Free | On::Other => {
                    (false, format!("{real}, but the rig is not in it: {}.", into(motions)))
                }
            }
        };
        let answer = Answer::exact(self.question.observable.of_orbit(orbit));
        Tried { valid, answer: Some(answer), cost: Some(motions.closed_cost), why, from_rest: None }
    }

    /// The same with the contact's duration.
    pub fn soft_corrected(&self, motions: &Motions, closed: &Tried) -> Tried {
        if laws::is_curved(self.scene) {
            return Tried::not("The correction knows springs only, and the contact's exponent is not 1.");
        }
        let Some(stiffness) = laws::keys(self.scene).stiffness else {
            return Tried::not("The contact's stiffness is not known.");
        };
        if !closed.valid {
            return Tried::not("There is nothing to correct: the closed form does not hold.");
        }
        let Ok(Some(orbit)) = motions.orbit() else { return Tried::not("There is nothing to correct.") };
        let (soft, cost) = self.timed(|| self.soften(orbit, stiffness));
        match soft {
            Err(error) => Tried { cost: Some(cost), ..Tried::refused(&error) },
            Ok(None) => Tried {
                cost: Some(cost),
                ..Tried::not(
                    "The correction finds no motion: with a contact of this duration the masses would have to rebound faster than they meet, or none is left.",
                )
            },
            Ok(Some((answer, share, restitution))) => {
                let mut why = format!(
                    "The contact lasts {:.2} % of the cycle, within the 2.5 % to which its correction is good.",
                    100.0 * share
                );
                let of_rig = self.rig().restitution;
                if (restitution - of_rig).abs() > 1e-3 {
                    let _ = write!(
                        why,
                        " Its spring and damper rebound with {restitution:.3}, the rig says {of_rig}: theirs counts."
                    );
                }
                Tried { valid: true, answer: Some(answer), cost: Some(cost), why, from_rest: None }
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

    /// Spring and damper.
    pub fn kelvin_voigt(&self, motions: &Motions) -> Tried {
        if laws::is_curved(self.scene) {
            return Tried::not("The contact's exponent is not 1: its stiffness is that of no spring.");
        }
        let Some(stiffness) = laws::keys(self.scene).stiffness else {
            return Tried::not("The contact's stiffness is not known.");
        };
        let said = format!("The contact's stiffness is known: {stiffness:.3e} N/m.");
        self.scene
            .spring(stiffness)
            .map_or_else(|e| Tried::refused(&e), |law| self.contact(motions, law, &said))
    }

    /// A contact whose law is known: followed the way the rig came, else from where the motion with impacts at once had settled and from rest.
    fn contact(&self, motions: &Motions, law: Law, said: &str) -> Tried {
        let run = || -> Result<Tried> {
            let rig = self.rig();
            let ((reading, cost), from_rest) = if let Some(way) = &motions.way {
                (self.follow(motions, &way.with(law)?)?, None)
            } else {
                let own = self.with(motions, law)?;
                let rest = Simulation::at_rest(rig);
                let mut rest = Compliant::new(rig, self.excitation, law, rest, 0.0)?;
                (own, Some(self.watching(motions, law).read(&mut rest)?))
            };
            let mut why = format!("{said} {}", told(&reading));
            if from_rest.as_ref().is_some_and(|rest| rest.end == End::Under) {
                why.push_str(" From rest it has not settled, and may come to another motion.");
            }
            Ok(Tried { valid: true, answer: Some(reading.answer), cost: Some(cost), why, from_rest })
        };
        run().unwrap_or_else(|error| Tried::refused(&error))
    }

    /// What a spring and damper of this stiffness (N/m) gives, from where the motion with impacts at once had settled.
    pub fn with_spring(&self, motions: &Motions, stiffness: f64) -> Result<(Reading, Cost)> {
        self.with(motions, self.scene.spring(stiffness)?)
    }

    fn with(&self, motions: &Motions, law: Law) -> Result<(Reading, Cost)> {
        let end = &motions.end;
        self.follow(motions, &Compliant::new(self.rig(), self.excitation, law, end.state(), end.phase())?)
    }

    fn follow(&self, motions: &Motions, start: &Compliant) -> Result<(Reading, Cost)> {
        let reader = self.watching(motions, start.law());
        let (reading, cost) = self.timed(|| reader.read(&mut start.clone()));
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

    /// A curved contact: the one stated, or one like the spring stated.
    pub fn hunt_crossley(&self, motions: &Motions) -> Tried {
        let speed = motions.reading.speed;
        let stated = laws::is_curved(self.scene);
        let Some(stiffness) = laws::keys(self.scene).stiffness else {
            return Tried::not("The contact's stiffness is not known.");
        };
        if speed <= 0.0 {
            return Tried::not("There are no impacts whose law could matter.");
        }
        if stated {
            return match laws::curved(self.scene, speed) {
                Ok(law) => self.contact(motions, law, "The contact's law is known."),
                Err(error) => Tried::refused(&error),
            };
        }
        let law = self.scene.spring(stiffness).and_then(|law| laws::alike(self.rig(), law, speed));
        match law.and_then(|law| self.with(motions, law)) {
            Err(error) => Tried::refused(&error),
            Ok((reading, cost)) => Tried {
                answer: Some(reading.answer),
                cost: Some(cost),
                ..Tried::not(
                    "The contact's exponent is not known; curved bodies (exponent 1.5) of the same duration and rebound stand in for it.",
                )
            },
        }
    }

    /// A mass 1 loose on its spring, from rest; with the contact's spring and damper where they are known.
    pub fn loose_mass(&self, stiffness: Option<f64>) -> Tried {
        let Some(buffer) = self.scene.buffer else {
            return Tried::not("The spring holds mass 1 both ways: the scene has no buffer.");
        };
        let run = || -> Result<(Reading, Cost)> {
            let (rig, rest) = (self.rig(), Simulation::at_rest(self.rig()));
            let start = match stiffness {
                Some(k) => {
                    let law = self.scene.spring(k)?;
                    Loose::with_law(rig, self.excitation, buffer.gap, law, rest, 0.0)?
                }
                None => Loose::new(rig, self.excitation, buffer.gap, rest, 0.0)?,
            };
            let (reading, cost) = self.timed(|| self.reader().read(&mut start.clone()));
            Ok((reading?, cost))
        };
        match run() {
            Err(error) => Tried::refused(&error),
            Ok((reading, cost)) => Tried {
                valid: true,
                answer: Some(reading.answer),
                cost: Some(cost),
                why: format!(
                    "The spring of mass 1 only pushes, beyond {}; from rest, {}. {} {ALONE}{}",
                    quantity(buffer.gap, "m", 4),
                    pattern(&reading),
                    told(&reading),
                    self.question.history.map_or("", |_| " The history is not followed.")
                ),
                from_rest: None,
            },
        }
    }
}

/// What is not done for a loose mass.
const ALONE: &str = "Other motions are not looked for, and no richer model checks the answer.";

/// Impacts at once.
pub fn restitution(motions: &Motions) -> Tried {
    Tried {
        valid: true,
        answer: Some(motions.reading.answer),
        cost: Some(motions.cost),
        why: format!("{} {}", capital(&into(motions)), told(&motions.reading)),
        from_rest: None,
    }
}
