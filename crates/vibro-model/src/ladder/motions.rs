//! The known motions of a rig at one excitation, and which of them it is in.

use super::driven_scene::{DrivenScene, timed};
use super::question::{APART, Answer, Question};
use super::reading::{MotionReader, Reading, Settling};
use super::rung::Model;
use super::starts::{Approach, Followed, several, starts};
use crate::flow::State;
use crate::motion::Motion;
use crate::orbit::{Orbit, Orbits, orbits_of};
use crate::regime::Regime;
use crate::regime::Strike;
use crate::simulate::Simulation;
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use vibro_record::{Error, Finding, Result};

/// Longest period, in cycles, of the motions with one impact that are computed in closed form.
pub(crate) const MOST_CYCLES: u32 = 6;
/// Total simulated cycles after which no further start state is tried; it bounds the computing time.
const MOST_FOLLOWED: u32 = 40_000;
/// Relative reduction of the speeds for a start near an orbit.
const BESIDE: f64 = 0.02;

/// A motion that the rig can be in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownMotion {
    /// Its pattern; in JSON `no impact`, impacts/cycles, `chatter` or `irregular`.
    #[serde(serialize_with = "as_text")]
    pub pattern: Regime,
    /// The model that it was found with.
    pub model: Model,
    /// Its observable for x₁ and x₂.
    pub answer: [f64; 2],
    /// Standard errors of the answer, where it is a mean over a motion that does not repeat; else 0.
    pub spread: [f64; 2],
    /// Whether it is stable. An unstable motion is listed where it separates the motion without impacts from
    /// motions with impacts around it.
    pub stable: bool,
    /// Whether it is a coexisting motion with less than one impact a cycle that the rig reaches neither from
    /// rest nor along its history, and no compliant contact reaches from rest. It gives a caution, and
    /// requires no history.
    pub rare: bool,
}

fn as_text<S: serde::Serializer>(pattern: &Regime, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_str(pattern)
}

impl KnownMotion {
    /// A stable motion, as read from a simulation.
    fn followed(reading: &Reading, model: Model, rare: bool) -> KnownMotion {
        let Answer { value, spread, .. } = reading.answer;
        KnownMotion { pattern: reading.regime, model, answer: value, spread, stable: true, rare }
    }

    /// Whether this may be the motion of `reading`: both have no impacts, or their answers agree within
    /// tolerance, noise floor or standard errors.
    fn may_be(&self, reading: &Reading, question: &Question) -> bool {
        let still = reading.regime == Regime::NoImpact && self.pattern == Regime::NoImpact;
        let own = Answer { spread: self.spread, ..Answer::exact(self.answer) };
        still || own.agrees(&reading.answer, question, APART)
    }
}

/// Which of the motions the rig is in.
#[derive(Debug, Clone, PartialEq)]
pub enum CurrentMotion {
    Free,
    Orbit(Box<Orbit>),
    /// Any other motion: not known in closed form, of a longer period, or not settled.
    Other,
    /// Several are known, and no history selects one.
    Open,
}

/// The known motions, and the simulation with rigid impacts.
#[derive(Debug)]
pub struct Motions {
    /// Motion without impacts, and orbits with one impact a cycle, in closed form.
    pub closed: Result<Orbits>,
    /// Computing time of the closed forms in ns.
    pub closed_cost: f64,
    /// Admissible orbits in closed form with one impact in 2 to [`MOST_CYCLES`] cycles: the masses do not
    /// pass through each other.
    longer: Vec<Orbit>,
    pub known: Vec<KnownMotion>,
    pub on: CurrentMotion,
    /// Smallest distance in m between mass 1 without impacts and mass 2; `None` without a closed form.
    pub clearance: Option<f64>,
    /// Sweep that led the rig to this excitation; `None` without a history.
    pub way: Option<Approach>,
    /// Start states from which other motions were searched; `None` without a search.
    pub followed: Option<Followed>,
    /// Reading of the simulation with rigid impacts, from rest or along the history.
    pub reading: Reading,
    /// Computing time of this simulation in ns.
    pub cost: f64,
    /// State of this simulation at its end.
    pub end: Simulation,
}

