//! Answers from records: every number an [`Estimate`].

mod estimate;
pub mod excitation;
pub mod impacts;
pub mod legacy;
pub mod line;
pub mod noise;
pub mod peaks;
pub mod resonance;
pub mod response;
pub mod restitution;
pub mod waterfall;

pub use estimate::Estimate;
