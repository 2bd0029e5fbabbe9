//! The motions of a rig at one excitation, as far as they are known, and the one that it is in.

use super::question::{APART, Answer, Question};
use super::reading::{MotionReader, Reading, Settling};
use super::rung::Model;
use super::stage::{DrivenScene, timed};
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

/// Cycles up to which motions with one impact are looked for in closed form.
pub(crate) const MOST_CYCLES: u32 = 6;
/// Cycles after which no further state is started from.
const MOST_FOLLOWED: u32 = 40_000;
/// Part of the speeds by which a motion starts beside an orbit.
const BESIDE: f64 = 0.02;

/// A motion that the rig can be in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownMotion {
    /// Its pattern; in JSON `no impact`, impacts/cycles, `chatter` or `irregular`.
    #[serde(serialize_with = "as_text")]
    pub pattern: Regime,
    /// The model by which it is known.
    pub model: Model,
    /// What is shown of it.
    pub answer: [f64; 2],
    /// Standard error of that, where it is a mean over a motion that does not repeat; else 0.
    pub spread: [f64; 2],
    /// Whether it lasts. One that does not is listed where it divides the motion without impacts from others
    /// with impacts round it.
    pub stable: bool,
    /// Whether it strikes less than once a cycle, and was found beside the motion to which the rig comes
    /// from rest, or the way it came, and to which no contact that gives way comes from rest. It is
    /// warned of, and asks for no history.
    pub rare: bool,
}

fn as_text<S: serde::Serializer>(pattern: &Regime, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_str(pattern)
}

impl KnownMotion {
    /// A motion that was followed, and lasts.
    fn followed(reading: &Reading, model: Model, rare: bool) -> KnownMotion {
        let Answer { value, spread, .. } = reading.answer;
        KnownMotion { pattern: reading.regime, model, answer: value, spread, stable: true, rare }
    }

    /// Whether it may be the motion that was read: both without impacts, or their answers no farther apart
    /// than is allowed.
    fn may_be(&self, reading: &Reading, question: &Question) -> bool {
        let still = reading.regime == Regime::NoImpact && self.pattern == Regime::NoImpact;
        let own = Answer { spread: self.spread, ..Answer::exact(self.answer) };
        still || own.agrees(&reading.answer, question, APART)
    }
}

/// The motion that the rig is in.
#[derive(Debug, Clone, PartialEq)]
pub enum CurrentMotion {
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
    /// Time in ns that that took.
    pub closed_cost: f64,
    /// In closed form with one impact in 2 to [`MOST_CYCLES`] cycles: those whose masses do not pass through
    /// each other.
    longer: Vec<Orbit>,
    pub known: Vec<KnownMotion>,
    pub on: CurrentMotion,
    /// How far mass 1 alone stays clear of mass 2, in m; `None` without a closed form.
    pub clearance: Option<f64>,
    /// The way the rig came there, where that is known.
    pub way: Option<Approach>,
    /// States that other motions were looked for from; `None` where none was looked for.
    pub followed: Option<Followed>,
    /// The motion followed with impacts at once, from rest or the way it came.
    pub reading: Reading,
    /// Time in ns that that took.
    pub cost: f64,
    /// Where it ended.
    pub end: Simulation,
}

impl Motions {
    /// Looks for them: in closed form, and by following the rig the way it came, or from rest and other
    /// states.
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

