//! Windows, filters, spectra, integration and frequency response functions.
//!
//! ```
//! use vibro_record::units::Unit;
//! use vibro_record::{Axis, Meta, Scaling, Trace, Traces, Window};
//! use vibro_signal::{segment::Segments, spectrum, welch::Welch};
//! let values = (0..4096).map(|i| 3.0 * (std::f64::consts::TAU * i as f64 / 16.0).cos()).collect();
//! let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
//! let trace = Trace { meta: meta.clone(), axis: Axis::time(0.0, 1.0 / 1024.0, 4096), values };
//! let welch = Welch { segments: Segments::new(1024, 0.5)?, window: Window::Hann, detrend: true };
//! let averages = welch.average(&mut Traces::from_memory(vec![trace])?, false, |_| ())?;
//! let lines = spectrum::averaged(&averages, 0, &meta, Window::Hann, Scaling::Peak)?;
//! assert!((lines.values.magnitude(64) - 3.0).abs() < 1e-9); // 64 Hz
//! # Ok::<(), vibro_record::Error>(())
//! ```

pub mod differentiate;
pub mod envelope;
pub mod fft;
pub mod filter;
pub mod impact;
pub mod integrate;
pub mod rails;
pub mod segment;
mod sound;
pub mod spectrum;
pub mod transfer;
pub mod welch;
pub mod window;
