//! What all simulated motions have in common, whatever their contact law: they go from event to event.

use super::excitation::Excitation;
use super::flow::State;
use super::impact::{Counts, Impact};
use super::law::Law;
use super::rig::Rig;
use vibro_record::Result;

/// What ended a piece of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The time asked for.
    Reached,
    /// The masses have met. A compliant contact reports it once, at its end, with the approach speed at its
    /// beginning.
    Impact(Impact),
    /// An impulse of the excitation.
    Kick,
    /// The force of the excitation stepped.
    Switch,
    /// The masses begin to move together.
    Stick,
    /// The masses cease to move together.
    Release,
    /// A compliant contact begins.
    Touch,
    /// A compliant contact ends.
    Part,
}

/// The motion within a piece.
pub trait Path {
    /// State at `t` seconds from the piece's start, 0 ≤ `t` ≤ its duration.
    fn state(&self, t: f64) -> State;
}

/// A stretch of motion without an event inside.
#[derive(Clone, Copy)]
pub struct Piece<'a> {
    /// Time in s of its start.
    pub start: f64,
    /// Duration in s, 0 or more.
    pub duration: f64,
    /// Its motion, from the state after the event before to the state before the event at its end.
    pub path: &'a dyn Path,
    /// What ended it.
    pub event: Event,
}

/// A motion that is followed from event to event, whatever its contact law.
pub trait Motion {
    /// The rig that moves.
    fn rig(&self) -> &Rig;

    /// Time in s.
    fn time(&self) -> f64;

    /// State now; after an event, if one happens now.
    fn state(&self) -> State;

    /// Phase in 0..2π of the excitation's cycle: a sine force is F₀ cos(phase), an impulse falls on phase 0
    /// and a pulse begins there. Once they have come it is above 0, so that a motion that starts from
    /// this state and phase goes on as this one: but for a pulse under way at a frequency that was
    /// changed within it, and for several sines whose frequencies are no multiples of the first.
    fn phase(&self) -> f64;

    /// Frequency of the excitation in Hz.
    fn frequency(&self) -> f64;

    /// Changes the frequency (Hz) from now on; phase, state and time go on without a step.
    ///
    /// # Errors
    /// If the excitation cannot have this frequency on this rig.
    fn set_frequency(&mut self, hz: f64) -> Result<()>;

    /// Goes on under an excitation of another size or frequency and of the same kind; phases, state and time
    /// go on without a step, and a pulse under way keeps its width.
    ///
    /// # Errors
    /// If the excitation is of another kind, has another number of sines, or is impossible on this rig.
    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()>;

    /// Follows the motion to the time `until` (s) and shows each piece in order, the last with
    /// [`Event::Reached`]. An impulse or a step of force at `until` itself is left to what follows.
    ///
    /// # Errors
    /// If `until` is not finite or in the past, or the motion needs more events than can be computed in
    /// bounded time.
    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()>;

    /// Law of its contact; `None` where impacts take no time.
    fn law(&self) -> Option<Law> {
        None
    }

    /// What it has met so far, where that is counted.
    fn counted(&self) -> Option<Counts> {
        None
    }
}

#[cfg(test)]
mod tests;
