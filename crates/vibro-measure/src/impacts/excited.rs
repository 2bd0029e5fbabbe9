//! Impacts against their excitation: phases, the fraction that they keep, or the beat by which they miss it.

use super::count::Counted;
use super::cycle::{self, Locking};
use super::cycles::cycles;
use super::{Impacts, ImpactsOptions};
use crate::Estimate;
use vibro_record::Result;
use vibro_record::units::notation::with_std;

/// Adds to `answer` what an excitation tells; nothing where none is known. `hidden` is the relative standard uncertainty of the interval from
/// samples that stand still to it.
pub fn compare(
    answer: &mut Impacts,
    counted: &Counted,
    (start, rate, hidden): (f64, f64, f64),
    options: &ImpactsOptions,
    warnings: &mut Vec<String>,
) -> Result<()> {
    let Some(cycles) = cycles(&answer.times, start, rate, options, warnings)? else { return Ok(()) };
    let kept: Vec<f64> = counted.kept.iter().filter_map(|i| cycles.at.get(*i)).copied().collect();
    let locking = cycle::locking(&kept, &counted.index, hidden.hypot(cycles.std / cycles.frequency));
    let per_cycle = if let Locking::Locked(fraction) = locking { Some(fraction) } else { None };
    answer.phases = per_cycle.map_or_else(Vec::new, |p| cycle::phases(&cycles.at, p));
    answer.phase = cycles.at.iter().map(|c| c.rem_euclid(1.0)).collect();
    (answer.excitation, answer.per_cycle, answer.regular) =
        (Some(cycles.frequency), per_cycle, per_cycle.is_some());
    match locking {
        Locking::Locked(_) => {}
        Locking::Drifting(near, slip) => {
            let beat = (slip * cycles.frequency).abs();
            let part = near.impacts as f64 / near.cycles as f64;
            let std = answer.frequency.std.map(|s| s.hypot(part * cycles.std));
            answer.beat = Some(Estimate::new(
                beat,
                std,
                "Hz",
                kept.len(),
                format!("impacts a second less {}/{} of the excitation", near.impacts, near.cycles),
            ));
            warnings.push(format!(
                "The train drifts: the impacts beat against {}/{} of the excitation of {} by {}: they do not keep their phase, or the excitation has another frequency.",
                near.impacts,
                near.cycles,
                with_std(cycles.frequency, Some(cycles.std).filter(|s| *s > 0.0), "Hz"),
                with_std(beat, std, "Hz")
            ));
        }
        Locking::Irregular => warnings.push(format!(
            "No fraction of up to 8 impacts in 8 cycles fits within {} % of the rate and {} of a cycle: irregular.",
            100.0 * cycle::FITS,
            cycle::REPEATS
        )),
    }
    Ok(())
}
