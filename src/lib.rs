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
//! # Read a file
//! ```
//! use vibroimpact::read::Reader;
//! let text = (0..2048).map(|i| format!("{};{}\n", f64::from(i) / 1024.0, (0.5 * f64::from(i)).sin()));
//! let text = "t [s];v [mm/s]\n".to_owned() + &text.collect::<String>();
//! let recording = Reader::new().from_reader("laser.csv", text.as_bytes())?;
//! let velocity = recording.trace(Some("v"), None)?;
//! assert_eq!((velocity.rate(), velocity.meta.unit.symbol()), (Some(1024.0), "m/s"));
//! # Ok::<(), vibroimpact::Error>(())
//! ```
//! A path goes to `Reader::from_path`; what was assumed of a file is in `recording.all_findings()`.
//!
//! # A spectrum with its uncertainty
//! ```
//! use vibroimpact::measure::spectral::{SpectralOptions, spectral};
//! use vibroimpact::record::{Axis, Meta, Trace, Traces};
//! use vibroimpact::units::Unit;
//! let values = (0..2048).map(|i| 1e-3 * (0.5 * f64::from(i)).sin()).collect();
//! let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
//! let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / 1024.0, 2048), values };
//! let options = SpectralOptions { tones: Some(1), ..SpectralOptions::default() };
//! let found = spectral(&mut Traces::from_memory(vec![trace])?, &options, |_| ())?;
//! let tone = &found.tones[0];
//! assert!((tone.frequency.value - 0.5 * 1024.0 / std::f64::consts::TAU).abs() < 1e-6); // Hz
//! println!("{} of {}", tone.amplitude, tone.frequency); // with standard uncertainty and unit
//! # Ok::<(), vibroimpact::Error>(())
//! ```
//!
//! # Orbits of a rig
//! ```
//! use vibroimpact::model::{Rig, orbits};
//! let found = orbits(&Rig::thesis(), 0.5, 11.0)?; // N, Hz
//! let real = |orbit: &&vibroimpact::model::Orbit| {
//!     orbit.validity.admissible && orbit.validity.stable == Some(true)
//! };
//! let orbit = found.orbits.iter().find(real).unwrap();
//! println!("impacts at {} m/s", orbit.approach_velocity);
//! # Ok::<(), vibroimpact::Error>(())
//! ```
//!
//! # Draw a figure
//! ```
//! use vibroimpact::figure::{AxisSpec, Figure, Plot, Series};
//! let (hertz, metres) = (vec![9.0, 10.0, 11.0], vec![1e-3, 14e-3, 2e-3]);
//! let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("amplitude", "m").log());
//! let figure = Figure::single("Response of mass 1").panel(plot.with(Series::line("up", hertz, metres)));
//! assert!(figure.draw().svg().starts_with("<svg"));
//! # Ok::<(), vibroimpact::Error>(())
//! ```
//!
//! # Answers of a campaign
//! The response of mass 1 in the example campaign, integrated from velocity to displacement:
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

// Only the command line uses the questions of models and the comparison of methods: without it, this code
// is
// unused.
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
