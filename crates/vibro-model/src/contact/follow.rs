//! Follows a rig from event to event through its linear modes, and through integrated contacts between them.

mod change;

use super::Law;
use super::modes::{Between, Modes};
use super::within::Within;
use crate::forcing::Forcing;
use crate::linear::{Course, Linear, Quantity};
use crate::motion::{Event, Motion, Path, Piece};
use crate::{Excitation, Rig, State, scales};
use vibro_record::{Error, Result};

/// Work of one call at most, a linear piece being 1 and an integrated one [`INTEGRATED`]: some minutes.
const MOST_WORK: f64 = 1e9;

/// Work of an integrated step.
const INTEGRATED: f64 = 10.0;

/// Events in a row without time passing after which a motion is given up.
const MOST_AT_ONCE: u32 = 1000;

/// Separation speed in m/s below which a rebound does not part masses that are pressed together.
const REST_SPEED: f64 = 1e-9;

/// How the masses meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Contact {
    /// At once, with the rig's restitution.
    Rebound,
    /// By a force.
    Law(Law),
}

/// Where a contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Apart.
    Apart,
    /// Pushing each other.
    Touching,
    /// The force has come to zero with the surfaces not yet back at their rest.
    Released,
    /// Moving together (without rebound).
    Together,
}

/// What a root of a watched quantity means.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mark {
    Meets,
    ForceEnds,
    ForceReturns,
    Separates,
    LetsGo,
    SpringActs,
    SpringFree,
}

/// The beginning of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Beginning {
    time: f64,
    phase: f64,
    approach: f64,
    impulse: f64,
}

/// A motion of a rig and where it is now.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Follow {
    rig: Rig,
    contact: Contact,
    loose: bool,
    modes: Modes,
    drive: Forcing,
    within: Within,
    time: f64,
    state: State,
    stage: Stage,
    spring_acts: bool,
    beginning: Beginning,
    /// Overlap in m, of the size of roundings, that is not yet a meeting: masses that leave each other from rest.
    slack: f64,
}

