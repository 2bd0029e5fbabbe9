//! What a simulated motion is told in: legs, the events that end them, and counts.

use crate::{Event, Flight, Pair, Path, State};
use serde::Serialize;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
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
    /// Impacts below the grazing speed after which the masses part by themselves: a little more gap and there is none. What
    /// follows depends on them more than on anything else.
    pub grazing: u64,
    /// Times the masses came to rest against each other.
    pub sticks: u64,
}
