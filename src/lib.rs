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
