//! Records: samples with their axis, quantity, unit and history.
//!
//! A record is a [`Trace`] (samples over time), a [`Spectrum`] (lines over frequency, with its scaling) or an
//! [`Frf`] (receptance, mobility or accelerance). Values are in SI units. Each record carries its [`Meta`]:
//! the channel, every step that made it, and findings about its values.
//!
//! ```
//! use vibro_record::units::Unit;
//! use vibro_record::{Axis, Estimate, Meta, Trace};
//! let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
//! let trace = Trace { meta, axis: Axis::time(0.0, 1e-3, 3), values: vec![0.0, 0.2, 0.1] };
//! assert_eq!((trace.rate(), trace.axis.at(2)), (Some(1000.0), 2e-3));
//! let frequency = Estimate::new(5.51446, Some(0.00045), "Hz", 8, "line fit of 8 periods");
//! assert_eq!(frequency.to_string(), "5.51446 ± 0.00045 Hz");
//! ```

mod axis;
mod clock;
pub mod code;
mod doubt;
mod error;
mod finding;
pub mod kind;
pub mod lanes;
mod meta;
mod near;
mod order;
mod resample;
mod shown;
mod spectrum;
mod sweep;
mod trace;
mod traces;
pub mod units;
mod window;
mod written;

use lanes::Extremes;
use num_complex::Complex64;

pub use axis::{Axis, AxisKind, Grid};
pub use clock::{Clock, RATE_OVER_BASE_BAND, Stretch, is_fine, stretches, uniform_std};
pub use doubt::{Doubt, Uncertain, doubt_with_record};
pub use error::{Error, Hint, Place, Result};
pub use finding::{Estimate, Fact, Finding, Severity};
pub use kind::{Kind, without_unit};
pub use meta::{ADDED_DECAY, AVERAGED_WITH, FROM_BLOWS, Meta, Step};
pub use near::{nearest, pattern};
pub use order::{median, quantile, sort_by_number, upper_median};
pub use resample::evened;
pub use shown::{is_unprintable, shown, typed};
pub use spectrum::{Frf, Scaling, Spectrum, Values};
pub use sweep::{Direction, StepTraces, Sweep, SweepPoint};
pub use trace::Trace;
pub use traces::{Stream, Traces, find_channel};
pub use window::Window;
pub use written::{Written, named};

/// A record of any type.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Record {
    /// Samples over time.
    Trace(Trace),
    /// Lines over frequency.
    Spectrum(Spectrum),
    /// Response over excitation.
    Frf(Frf),
}

impl Record {
    /// `trace`, `spectrum` or `frf`, as in JSON.
    pub fn kind(&self) -> &'static str {
        match self {
            Record::Trace(_) => "trace",
            Record::Spectrum(_) => "spectrum",
            Record::Frf(_) => "frf",
        }
    }

    /// Channel, unit, history.
    pub fn meta(&self) -> &Meta {
        match self {
            Record::Trace(r) => &r.meta,
            Record::Spectrum(r) => &r.meta,
            Record::Frf(r) => &r.meta,
        }
    }

    /// Channel, unit, history, to be changed.
    pub fn meta_mut(&mut self) -> &mut Meta {
        match self {
            Record::Trace(r) => &mut r.meta,
            Record::Spectrum(r) => &mut r.meta,
            Record::Frf(r) => &mut r.meta,
        }
    }

    /// The abscissa.
    pub fn axis(&self) -> &Axis {
        match self {
            Record::Trace(r) => &r.axis,
            Record::Spectrum(r) => &r.axis,
            Record::Frf(r) => &r.axis,
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.axis().len()
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the values are complex.
    pub fn is_complex(&self) -> bool {
        match self {
            Record::Trace(_) => false,
            Record::Spectrum(r) => matches!(r.values, Values::Complex(_)),
            Record::Frf(_) => true,
        }
    }

    /// Smallest and largest value; for complex values of their magnitudes.
    pub fn extremes(&self) -> Extremes {
        match self.numbers() {
            (real, []) => Extremes::of(real),
            (_, complex) => Extremes::of(&complex.iter().map(|v| v.norm()).collect::<Vec<f64>>()),
        }
    }

    /// Real and complex values: one of both is empty.
    pub fn numbers(&self) -> (&[f64], &[Complex64]) {
        match self {
            Record::Trace(Trace { values, .. })
            | Record::Spectrum(Spectrum { values: Values::Real(values), .. }) => (values, &[]),
            Record::Frf(Frf { values, .. })
            | Record::Spectrum(Spectrum { values: Values::Complex(values), .. }) => (&[], values),
        }
    }
}
