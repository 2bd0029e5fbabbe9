//! Is a computed orbit real? Four verdicts, each on its own.

use super::flow::{Flight, Signal};
use serde::Serialize;

/// Verdicts on an orbit. A motion that can be measured needs `exists`, `admissible` and `stable`; how far it is from
/// losing one of them is in `grazing_distance`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Validity {
    /// The impulse pushes and the masses approach: J > 0.
    pub exists: bool,
    /// The masses do not pass through each other between the impacts, found by a search that misses no contact.
    pub admissible: bool,
    /// Every Floquet multiplier lies inside the unit circle; `None` where rounding cannot tell the largest from 1. False
    /// where there are no multipliers.
    pub stable: Option<bool>,
    /// The same in a word: `stable`, `unstable` or `neutral`. A neutral motion neither dies away after a disturbance nor is left: that of a
    /// rig without losses, or one at the border of stability.
    pub stability: &'static str,
    /// Smallest gap over the period in m: 0, that of the impact itself, or the depth by which the masses would pass
    /// through each other, as a negative number.
    pub min_gap: f64,
    /// Gap in m at the closest approach that is not the impact; `None` where the masses part and return without one.
    pub clearance: Option<f64>,
    /// Change of the rest gap in m, to first order, by which the impact would graze, the orbit fold, or a second contact
    /// appear. Where this is not larger than the uncertainty of the gap, the verdicts and the multipliers are not to be
    /// relied on: near grazing the multipliers grow like the reciprocal of the approach speed.
    pub grazing_distance: f64,
}

impl Validity {
    /// Judges the orbit that flies `motion` for one `period`.
    ///
    /// `sensitivity` is |dJ/dΔ| in N s/m, infinite at a fold; `stable` the verdict of the multipliers.
    pub(super) fn judge(
        impulse: f64,
        sensitivity: f64,
        motion: &Flight,
        period: f64,
        stable: Option<bool>,
    ) -> Validity {
        // What lies nearer to the impact than this is the impact itself (without rebound the gap starts at zero rate).
        let (noise, margin) = (8.0 * motion.noise(), 1e-9 * period);
        let (mut lowest, mut clearance) = (0.0_f64, None::<f64>);
        motion.each_stationary(Signal::Gap, period, |t| {
            let here = motion.bounded(Signal::Gap, 1, t);
            // Rate rising through zero: a smallest gap.
            if here.slope > 0.0 && t > margin && t < period - margin {
                let gap = motion.gap(t);
                clearance = Some(clearance.map_or(gap, |c| c.min(gap)));
                lowest = lowest.min(gap);
            }
        });
        // The gap is zero at both ends, so wherever it is negative it has a smallest value inside.
        let min_gap = if lowest < -noise { lowest } else { 0.0 };
        let exists = impulse > 0.0;
        let admissible = exists && min_gap == 0.0;
        let own = impulse.abs() / sensitivity;
        Validity {
            exists,
            admissible,
            stable,
            stability: match stable {
                Some(true) => "stable",
                Some(false) => "unstable",
                None => "neutral",
            },
            min_gap,
            clearance,
            grazing_distance: clearance.map_or(own, |c| own.min(c.max(0.0))),
        }
    }

    /// Whether the orbit is real, and stays so for any gap within `gap_uncertainty` (m) of the stated one.
    pub fn robust(&self, gap_uncertainty: f64) -> bool {
        self.exists && self.admissible && self.stable == Some(true) && self.grazing_distance > gap_uncertainty
    }
}
