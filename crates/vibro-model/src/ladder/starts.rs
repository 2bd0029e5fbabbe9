//! States from which motions are looked for.

use crate::{Excitation, Rig, State, no_impact};
use serde::Serialize;
use std::f64::consts::TAU;

/// States tried.
const STARTS: u32 = 8;
/// Their size at least and at most, in units of the gap or of what mass 1 does alone, the larger.
const SIZES: (f64, f64) = (1.0, 6.0);

/// How many states beside rest the rig was followed from in search of other motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Followed {
    /// Those that were.
    pub states: u32,
    /// All that there are. Fewer are followed once a second motion is found, where it takes too many cycles, and where some lead beyond what can
    /// be followed.
    pub of: u32,
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Simulation, Sine};

    #[test]
    fn states_are_apart_and_grow_in_all_directions() {
        let sine: Excitation = Sine { force: 0.3, frequency: 12.97 }.into();
        for (gap, m2) in [(1e-3, 0.094), (0.0, 0.094), (-5e-4, 0.094), (1e-3, f64::INFINITY)] {
            let rig = Rig { m2, gap, ..Rig::thesis() };
            let all: Vec<State> = starts(&rig, &sine).map(|s| s.0).collect();
            assert_eq!(all.len(), STARTS as usize);
            // Overlapping and moving walls are refused.
            assert!(all.iter().all(|s| Simulation::from_state(&rig, &sine, *s, 0.0).is_ok()));
            // x₁ need not: it cannot lie far beyond a contact.
            assert!(all.iter().any(|s| s.v1 > 0.0) && all.iter().any(|s| s.v1 < 0.0));
            let size = |s: &State| s.v1.abs().max(s.v2.abs()) / (TAU * 12.97);
            let unit = no_impact(&rig, &sine).unwrap().largest.max(gap.abs());
            assert!(all.iter().all(|s| size(s) <= SIZES.1 * unit) && size(&all[0]) <= SIZES.0 * unit);
        }
    }
}
