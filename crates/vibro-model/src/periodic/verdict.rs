//! Is a motion with several impacts real?

use super::Beat;
use crate::flow::Signal;
use crate::validity::Loss;
use crate::{Flight, Stability, Validity};
use nalgebra::Matrix4;
use num_complex::Complex64;

/// Verdicts over all impacts and flights; `own` is the change of the gap in m at which, to first order, the first impact grazes.
///
/// The energy rule of one impact is that the multipliers beyond +1 are even in number: det(I − M) > 0. So it is taken here.
pub(super) fn judge(
    flights: &[Flight],
    beats: &[Beat],
    own: f64,
    stable: Option<bool>,
    multipliers: Option<&[Complex64; 4]>,
    monodromy: Option<&Matrix4<f64>>,
) -> Validity {
    let exists = beats.iter().all(|b| b.impulse > 0.0 && b.interval > 0.0);
    let period: f64 = beats.iter().map(|b| b.interval).sum();
    // What lies nearer to an impact than this is the impact itself (without rebound the gap starts at zero rate).
    let margin = 1e-9 * period;
    let (mut lowest, mut clearance) = (0.0_f64, None::<f64>);
    for (flight, beat) in flights.iter().zip(beats) {
        let duration = beat.interval.max(0.0);
        let noise = 8.0 * flight.noise();
        flight.each_stationary(Signal::Gap, duration, |t| {
            let rising = flight.bounded(Signal::Gap, 1, t).slope > 0.0;
            if rising && t > margin && t < duration - margin {
                let gap = flight.gap(t);
                clearance = Some(clearance.map_or(gap, |c| c.min(gap)));
                if gap < -noise {
                    lowest = lowest.min(gap);
                }
            }
        });
    }
    Validity {
        exists,
        admissible: exists && lowest == 0.0,
        stable,
        stability: match stable {
            Some(true) => Stability::Stable,
            Some(false) => Stability::Unstable,
            None => Stability::Neutral,
        },
        instability: (exists && stable == Some(false)).then(|| Loss::of(multipliers)),
        energy_rule: monodromy.is_some_and(|m| (Matrix4::identity() - m).determinant() > 0.0),
        min_gap: lowest,
        clearance,
        grazing_distance: clearance.map_or(own, |c| own.min(c.max(0.0))),
    }
}
