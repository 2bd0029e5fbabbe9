//! Compliant contact: its laws, the restitution they give, and the motion of the rig with them.
//!
//! With the indentation δ = x₁ − x₂ − Δ > 0 the masses push each other apart with a force F that never pulls:
//! - Kelvin–Voigt: F = k₃δ + c₃δ̇, cut at 0: during contact the rig is another linear system, solved
//!   exactly;
//! - Hertz: F = kδ^{3/2}; Hunt–Crossley: F = kδⁿ(1 + αδ̇), cut at 0: integrated during the contact.
//!
//! ```
//! use vibro_model::{Compliant, Excitation, Law, Motion, Event, Rig, Sine, State};
//! let rig = Rig::thesis();
//! let sine = Excitation::Sine(Sine { force: 0.5, frequency: 11.0 });
//! let law = Law::kelvin_voigt(1e5, rig.restitution, rig.reduced_mass())?;
//! let mut motion = Compliant::new(&rig, &sine, law, State::REST, 0.0)?;
//! let mut impacts = 0;
//! motion.advance(1.0, &mut |piece| impacts += usize::from(matches!(piece.event, Event::Impact(_))))?;
//! assert!(impacts > 8);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod change;
mod compliant;
mod modes;
mod still;
mod within;

pub use crate::law::{Law, conversion};
pub use compliant::Compliant;
