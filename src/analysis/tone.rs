//! The strongest sine of a record.

use crate::measure::tones::sine;
use crate::record::Trace;

/// The strongest sine of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strongest {
    /// Its frequency in Hz.
    pub frequency: f64,
    /// Its share of the power of the record without its mean, 0 to 1.
    pub share: f64,
}

impl Strongest {
    /// The strongest sine of a trace; `None` where no line is above the noise.
    pub fn of(trace: &Trace) -> Option<Strongest> {
        let tone = sine(trace, None).ok()?.tones.into_iter().next()?;
        let n = trace.values.len() as f64;
        let mean = trace.values.iter().sum::<f64>() / n;
        let power = trace.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
        let share = (0.5 * tone.amplitude.value.powi(2) / power).min(1.0);
        Some(Strongest { frequency: tone.frequency.value, share })
    }
}
