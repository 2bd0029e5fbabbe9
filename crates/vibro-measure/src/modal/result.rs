//! Results of a modal analysis: modes, with the estimates of every method.

use crate::Estimate;
use num_complex::Complex64;
use serde::{Serialize, Serializer};
use std::f64::consts::TAU;
use vibro_record::{Finding, uncertain};

/// Options of a modal analysis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModalOptions {
    /// Band in Hz whose peaks are fitted together. Default: a band around each peak.
    pub band: Option<(f64, f64)>,
    /// Mass in kg for the stiffness k = m(2πf)², taken as exact. Default: none.
    pub mass: Option<f64>,
    /// Lines with a coherence below this are left out; 0.5 where `None`.
    pub least_coherence: Option<f64>,
    /// Decay in 1/s that an exponential window added to the response, to be subtracted. Default: none.
    pub decay: Option<f64>,
    /// Relative standard uncertainty of the sampling rate, which is common to all frequencies. Default: 0.
    pub clock: f64,
}

/// The modes of a frequency response function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModalResult {
    /// Modes by frequency.
    pub modes: Vec<Mode>,
    /// Findings: assumptions, what was left out, and doubts that the lines leave.
    pub findings: Vec<Finding>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// Undamped natural frequency in Hz.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Estimate,
    /// Modal constant A of the receptance A/(ωᵣ² − ω² + 2iζωᵣω), in 1/kg: its magnitude, negative where its
    /// phase is within 45° of 180°. In a mode shape the signs are the directions.
    pub modal_constant: Estimate,
    /// Phase of the modal constant in degrees: 0 or 180° for a mode of which all parts move in step. `None`
    /// without phases.
    pub phase: Option<Estimate>,
    /// Method of these estimates.
    pub method: String,
    /// k = m(2πf)² in N/m; `None` without a mass.
    pub stiffness: Option<Estimate>,
    /// First and last line in Hz, and the number of lines, that were fitted.
    pub lines: (f64, f64, usize),
    /// Results of every method.
    pub by: Vec<ByMethod>,
    /// Frequency and fitted response of the lines that were used, real and imaginary.
    #[serde(skip)]
    pub fitted: Vec<(f64, f64, f64)>,
}

uncertain!(ModalResult: modes);
uncertain!(Mode: frequency, zeta, phase, stiffness, by; scaled: modal_constant);
uncertain!(ByMethod: frequency, zeta; scaled: modal_constant);

/// Result of one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByMethod {
    /// `rational fit` in the complex plane, `circle fit` in the Nyquist plane, `half power` or largest line
    /// (`peak`).
    pub method: &'static str,
    /// Natural frequency in Hz; NaN where the method gives none.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Option<Estimate>,
    /// Modal constant, with the sign of [`Mode::modal_constant`].
    pub modal_constant: Option<Estimate>,
    /// Limitation of the method for this mode; in JSON the code of the finding.
    #[serde(serialize_with = "code")]
    pub note: Option<Finding>,
}

// serde passes a reference to the field: the type of `note` is not free.
#[allow(clippy::ref_option)]
fn code<S: Serializer>(note: &Option<Finding>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(note.as_ref().map_or("", |n| n.code.as_ref()))
}

/// A mode of viscous damping: receptance A/(ωᵣ² − ω² + 2iζωᵣω).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Undamped natural frequency in Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub zeta: f64,
    /// Modal constant A: 1/kg for a response over a force, 1/s² for a ratio of equal units.
    pub constant: Complex64,
}

impl Pole {
    /// Response of the mode at `f` in Hz: its receptance times (iω)^`power`.
    pub fn at(&self, f: f64, power: i32) -> Complex64 {
        let (omega, own) = (TAU * f, TAU * self.frequency);
        let factor = Complex64::new(0.0, omega).powi(power);
        factor * self.constant / Complex64::new(own * own - omega * omega, 2.0 * self.zeta * own * omega)
    }

    /// The mode without a decay σ in 1/s that an exponential window added to a response of (iω)^`power` times
    /// the receptance.
    ///
    /// The window moves the pole s = −ζωᵣ ± iωᵣ√(1 − ζ²) by −σ and leaves its residue, which is `s^power`
    /// A/(2iωᵣ√(1 − ζ²)). `None` where the mode decays by less than σ, or does not oscillate (ζ of 1 and
    /// more).
    pub(crate) fn without_decay(&self, decay: f64, power: i32) -> Option<Pole> {
        if self.zeta.is_nan() || self.zeta.abs() >= 1.0 {
            return None;
        }
        let own = TAU * self.frequency;
        let with = Complex64::new(-self.zeta * own, own * (1.0 - self.zeta * self.zeta).sqrt());
        let pole = with + decay;
        let zeta = -pole.re / pole.norm();
        let constant = self.constant * (with / pole).powi(power);
        (zeta > 0.0).then(|| Pole { frequency: pole.norm() / TAU, zeta, constant })
    }
}
