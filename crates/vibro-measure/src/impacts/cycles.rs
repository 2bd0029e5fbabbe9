//! Times of impacts in cycles of the excitation.

use super::ImpactsOptions;
use super::cycle::{self, Reference};
use vibro_record::Result;

/// Times of impacts in excitation cycles.
pub struct Cycles {
    /// Frequency of the excitation in Hz.
    pub frequency: f64,
    /// Standard uncertainty of the frequency that `at` does not show.
    pub std: f64,
    /// The times, in cycles.
    pub at: Vec<f64>,
}

/// The cycles of the excitation that is known; `None` where none is.
///
/// # Errors
/// As [`Reference::new`].
pub fn cycles(
    times: &[f64],
    start: f64,
    rate: f64,
    options: &ImpactsOptions,
    warnings: &mut Vec<String>,
) -> Result<Option<Cycles>> {
    if let Some(channel) = &options.reference {
        let reference = Reference::new(channel)?;
        if reference.missing + reference.extra > 0 {
            warnings.push(format!(
                "Edges of the reference channel: {} missing, {} too many; cycles were counted as if they were right.",
                reference.missing, reference.extra
            ));
        }
        let at = times.iter().map(|t| reference.counted((t - start) * rate)).collect();
        let frequency = rate / reference.mean_cycle();
        return Ok(Some(Cycles { frequency, std: frequency * reference.std(), at }));
    }
    Ok(options.excitation.map(|frequency| Cycles {
        frequency,
        std: options.excitation_std.unwrap_or_else(|| cycle::of_digits(frequency)),
        at: times.iter().map(|t| t * frequency).collect(),
    }))
}
