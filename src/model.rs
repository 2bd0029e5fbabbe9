//! Models of the two-mass rig: what its motion should be.
//!
//! Two oscillators, each on its own spring and damper, face each other across a gap g = Δ + x₂ − x₁ ≥ 0; x₁ (excited)
//! and x₂ (passive) are displacements from their own rest. Contact is instantaneous: with the reduced mass
//! M = m₁m₂/(m₁ + m₂) and the approach speed vᵣ = v₁ − v₂, an impact takes J = M(1 + R)vᵣ from the momentum of mass 1
//! and gives it to mass 2.
//!
//! - [`orbits`]: every periodic motion with one impact a period in closed form, each with its verdicts;
//! - [`Simulation`]: any motion, event by event, on exact flights between guaranteed contacts.
//!
//! ```
//! use vibroimpact::model::{Rig, orbits};
//! let found = orbits(&Rig::thesis(), 0.5, 11.0)?;
//! let real = found.orbits.iter().filter(|o| o.validity.admissible && o.validity.stable == Some(true));
//! assert_eq!(real.count(), 1);
//! # Ok::<(), vibroimpact::Error>(())
//! ```

pub mod contact;
mod drive;
pub mod excitation;
pub mod floquet;
pub mod flow;
pub mod green;
pub mod linear;
pub mod loose;
pub mod motion;
pub mod orbit;
pub mod receptance;
pub mod rig;
pub mod simulate;
pub mod validity;

pub use contact::{Compliant, Law};
pub use excitation::{Excitation, Impulses, Part, Pulses, Sine, Sines};
pub use flow::{Flight, State};
pub use green::Green;
pub use loose::Loose;
pub use motion::{Event, Motion, Path, Piece};
pub use orbit::{Orbit, Orbits, orbits};
pub use receptance::{NoImpact, Steady};
pub use rig::Rig;
pub use simulate::{Impact, Leg, Simulation};
pub use validity::Validity;
