//! Orbits under a sine force: a quadratic.

use super::Orbit;
use super::conditions::{Conditions, Root};
use super::course::Course;
use super::drive::Drive;
use super::stretch::Stretch;
use crate::model::Steady;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Orbits under the force `force` cos ωt whose steady motion is `steady`, larger impulse first.
///
/// y = A cos φ = Δ + JC and ẏ = −Aω sin φ = JP give (C² + (P/ω)²)J² + 2ΔCJ + Δ² − A² = 0.
pub fn orbits<'a>(
    conditions: &'a Conditions<'a>,
    steady: &'a Steady,
    force: f64,
) -> impl Iterator<Item = Orbit> + use<'a> {
    let (c, p, gap) = (conditions.c, conditions.p / steady.omega, conditions.rig.gap);
    let amplitude = steady.amplitude();
    let a = c * c + p * p;
    let half = gap * c;
    // Square of the half distance of the roots times a, written so that it does not cancel.
    let discriminant = amplitude.powi(2) * a - (gap * p).powi(2);
    let product = (gap - amplitude) * (gap + amplitude) / a;
    let pair = (a > 0.0 && discriminant >= 0.0).then(|| {
        // The root in which the terms add up first, the other from their product.
        let first = -(half + discriminant.sqrt().copysign(half)) / a;
        let second = if first == 0.0 { 0.0 } else { product / first };
        [(first.max(second), true), (first.min(second), false)]
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