impl Motions {
    /// Finds the motions in closed form, and by simulation: along the history, or else from rest and from
    /// other states.
    pub fn new(stage: &DrivenScene<'_>) -> Result<Motions> {
        let (rig, excitation, question) = (&stage.scene.rig, stage.excitation, stage.question);
        let (closed, closed_cost) = timed(|| orbits_of(rig, excitation, 1));
        let clearance = closed.as_ref().ok().map(|found| rig.gap - found.no_impact.largest);
        let longer = (2..=MOST_CYCLES).filter_map(|cycles| orbits_of(rig, excitation, cycles).ok());
        let longer = longer.flat_map(|found| found.orbits).filter(|o| o.validity.admissible).collect();
        let way = question.history.map(|direction| Approach::new(rig, excitation, direction)).transpose()?;
        let mut end = match &way {
            Some(way) => way.rigid()?,
            None => Simulation::new(rig, excitation)?,
        };
        let reader = MotionReader { clearance, ..MotionReader::new(rig, excitation.frequency(), question) };
        let (reading, cost) = timed(|| reader.read(&mut end));
        let (reading, on, known, followed) = (reading?, CurrentMotion::Other, Vec::new(), None);
        let mut motions =
            Motions { closed, closed_cost, longer, known, on, clearance, way, followed, reading, cost, end };
        motions.list(question, reader.fine());
        if motions.way.is_none() {
            motions.seek(stage, &reader);
            if common(&motions.known) > 1 || motions.closed.as_ref().is_ok_and(several) {
                motions.on = CurrentMotion::Open;
            }
        }
        Ok(motions)
    }

    /// Searches for coexisting motions by simulation from other states: near unstable orbits, and those of
    /// [`starts`].
    fn seek(&mut self, stage: &DrivenScene<'_>, reader: &MotionReader) {
        let (rig, excitation) = (&stage.scene.rig, stage.excitation);
        let orbits = self.closed.iter().flat_map(|found| &found.orbits).chain(&self.longer);
        let lost = orbits.filter(|o| o.validity.admissible && o.validity.stable == Some(false));
        let round = lost.map(|orbit| (beside(orbit), orbit.force_phase));
        let states: Vec<_> = round.chain(starts(rig, excitation)).collect();
        let (of, mut followed, mut cycles) = (states.len() as u32, 0, 0);
        for (state, phase) in states {
            if common(&self.known) > 1 || cycles > MOST_FOLLOWED {
                break;
            }
            let started = Simulation::from_state(rig, excitation, state, phase).and_then(at_phase_0);
            // A state from which the simulation fails is skipped.
            let Ok(reading) = started.and_then(|mut motion| reader.read(&mut motion)) else { continue };
            (followed, cycles) = (followed + 1, cycles + reading.cycles);
            self.add(&reading, stage.question);
        }
        self.followed = Some(Followed { states: followed, of });
    }

    /// If a compliant contact reaches from rest another motion than that of its `answer`, lists this motion
    /// and sets the present motion to open.
    pub fn differs(&mut self, answer: &Answer, rest: &Reading, model: Model, question: &Question) {
        if rest.end == Settling::Under || !answer.steady || answer.agrees(&rest.answer, question, APART) {
            return;
        }
        self.on = CurrentMotion::Open;
        let found = KnownMotion::followed(rest, model, false);
        let same = |known: &&mut KnownMotion| known.pattern == found.pattern && known.may_be(rest, question);
        match self.known.iter_mut().find(same) {
            // The compliant contact reaches it from rest, so it is not rare.
            Some(known) => known.rare = false,
            None => self.known.push(found),
        }
    }

    /// Adds a settled motion with rigid impacts whose answer differs from those of all known motions.
    fn add(&mut self, reading: &Reading, question: &Question) {
        let settled = |reading: &Reading| reading.end != Settling::Under;
        let own = settled(&self.reading) && self.reading.answer.agrees(&reading.answer, question, APART);
        if settled(reading) && !own && !self.known.iter().any(|known| known.may_be(reading, question)) {
            let rare = matches!(reading.regime, Regime::Periodic { impacts, cycles } if impacts < cycles);
            self.known.push(KnownMotion::followed(reading, Model::Restitution, rare));
        }
    }

    /// Admissible and stable orbits with one impact a cycle.
    fn stable(&self) -> impl Iterator<Item = &Orbit> {
        self.closed.iter().flat_map(|found| &found.orbits).filter(|orbit| orbit.validity.real())
    }

    /// The orbit that the simulated motion is on; `fine` is the relative accuracy to which its state has
    /// settled.
    fn own(&self, fine: f64) -> Option<&Orbit> {
        let (strike, Regime::Periodic { impacts: 1, cycles }) = (self.reading.strike?, self.reading.regime)
        else {
            return None;
        };
        let real = self.stable().chain(self.longer.iter().filter(|o| o.validity.real()));
        let near = real.filter(|o| o.cycles == cycles).map(|orbit| (distance(&strike, orbit), orbit));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.filter(|(far, orbit)| *far <= reach(fine, orbit)).map(|(_, orbit)| orbit)
    }

