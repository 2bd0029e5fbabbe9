//! Any motion of the rig with a contact that gives way.

use super::{Contact, Follow, Followed, Law};
use crate::{Excitation, Rig, State};
use vibro_record::Result;

/// A motion with a contact that gives way: where it is now, and what drives it on.
///
/// Flights and Kelvin–Voigt contacts are linear modes, exact to rounding; Hertz and Hunt–Crossley contacts are integrated to
/// a relative error of 1e-13 a step. The rig's restitution is not used: the contact's law makes the rebound. Mass 2 may be a
/// wall (m₂ infinite): the impact oscillator.
///
/// Pieces end with `Touch` where the surfaces meet, `Part` where the force comes to zero before the surfaces are back at
/// their rest (the damper holds them back), `Touch` again where it returns before that, and with `Impact` once they are
/// back: it tells the time, the phase and the approach speed of the beginning, and the whole impulse. Long stretches come in
/// several pieces that end with `Reached`.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliant {
    law: Law,
    follow: Follow,
}

impl Compliant {
    /// A motion that starts from `state` at time 0 and `phase` (rad) of the excitation's cycle. The masses may be pressed into
    /// each other.
    ///
    /// # Errors
    /// If a parameter is impossible, or the state or the phase is not finite.
    pub fn new(rig: &Rig, excitation: &Excitation, law: Law, state: State, phase: f64) -> Result<Compliant> {
        let follow = Follow::new(rig, excitation, Contact::Law(law), None, state, phase)?;
        Ok(Compliant { law, follow })
    }

    /// The law of the contact.
    pub fn law(&self) -> Law {
        self.law
    }
}

impl Followed for Compliant {
    fn follow(&self) -> &Follow {
        &self.follow
    }

    fn follow_mut(&mut self) -> &mut Follow {
        &mut self.follow
    }
}

#[cfg(test)]
mod tests;
