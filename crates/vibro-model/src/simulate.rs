//! Any motion of the rig, event by event: exact flights between guaranteed contacts.
//!
//! Nothing is integrated in steps. Each flight is a closed form and ends at the first root of the gap. The
//! impact changes the velocities, and the next flight starts from the state after it. So errors do not grow
//! with a flight's length. Where impacts accumulate (chatter), the time of their end is computed. From then
//! on both masses move together, again in closed form, up to the first root of the force between them. The
//! phase stays between 0 and 2π, and is continuous when the frequency changes.

mod meet;

use super::drive::Drive;
use super::excitation::Excitation;
use super::flow::{Flight, State};
use super::impact::{Counts, Impact};
use super::motion::{Event, Motion, Path, Piece};
use super::rig::Rig;
use super::scales::{self, MOST_EVENTS, check_time, check_work};
use super::stick::Pair;
use vibro_math::Oscillator;
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Approach speed in m/s below which an impact is counted as grazing, if the masses then part by themselves,
/// unless [`Simulation::grazing_below`] sets another.
pub const GRAZING_SPEED: f64 = 1e-3;

/// Most legs in one call of [`Simulation::run`]: about ten seconds of work.
const MOST_LEGS: f64 = 2e7;
/// The limit on the events of a call of [`Simulation::run`] allows for at least this many cycles: a short
/// call may begin with a long chatter.
const LEAST_BUDGET_CYCLES: f64 = 10.0;

/// Motion of both masses in a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LegMotion {
    /// Not in contact: each mass on its own spring and damper.
    Apart(Flight),
    /// In lasting contact.
    Together(Pair),
}

impl Path for LegMotion {
    fn state(&self, t: f64) -> State {
        match self {
            LegMotion::Apart(flight) => flight.state(t),
            LegMotion::Together(pair) => pair.state(t),
        }
    }
}

/// A part of a simulated motion between two events, and the event that ended it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Start time in s.
    pub start: f64,
    /// Duration in s.
    pub duration: f64,
    /// The motion.
    pub course: LegMotion,
    /// The event at the end of the leg.
    pub event: Event,
}

impl Leg {
    /// State at `t` seconds from the leg's start.
    pub fn state(&self, t: f64) -> State {
        self.course.state(t)
    }

    /// The impact that ended the leg, if one did.
    pub fn impact(&self) -> Option<Impact> {
        match self.event {
            Event::Impact(impact) => Some(impact),
            _ => None,
        }
    }
}

/// Contact state of the masses.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Hold {
    Apart,
    /// Just parted after resting against each other.
    Parting,
    /// In the last part of a chatter, which ends after this time in s. The masses already move together.
    Settling(f64),
    Together,
}

/// A simulated motion: its present state, excitation and contact state.
///
/// ```
/// use vibro_model::{Rig, Simulation, Sine};
/// let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.5, frequency: 11.0 })?;
/// motion.run(20.0, |_| {})?;
/// let mut impacts = 0;
/// motion.run(21.0, |leg| impacts += usize::from(leg.impact().is_some()))?;
/// assert_eq!(impacts, 11);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    rig: Rig,
    drive: Drive,
    oscillators: [Oscillator; 2],
    /// M(1 + R) in kg: the impulse of an impact divided by its approach speed.
    exchange: f64,
    time: f64,
    /// Rounding error of `time` in s (compensated summation).
    carry: f64,
    state: State,
    hold: Hold,
    counts: Counts,
    grazing_speed: f64,
}

impl Simulation {
    /// Both masses at rest at time 0 and phase 0 of the excitation: the crest of a sine, the instant of an
    /// impulse, the beginning of a pulse. With a negative gap they rest pressed together, at
    /// x₁ = k₂Δ/(k₁ + k₂), or at x₁ = Δ against a wall.
    ///
    /// # Errors
    /// If a parameter is impossible, there are more than four sines, or mass 1 is undamped and driven at
    /// resonance.
    pub fn new(rig: &Rig, excitation: &(impl Clone + Into<Excitation>)) -> Result<Simulation> {
        Simulation::from_state(rig, excitation, Simulation::at_rest(rig), 0.0)
    }

