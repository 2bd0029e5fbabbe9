//! Orbits under a sine force: a quadratic.

use super::Orbit;
use super::conditions::{Conditions, Root};
use super::course::Course;
use super::drive::Drive;
use super::stretch::Stretch;
use crate::Steady;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// (C² + (P/ω)²)J² + 2ΔCJ + Δ² − A² = 0, from y = A cos φ = Δ + JC and ẏ = −Aω sin φ = JP.
#[derive(Debug, Clone, Copy)]
pub struct Quadratic {
    /// C² + (P/ω)².
    a: f64,
    /// ΔC.
    half: f64,
    /// Square of the half distance of the roots times a, written so that it does not cancel; negative beyond the fold.
    discriminant: f64,
    /// Product of the roots.
    product: f64,
}

impl Quadratic {
    /// That of these conditions, for a steady motion of mass 1 alone of `amplitude` (m) at `omega` (rad/s).
    pub fn new(conditions: &Conditions<'_>, amplitude: f64, omega: f64) -> Quadratic {
        let (c, p, gap) = (conditions.c, conditions.p / omega, conditions.rig.gap);
        let a = c * c + p * p;
        Quadratic {
            a,
            half: gap * c,
            discriminant: amplitude.powi(2) * a - (gap * p).powi(2),
            product: (gap - amplitude) * (gap + amplitude) / a,
        }
    }

    /// Whether it has roots.
    pub(crate) fn has_roots(&self) -> bool {
        self.a > 0.0 && self.discriminant >= 0.0
    }

    /// Its roots, the larger first; beyond the fold twice the place where they met.
    pub fn roots(&self) -> [f64; 2] {
        // The root in which the terms add up first, the other from their product.
        let root = self.discriminant.max(0.0).sqrt();
        let first = -(self.half + root.copysign(self.half)) / self.a;
        let second = match (first == 0.0, self.discriminant > 0.0) {
            (true, _) => 0.0,
            (false, true) => self.product / first,
            (false, false) => first,
        };
        [first.max(second), first.min(second)]
    }
}

/// Orbits under the force `force` cos ωt whose steady motion is `steady`, larger impulse first.
pub fn orbits<'a>(
    conditions: &'a Conditions<'a>,
    steady: &'a Steady,
    force: f64,
) -> impl Iterator<Item = Orbit> + use<'a> {
    let (c, p, gap) = (conditions.c, conditions.p / steady.omega, conditions.rig.gap);
    let amplitude = steady.amplitude();
    let quadratic = Quadratic::new(conditions, amplitude, steady.omega);
    let discriminant = quadratic.discriminant;
    let pair = quadratic.has_roots().then(|| {
        let [larger, smaller] = quadratic.roots();
        [(larger, true), (smaller, false)]
    });
    pair.into_iter().flatten().map(move |(impulse, upper)| {
        let cosine = (gap + impulse * c) / amplitude;
        let sine = -impulse * p / amplitude;
        let timing = f64::atan2(sine, cosine).rem_euclid(TAU);
        let root = Root {
            impulse,
            timing,
            force_phase: (timing - steady.response.arg()).rem_euclid(TAU),
            // From the quadratic: (aJ + ΔC) dJ = −(CJ + Δ) dΔ.
            sensitivity: (c * impulse + gap).abs() / discriminant.max(0.0).sqrt(),
            size: gap.abs() + amplitude,
            upper,
        };
        let [chi1, chi2] = &conditions.greens;
        let stretch = Stretch {
            oscillators: conditions.rig.oscillators(),
            free: [
                (-impulse * chi1.start, -impulse * chi1.slope_after),
                (impulse * chi2.start, impulse * chi2.slope_after),
            ],
            forced: Complex64::from_polar(amplitude, timing),
            omega: steady.omega,
            rest: 0.0,
            gap,
        };
        let course = Course::Smooth { stretch, period: conditions.period() };
        conditions.orbit(&root, &course, Drive::Sine(force))
    })
}
