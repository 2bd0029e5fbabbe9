//! Spectral windows by name.
//!
//! Coefficients: F. J. Harris, "On the use of windows for harmonic analysis with the discrete Fourier
//! transform", Proc. IEEE 66 (1978), table I; flat top: the five-term window of ISO 18431-2, as in scipy's
//! `flattop`.

use Window::{Blackman, BlackmanHarris, FlatTop, Hamming, Hann, Rectangular};
use serde::{Deserialize, Serialize};

/// Windows by name; their samples and line shapes are in the crate `vibro-signal`.
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
    /// Three-term Blackman (coefficients 0.42, 0.5, 0.08).
    Blackman,
    /// Four-term Blackman–Harris, −92 dB.
    BlackmanHarris,
    /// Five-term flat top (ISO 18431-2, as in scipy's `flattop`).
    #[serde(alias = "flattop")]
    FlatTop,
}

/// Name and cosine coefficients of each window, in the order of the variants.
const TABLE: [(&str, &[f64]); 6] = [
    ("rectangular", &[1.0]),
    ("hann", &[0.5, 0.5]),
    ("hamming", &[0.54, 0.46]),
    ("blackman", &[0.42, 0.5, 0.08]),
    ("blackman-harris", &[0.358_75, 0.488_29, 0.141_28, 0.011_68]),
    ("flat-top", &[0.215_578_95, 0.416_631_58, 0.277_263_158, 0.083_578_947, 0.006_947_368]),
];

impl Window {
    /// Every window.
    pub const ALL: [Window; 6] = [Rectangular, Hann, Hamming, Blackman, BlackmanHarris, FlatTop];

    /// Name, as in JSON and in `campaign.toml`.
    pub fn name(self) -> &'static str {
        TABLE[self as usize].0
    }

    /// The window with this name, in the spellings of analysers; case, blanks, `-` and `_` are ignored.
    pub fn from_name(name: &str) -> Option<Window> {
        let key: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        let key = match key.as_str() {
            "none" | "rect" | "boxcar" | "uniform" => "rectangular",
            "hanning" => "hann",
            key => key,
        };
        Window::ALL.into_iter().find(|window| window.name().replace('-', "") == key)
    }

    /// Cosine coefficients a₀, a₁, … of w(n) = Σ (−1)ᵏ aₖ cos(2πkn/N).
    pub fn coefficients(self) -> &'static [f64] {
        TABLE[self as usize].1
    }

    /// Mean of the samples: the factor by which the window lowers the line of a sine before correction.
    pub fn coherent_gain(self) -> f64 {
        self.coefficients()[0]
    }

    /// Equivalent noise bandwidth in spectral lines, Σw²·N/(Σw)² = 1 + Σₖ aₖ²/(2a₀²): 1 for no window, 1.5
    /// for Hann.
    pub fn enbw(self) -> f64 {
        let a = self.coefficients();
        1.0 + a[1..].iter().map(|ak| ak * ak / (2.0 * a[0] * a[0])).sum::<f64>()
    }
}
