//! Four independent verdicts on a computed orbit: whether it exists, is admissible, is stable, and how far
//! it is from grazing.

use super::Course;
use crate::floquet;
use crate::rig::Rig;
use nalgebra::Matrix4;
use num_complex::Complex64;
use serde::Serialize;
use serde_json::{Value, json};

/// Verdicts on an orbit. A motion that can be measured needs `exists`, `admissible` and `stable`;
/// `grazing_distance` is the change of the gap to the loss of one of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Validity {
    /// The impulse pushes and the masses approach: J > 0.
    pub exists: bool,
    /// The masses do not pass through each other between the impacts, by a search that misses no contact.
    pub admissible: bool,
    /// Every Floquet multiplier lies inside the unit circle; `None` where one may lie on it within rounding,
    /// or for a free motion without losses. False where there are no multipliers.
    pub stable: Option<bool>,
    /// How an unstable motion has lost its stability; `None` for other motions.
    pub instability: Option<Loss>,
    /// The energy rule: a larger impulse would take more energy than the force provides. "The positive root
    /// is stable" is this rule for a sine force. It only detects the loss of stability through a multiplier
    /// +1: a motion that breaks it is unstable, but one that meets it need not be stable.
    pub energy_rule: bool,
    /// Smallest gap over the period in m: 0 (at the impact itself), or negative, the depth by which the
    /// masses would pass through each other.
    pub min_gap: f64,
    /// Smallest minimum of the gap in m between the impacts; `None` where the gap has no minimum there.
    pub clearance: Option<f64>,
    /// Change of the rest gap in m, to first order, at which the impact would graze, the orbit fold, or a
    /// second contact appear; stability may be lost earlier. If this is not larger than the uncertainty of
    /// the gap, verdicts and multipliers are not reliable: near grazing the multipliers grow with the
    /// reciprocal of the approach speed.
    pub grazing_distance: f64,
}

/// How a periodic motion loses its stability, by the multiplier farthest outside the unit circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// A real multiplier beyond +1: disturbances grow to one side. Where one passes +1 the motion meets
    /// another one, and both vanish.
    Fold,
    /// A real multiplier beyond −1: the period doubles.
    Flip,
    /// A complex pair: a slow beat grows.
    NeimarkSacker,
    /// No multipliers: the impact grazes.
    Grazing,
}

impl Loss {
    /// Name as it is printed.
    pub fn name(self) -> &'static str {
        ["fold", "flip", "Neimark–Sacker", "grazing"][self as usize]
    }

    /// Kind of instability by the largest of these multipliers.
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
    /// The verdicts with their keys in JSON.
    pub fn keys(&self) -> [(&'static str, Value); 9] {
        [
            ("min_gap", json!(self.min_gap)),
            ("clearance", json!(self.clearance)),
            ("exists", json!(self.exists)),
            ("admissible", json!(self.admissible)),
            ("stable", json!(self.stable == Some(true))),
            ("stability", json!(self.stability())),
            ("instability", json!(self.instability)),
            ("energy_rule", json!(self.energy_rule)),
            ("grazing_distance", json!(self.grazing_distance)),
        ]
    }

    /// Whether disturbances die away (`stable`), grow (`unstable`), or neither, as in a rig without losses or
    /// at the border of stability (`neutral`).
    pub fn stability(&self) -> &'static str {
        match self.stable {
            Some(true) => "stable",
            Some(false) => "unstable",
            None => "neutral",
        }
    }

    /// Whether the motion can be measured: it exists, is admissible and stable.
    pub fn real(&self) -> bool {
        self.exists && self.admissible && self.stable == Some(true)
    }
}

/// A periodic motion with its verdicts.
pub struct Judged {
    pub validity: Validity,
    /// Floquet multipliers, largest modulus first, and the monodromy matrix; `None` unless the motion exists
    /// and is driven.
    pub multipliers: Option<[Complex64; 4]>,
    pub monodromy: Option<Matrix4<f64>>,
    /// Peak-to-peak values of x₁ and x₂ in m.
    pub peak_to_peak: [f64; 2],
}

