//! Impacts against their excitation: phases, the fraction that they keep, or the beat by which they miss it.

use super::count::Counted;
use super::locking::{Locking, locking, phases, typed};
use super::reference::Reference;
use super::{Impacts, ImpactsOptions};
use crate::Estimate;
use vibro_record::{Finding, Result};

/// Times of impacts in cycles of the excitation.
struct Cycles {
    /// Frequency of the excitation in Hz, and its standard uncertainty that `at` does not show.
    frequency: f64,
    std: f64,
    at: Vec<f64>,
}

/// Adds to `answer` how the impacts go with the excitation; nothing where none is known. The record begins at `start` in s and has a
/// sampling `rate` in Hz; `sampled` is the relative standard uncertainty of the interval from onsets that lie anywhere within a sample.
///
/// # Errors
/// As [`Reference::new`].
pub fn compare(
    answer: &mut Impacts,
    counted: &Counted,
    (start, rate, sampled): (f64, f64, f64),
    options: &ImpactsOptions,
) -> Result<()> {
    let Some(Cycles { frequency, std, at }) = cycles(answer, start, rate, options)? else { return Ok(()) };
    let kept: Vec<f64> = counted.kept.iter().map(|i| at[*i]).collect();
    let locking = locking(&kept, &counted.index, sampled.hypot(std / frequency));
    answer.excitation = Some(frequency);
    answer.phase = at.iter().map(|c| c.rem_euclid(1.0)).collect();
    answer.regular = matches!(locking, Locking::Locked(_));
    match locking {
        Locking::Locked(fraction) => {
            answer.per_cycle = Some(fraction);
            answer.phases = phases(&at, fraction);
        }
        Locking::Drifting(near, slip) => {
            let beat = (slip * frequency).abs();
            let part = near.impacts as f64 / near.cycles as f64;
            let u = answer.frequency.std.map(|s| s.hypot(part * std));
            let method = format!("impacts a second less {}/{} of the excitation", near.impacts, near.cycles);
            answer.beat = Some(Estimate::new(beat, u, "Hz", kept.len(), method));
            answer.findings.push(
                Finding::caution("impacts-drift")
                    .count("impacts", near.impacts)
                    .count("cycles", near.cycles)
                    .number("excitation", frequency)
                    .number("beat", beat),
            );
        }
        Locking::Irregular => answer.findings.push(Finding::caution("no-fraction-fits")),
    }
    Ok(())
}

/// The impacts in cycles of the excitation; `None` where none is known.
fn cycles(answer: &mut Impacts, start: f64, rate: f64, options: &ImpactsOptions) -> Result<Option<Cycles>> {
    if let Some(channel) = &options.reference {
        let reference = Reference::new(channel)?;
        if reference.missing + reference.extra > 0 {
            answer.findings.push(
                Finding::caution("reference-edges")
                    .count("missing", reference.missing)
                    .count("extra", reference.extra),
            );
        }
        let at = answer.times.iter().map(|t| reference.counted((t - start) * rate)).collect();
        let frequency = rate / reference.mean_cycle();
        return Ok(Some(Cycles { frequency, std: frequency * reference.std(), at }));
    }
    Ok(options.excitation.map(|frequency| Cycles {
        frequency,
        std: options.excitation_std.or(typed(&frequency.to_string()).map(|t| t.1)).unwrap_or(0.0),
        at: answer.times.iter().map(|t| t * frequency).collect(),
    }))
}
