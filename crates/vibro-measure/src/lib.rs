//! Answers from records: every number an [`Estimate`].

pub mod crossing;
pub mod drill;
pub mod excitation;
pub mod exposure;
pub mod impacts;
pub mod jump;
pub mod legacy;

mod line;
mod mean;
pub mod modal;
mod noise;
pub mod peaks;
pub mod pulse;
pub mod residuals;
pub mod resonance;
pub mod response;
pub mod restitution;
pub mod spectral;
#[cfg(test)]
#[path = "tests/synthetic.rs"]
pub(crate) mod synthetic;
pub mod tones;
pub mod waterfall;

pub use vibro_record::Estimate;
