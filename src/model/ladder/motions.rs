//! The motions of a rig at one excitation, as far as they are known, and the one that it is in.

use super::change::Answer;
use super::cost::{timed, timed_once};
use super::history::arrived;
use super::reading::{Reader, Reading};
use super::{Model, Question};
use crate::error::{Error, Result};
use crate::model::{Excitation, Orbit, Orbits, Regime, Rig, Simulation, orbits_of};
use serde::Serialize;

/// A motion that the rig can be in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Known {
    /// Its pattern: `no impact`, impacts/cycles, `chatter` or `irregular`.
    pub pattern: String,
    /// What is shown of it.
    pub answer: [f64; 2],
}

/// The motion that the rig is in.
#[derive(Debug, Clone, PartialEq)]
pub enum On {
    Free,
    Orbit(Box<Orbit>),
    /// None of those known in closed form.
    Other,
    /// Several are known, and nothing says which.
    Open,
}

/// What is known of the motions.
#[derive(Debug)]
pub struct Motions {
    /// In closed form.
    pub closed: Result<Orbits>,
    /// What that took in ns.
    pub closed_cost: f64,
    pub known: Vec<Known>,
    pub on: On,
    /// Whether it is told from the way the rig came there.
    pub by_history: bool,
    /// The motion followed with impacts at once, from rest or the way it came.
    pub reading: Reading,
    /// What that took in ns.
    pub cost: f64,
    /// Where it ended.
    pub end: Simulation,
}

/// Whether an orbit can be and stay.
fn stays(orbit: &Orbit) -> bool {
    let v = &orbit.validity;
    v.exists && v.admissible && v.stable == Some(true)
}

impl Motions {
    /// Looks for them: in closed form, and from rest.
    pub fn new(rig: &Rig, excitation: &Excitation, question: &Question) -> Result<Motions> {
        let (closed, closed_cost) = timed(|| orbits_of(rig, excitation, 1));
        let mut end = Simulation::new(rig, excitation)?;
        let reader = Reader::new(rig, excitation.frequency(), question);
        let (reading, cost) = timed_once(|| reader.read(&mut end));
        let mut motions = Motions {
            closed,
            closed_cost,
            known: Vec::new(),
            on: On::Other,
            by_history: false,
            reading: reading?,
            cost,
            end,
        };
        motions.on = motions.which(question);
        motions.list(question);
        if motions.known.len() > 1 {
            match question.history {
                None => motions.on = On::Open,
                Some(direction) => {
                    motions.end = arrived(rig, excitation, direction)?;
                    let (reading, cost) = timed_once(|| reader.read(&mut motions.end));
                    (motions.reading, motions.cost, motions.by_history) = (reading?, cost, true);
                    motions.on = motions.which(question);
                }
            }
        }
        Ok(motions)
    }

    /// Orbits that can be and stay.
    fn stable(&self) -> impl Iterator<Item = &Orbit> {
        self.closed.iter().flat_map(|found| found.orbits.iter().filter(|orbit| stays(orbit)))
    }

    /// The motion that was followed, among those in closed form.
    fn which(&self, question: &Question) -> On {
        if self.reading.regime == Regime::NoImpact {
            return On::Free;
        }
        let near = |orbit: &&Orbit| {
            let answer = Answer::exact(question.observable.of_orbit(orbit));
            let off = (self.reading.speed / orbit.approach_velocity - 1.0).abs();
            off <= question.tolerance.max(1e-3)
                && answer.change(&self.reading.answer, Model::Restitution, question).enough
        };
        self.stable().find(near).map_or(On::Other, |orbit| On::Orbit(Box::new(*orbit)))
    }

    /// Lists the motions known.
    fn list(&mut self, question: &Question) {
        let mut known = Vec::new();
        if let Ok(found) = &self.closed
            && found.no_impact.possible
        {
            let answer = question.observable.of_no_impact(&found.no_impact);
            known.push(Known { pattern: Regime::NoImpact.to_string(), answer });
        }
        known.extend(self.stable().map(|orbit| Known {
            pattern: Regime::Periodic { impacts: 1, cycles: 1 }.to_string(),
            answer: question.observable.of_orbit(orbit),
        }));
        if self.on == On::Other {
            known.push(Known { pattern: self.reading.regime.to_string(), answer: self.reading.answer.value });
        }
        self.known = known;
    }

    /// The orbit to speak of: the one the rig is in, else the first that can be and stay, else the first that exists.
    pub fn orbit(&self) -> std::result::Result<Option<&Orbit>, &Error> {
        if let On::Orbit(orbit) = &self.on {
            return Ok(Some(orbit));
        }
        let found = self.closed.as_ref()?;
        let existing = found.orbits.iter().find(|o| o.validity.exists);
        Ok(self.stable().next().or(existing))
    }
}
