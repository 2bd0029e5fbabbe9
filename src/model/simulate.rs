//! Any motion of the rig, event by event: exact flights between guaranteed contacts.
//!
//! Nothing is integrated in steps. Each flight is a closed form; it ends at the first root of the gap; the impact
//! changes the velocities; the next flight starts from the state found there, so errors do not grow with a flight's
//! length. Where impacts accumulate, their end is computed ([`super::stick`]); from there both masses move together, again in
//! closed form, up to the first root of the force between them. The phase is kept within 2π and runs on when the frequency is
//! changed.

use super::drive::{Drive, Tick};
use super::stick::{Pair, Press};
use super::{Event, Excitation, Flight, Motion, Path, Piece, Rig, State};
use crate::error::{Error, Result};
use crate::math::Oscillator;
use serde::Serialize;

/// Approach speed in m/s below which an impact after which the masses part by themselves is counted as grazing, unless
/// [`Simulation::grazing_below`] says otherwise.
pub const GRAZING_SPEED: f64 = 1e-3;

/// Approach speed in m/s below which the end of a chatter is looked for; above it, impacts do not yet accumulate closely enough.
const SLOW: f64 = 1e-3;

/// The most cycles of the excitation, and pieces, that one call follows: some ten seconds of work.
const MOST_CYCLES: f64 = 2e7;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Impact {
    /// Time in s.
    pub time: f64,
    /// Phase in 0..2π of the excitation's cycle; a sine force is F₀ cos(phase).
    pub phase: f64,
    /// Approach speed v₁ − v₂ in m/s.
    pub approach_velocity: f64,
    /// Impulse in N s.
    pub impulse: f64,
}

/// How both masses move in a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course {
    /// Each on its own.
    Apart(Flight),
    /// In contact.
    Together(Pair),
}

impl Path for Course {
    fn state(&self, t: f64) -> State {
        match self {
            Course::Apart(flight) => flight.state(t),
            Course::Together(pair) => pair.state(t),
        }
    }
}

/// A stretch of a simulated motion and the event that ended it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Time in s of its start.
    pub start: f64,
    /// Duration in s.
    pub duration: f64,
    /// The motion.
    pub course: Course,
    /// What ended it.
    pub event: Event,
}

impl Leg {
    /// State at `t` seconds from the leg's start.
    pub fn state(&self, t: f64) -> State {
        self.course.state(t)
    }

    /// The impact at its end, if one ended it.
    pub fn impact(&self) -> Option<Impact> {
        match self.event {
            Event::Impact(impact) => Some(impact),
            _ => None,
        }
    }
}

/// What a motion has met so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Stretches of motion in closed form.
    pub flights: u64,
    /// Impacts, those below the end of a chatter left out.
    pub impacts: u64,
    /// Impacts below the grazing speed after which the masses part by themselves: a little more gap and there is none. What
    /// follows depends on them more than on anything else.
    pub grazing: u64,
    /// Times the masses came to rest against each other.
    pub sticks: u64,
}

/// Displacements, velocities and impacts over an interval of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorded {
    /// State at each sampling time; at an impact, the state after it.
    pub states: Vec<State>,
    /// Impacts in order.
    pub impacts: Vec<Impact>,
}

/// How the masses are to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Hold {
    Apart,
    /// They have just parted from rest against each other.
    Parting,
    /// A chatter that ends in so many seconds.
    Settling(f64),
    Together,
}

/// A simulated motion: where it is now, and what drives it on.
///
/// ```
/// use vibroimpact::model::{Rig, Simulation, Sine};
/// let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.5, frequency: 11.0 })?;
/// motion.run(20.0, |_| {})?;
/// let mut impacts = 0;
/// motion.run(21.0, |leg| impacts += usize::from(leg.impact().is_some()))?;
/// assert_eq!(impacts, 11);
/// # Ok::<(), vibroimpact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    rig: Rig,
    drive: Drive,
    oscillators: [Oscillator; 2],
    /// M(1 + R).
    exchange: f64,
    time: f64,
    /// What the rounding of `time` has left out, in s.
    carry: f64,
    state: State,
    hold: Hold,
    counts: Counts,
    grazing_speed: f64,
}

