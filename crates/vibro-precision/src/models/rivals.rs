//! What else is done: integration in steps, by a loop, with events, with a stiff spring, by time stepping.
//!
//! Each is written as it usually is, and correctly.

#[cfg(feature = "diffsol")]
mod diffsol;
mod events;
mod loops;
mod moreau;
mod penalty;
mod stepper;

#[cfg(feature = "diffsol")]
pub use self::diffsol::{Diffsol, contacts, impacts};
pub use events::{Events, events};
pub use loops::Loop;
pub(crate) use loops::marched;
pub(crate) use moreau::moreau;
pub(crate) use penalty::sprung;
pub use penalty::{Spring, penalty};
pub use stepper::{Kind, Stepper, Taken};
