//! Measurements of impacting machines: from instrument files to answers, each with its uncertainty.
//!
//! # Flow
//! Data flows one way: [`read`] → [`signal`] → [`measure`] → [`model`] →
//! [`campaign`] → [`compare`] → [`report`]; [`mod@write`] turns records into files again.
//! [`record`], [`units`], [`error`] and [`math`] lie below all of them.
//!
//! # Units and scaling
//! SI throughout: m, m/s, m/s², N, kg, s; frequencies in Hz unless a name says ω (rad/s). Spectra are one-sided, and
//! every [`record::Spectrum`] names its [`record::Scaling`].
//!
//! # Example
//! The response of mass 1 in the example campaign, taken from velocity to displacement:
//! ```
//! use vibroimpact::campaign::Campaign;
//! use vibroimpact::measure::response::{ResponseOptions, response};
//! let campaign = Campaign::from_path("examples/two_mass_rig/campaign.toml")?;
//! let (list, reader) = campaign.sweep(Some("mass 1, up"), false)?;
//! let found = response(&reader.read(&list)?, &ResponseOptions { integrate: 1, ..Default::default() })?;
//! let largest = found.points.iter().map(|p| &p.amplitude).max_by(|a, b| a.value.total_cmp(&b.value)).unwrap();
//! assert!((largest.value - 14.19e-3).abs() < 0.02e-3); // m
//! assert!(largest.std.unwrap() < 1e-6);
//! # Ok::<(), vibroimpact::Error>(())
//! ```

pub mod campaign;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod error;
pub mod math;
pub mod measure;
pub mod model;
pub mod read;
pub mod record;
pub mod report;
pub mod signal;
pub mod units;
pub mod write;

pub use error::{Error, Result};
