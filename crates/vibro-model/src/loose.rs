//! The loose mass: the spring of mass 1 is a buffer that only pushes, and only beyond a gap of its own.
//!
//! Behind mass 1, on the side away from mass 2, its spring begins `buffer_gap` away from its rest: the force on mass 1 is
//! −k₁(x₁ + b) for x₁ < −b and none elsewhere, where only its damper holds it. With the contact of the masses (at once, or by
//! a spring and a damper) the motion has four linear modes, each flown exactly ([`super::linear`]).

use super::contact::{Contact, Follow, Followed};
use super::{Excitation, Law, Rig, State};
use vibro_record::{Error, Result};

/// A motion with a loose mass 1: where it is now, and what drives it on.
///
/// Pieces end with `Switch` where the buffer begins and ceases to act, else as those of [`super::Compliant`]; with
/// rebounds at once, with `Impact`, with `Stick` where the masses have chattered to rest against each other and
/// with `Release` where they cease to move together.
///
/// ```
/// use vibro_model::{Event, Excitation, Loose, Motion, Rig, Sine, State};
/// let sine = Excitation::Sine(Sine { force: 0.1, frequency: 4.5 });
/// let mut motion = Loose::new(&Rig::thesis(), &sine, 0.0, State::REST, 0.0)?;
/// let mut switches = 0;
/// motion.advance(2.0, &mut |piece| switches += usize::from(piece.event == Event::Switch))?;
/// assert!(switches > 4);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Loose {
    follow: Follow,
}

impl Loose {
    /// A loose mass that rebounds with the rig's restitution, from `state` at time 0 and `phase` (rad) of the excitation's
    /// cycle; its spring acts beyond `buffer_gap` (m).
    ///
    /// # Errors
    /// If a parameter is impossible, the state or the phase is not finite, or the masses overlap.
    pub fn new(
        rig: &Rig,
        excitation: &Excitation,
        buffer_gap: f64,
        state: State,
        phase: f64,
    ) -> Result<Loose> {
        let follow = Follow::new(rig, excitation, Contact::Rebound, Some(buffer_gap), state, phase)?;
        Ok(Loose { follow })
    }

    /// A loose mass whose contact with mass 2 gives way by a spring and a damper.
    ///
    /// # Errors
    /// As [`Loose::new`], but the masses may overlap; and if the law is not that of Kelvin and Voigt.
    pub fn with_law(
        rig: &Rig,
        excitation: &Excitation,
        buffer_gap: f64,
        law: Law,
        state: State,
        phase: f64,
    ) -> Result<Loose> {
        if !matches!(law, Law::KelvinVoigt { .. }) {
            return Err(Error::usage(
                "a loose mass with a contact law that is not linear",
                "rebounds at once or a Kelvin–Voigt contact: the other laws are for masses on their springs",
            ));
        }
        let follow = Follow::new(rig, excitation, Contact::Law(law), Some(buffer_gap), state, phase)?;
        Ok(Loose { follow })
    }
}

impl Followed for Loose {
    fn follow(&self) -> &Follow {
        &self.follow
    }

    fn follow_mut(&mut self) -> &mut Follow {
        &mut self.follow
    }
}

#[cfg(test)]
mod tests;
