//! Whether velocity and reference can be what they are said to be, and the levels of the reference.

use super::survey::{Survey, median};
use super::{DrillOptions, Surveyed};
use vibro_record::{Error, Result};

/// A pulse stands on its two levels for more than this part of the time; edges and noise are the rest. A motion is near two levels for
/// less: a sine near the medians of its halves for a quarter.
const PULSED: f64 = 0.8;
/// Turns of a shaft are as long as their neighbours within this part; what vibrates crosses its middle at any distance.
const UNEVEN: f64 = 0.2;
/// Fewer edges do not show whether they come evenly.
const FEW: usize = 6;

/// The two levels of the reference between which edges are counted.
///
/// # Errors
/// If the velocity is constant or missing; if both channels are the same; if the reference has one level only, or does not cross the
/// level that was stated.
pub(super) fn levels(surveyed: &Surveyed, options: &DrillOptions) -> Result<(f64, f64)> {
    let Some((low, high)) = surveyed.velocity.range() else {
        return Err(Error::refused("the velocity channel holds no value").setting("velocity"));
    };
    if surveyed.same {
        return Err(Error::refused("velocity and reference are the same channel")
            .hint("name two channels; `vibro info` lists them")
            .setting("velocity")
            .setting("reference"));
    }
    if low == high {
        return Err(Error::refused(format!("the velocity is constant, {low} m/s"))
            .hint("check that the laser sees the target")
            .setting("velocity"));
    }
    let Some((low, high)) = surveyed.reference.levels() else {
        let what = surveyed
            .reference
            .range()
            .map_or("without a value".to_owned(), |(v, _)| format!("constant, {v}"));
        return Err(Error::refused(format!("no edge: the reference channel is {what}")).setting("reference"));
    };
    match options.level {
        None => Ok((low, high)),
        // The level stands in the middle; the nearer of both levels gives the height.
        Some(level) if level > low && level < high => {
            let half = (level - low).min(high - level);
            Ok((level - half, level + half))
        }
        Some(level) => Err(Error::refused(format!(
            "the reference lies between {low:.4} and {high:.4}: it does not cross the level {level}"
        ))
        .setting("level")),
    }
}

/// Refuses what is no reference: the velocity in its place, or a vibration.
///
/// Evenness is the median difference of neighbouring edge distances over the median distance: a machine that runs up changes little
/// from one turn to the next.
///
/// # Errors
/// If the velocity stands on two levels and the reference does not; if the reference neither does nor has even edges.
pub(super) fn check_pulses(velocity: &Survey, reference: &Survey, edges: &[f64]) -> Result<()> {
    let on_levels = 100.0 * reference.two_levels();
    if on_levels >= 100.0 * PULSED {
        return Ok(());
    }
    if velocity.two_levels() > PULSED {
        return Err(Error::refused(format!(
            "the velocity stands on two levels as a pulse does, the reference for {on_levels:.0} % of the time"
        ))
        .hint("are the two channels swapped?")
        .setting("velocity")
        .setting("reference"));
    }
    let steps: Vec<f64> = edges.windows(2).map(|w| w[1] - w[0]).collect();
    let uneven = median(steps.windows(2).map(|w| (w[1] - w[0]).abs())) / median(steps.iter().copied());
    if steps.len() >= FEW && uneven > UNEVEN {
        let uneven = 100.0 * uneven;
        return Err(Error::refused(format!(
            "the reference is no pulse of a shaft: neighbouring edge distances differ by {uneven:.0} %"
        ))
        .hint("name the channel of the pulse; `vibro info` lists the channels")
        .setting("reference"));
    }
    Ok(())
}