impl Simulation {
    /// Both masses at rest at time 0 and phase 0 of the excitation: the crest of a sine, the instant of an impulse, the beginning of a
    /// pulse. With a negative gap they rest pressed together, at x₁ = k₂Δ/(k₁ + k₂).
    ///
    /// # Errors
    /// If a parameter is impossible, there are more than four sines, or mass 1 is undamped and driven at resonance.
    pub fn new(rig: &Rig, excitation: impl Into<Excitation>) -> Result<Simulation> {
        let mut state = State::REST;
        if rig.gap < 0.0 {
            state.x1 = rig.k2 * rig.gap / (rig.k1 + rig.k2);
            state.x2 = state.x1 - rig.gap;
        }
        Simulation::from_state(rig, excitation, state, 0.0)
    }

    /// A motion that starts from `state` at time 0 and at `phase` (rad) of the excitation's cycle: a sine force is F₀ cos(ωt + phase),
    /// each of several sines has its own phase at phase 0, an impulse falls on phase 0 and a pulse begins there.
    ///
    /// # Errors
    /// As [`Simulation::new`], and if the state is not finite or the masses overlap in it.
    pub fn from_state(
        rig: &Rig,
        excitation: impl Into<Excitation>,
        state: State,
        phase: f64,
    ) -> Result<Simulation> {
        let State { x1, v1, x2, v2 } = state;
        if ![x1, v1, x2, v2, phase].iter().all(|v| v.is_finite()) {
            return Err(Error::usage(
                format!("initial state {x1}, {v1}, {x2}, {v2} with phase {phase}"),
                "finite values",
            ));
        }
        let drive = Drive::new(rig, &excitation.into(), phase)?;
        let overlap = x1 - x2 - rig.gap;
        // A state left behind by an impact overlaps by its rounding.
        let rounding = 4.0 * f64::EPSILON * (x1.abs() + x2.abs() + rig.gap.abs());
        if overlap > rounding {
            return Err(Error::usage(
                format!("the masses overlap by {overlap} m at the start"),
                "x1 − x2 of at most the gap; give an initial state in which they are apart",
            ));
        }
        let mut motion = Simulation {
            rig: *rig,
            drive,
            oscillators: rig.oscillators(),
            exchange: rig.reduced_mass() * (1.0 + rig.restitution),
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
        }
        Ok(motion)
    }

    /// Counts as grazing what approaches with less than `speed` (m/s) instead of [`GRAZING_SPEED`].
    pub fn grazing_below(mut self, speed: f64) -> Simulation {
        self.grazing_speed = speed;
        self
    }

    /// Time in s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// State now; after an impact, if one happens now.
    pub fn state(&self) -> State {
        self.state
    }

    /// Phase in 0..2π of the excitation's cycle now.
    pub fn phase(&self) -> f64 {
        self.drive.phase()
    }

    /// Frequency of the excitation in Hz; of several sines, the first one's.
    pub fn frequency(&self) -> f64 {
        self.drive.frequency()
    }

    /// The rig.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// What the motion has met so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Whether the masses are in contact now, at rest against each other.
    pub fn together(&self) -> bool {
        self.hold == Hold::Together
    }

    /// Changes the frequency (Hz) from now on; phase, state and time go on without a step, several sines keep the ratios of their
    /// frequencies, and a pulse under way keeps its width.
    ///
    /// # Errors
    /// If the frequency is impossible, pulses would not end within their cycle, or mass 1 is undamped and would be driven at
    /// resonance.
    pub fn set_frequency(&mut self, frequency: f64) -> Result<()> {
        self.drive.set_frequency(&self.rig, frequency)
    }

