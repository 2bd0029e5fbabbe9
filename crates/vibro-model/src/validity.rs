//! Is a computed orbit real? Four verdicts, each on its own.

use num_complex::Complex64;
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
    /// The same in a word.
    pub stability: Stability,
    /// How an unstable motion has lost its stability; `None` for any other.
    pub instability: Option<Loss>,
    /// The energy rule: a larger impulse would take more energy than the force then gives. "The positive root is stable" is this rule for
    /// a sine force. It sees only the loss through a multiplier +1, so a motion that breaks it is unstable, and one that keeps it need
    /// not be stable.
    pub energy_rule: bool,
    /// Smallest gap over the period in m: 0, that of the impact itself, or the depth by which the masses would pass
    /// through each other, as a negative number.
    pub min_gap: f64,
    /// Gap in m at the closest approach that is not the impact; `None` where the masses part and return without one.
    pub clearance: Option<f64>,
    /// Change of the rest gap in m, to first order, by which the impact would graze, the orbit fold, or a second contact
    /// appear; the motion may lose its stability before. Where this is not larger than the uncertainty of the gap, the verdicts and the
    /// multipliers are not to be relied on: near grazing the multipliers grow like the reciprocal of the approach speed.
    pub grazing_distance: f64,
}

/// Whether disturbances of a periodic motion die away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stability {
    /// They die away.
    Stable,
    /// They grow.
    Unstable,
    /// Neither: the motion of a rig without losses, or one at the border of stability.
    Neutral,
}

impl Stability {
    /// `stable`, `unstable` or `neutral`.
    pub fn name(self) -> &'static str {
        match self {
            Stability::Stable => "stable",
            Stability::Unstable => "unstable",
            Stability::Neutral => "neutral",
        }
    }
}

/// How a periodic motion loses its stability, by the multiplier farthest outside the unit circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// A real one beyond +1: disturbances grow to one side. Where one passes +1 the motion meets another one and both vanish.
    Fold,
    /// A real one beyond −1: the period doubles.
    Flip,
    /// A pair: a slow beat grows.
    NeimarkSacker,
    /// None can be computed: the impact grazes.
    Grazing,
}

impl Loss {
    /// Name as it is printed.
    pub fn name(self) -> &'static str {
        match self {
            Loss::Fold => "fold",
            Loss::Flip => "flip",
            Loss::NeimarkSacker => "Neimark–Sacker",
            Loss::Grazing => "grazing",
        }
    }

    /// The loss that the largest of these multipliers shows.
    pub(super) fn of(multipliers: Option<&[Complex64; 4]>) -> Loss {
        match multipliers.map(|m| m[0]) {
            None => Loss::Grazing,
            Some(z) if z.im != 0.0 => Loss::NeimarkSacker,
            Some(z) if z.re > 0.0 => Loss::Fold,
            Some(_) => Loss::Flip,
        }
    }
}

impl Validity {
    /// Verdicts on a motion: whether its impacts push and the energy rule holds, the change of the gap in m at which an impact itself
    /// grazes (`own`), its smallest gap between the impacts, known to `noise`, and what its multipliers say.
    pub(super) fn judge(
        exists: bool,
        energy_rule: bool,
        own: f64,
        clearance: Option<f64>,
        noise: f64,
        stable: Option<bool>,
        multipliers: Option<&[Complex64; 4]>,
    ) -> Validity {
        // The gap is zero at the impacts, so wherever it is negative it has a smallest value between them.
        let min_gap = clearance.filter(|gap| *gap < -8.0 * noise).unwrap_or(0.0);
        Validity {
            exists,
            admissible: exists && min_gap == 0.0,
            stable,
            stability: match stable {
                Some(true) => Stability::Stable,
                Some(false) => Stability::Unstable,
                None => Stability::Neutral,
            },
            instability: (exists && stable == Some(false)).then(|| Loss::of(multipliers)),
            energy_rule: exists && energy_rule,
            min_gap,
            clearance,
            grazing_distance: clearance.map_or(own, |c| own.min(c.max(0.0))),
        }
    }

    /// Whether the motion can be measured: it exists, is admissible and stable.
    pub fn real(&self) -> bool {
        self.exists && self.admissible && self.stable == Some(true)
    }
}