    /// Lists the known motions, and finds which of them was simulated.
    fn list(&mut self, question: &Question, fine: f64) {
        let own = self.own(fine).filter(|_| self.reading.end == Settling::Settled);
        let on = match own {
            _ if self.reading.end == Settling::Settled && self.reading.regime == Regime::NoImpact => {
                CurrentMotion::Free
            }
            Some(orbit) if orbit.cycles == 1 => CurrentMotion::Orbit(Box::new(orbit.clone())),
            _ => CurrentMotion::Other,
        };
        let mut known = Vec::new();
        let found = self.closed.as_ref().ok();
        if let Some(free) = found.map(|found| &found.no_impact).filter(|free| free.possible) {
            let answer = question.observable.of_no_impact(free);
            let (pattern, model, spread) = (Regime::NoImpact, Model::Linear, [0.0; 2]);
            known.push(KnownMotion { pattern, model, answer, spread, stable: true, rare: false });
        }
        let known_as = |orbit: &Orbit| KnownMotion {
            pattern: Regime::Periodic { impacts: 1, cycles: orbit.cycles },
            model: Model::ClosedForm,
            answer: question.observable.of_orbit(orbit),
            spread: [0.0; 2],
            stable: orbit.validity.real(),
            rare: orbit.cycles > 1 && own.is_none_or(|own| own != orbit),
        };
        known.extend(self.stable().chain(self.longer.iter().filter(|o| o.validity.real())).map(known_as));
        if on == CurrentMotion::Other && self.reading.end != Settling::Under && own.is_none() {
            known.push(KnownMotion::followed(&self.reading, Model::Restitution, false));
        }
        // If no other motion with impacts is known, the unstable orbits are listed: other motions may lie
        // around them.
        if let Some(found) = found.filter(|found| common(&known) == 1 && several(found)) {
            known.extend(found.orbits.iter().filter(|o| o.validity.admissible).map(known_as));
        }
        (self.known, self.on) = (known, on);
    }

    /// The approach speed in m/s of the simulated impacts.
    pub fn speed(&self) -> std::result::Result<f64, Finding> {
        let speed = self.reading.speed;
        if speed > 0.0 { Ok(speed) } else { Err(Finding::note("impacts-missing")) }
    }

    /// The orbit to report: the one the rig is in, else the first admissible and stable one, else the first
    /// that exists.
    pub fn orbit(&self) -> std::result::Result<Option<&Orbit>, &Error> {
        if let CurrentMotion::Orbit(orbit) = &self.on {
            return Ok(Some(orbit));
        }
        let existing = self.closed.as_ref()?.orbits.iter().find(|o| o.validity.exists);
        Ok(self.stable().next().or(existing))
    }
}

/// Number of motions that are not rare. If there are several, only the history can select one.
fn common(known: &[KnownMotion]) -> usize {
    known.iter().filter(|m| !m.rare).count()
}

/// State after the impact of an orbit, with slightly smaller speeds.
fn beside(orbit: &Orbit) -> State {
    let state = orbit.state(0.0);
    State { v1: (1.0 - BESIDE) * state.v1, v2: (1.0 - BESIDE) * state.v2, ..state }
}

/// The motion, advanced to the next phase 0 of the excitation, where the cycles of a reading begin.
fn at_phase_0(mut motion: Simulation) -> Result<Simulation> {
    let left = (-motion.phase()).rem_euclid(TAU) / (TAU * motion.frequency());
    motion.advance(motion.time() + left, &mut |_| {})?;
    Ok(motion)
}

/// Distance of an impact from that of an orbit: the largest difference of the phases in rad, and of the
/// states over the largest speed.
fn distance(strike: &Strike, orbit: &Orbit) -> f64 {
    let omega = TAU * orbit.frequency;
    let (a, b) = (&strike.before, &orbit.before_impact());
    let turn = (strike.phase - orbit.force_phase + PI).rem_euclid(TAU) - PI;
    let moved = [(a.x1 - b.x1) * omega, a.v1 - b.v1, (a.x2 - b.x2) * omega, a.v2 - b.v2];
    moved.iter().fold(turn.abs(), |far, d| far.max(d.abs() / speed(orbit)))
}

/// The larger of all speeds and ω × displacements just before the impact, in m/s.
fn speed(orbit: &Orbit) -> f64 {
    let (omega, s) = (TAU * orbit.frequency, orbit.before_impact());
    [s.x1 * omega, s.v1, s.x2 * omega, s.v2].iter().fold(f64::MIN_POSITIVE, |most, v| most.max(v.abs()))
}

/// Largest [`distance`] from its orbit at which the impact of a settled motion may lie; `fine` is the
/// relative deviation of its state once a cycle. Each of both masses deviates by this fraction of its
/// largest motion, and by about twice that at the impact: hence the factor 4. The impact is early or late by
/// the deviation over the approach speed, which shifts the phase, and the speeds by as much again.
fn reach(fine: f64, orbit: &Orbit) -> f64 {
    let moves = orbit.peak_to_peak[0].max(orbit.peak_to_peak[1]) * TAU * orbit.frequency;
    let size = moves.max(speed(orbit));
    4.0 * fine * (size / speed(orbit)) * (1.0 + size / orbit.approach_velocity)
}

#[cfg(test)]
mod tests;
