//! Answers from records: every number an [`Estimate`].

mod apex;
mod bisection;
pub mod coloured;
pub mod crossing;
pub mod drill;
pub mod excitation;
pub mod exposure;
mod folded;
pub mod impacts;
pub mod jump;
pub mod legacy;
mod limit;
mod line;
mod mean;
mod median;
pub mod modal;
mod noise;
pub mod peaks;
pub mod pulse;
pub mod residuals;
pub mod resonance;
pub mod response;
pub mod restitution;
pub mod sine;
mod sinusoids;
pub mod spectral;
#[cfg(test)]
pub(crate) mod synthetic;
pub mod tones;
pub mod waterfall;

pub use vibro_record::Estimate;
