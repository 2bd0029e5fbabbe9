//! Spectral lines over frequency: spectra, and frequency response functions.

use super::{Axis, Meta, Window};
use Scaling::{Coherence, Energy, Peak, Power, Psd, Rms, Unknown};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Real or complex values of spectral lines.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Values {
    /// Values without phase: magnitudes, powers, densities or coherence.
    Real(Vec<f64>),
    /// Values with phase.
    Complex(Vec<Complex64>),
}

impl Default for Values {
    /// No lines.
    fn default() -> Values {
        Values::Real(Vec::new())
    }
}

impl Values {
    /// Values from their real parts and, for complex ones, imaginary parts.
    pub fn of(real: Vec<f64>, imaginary: Option<Vec<f64>>) -> Values {
        let Some(imaginary) = imaginary else { return Values::Real(real) };
        let pairs = real.into_iter().zip(imaginary);
        Values::Complex(pairs.map(|(re, im)| Complex64::new(re, im)).collect())
    }

    /// Real values; `None` for complex ones.
    pub fn reals(&self) -> Option<&[f64]> {
        if let Values::Real(values) = self { Some(values) } else { None }
    }

    /// Number of lines.
    pub fn len(&self) -> usize {
        match self {
            Values::Real(v) => v.len(),
            Values::Complex(v) => v.len(),
        }
    }

    /// Whether there are no lines.
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

/// Meaning of a line's value in a one-sided spectrum.
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
    #[serde(skip_deserializing)]
    Energy,
    /// Coherence and other ratios between 0 and 1.
    #[serde(skip_deserializing)]
    Coherence,
    /// Unknown: the file does not state it.
    #[serde(skip_deserializing)]
    Unknown,
}

/// Names of the scalings, in the order of the variants.
const NAMES: [&str; 7] = ["peak", "rms", "power", "psd", "energy", "coherence", "unknown"];

impl Scaling {
    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    /// The scaling with this name.
    pub fn from_name(name: &str) -> Option<Scaling> {
        let all = [Peak, Rms, Power, Psd, Energy, Coherence, Unknown];
        all.into_iter().find(|scaling| scaling.name() == name)
    }
}

/// One-sided spectrum.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Spectrum {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Frequency in Hz; an index where the file states no frequencies.
    pub axis: Axis,
    /// Values of the lines in SI units.
    pub values: Values,
    /// Meaning of the values.
    pub scaling: Scaling,
    /// Window, where known.
    pub window: Option<Window>,
    /// Equivalent noise bandwidth in spectral lines, where known.
    pub enbw: Option<f64>,
}

/// Frequency response function, complex, over frequency in Hz.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Frf {
    /// Channel, unit, history.
    pub meta: Meta,
    /// Frequency in Hz.
    pub axis: Axis,
    /// Complex values in SI units.
    pub values: Vec<Complex64>,
}
