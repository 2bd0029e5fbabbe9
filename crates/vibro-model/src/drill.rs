//! Impact unit of a hammer drill: crank, piston, air cushion, striker, intermediate piston, bit, damper.
//!
//! The equations of motion, with positions towards the bit, `x_p` of the piston from the crank:
//! - cushion: `V = A(L₀ + x_s − x_p) + V_d` and ṗ = (n/V)(RT ṁ − pV̇), T the temperature of what flows: that
//!   of the cushion, pV/(mR), outwards and the ambient one inwards. Sealed, this is pVⁿ = const;
//! - flow ṁ by ISO 6358 through leakage and vents;
//! - striker: `m_s ẍ_s = (p − pₐ)A + m_s g cos β − F_c sign ẋ_s − c ẋ_s`. Where its velocity falls to zero
//!   the balance of forces decides whether it sticks;
//! - contacts by restitution or by a law of [`crate::contact`].
//!
//! Integrated by DOP853. The air flows, the seal slips, the contacts act by one smooth law each between two
//! events; an event is the first crossing of a linear function of the state in the step's polynomial, and
//! none is missed in that polynomial. Blow energies are those of the model; they are not those of EPTA.
//!
//! ```
//! use vibro_model::drill::{Course, Machine, Regime, Rung, run};
//! let slow = run(&Machine::example().at_speed(6.0), Rung::Friction, &Course::turns(20))?;
//! assert_eq!(slow.regime, Regime::NoBlow);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod chain;
mod check;
mod contact;
mod crank;
mod cushion;
mod draft;
mod flow;
mod machine;
mod motion;
mod plant;
mod run;
mod rungs;
mod turn;

pub use contact::Contact;
pub use crank::Crank;
pub use cushion::Cushion;
pub use draft::MachineDraft;
pub use flow::{Flow, GAS_CONSTANT, Vent};
pub use machine::{Bit, Interface, Intermediate, Machine, SOUND_SPEED, Striker};
pub use motion::Motion;
pub use run::{Course, Regime, Run, Start, WaveLimit, run};
pub use rungs::{Ladder, Rung, Step, climb};
pub use turn::{Blow, Book, Extremes, Impact, Sample, Turn};

#[cfg(test)]
mod reference_tests;
#[cfg(test)]
mod tests;