impl Judged {
    /// Verdicts on a motion along `courses`, each from one impact to the next.
    ///
    /// `exists`: whether all impulses are positive. `energy_rule`: whether the energy rule holds, if known.
    /// `impact_grazing`: change of the gap in m at which an impact itself grazes. `amplified`: factor on the
    /// rounding error; `None` for a free motion.
    pub fn new(
        rig: &Rig,
        courses: &[Course],
        exists: bool,
        energy_rule: Option<bool>,
        impact_grazing: f64,
        amplified: Option<f64>,
    ) -> Judged {
        let (mut multipliers, mut monodromy) = (None, None);
        // A free motion without losses belongs to a family of motions: disturbances neither decay nor grow.
        let mut stable = amplified.map(|_| false);
        if let Some(amplified) = amplified.filter(|_| exists) {
            let (whole, rounding) = product(rig, courses);
            multipliers = floquet::multipliers(&whole).ok();
            stable =
                multipliers.as_ref().map_or(stable, |m| floquet::inside(&whole, m, amplified * rounding));
            monodromy = Some(whole);
        }
        // With one impact per period the energy rule is equivalent to an even number of multipliers beyond
        // +1. With several impacts this condition replaces the rule.
        let even = || monodromy.is_some_and(|m| (Matrix4::identity() - m).determinant() > 0.0);
        let surveys: Vec<_> = courses.iter().map(Course::survey).collect();
        let clearance = surveys.iter().filter_map(|s| s.closest).reduce(f64::min);
        let noise = courses.iter().map(Course::noise).fold(0.0, f64::max);
        // The gap is zero at the impacts, so a negative gap has a minimum between them.
        let min_gap = clearance.filter(|gap| *gap < -8.0 * noise).unwrap_or(0.0);
        let validity = Validity {
            exists,
            admissible: exists && min_gap == 0.0,
            stable,
            instability: (exists && stable == Some(false)).then(|| Loss::of(multipliers.as_ref())),
            energy_rule: exists && energy_rule.unwrap_or_else(even),
            min_gap,
            clearance,
            grazing_distance: clearance.map_or(impact_grazing, |c| impact_grazing.min(c.max(0.0))),
        };
        let spread = |mass: usize| {
            let ranges = surveys.iter().map(|s| s.ranges[mass]);
            let (low, high) = ranges.reduce(|r, x| (r.0.min(x.0), r.1.max(x.1))).unwrap_or_default();
            high - low
        };
        Judged { validity, multipliers, monodromy, peak_to_peak: [0, 1].map(spread) }
    }
}

/// Monodromy of a motion along `courses`, each from an impact to the next, and a bound on its rounding.
///
/// An error δ of the factor Aᵢ changes the product by Aₙ…Aᵢ₊₁ δ Aᵢ₋₁…A₁. The norms of these products are
/// taken, not the products of norms: the latter grow with every impact, and rounding then seems to hide what
/// is certain.
fn product(rig: &Rig, courses: &[Course]) -> (Matrix4<f64>, f64) {
    let mut before = courses.last().map_or([0.0; 4], |last| last.rates().0);
    let parts = courses.iter().map(|course| {
        let (next, after) = course.rates();
        let part = floquet::monodromy(rig, course.period, &before, &after);
        before = next;
        part
    });
    let parts: Vec<(Matrix4<f64>, f64)> = parts.collect();
    // Without factors on one side the norm is 1.
    let norms = |factors: &mut dyn Iterator<Item = Matrix4<f64>>, left: bool| -> Vec<f64> {
        let (mut whole, mut norms) = (None::<Matrix4<f64>>, Vec::new());
        for factor in factors {
            norms.push(whole.map_or(1.0, |whole| whole.norm()));
            whole = Some(whole.map_or(factor, |whole| if left { factor * whole } else { whole * factor }));
        }
        norms
    };
    let earlier = norms(&mut parts.iter().map(|part| part.0), true);
    let later = norms(&mut parts.iter().rev().map(|part| part.0), false);
    let sides = earlier.iter().zip(later.iter().rev());
    let rounding =
        parts.iter().zip(sides).map(|((_, rounding), (earlier, later))| earlier * rounding * later).sum();
    (parts.iter().fold(Matrix4::identity(), |whole, part| part.0 * whole), rounding)
}
