//! Options and results of the analysis of a free decay.

use crate::Estimate;
use serde::Serialize;
use vibro_record::{Finding, uncertain};

/// Options of the analysis of a free decay.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DecayOptions {
    /// Band in Hz in which modes are searched. Default: all lines.
    pub band: Option<(f64, f64)>,
    /// Number of modes. Default: all above the noise.
    pub modes: Option<usize>,
}

/// A mode of a free decay, A e^(−ζω₀t) cos(ω₀√(1−ζ²) t + φ), with t from the start of the part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayMode {
    /// Undamped natural frequency ω₀/2π in Hz.
    pub frequency: Estimate,
    /// Damping ratio ζ.
    pub zeta: Estimate,
    /// Amplitude A at the start, in the unit of the record.
    pub amplitude: Estimate,
    /// Phase φ at the start in rad.
    pub phase: Estimate,
}

/// The strongest mode in a stretch of the part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Beginning of the stretch in s.
    pub start: f64,
    /// The mode as fitted to this stretch alone; its amplitude is that at the beginning of the stretch.
    #[serde(flatten)]
    pub mode: DecayMode,
}

/// Modes of a free decay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayResult {
    /// Beginning of the part that was used, in s.
    pub start: f64,
    /// End of the part in s.
    pub end: f64,
    /// End of the record in s.
    pub last: f64,
    /// Modes by rising frequency.
    pub modes: Vec<DecayMode>,
    /// The strongest mode over falling amplitude, where the part is long enough.
    pub levels: Vec<Level>,
    /// Damping ratio of the strongest mode from the logarithmic decrement between the first and the last
    /// level.
    pub decrement: Option<Estimate>,
    /// Findings: what was left out, and doubts.
    pub findings: Vec<Finding>,
    /// Time in s, record, and sum of the modes over the part, for a figure.
    #[serde(skip)]
    pub curves: [Vec<f64>; 3],
}

uncertain!(DecayResult: modes, levels, decrement);
uncertain!(DecayMode: frequency, zeta, phase; scaled: amplitude);
uncertain!(Level: mode);
