//! States from which motions are looked for.

use crate::model::{Excitation, Rig, State, no_impact};
use std::f64::consts::TAU;

/// States tried.
pub const STARTS: u32 = 8;
/// Their size at least and at most, in units of the gap or of what mass 1 does alone, the larger.
const SIZES: (f64, f64) = (1.0, 6.0);

/// States with the phase 0 of the excitation, of sizes that rise from one to the next and in directions spread evenly (the additive recurrence
/// of the generalised golden ratio, M. Roberts, 2018). Masses that would overlap are mirrored at their contact.
pub fn starts(rig: &Rig, excitation: &Excitation) -> impl Iterator<Item = (State, f64)> {
    let alone = no_impact(rig, excitation).map_or(0.0, |free| free.largest);
    let unit = alone.max(rig.gap.abs());
    let omega = TAU * excitation.frequency();
    // φ⁵ = φ + 1, the ratio for four dimensions.
    let golden = (0..64).fold(1.0_f64, |phi, _| (1.0 + phi).powf(0.2));
    let (gap, wall) = (rig.gap, rig.has_wall());
    (0..STARTS).filter(move |_| unit.is_finite() && unit > 0.0).map(move |n| {
        let part = f64::from(n) / f64::from(STARTS - 1);
        let size = unit * (SIZES.0 + part * (SIZES.1 - SIZES.0));
        let [x1, v1, x2, v2] =
            [1, 2, 3, 4].map(|k| size * (2.0 * (0.5 + f64::from(n + 1) / golden.powi(k)).fract() - 1.0));
        let [x2, v2] = if wall { [0.0; 2] } else { [x2, v2] };
        let overlap = (x1 - x2 - gap).max(0.0);
        (State { x1: x1 - 2.0 * overlap, v1: omega * v1, x2, v2: omega * v2 }, 0.0)
    })
}
