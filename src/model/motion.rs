//! What every simulated motion can do, whatever its contact law: go on from event to event.

use super::{Flight, Impact, Simulation, State};
use crate::error::Result;

/// What ended a piece of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The time asked for.
    Reached,
    /// An impact; with a compliant contact its end.
    Impact(Impact),
    /// An impulse of the excitation.
    Kick,
    /// The excitation's force stepped.
    Switch,
    /// The masses begin to move together.
    Stick,
    /// They cease to move together.
    Release,
    /// A compliant contact begins.
    Touch,
    /// A compliant contact ends.
    Part,
}

/// A stretch of a motion without an event inside.
pub struct Piece<'a> {
    /// Time in s of its start.
    pub start: f64,
    /// Duration in s.
    pub duration: f64,
    /// The motion in it.
    pub path: &'a dyn Path,
    /// What ended it.
    pub event: Event,
}

/// States along a piece.
pub trait Path {
    /// State `t` seconds after the start of the piece.
    fn state(&self, t: f64) -> State;
}

/// A motion that is followed from event to event.
pub trait Motion: Clone {
    /// Time in s.
    fn time(&self) -> f64;
    /// State now; after an impact, if one happens now.
    fn state(&self) -> State;
    /// Phase in 0..2π of the excitation's cycle (force F₀ cos θ for a sine).
    fn phase(&self) -> f64;
    /// Frequency of the excitation in Hz.
    fn frequency(&self) -> f64;
    /// Changes the frequency (Hz) from now on; phase, state and time go on without a step.
    ///
    /// # Errors
    /// If the frequency is impossible.
    fn set_frequency(&mut self, frequency: f64) -> Result<()>;
    /// Goes on until the time `until` (s) and shows each piece.
    ///
    /// # Errors
    /// If `until` is not finite or in the past.
    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()>;
}

impl Path for Flight {
    fn state(&self, t: f64) -> State {
        Flight::state(self, t)
    }
}

impl Motion for Simulation {
    fn time(&self) -> f64 {
        Simulation::time(self)
    }

    fn state(&self) -> State {
        Simulation::state(self)
    }

    fn phase(&self) -> f64 {
        Simulation::phase(self)
    }

    fn frequency(&self) -> f64 {
        self.sine().frequency
    }

    fn set_frequency(&mut self, frequency: f64) -> Result<()> {
        Simulation::set_frequency(self, frequency)
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        self.run(until, |leg| {
            visit(Piece {
                start: leg.start,
                duration: leg.duration,
                path: &leg.flight,
                event: leg.impact.map_or(Event::Reached, Event::Impact),
            });
        })
    }
}