    /// Both masses at rest without a force: pressed together where the gap is negative.
    pub fn at_rest(rig: &Rig) -> State {
        if rig.gap >= 0.0 {
            return State::REST;
        }
        let Some(both) = rig.joined() else { return State { x1: rig.gap, ..State::REST } };
        let x1 = rig.bodies()[1].stiffness * rig.gap / both.stiffness;
        State { x1, x2: x1 - rig.gap, ..State::REST }
    }

    /// A motion that starts from `state` at time 0 and at `phase` (rad) of the excitation's cycle: a sine
    /// force is F₀ cos(ωt + phase), each of several sines has its own phase at phase 0, an impulse falls
    /// on phase 0 and a pulse begins there.
    ///
    /// # Errors
    /// As [`Simulation::new`], and if the state is not finite, the masses overlap in it or it moves a wall.
    pub fn from_state(
        rig: &Rig,
        excitation: &(impl Clone + Into<Excitation>),
        state: State,
        phase: f64,
    ) -> Result<Simulation> {
        rig.check()?;
        rig.check_start(&state, phase)?;
        let State { x1, v1, x2, v2 } = state;
        let drive = Drive::new(rig, &excitation.clone().into(), phase)?;
        let overlap = x1 - x2 - rig.gap;
        // After an impact the state may overlap by its rounding.
        let rounding = 4.0 * f64::EPSILON * (x1.abs() + x2.abs() + rig.gap.abs());
        if overlap > rounding {
            return Err(rig.overlap(&state));
        }
        let mut motion = Simulation {
            rig: *rig,
            drive,
            oscillators: rig.oscillators(),
            exchange: rig.exchange(),
            time: 0.0,
            carry: 0.0,
            state,
            hold: Hold::Apart,
            counts: Counts::default(),
            grazing_speed: GRAZING_SPEED,
        };
        if overlap >= -rounding && (v1 - v2).abs() <= 4.0 * f64::EPSILON * (v1.abs() + v2.abs()) {
            motion.rest()?;
            if motion.hold != Hold::Parting {
                motion.hold = Hold::Together;
            }
            motion.counts = Counts::default();
        }
        Ok(motion)
    }

    /// Counts impacts with less than `speed` (m/s) as grazing, instead of [`GRAZING_SPEED`].
    pub fn grazing_below(mut self, speed: f64) -> Simulation {
        self.grazing_speed = speed;
        self
    }

    /// Numbers of flights, grazing impacts and lasting contacts so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Follows the motion to the next event, or to the time `until` (s) if that is earlier; an impulse or a
    /// step of force at `until` itself belongs to the next call. Does not allocate.
    ///
    /// # Errors
    /// If `until` is not finite or in the past, or the motion exceeds the range of numbers.
    pub fn fly(&mut self, until: f64) -> Result<Leg> {
        check_time(self.time, until)?;
        let remaining = ((until - self.time) - self.carry).max(0.0);
        let (wait, tick) = self.drive.forcing.next(remaining, until);
        let ahead = remaining.min(wait);
        let start = self.time;
        self.counts.flights += 1;
        let (course, duration, event) = match self.hold {
            Hold::Apart | Hold::Parting => {
                let mut flight = self.flight();
                if self.hold == Hold::Parting {
                    flight = flight.parting();
                }
                let landing = flight.land(ahead);
                let duration = landing.map_or(ahead, |l| l.time);
                self.state = landing.map_or_else(|| flight.state(ahead), |l| l.state);
                self.go(duration);
                if duration >= flight.open {
                    self.hold = Hold::Apart;
                }
                let event = landing.map(|_| self.collide()).transpose()?.map(Event::Impact);
                (LegMotion::Apart(flight), duration, event)
            }
            Hold::Settling(left) => {
                let pair = self.pair()?;
                let duration = ahead.min(left);
                self.state = pair.state(duration);
                self.go(duration);
                let ends = left <= ahead;
                self.hold = if ends { Hold::Together } else { Hold::Settling(left - duration) };
                (LegMotion::Together(pair), duration, ends.then_some(Event::Stick))
            }
            Hold::Together => {
                let pair = self.pair()?;
                let release = pair.release(ahead);
                let duration = release.unwrap_or(ahead);
                self.state = pair.state(duration);
                self.go(duration);
                if release.is_some() {
                    self.hold = Hold::Parting;
                }
                (LegMotion::Together(pair), duration, release.map(|_| Event::Release))
            }
        };
        let event = match (event, tick) {
            (Some(event), _) => event,
            (None, Some(tick)) => self.tick(tick)?,
            _ => {
                (self.time, self.carry) = (until, 0.0);
                Event::Reached
            }
        };
        let State { x1, v1, x2, v2 } = self.state;
        if !(x1 + v1 + x2 + v2).is_finite() {
            return Err(Error::refused(format!(
                "at {} s the motion exceeds all numbers",
                significant(self.time, 6)
            )));
        }
        Ok(Leg { start, duration, course, event })
    }

