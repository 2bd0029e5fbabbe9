//! Whether velocity and reference are what they are said to be.

use super::Survey;
use super::survey::median;
use vibro_record::{Error, Result};

/// A pulse stands on its two levels for more than this part of the time; edges and noise are the rest. A motion is near two levels for
/// less: a sine near the medians of its halves for a quarter.
const PULSED: f64 = 0.8;

/// Turns of a shaft are as long as their neighbours within this part; what vibrates crosses its middle at any distance.
const UNEVEN: f64 = 0.2;

/// Fewer edges do not show whether they come evenly.
const FEW: usize = 6;

/// Refuses what is no reference: the velocity in its place, or a vibration.
///
/// Evenness is the median difference of neighbouring edge distances over the median distance: a machine that runs up changes little
/// from one turn to the next.
///
/// # Errors
/// If the velocity stands on two levels and the reference does not; if the reference neither does nor has even edges.
pub(super) fn reference(velocity: &Survey, reference: &Survey, edges: &[f64]) -> Result<()> {
    let on_levels = 100.0 * reference.two_levels();
    if reference.two_levels() >= PULSED {
        return Ok(());
    }
    if velocity.two_levels() > PULSED {
        return Err(Error::refused(format!(
            "the velocity stands on two levels as a pulse does, and the reference for {on_levels:.0} % of the time only: are the two channels swapped?"
        ))
        .hint("--velocity names the channel of the laser, --reference that of the pulse"));
    }
    let steps: Vec<f64> = edges.windows(2).map(|w| w[1] - w[0]).collect();
    let uneven = median(steps.windows(2).map(|w| (w[1] - w[0]).abs())) / median(steps.iter().copied());
    if steps.len() >= FEW && uneven > UNEVEN {
        return Err(Error::refused(format!(
            "the reference stands on its two levels for {on_levels:.0} % of the time only, and distances of its edges differ by {:.0} % from one to the next: it is no pulse of a shaft",
            100.0 * uneven
        ))
        .hint("--reference names the channel of the pulse; `vibro info` lists the channels"));
    }
    Ok(())
}
