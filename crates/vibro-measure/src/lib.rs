//! Measures quantities in records; every result is an [`Estimate`].
//!
//! ```
//! use vibro_measure::restitution::{Measured, Train, restitution};
//! let bounces = Train { intervals: vec![0.300, 0.181, 0.109, 0.066], ..Train::default() };
//! let found = restitution(&Measured { trains: vec![bounces], ..Measured::default() })?;
//! assert!((found.restitution.value - 0.60).abs() < 0.01);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod answered;
pub mod chain;
pub mod chance;
mod clipping;
mod converter;
pub mod crossing;
pub mod decay;
pub mod drill;
pub mod excitation;
pub mod expected;
pub mod exposure;
pub mod impacts;
pub mod jump;
pub mod legacy;

mod line;
mod mains;
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
mod stands_out;
pub mod stepped;
mod swings;
#[cfg(test)]
#[path = "tests/synthetic.rs"]
pub(crate) mod synthetic;
pub mod tones;
pub mod waterfall;

pub use vibro_record::Estimate;