    /// Advances time and phase. Time is a compensated sum (W. Kahan, 1965).
    #[inline]
    fn go(&mut self, duration: f64) {
        let step = duration + self.carry;
        let time = self.time + step;
        self.carry = step - (time - self.time);
        self.time = time;
        self.drive.forcing.pass(duration);
    }

    /// Flight of the separate masses from the present state.
    #[inline]
    fn flight(&self) -> Flight {
        let rest = self.drive.forcing.constant() / self.rig.bodies()[0].stiffness;
        Flight::with(self.oscillators, self.drive.alone(), rest, self.rig.gap, &self.state)
    }

    /// Motion of both masses together from the present state, with their common momentum.
    fn pair(&self) -> Result<Pair> {
        let (rig, state) = (&self.rig, &self.state);
        let v = rig.common_speed(state);
        let pair = Pair::new(rig, self.drive.together(), self.drive.forcing.constant(), state.x1, v);
        if pair.is_finite() {
            return Ok(pair);
        }
        Err(Error::refused(format!(
            "at {} s the masses move together without a damper and are driven at their natural frequency",
            self.time
        ))
        .hint("give c1 or c2 a value above 0, or move the frequency"))
    }

    /// Follows the motion to the time `until` (s), and calls `visit` with each leg; the last one ends with
    /// [`Event::Reached`].
    ///
    /// # Errors
    /// As [`Simulation::fly`]; if the call covers more than 1e8 cycles, or needs more than 20 million legs,
    /// or more than 10 000 legs a cycle (or a swing, where that is shorter).
    pub fn run(&mut self, until: f64, mut visit: impl FnMut(&Leg)) -> Result<()> {
        let cycles = (until - self.time) * self.frequency();
        check_work(cycles)?;
        let swings = self.rig.natural_frequencies().into_iter().fold(1.0, f64::max) / self.frequency();
        let most = (MOST_EVENTS * cycles.max(LEAST_BUDGET_CYCLES) * swings.max(1.0)).min(MOST_LEGS);
        for _ in 0..most as u64 {
            let leg = self.fly(until)?;
            visit(&leg);
            if leg.event == Event::Reached {
                return Ok(());
            }
        }
        Err(Error::refused(format!(
            "more than {most:.0} impacts and other events before {} s of {} s",
            significant(self.time, 6),
            significant(until, 6)
        ))
        .hint("ask for less time, or give the impacts some loss: restitution below 1"))
    }
}

impl Motion for Simulation {
    fn rig(&self) -> &Rig {
        &self.rig
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        self.state
    }

    fn phase(&self) -> f64 {
        self.drive.forcing.phase
    }

    fn frequency(&self) -> f64 {
        self.drive.forcing.frequency
    }

    fn set_frequency(&mut self, hz: f64) -> Result<()> {
        self.drive.change(&self.rig, |force| force.set_frequency(hz))
    }

    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        scales::check(&self.rig, excitation)?;
        self.drive.change(&self.rig, |force| force.set_excitation(excitation))?;
        self.look_again()
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        self.run(until, |leg| {
            visit(Piece { start: leg.start, duration: leg.duration, path: &leg.course, event: leg.event });
        })
    }

    fn counted(&self) -> Option<Counts> {
        Some(self.counts)
    }
}

#[cfg(test)]
mod tests;
