//! What is known of each mode.

use crate::Estimate;
use serde::{Serialize, Serializer};
use vibro_record::Finding;

/// How modes are looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalOptions {
    /// Band in Hz whose peaks are fitted together. Default: a band around each peak.
    pub band: Option<(f64, f64)>,
    /// Mass in kg for the stiffness k = m(2πf)², taken as exact. Default: none.
    pub mass: Option<f64>,
    /// Lines of a coherence below this are left out. Default 0.5.
    pub least_coherence: f64,
    /// Decay in 1/s that an exponential window added to the response, to be subtracted. Default: none.
    pub decay: Option<f64>,
    /// Whether the function was averaged over the blows of a hammer, each a record as long as one over the distance of the lines.
    /// Default: false.
    pub from_blows: bool,
}

impl Default for ModalOptions {
    fn default() -> ModalOptions {
        ModalOptions { band: None, mass: None, least_coherence: 0.5, decay: None, from_blows: false }
    }
}

/// The modes of a frequency response function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModalResult {
    /// Modes by frequency.
    pub modes: Vec<Mode>,
    /// What was assumed and left out, and what the lines leave open.
    pub findings: Vec<Finding>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// Undamped natural frequency in Hz.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Estimate,
    /// Modal constant A of the receptance A/(ωᵣ² − ω² + 2iζωᵣω), 1/kg: its magnitude, negative where its phase is within 45° of
    /// 180°. In a mode shape the signs are the directions.
    pub modal_constant: Estimate,
    /// Phase of the modal constant in degrees: 0 or 180° for a mode of which all parts move in step. `None` without phases.
    pub phase: Option<Estimate>,
    /// How these were found.
    pub method: String,
    /// k = m(2πf)² in N/m; `None` without a mass.
    pub stiffness: Option<Estimate>,
    /// First and last line in Hz, and the number of lines, that were fitted.
    pub lines: (f64, f64, usize),
    /// What every method gives.
    pub by: Vec<ByMethod>,
    /// Frequency and fitted response of the lines that were used, real and imaginary.
    #[serde(skip)]
    pub fitted: Vec<(f64, f64, f64)>,
}

/// What one method gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByMethod {
    /// `rational fit` in the complex plane, `circle fit` in the Nyquist plane, `half power` or largest line (`peak`).
    pub method: &'static str,
    /// Natural frequency in Hz; NaN where the method gives none.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Option<Estimate>,
    /// Modal constant, with the sign of [`Mode::modal_constant`].
    pub modal_constant: Option<Estimate>,
    /// What limits it; in JSON its code.
    #[serde(serialize_with = "code")]
    pub note: Option<Finding>,
}

// serde hands over the field as it is.
#[allow(clippy::ref_option)]
fn code<S: Serializer>(note: &Option<Finding>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(note.as_ref().map_or("", |n| n.code))
}