    /// Goes to the next event, or to the time `until` if that comes before. Does not allocate.
    ///
    /// # Errors
    /// If `until` is not finite or in the past, or the motion grows beyond all numbers.
    pub fn fly(&mut self, until: f64) -> Result<Leg> {
        if !(until.is_finite() && until >= self.time) {
            return Err(Error::usage(
                format!("a flight until {until} s from {} s", self.time),
                "a finite time that is not in the past",
            ));
        }
        let remaining = ((until - self.time) - self.carry).max(0.0);
        let (wait, tick) = self.drive.next();
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
                if !flight.is_open(duration) {
                    self.hold = Hold::Apart;
                }
                let event = landing.map(|_| self.collide()).transpose()?.map(Event::Impact);
                (Course::Apart(flight), duration, event)
            }
            Hold::Settling(left) => {
                let pair = self.pair()?;
                let duration = ahead.min(left);
                self.state = pair.state(duration);
                self.go(duration);
                let ends = left <= ahead;
                self.hold = if ends { Hold::Together } else { Hold::Settling(left - duration) };
                (Course::Together(pair), duration, ends.then_some(Event::Stick))
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
                (Course::Together(pair), duration, release.map(|_| Event::Release))
            }
        };
        let event = match (event, tick) {
            (Some(event), _) => event,
            (None, Some(tick)) if wait <= remaining => self.tick(tick)?,
            _ => {
                (self.time, self.carry) = (until, 0.0);
                Event::Reached
            }
        };
        let State { x1, v1, x2, v2 } = self.state;
        if !(x1 + v1 + x2 + v2).is_finite() {
            return Err(Error::refused(format!("at {} s the motion exceeds all numbers", self.time)));
        }
        Ok(Leg { start, duration, course, event })
    }

    /// Lets time and phase go on. Time is summed with what its rounding leaves out (W. Kahan, 1965).
    #[inline]
    fn go(&mut self, duration: f64) {
        let step = duration + self.carry;
        let time = self.time + step;
        self.carry = step - (time - self.time);
        self.time = time;
        self.drive.advance(duration);
    }

    /// Motion of masses that are apart, from now on.
    #[inline]
    fn flight(&self) -> Flight {
        let rest = self.drive.constant() / self.rig.k1;
        Flight::with(self.oscillators, self.drive.alone(), rest, self.rig.gap, &self.state)
    }

    /// Motion of both masses together from now on, with their common momentum.
    fn pair(&self) -> Result<Pair> {
        let (rig, state) = (&self.rig, &self.state);
        let v = (rig.m1 * state.v1 + rig.m2 * state.v2) / (rig.m1 + rig.m2);
        let pair = Pair::new(rig, self.drive.together(), self.drive.constant(), state.x1, v);
        if pair.is_finite() {
            return Ok(pair);
        }
        Err(Error::refused(format!(
            "at {} s the masses move together without a damper and are driven at their natural frequency",
            self.time
        ))
        .hint("give c1 or c2 a value above 0, or move the frequency"))
    }

    /// Exchanges momentum in the present state, which is at contact.
    #[inline]
    fn collide(&mut self) -> Result<Impact> {
        let approach = self.state.approach();
        let impulse = self.exchange * approach;
        self.state.v1 -= impulse / self.rig.m1;
        self.state.v2 += impulse / self.rig.m2;
        self.hold = Hold::Apart;
        self.counts.impacts += 1;
        if approach < SLOW.max(self.grazing_speed) || self.rig.restitution == 0.0 {
            self.settle(approach)?;
        }
        Ok(Impact { time: self.time, phase: self.drive.phase(), approach_velocity: approach, impulse })
    }

    /// Looks after an impact whether the masses come to rest against each other, at once or after a chatter.
    fn settle(&mut self, approach: f64) -> Result<()> {
        let press = Press::of(&self.flight());
        if press.acceleration <= 0.0 && approach < self.grazing_speed {
            self.counts.grazing += 1;
        }
        let separation = self.rig.restitution * approach;
        if separation == 0.0 || press.acceleration > 0.0 && press.is_rest(separation) {
            return self.rest();
        }
        if press.acceleration > 0.0
            && let Some(left) = press.accumulation(&self.rig, separation)
        {
            let pair = self.pair()?;
            // The masses must be pressed together all the time.
            if pair.force(0.0).value > 0.0 && pair.release(left).is_none() {
                self.state = pair.state(0.0);
                self.hold = Hold::Settling(left);
                self.counts.sticks += 1;
            }
        }
        Ok(())
    }

    /// Decides, for masses at contact without relative motion, whether they stay together.
    fn rest(&mut self) -> Result<()> {
        let pair = self.pair()?;
        let (force, noise) = (pair.force(0.0), pair.noise());
        self.state = pair.state(0.0);
        if force.value > noise || force.value >= -noise && force.slope > 0.0 {
            self.hold = Hold::Settling(0.0);
            self.counts.sticks += 1;
        } else {
            self.hold = Hold::Parting;
        }
        Ok(())
    }

    /// Does what the excitation does now.
    fn tick(&mut self, tick: Tick) -> Result<Event> {
        self.drive.tick(tick);
        if let Tick::Kick(impulse) = tick {
            self.state.v1 += impulse / self.rig.m1;
            if impulse != 0.0 {
                self.hold = Hold::Apart;
            }
            return Ok(Event::Kick);
        }
        if self.hold == Hold::Parting {
            // The new force may press again what has only begun to part.
            let flight = self.flight();
            if flight.gap(0.0) > 16.0 * flight.noise() {
                self.hold = Hold::Apart;
            } else {
                self.rest()?;
            }
        }
        Ok(Event::Switch)
    }

    /// Follows the motion to the time `until`, showing each leg, the last with [`Event::Reached`].
    ///
    /// # Errors
    /// As [`Simulation::fly`]; if more than 20 million cycles are asked for, or as many legs are needed.
    pub fn run(&mut self, until: f64, mut visit: impl FnMut(&Leg)) -> Result<()> {
        let cycles = (until - self.time) * self.frequency();
        if cycles > MOST_CYCLES {
            return Err(Error::usage(
                format!("{cycles:.0} cycles of the excitation"),
                format!("at most {MOST_CYCLES:.0} at a time: a motion that has not settled by then will not"),
            ));
        }
        let mut legs = 0.0;
        loop {
            let leg = self.fly(until)?;
            visit(&leg);
            if leg.event == Event::Reached {
                return Ok(());
            }
            legs += 1.0;
            if legs > MOST_CYCLES {
                return Err(Error::refused(format!(
                    "more than {MOST_CYCLES:.0} impacts and other events before {} s of {until} s",
                    self.time
                ))
                .hint("ask for less time, or give the impacts some loss: restitution below 1"));
            }
        }
    }

    /// Goes on for `n` intervals of `interval` seconds and takes the state at the start of each.
    ///
    /// # Errors
    /// As [`Simulation::run`], and if there is no memory for so many.
    pub fn record(&mut self, interval: f64, n: usize) -> Result<Recorded> {
        let start = self.time;
        let mut recorded = Recorded::default();
        if recorded.states.try_reserve_exact(n).is_err() {
            return Err(Error::usage(format!("{n} samples"), "as many as the memory holds"));
        }
        self.run(start + n as f64 * interval, |leg| {
            let end = leg.start + leg.duration;
            while recorded.states.len() < n {
                let time = start + recorded.states.len() as f64 * interval;
                // A sample at the very end belongs to what follows: to the state after the impact.
                if time >= end {
                    break;
                }
                recorded.states.push(leg.state((time - leg.start).max(0.0)));
            }
            recorded.impacts.extend(leg.impact());
        })?;
        Ok(recorded)
    }
}

impl Motion for Simulation {
    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        self.state
    }

    fn phase(&self) -> f64 {
        self.drive.phase()
    }

    fn frequency(&self) -> f64 {
        self.drive.frequency()
    }

    fn set_frequency(&mut self, hz: f64) -> Result<()> {
        Simulation::set_frequency(self, hz)
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        self.run(until, |leg| {
            visit(Piece { start: leg.start, duration: leg.duration, path: &leg.course, event: leg.event });
        })
    }
}

#[cfg(test)]
mod tests;
