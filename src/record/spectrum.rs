//! Lines over frequency.

use super::{Axis, Meta};
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

/// Windows by name; their samples and sums are in [`crate::signal::window`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Window {
    /// No window.
    #[serde(alias = "none", alias = "boxcar", alias = "uniform")]
    Rectangular,
    /// Raised cosine.
    #[serde(alias = "hanning")]
    Hann,
    /// 0.54 − 0.46 cos.
    Hamming,
    /// Three-term Blackman (exact coefficients 0.42, 0.5, 0.08).
    Blackman,
    /// Four-term Blackman–Harris, −92 dB.
    BlackmanHarris,
    /// Five-term flat top (ISO 18431-2, as in scipy's `flattop`).
    #[serde(alias = "flattop")]
    FlatTop,
}

impl Window {
    /// Name, as in JSON and in `campaign.toml`.
    pub fn name(self) -> &'static str {
        match self {
            Window::Rectangular => "rectangular",
            Window::Hann => "hann",
            Window::Hamming => "hamming",
            Window::Blackman => "blackman",
            Window::BlackmanHarris => "blackman-harris",
            Window::FlatTop => "flat-top",
        }
    }

    /// Every window.
    pub const ALL: [Window; 6] = [
        Window::Rectangular,
        Window::Hann,
        Window::Hamming,
        Window::Blackman,
        Window::BlackmanHarris,
        Window::FlatTop,
    ];

    /// The window with this name, in the spellings analysers use; case, blanks, `-` and `_` do not count.
    pub fn from_name(name: &str) -> Option<Window> {
        let key: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        Some(match key.as_str() {
            "none" | "rectangular" | "rect" | "boxcar" | "uniform" => Window::Rectangular,
            "hann" | "hanning" => Window::Hann,
            "hamming" => Window::Hamming,
            "blackman" => Window::Blackman,
            "blackmanharris" => Window::BlackmanHarris,
            "flattop" => Window::FlatTop,
            _ => return None,
        })
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
