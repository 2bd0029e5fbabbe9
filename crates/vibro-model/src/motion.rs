//! Common interface of all simulated motions, whatever their contact law: they proceed from event to event.

use super::excitation::Excitation;
use super::flow::State;
use super::impact::{Counts, Impact};
use super::law::Law;
use super::rig::Rig;
use vibro_record::Result;

/// The event that ends a piece of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The requested time is reached.
    Reached,
    /// An impact. A compliant contact reports it once, at its end, with the approach speed at its beginning.
    Impact(Impact),
    /// An impulse of the excitation.
    Kick,
    /// A step of the excitation's force.
    Switch,
    /// The masses begin to move together.
    Stick,
    /// The masses cease to move together.
    Release,
    /// A compliant contact begins, or its force returns.
    Touch,
    /// The force of a compliant contact has fallen to zero before the surfaces separate.
    Part,
}

/// The motion within a piece.
pub trait Path {
    /// State at `t` seconds from the piece's start, 0 ≤ `t` ≤ its duration.
    fn state(&self, t: f64) -> State;
}

/// A part of a motion without an event inside.
#[derive(Clone, Copy)]
pub struct Piece<'a> {
    /// Start time in s.
    pub start: f64,
    /// Duration in s, 0 or more.
    pub duration: f64,
    /// Its motion, from the state after the previous event to the state before the event at its end.
    pub path: &'a dyn Path,
    /// The event that ends it.
    pub event: Event,
}

/// A simulated motion that proceeds from event to event, whatever its contact law.
pub trait Motion {
    /// The rig that moves.
    fn rig(&self) -> &Rig;

    /// Time in s.
    fn time(&self) -> f64;

    /// Present state; if an event happens now, the state after it.
    fn state(&self) -> State;

    /// Phase in 0..2π of the excitation's cycle: a sine force is F₀ cos(phase), an impulse or the start of a
    /// pulse is at phase 0. Once it has been applied, the phase is above 0. So a motion started from this
    /// state and phase continues this one, with two exceptions: during a pulse in which the frequency was
    /// changed, and for several sines whose frequencies are not multiples of the first.
    fn phase(&self) -> f64;

    /// Frequency of the excitation in Hz.
    fn frequency(&self) -> f64;

    /// Changes the frequency (Hz) from now on; phase, state and time are continuous.
    ///
    /// # Errors
    /// If the excitation cannot have this frequency on this rig.
    fn set_frequency(&mut self, hz: f64) -> Result<()>;

    /// Changes to an excitation of another size or frequency, of the same kind; phases, state and time are
    /// continuous, and the present pulse keeps its width.
    ///
    /// # Errors
    /// If the excitation is of another kind, has another number of sines, or is impossible on this rig.
    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()>;

    /// Follows the motion to the time `until` (s) and calls `visit` with each piece in order, the last with
    /// [`Event::Reached`]. An impulse or a step of force at `until` itself belongs to the next call.
    ///
    /// # Errors
    /// If `until` is not finite or in the past, or the motion needs more events than can be computed in
    /// bounded time.
    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()>;

    /// Law of its contact; `None` for rigid impacts.
    fn law(&self) -> Option<Law> {
        None
    }

    /// Numbers of flights, grazing impacts and lasting contacts so far, where they are counted.
    fn counted(&self) -> Option<Counts> {
        None
    }
}

#[cfg(test)]
mod tests;
