//! Answers from records: every number an [`Estimate`].

mod estimate;
pub mod excitation;
pub mod legacy;
pub mod line;
pub mod modal;
pub mod noise;
pub mod peaks;
pub mod pulse;
pub mod residuals;
pub mod resonance;
pub mod response;
pub mod waterfall;

pub use estimate::Estimate;