impl Follow {
    /// A motion from `state` at time 0, at `phase` of the excitation's cycle; the spring of mass 1 acts for x₁ < −`buffer`, or
    /// always.
    pub fn new(
        rig: &Rig,
        excitation: &Excitation,
        contact: Contact,
        buffer: Option<f64>,
        state: State,
        phase: f64,
    ) -> Result<Follow> {
        scales::check(rig, excitation)?;
        rig.check_wall(&state)?;
        let law = match contact {
            Contact::Rebound => None,
            Contact::Law(law) => law.check().map(|()| Some(law))?,
        };
        if let Some(gap) = buffer
            && !(gap.is_finite() && gap >= 0.0)
        {
            return Err(Error::usage(format!("buffer gap is {gap} m"), "a finite value of 0 or more"));
        }
        let State { x1, v1, x2, v2 } = state;
        if ![x1, v1, x2, v2, phase].iter().all(|v| v.is_finite()) {
            return Err(Error::usage(
                format!("initial state {x1}, {v1}, {x2}, {v2} with phase {phase}"),
                "finite values",
            ));
        }
        let modes = Modes::new(rig, law, buffer.unwrap_or(0.0));
        let drive = Forcing::new(excitation, phase)?;
        let mut motion = Follow {
            rig: *rig,
            contact,
            loose: buffer.is_some(),
            within: Within::new(rig, law, modes.reduced_mass),
            drive,
            time: 0.0,
            state,
            stage: Stage::Apart,
            spring_acts: buffer.is_none() || modes.compression.value(&state, 0.0) > 0.0,
            beginning: Beginning::default(),
            slack: 0.0,
            modes,
        };
        let overlap = motion.indentation();
        if overlap > 4.0 * f64::EPSILON * (x1.abs() + x2.abs() + rig.gap.abs()) {
            if law.is_none() {
                return Err(Error::usage(
                    format!("the masses overlap by {overlap} m at the start"),
                    "x1 − x2 of at most the gap; give an initial state in which they are apart",
                ));
            }
            motion.touch();
            motion.settle();
        }
        Ok(motion)
    }

    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        self.drive.set_excitation(excitation)?;
        self.settle();
        Ok(())
    }

    fn indentation(&self) -> f64 {
        self.modes.indentation.value(&self.state, 0.0)
    }

    /// Rounding of the indentation in m.
    fn rounding(&self) -> f64 {
        8.0 * f64::EPSILON * (self.state.x1.abs() + self.state.x2.abs() + self.rig.gap.abs())
    }

    fn mode(&self) -> &Linear {
        let between = match self.stage {
            Stage::Apart | Stage::Released => Between::Apart,
            Stage::Touching => Between::Pushing,
            Stage::Together => Between::Together,
        };
        self.modes.mode(between, self.spring_acts)
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        let span = until - self.time;
        if !(span.is_finite() && span >= 0.0) {
            return Err(Error::usage(
                format!("a motion until {until} s from {} s", self.time),
                "a finite time that is not in the past",
            ));
        }
        let rate = self.modes.mode(Between::Apart, true).rate().max(self.drive.fastest());
        let too_much = |from: f64, drive: &Forcing| {
            let (seconds, hz) = (until - from, drive.frequency());
            Error::refused(format!("{seconds} s of motion at {hz} Hz are more than one call computes"))
                .hint("ask for less time at once, or for a softer contact")
        };
        if span * rate.max(self.drive.frequency()) > MOST_WORK {
            return Err(too_much(self.time, &self.drive));
        }
        let (mut at_once, mut last, mut work) = (0, f64::NAN, 0.0);
        loop {
            work += if self.stage == Stage::Touching && self.within.integrates() { INTEGRATED } else { 1.0 };
            if work > MOST_WORK {
                return Err(too_much(self.time, &self.drive));
            }
            let reached = self.piece(until, visit)?;
            if reached {
                return Ok(());
            }
            at_once = if self.time == last { at_once + 1 } else { 0 };
            last = self.time;
            if at_once > MOST_AT_ONCE {
                return Err(Error::refused(format!(
                    "at {} s the motion changes its mode again and again without moving on",
                    self.time
                ))
                .hint("change the initial state or a parameter a little"));
            }
        }
    }

    /// Computes one piece; whether it reached `until`.
    fn piece(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<bool> {
        if self.stage == Stage::Touching && self.within.integrates() {
            return self.integrated(until, visit);
        }
        let remaining = until - self.time;
        let (jump, tick) = self.drive.next(remaining, until);
        let mode = self.mode();
        let longest = 1.0 / mode.rate().max(self.drive.fastest());
        let span = remaining.min(jump).min(longest);
        let force = self.drive.terms(span);
        let taylor = mode.fly(&self.state, &force, span);
        let mut first: Option<(f64, Mark)> = None;
        let mut watch = |course: &Course, mark: Mark| {
            if let Some(t) = course.first_fall()
                && first.is_none_or(|(earlier, _)| t < earlier)
            {
                first = Some((t, mark));
            }
        };
        let read = |quantity: &Quantity| taylor.read(quantity, &force);
        match self.stage {
            Stage::Apart => {
                let mut gap = self.modes.indentation.reversed();
                gap.offset += self.slack;
                watch(&read(&gap), Mark::Meets);
            }
            Stage::Touching => watch(&read(&self.modes.contact_force), Mark::ForceEnds),
            Stage::Released => {
                watch(&read(&self.modes.indentation), Mark::Separates);
                watch(&read(&self.modes.contact_force.reversed()), Mark::ForceReturns);
            }
            Stage::Together => watch(&read(&self.modes.pressing(self.spring_acts)), Mark::LetsGo),
        }
        if self.loose {
            if self.spring_acts {
                watch(&read(&self.modes.compression), Mark::SpringFree);
            } else {
                watch(&read(&self.modes.compression.reversed()), Mark::SpringActs);
            }
        }
        let start = self.time;
        let duration = first.map_or(span, |(t, _)| t);
        if self.stage == Stage::Touching {
            self.beginning.impulse += read(&self.modes.contact_force).integral(duration);
        }
        self.state = taylor.state(duration);
        self.drive.pass(duration);
        let whole = first.is_none() && span == remaining;
        self.time = if whole { until } else { start + duration };
        let event = match first {
            Some((_, mark)) => self.mark(mark),
            None => match tick.filter(|_| span == jump) {
                Some(tick) => self.tick(tick),
                None => Event::Reached,
            },
        };
        visit(Piece { start, duration, path: &taylor, event });
        if self.stage == Stage::Apart && matches!(event, Event::Impact(_)) {
            self.come_to_rest(visit);
        }
        Ok(whole && event == Event::Reached)
    }

    /// One step within a contact that is not linear.
    fn integrated(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<bool> {
        let remaining = until - self.time;
        let (jump, tick) = self.drive.next(remaining, until);
        let span = remaining.min(jump);
        let start = self.time;
        let mode = self.modes.mode(Between::Apart, self.spring_acts);
        let step = self.within.step(mode, &self.drive, &self.state, span)?;
        let fall = step.first_fall();
        let duration = fall.unwrap_or(step.duration());
        let ended = fall.is_none() && duration == span;
        self.beginning.impulse += step.impulse(duration);
        self.state = step.state(duration);
        self.drive.pass(duration);
        let whole = ended && span == remaining;
        self.time = if whole { until } else { start + duration };
        let event = if fall.is_some() {
            self.separate()
        } else if let Some(tick) = tick.filter(|_| ended && span == jump) {
            self.tick(tick)
        } else {
            Event::Reached
        };
        visit(Piece { start, duration, path: &step, event });
        Ok(whole && event == Event::Reached)
    }
}

/// A motion that consists of following a rig from event to event.
pub(crate) trait Followed: Clone {
    /// Where it is now.
    fn follow(&self) -> &Follow;

    /// Where it is now, to be driven on.
    fn follow_mut(&mut self) -> &mut Follow;
}

impl<T: Followed> Motion for T {
    fn rig(&self) -> &Rig {
        &self.follow().rig
    }

    fn time(&self) -> f64 {
        self.follow().time
    }

    fn state(&self) -> State {
        self.follow().state
    }

    fn phase(&self) -> f64 {
        self.follow().drive.phase()
    }

    fn frequency(&self) -> f64 {
        self.follow().drive.frequency()
    }

    fn set_frequency(&mut self, hz: f64) -> Result<()> {
        self.follow_mut().drive.set_frequency(hz)
    }

    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        self.follow_mut().set_excitation(excitation)
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        self.follow_mut().advance(until, visit)
    }
}

#[cfg(test)]
mod tests;