    /// Looks for a second motion from other states: near orbits that have lost their stability, and those of
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
            // Some states lead beyond what can be followed.
            let Ok(reading) = started.and_then(|mut motion| reader.read(&mut motion)) else { continue };
            (followed, cycles) = (followed + 1, cycles + reading.cycles);
            self.add(&reading, stage.question);
        }
        self.followed = Some(Followed { states: followed, of });
    }

    /// Whether a contact that gives way leads from `rest` to another motion than the one that its `answer` is
    /// read from.
    pub fn differs(&mut self, answer: &Answer, rest: &Reading, model: Model, question: &Question) {
        if rest.end == Settling::Under || !answer.steady || answer.agrees(&rest.answer, question, APART) {
            return;
        }
        self.on = CurrentMotion::Open;
        let found = KnownMotion::followed(rest, model, false);
        let same = |known: &&mut KnownMotion| known.pattern == found.pattern && known.may_be(rest, question);
        match self.known.iter_mut().find(same) {
            // From rest it is come to, if not with impacts at once.
            Some(known) => known.rare = false,
            None => self.known.push(found),
        }
    }

    /// Adds a motion with impacts at once, where that is not on its way and answers differently from those
    /// known.
    fn add(&mut self, reading: &Reading, question: &Question) {
        let settled = |reading: &Reading| reading.end != Settling::Under;
        let own = settled(&self.reading) && self.reading.answer.agrees(&reading.answer, question, APART);
        if settled(reading) && !own && !self.known.iter().any(|known| known.may_be(reading, question)) {
            let rare = matches!(reading.regime, Regime::Periodic { impacts, cycles } if impacts < cycles);
            self.known.push(KnownMotion::followed(reading, Model::Restitution, rare));
        }
    }

    /// Orbits with one impact a cycle that can be and stay.
    fn stable(&self) -> impl Iterator<Item = &Orbit> {
        self.closed.iter().flat_map(|found| &found.orbits).filter(|orbit| orbit.validity.real())
    }

    /// The orbit that the motion which was followed is on; `fine` is the part of its states to which it has
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

    /// Lists the motions known, and which of them was followed.
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
        // Where nothing else is known with impacts, orbits that have lost their stability tell of others
        // round them.
        if let Some(found) = found.filter(|found| common(&known) == 1 && several(found)) {
            known.extend(found.orbits.iter().filter(|o| o.validity.admissible).map(known_as));
        }
        (self.known, self.on) = (known, on);
    }

    /// The speed in m/s at which the masses meet.
    pub fn speed(&self) -> std::result::Result<f64, Finding> {
        let speed = self.reading.speed;
        if speed > 0.0 { Ok(speed) } else { Err(Finding::note("impacts-missing")) }
    }

    /// The orbit to speak of: the one the rig is in, else the first that can be and stay, else the first that
    /// exists.
    pub fn orbit(&self) -> std::result::Result<Option<&Orbit>, &Error> {
        if let CurrentMotion::Orbit(orbit) = &self.on {
            return Ok(Some(orbit));
        }
        let existing = self.closed.as_ref()?.orbits.iter().find(|o| o.validity.exists);
        Ok(self.stable().next().or(existing))
    }
}

/// Motions between which only the history decides.
fn common(known: &[KnownMotion]) -> usize {
    known.iter().filter(|m| !m.rare).count()
}

/// The state after the impact of an orbit, with speeds that are a little less.
fn beside(orbit: &Orbit) -> State {
    let state = orbit.state(0.0);
    State { v1: (1.0 - BESIDE) * state.v1, v2: (1.0 - BESIDE) * state.v2, ..state }
}

/// The same motion at the next phase 0 of the excitation, where cycles that are read begin.
fn at_phase_0(mut motion: Simulation) -> Result<Simulation> {
    let left = (-motion.phase()).rem_euclid(TAU) / (TAU * motion.frequency());
    motion.advance(motion.time() + left, &mut |_| {})?;
    Ok(motion)
}

/// Distance of an impact to that of an orbit: of phases in rad, and of states in units of the largest.
fn distance(strike: &Strike, orbit: &Orbit) -> f64 {
    let omega = TAU * orbit.frequency;
    let (a, b) = (&strike.before, &orbit.before_impact());
    let turn = (strike.phase - orbit.force_phase + PI).rem_euclid(TAU) - PI;
    let moved = [(a.x1 - b.x1) * omega, a.v1 - b.v1, (a.x2 - b.x2) * omega, a.v2 - b.v2];
    moved.iter().fold(turn.abs(), |far, d| far.max(d.abs() / speed(orbit)))
}

/// The largest of the speeds and ω × displacements at the impact, in m/s.
fn speed(orbit: &Orbit) -> f64 {
    let (omega, s) = (TAU * orbit.frequency, orbit.before_impact());
    [s.x1 * omega, s.v1, s.x2 * omega, s.v2].iter().fold(f64::MIN_POSITIVE, |most, v| most.max(v.abs()))
}

/// How far from its orbit the impact of a motion may be whose state is off by the part `fine` once a cycle.
/// Both masses are off, by that of what each moves at most: some twice what they do at the impact. They meet
/// earlier or later by the distance over the approach speed, which turns the phase, and the speeds by as much
/// again.
fn reach(fine: f64, orbit: &Orbit) -> f64 {
    let moves = orbit.peak_to_peak[0].max(orbit.peak_to_peak[1]) * TAU * orbit.frequency;
    let size = moves.max(speed(orbit));
    4.0 * fine * (size / speed(orbit)) * (1.0 + size / orbit.approach_velocity)
}

#[cfg(test)]
mod tests;
