//! Measurements of impacting machines: from instrument files to answers, each with its uncertainty.
//!
//! # Flow
//! Data flows one way: [`read`] → [`signal`] → [`measure`] → [`model`] → [`compare`] → [`analysis`];
//! [`mod@write`] turns records into files again. An analysis takes its keys from a [`campaign`] or a command
//! line, and shows what it found by [`report`]. [`record`], [`units`], [`error`] and [`math`] lie below all
//! of them.
//!
//! # Units and scaling
//! SI throughout: m, m/s, m/s², N, kg, s; frequencies in Hz unless a name says ω (rad/s). Spectra are
//! one-sided, and every [`record::Spectrum`] names its [`record::Scaling`].
//!
//! # Example
//! The response of mass 1 in the example campaign, taken from velocity to displacement:
//! ```
//! use vibroimpact::analysis::{named, open};
//! use vibroimpact::measure::response::ResponseOptions;
//! let campaign = open("examples/two_mass_rig/campaign.toml")?;
//! let (_, found) = named(&campaign, Some("mass 1, up"))?.sweep_and_response(&ResponseOptions::default())?;
//! let amplitudes = found.points.iter().map(|p| &p.amplitude);
//! let largest = amplitudes.max_by(|a, b| a.value.total_cmp(&b.value)).unwrap();
//! assert!((largest.value - 14.19e-3).abs() < 0.02e-3); // m
//! assert!(largest.std.unwrap() < 1e-6);
//! # Ok::<(), vibroimpact::Error>(())
//! ```

// Questions to models and the comparison of methods are asked by the command alone.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

pub mod analysis;
pub mod campaign;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod proposal;
pub mod report;

pub use vibro_figure as figure;
pub use vibro_io as read;
pub use vibro_io::write;
pub use vibro_math as math;
pub use vibro_measure as measure;
pub use vibro_model as model;
pub use vibro_precision as precision;
pub use vibro_record as record;
pub use vibro_record::units;
pub use vibro_record::{Error, Result};
pub use vibro_signal as signal;
/// Errors that say where, what was found, what was expected and what to try.
pub mod error {
    pub use vibro_record::{Error, Hint, Place, Result};
}
