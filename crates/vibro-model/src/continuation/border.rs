//! Where stability ends: values that change their sign there.

use super::MarkKind;
use crate::PeriodicOrbit;
use nalgebra::{Matrix4, Matrix6};

/// A value that changes its sign where something happens.
pub type Test = fn(&PeriodicOrbit) -> Option<f64>;

/// det(M + I): changes its sign where a multiplier passes −1.
pub fn flip(orbit: &PeriodicOrbit) -> Option<f64> {
    orbit.monodromy.map(|m| (m + Matrix4::identity()).determinant())
}

/// det(M ∧ M − I), the product of λᵢλⱼ − 1 over all pairs of multipliers: changes its sign where a complex pair passes the unit circle
/// (bialternate product; J. Guckenheimer, M. Myers, B. Sturmfels 1997), and where two real multipliers become each other's inverse.
pub fn pair(orbit: &PeriodicOrbit) -> Option<f64> {
    const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let m = orbit.monodromy?;
    let wedge = Matrix6::from_fn(|r, c| {
        let ((i, j), (k, l)) = (PAIRS[r], PAIRS[c]);
        m[(i, k)] * m[(j, l)] - m[(i, l)] * m[(j, k)]
    });
    Some((wedge - Matrix6::identity()).determinant())
}

/// Whether the motion found is what the mark says, not a step of a test.
pub fn confirmed(kind: MarkKind, orbit: &PeriodicOrbit) -> bool {
    let near = |distance: &dyn Fn(&num_complex::Complex64) -> f64| {
        orbit.multipliers.is_some_and(|m| m.iter().any(|z| distance(z) < 1e-5))
    };
    match kind {
        MarkKind::Fold => true,
        MarkKind::Flip => near(&|z| (z + 1.0).norm()),
        MarkKind::NeimarkSacker => {
            near(&|z| if z.im.abs() > 1e-6 { (z.norm() - 1.0).abs() } else { f64::INFINITY })
        }
        MarkKind::Grazing => clearance(orbit).is_some_and(|c| c.abs() < 1e-6 * orbit.peak_to_peak[0]),
    }
}

/// Smallest gap inside the flights.
pub fn clearance(orbit: &PeriodicOrbit) -> Option<f64> {
    orbit.validity.clearance
}
