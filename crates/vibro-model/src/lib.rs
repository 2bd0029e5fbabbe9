//! Models that predict the motion of the two-mass rig.
//!
//! Two oscillators, each on its own spring and damper, face each other across a gap g = Δ + x₂ − x₁ ≥ 0; x₁
//! (excited) and x₂ (passive) are displacements from their own rest. Contact is instantaneous: with the
//! reduced mass M = m₁m₂/(m₁ + m₂) and the approach speed vᵣ = v₁ − v₂, an impact takes J = M(1 + R)vᵣ from
//! the momentum of mass 1 and gives it to mass 2.
//!
//! - [`orbits`]: every periodic motion with one impact a period in closed form, each with its verdicts;
//! - [`Simulation`]: any motion, event by event, on exact flights between guaranteed contacts;
//! - [`ladder`]: the simplest of these models that is good enough for a scene;
//! - [`drill`]: the impact unit of a hammer drill, a model of its own.
//!
//! ```
//! use vibro_model::{Rig, orbits};
//! let found = orbits(&Rig::thesis(), 0.5, 11.0)?;
//! let real = found.orbits.iter().filter(|o| o.validity.admissible && o.validity.stable == Some(true));
//! assert_eq!(real.count(), 1);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod body;
mod chirp;
pub mod contact;
pub mod continuation;
pub mod drill;
mod drive;
mod duffing;
mod excitation;
mod floquet;
mod flow;
mod forcing;
mod given;
mod green;
mod impact;
pub mod ladder;
mod law;
mod least;
mod linear;
pub mod map;
mod motion;
mod observable;
mod orbit;
mod parallel;
mod parameter;
mod periodic;
pub mod portrait;
mod reaction;
pub mod regime;
pub mod response;
mod rig;
mod scales;
mod scene;
pub mod simulate;
mod steady;
mod stick;
pub mod sweep;
mod uncertainty;
mod waves;

pub use chirp::Chirp;
pub use contact::Compliant;
pub use continuation::{Branch, follow};
pub use duffing::{CurveJump, CurvePoint, CurvedResponse, Duffing, ExactMotion};
pub use excitation::{Excitation, Impulses, Part, Pulses, Sine, Sines};
pub use flow::{Flight, State};
pub use green::Green;
pub use impact::{Counts, Impact};
pub use law::{FORMS, HertzRebound, Law, LawDamping, LawForm};
pub use motion::{Event, Motion, Path, Piece};
pub use observable::Observable;
pub use orbit::{
    Compliance, EnergyBalance, EnergyPoint, Loss, Orbit, Orbits, ShownOrbit, Softened, Validity, backbone,
    no_impact, orbits, orbits_of, shown, softened,
};
pub use parameter::Parameter;
pub use periodic::{Beat, PeriodicOrbit, search};
pub use reaction::{Reaction, Tally};
pub use regime::{Pattern, Regime, regime};
pub use response::{Change, ChangeKind, Response, ResponsePoint, response};
pub use rig::Rig;
pub use scene::{Buffer, ContactKeys, Draft, Scene, Springs};
pub use simulate::{Leg, Simulation};
pub use steady::{NoImpact, Steady};
pub use stick::Pair;
pub use uncertainty::Uncertainty;
