//! Lines over frequency.

use super::{Axis, Meta, Window};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Real or complex line values.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Magnitudes, powers, densities or coherence.
    Real(Vec<f64>),
    /// Lines with phase.
    Complex(Vec<Complex64>),
}

impl Values {
    /// Number of lines.
    pub fn len(&self) -> usize {
        match self {
            Values::Real(v) => v.len(),
            Values::Complex(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Magnitude of line `i`.
    ///
    /// # Panics
    /// If `i` is not below [`Values::len`].
    pub fn magnitude(&self, i: usize) -> f64 {
        match self {
            Values::Real(v) => v[i].abs(),
            Values::Complex(v) => v[i].norm(),
        }
    }

    /// All magnitudes.
    pub fn magnitudes(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.magnitude(i)).collect()
    }
}

/// What a line's value means, for a one-sided spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scaling {
    /// Amplitude A of A cos ωt.
    Peak,
    /// A/√2.
    Rms,
    /// Square of the RMS amplitude.
    Power,
    /// Power per hertz.
    Psd,
    /// Power per hertz times record length.
    Energy,
    /// Coherence and other ratios between 0 and 1.
    Coherence,
    /// The file does not say.
    Unknown,
}

impl Scaling {
    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Scaling::Peak => "peak",
            Scaling::Rms => "rms",
            Scaling::Power => "power",
            Scaling::Psd => "psd",
            Scaling::Energy => "energy",
            Scaling::Coherence => "coherence",
            Scaling::Unknown => "unknown",
        }
    }
}

/// One-sided spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Frequency in Hz, or an index.
    pub axis: Axis,
    /// Line values in SI.
    pub values: Values,
    /// What they mean.
    pub scaling: Scaling,
    /// Window, where known.
    pub window: Option<Window>,
    /// Equivalent noise bandwidth in lines, where known.
    pub enbw: Option<f64>,
}
