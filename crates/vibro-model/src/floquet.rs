//! Stability of a periodic motion with impacts: monodromy and Floquet multipliers.

use super::rig::Rig;
use nalgebra::{Matrix2, Matrix4, RowVector4, SVD, Schur, Vector4};
use num_complex::Complex64;
use vibro_record::{Error, Result};

/// Free flow Φ(t): matrix that carries a small disturbance of (x₁, v₁, x₂, v₂) over `t` (s). The force does
/// not enter, since it moves all neighbouring motions alike. A wall cannot be disturbed: its part is 0.
fn flow(rig: &Rig, t: f64) -> Matrix4<f64> {
    let mut phi = Matrix4::zeros();
    let moving = if rig.has_wall() { 1 } else { 2 };
    for (i, oscillator) in rig.oscillators().iter().enumerate().take(moving) {
        let ((a, b), (c, d)) = (oscillator.free(1.0, 0.0, t), oscillator.free(0.0, 1.0, t));
        phi.fixed_view_mut::<2, 2>(2 * i, 2 * i).copy_from(&Matrix2::new(a, c, b, d));
    }
    phi
}

/// Saltation matrix S = D + (f⁺ − D f⁻)nᵀ/(nᵀf⁻) of an impact (Müller 1995; Leine and Nijmeijer 2004). n =
/// ∇g is the gradient of the gap, D the matrix of the velocity change, f⁻ and f⁺ the rates of the state just
/// before and just after.
///
/// The determinant of S is R². Its elements grow like 1/vᵣ, with the approach speed vᵣ, when the impact
/// grazes.
fn saltation(rig: &Rig, before: &[f64; 4], after: &[f64; 4]) -> Matrix4<f64> {
    let mut jump = Matrix4::identity();
    let [first, second] = rig.masses().map(|mass| rig.exchange() / mass);
    jump[(1, 1)] -= first;
    jump[(1, 3)] += first;
    jump[(3, 1)] += second;
    jump[(3, 3)] -= second;
    let normal = RowVector4::new(-1.0, 0.0, 1.0, 0.0);
    let (before, after) = (Vector4::from(*before), Vector4::from(*after));
    jump + (after - jump * before) * normal / (normal * before)[0]
}

/// Monodromy Φ(T)S of a motion with one impact a period, from just before one impact to just before the next,
/// and a bound on its rounding in the Frobenius norm, for relative errors of ε in the arguments.
///
/// `before` and `after` are rates of the state (v₁, a₁, v₂, a₂) just before and after the impact. The bound
/// covers these errors: of the free flow, ε times its phase ΩT; of each sum or product of four terms, 4ε; of
/// the quotient in the saltation, the four terms of each acceleration; of the Schur form, a few ε of the
/// product. Together they are below 64 (1 + ΩT) ε times the norms of flow and saltation.
pub(super) fn monodromy(rig: &Rig, period: f64, before: &[f64; 4], after: &[f64; 4]) -> (Matrix4<f64>, f64) {
    let (flow, saltation) = (scaled(rig, flow(rig, period)), scaled(rig, saltation(rig, before, after)));
    let phase = rig.oscillators().iter().map(|o| o.omega2().sqrt() * period).fold(0.0, f64::max);
    let rounding = 64.0 * f64::EPSILON * (1.0 + phase) * (flow.norm() * saltation.norm());
    (flow * saltation, rounding)
}

/// A matrix for the states Ω₁x₁, v₁, Ω₂x₂, v₂ in place of x₁, v₁, x₂, v₂: its elements are velocities over
/// velocities, so that its norm is near its size, and rounding of small elements does not seem to hide large
/// ones. Eigenvalues and determinants are those of the matrix itself.
fn scaled(rig: &Rig, matrix: Matrix4<f64>) -> Matrix4<f64> {
    let unit = |omega2: f64| if omega2.is_finite() && omega2 > 0.0 { omega2.sqrt() } else { 1.0 };
    let [first, second] = rig.oscillators().map(|oscillator| unit(oscillator.omega2()));
    let units = [first, 1.0, second, 1.0];
    Matrix4::from_fn(|row, column| matrix[(row, column)] * units[row] / units[column])
}

/// Whether all multipliers lie inside the unit circle; `None` where an error of norm `rounding` in the
/// monodromy could move one onto it, and none lies outside with certainty.
///
/// Some matrix within `rounding` of M has the eigenvalue z exactly where the smallest singular value of M − z
/// does not exceed `rounding` (L. N. Trefethen and M. Embree, *Spectra and Pseudospectra* (2005), §2). This
/// also holds for double multipliers, however ill-conditioned they are.
pub(super) fn inside(monodromy: &Matrix4<f64>, multipliers: &[Complex64; 4], rounding: f64) -> Option<bool> {
    let open = |z: &Complex64| {
        let nearest = z / z.norm();
        // At this distance from the circle, rounding cannot move a multiplier onto it.
        if (z.norm() - 1.0).abs() > 0.1 {
            return false;
        }
        let moved = monodromy.map(Complex64::from) - Matrix4::from_diagonal_element(nearest);
        // The determinant follows from the multipliers, exact for a matrix within `rounding`.
        let determinant = multipliers.iter().map(|other| other - nearest).product::<Complex64>().norm();
        if singular_floor(determinant, moved.norm_squared()) > 2.0 * rounding {
            return false;
        }
        let svd = SVD::try_new(moved, false, false, f64::EPSILON, 1000);
        svd.is_none_or(|svd| svd.singular_values.min() <= rounding)
    };
    if multipliers.iter().any(|z| z.norm() > 1.0 && !open(z)) {
        return Some(false);
    }
    (!multipliers.iter().any(open)).then_some(true)
}

/// Lower bound on the smallest singular value of a 4 × 4 matrix from its determinant and the square of its
/// Frobenius norm, |det| ((n − 1)/‖·‖²)^((n − 1)/2) (Y. Yu and D. Gu, *Linear Algebra Appl.* 253 (1997) 25).
fn singular_floor(determinant: f64, norm_squared: f64) -> f64 {
    let share = 3.0 / norm_squared;
    determinant * share * share.sqrt()
}

/// Floquet multipliers: eigenvalues of the monodromy, largest modulus first.
///
/// # Errors
/// If the matrix has a value that is not finite, or the iteration does not converge.
pub(super) fn multipliers(monodromy: &Matrix4<f64>) -> Result<[Complex64; 4]> {
    let unsettled =
        || Error::refused("the Floquet multipliers could not be computed: the impact grazes too closely");
    if monodromy.iter().any(|v| !v.is_finite()) {
        return Err(unsettled());
    }
    let schur = Schur::try_new(*monodromy, f64::EPSILON, 1000).ok_or_else(unsettled)?;
    let mut values: [Complex64; 4] = schur.complex_eigenvalues().into();
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im)));
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn determinants_are_those_of_the_impact_and_of_the_dampers() {
        let cases = [
            (Rig::thesis(), 0.19),
            (Rig { restitution: 1.0, c1: 0.0, c2: 0.0, ..Rig::thesis() }, 0.09),
            (Rig { restitution: 0.2, c1: 9.0, c2: 0.5, ..Rig::thesis() }, 0.05),
        ];
        for (rig, period) in cases {
            let before = [0.3, -4.0, -0.1, 2.0];
            let share = rig.reduced_mass() * (1.0 + rig.restitution) * 0.4;
            let after = [0.3 - share / rig.m1, -3.5, -0.1 + share / rig.m2, 1.5];
            let s = saltation(&rig, &before, &after);
            // A determinant is a sum of 24 products of four elements.
            let rounding = |m: &Matrix4<f64>| 24.0 * f64::EPSILON * m.amax().powi(2).max(1.0);
            assert!((s.determinant() - rig.restitution.powi(2)).abs() < rounding(&s));
            let [b1, b2] = rig.oscillators().map(|o| o.decay());
            let expected = rig.restitution.powi(2) * (-2.0 * (b1 + b2) * period).exp();
            let (m, _) = monodromy(&rig, period, &before, &after);
            let found = multipliers(&m).unwrap().iter().product::<Complex64>();
            // Backward stable: the eigenvalues belong to a matrix that differs by a few ε‖M‖.
            let tolerance = 64.0 * f64::EPSILON * m.norm().powi(2).max(1.0);
            assert!((found - expected).norm() < tolerance, "{found} {expected}");
        }
    }

    #[test]
    fn the_floor_lies_below_the_smallest_singular_value() {
        // Random matrices with independent elements.
        let mut noise = vibro_math::Noise::new(20_261_120);
        let mut next = || noise.uniform() - 0.5;
        let mut closest: f64 = 0.0;
        for _ in 0..2000 {
            let matrix = Matrix4::from_fn(|_, _| Complex64::new(next(), next()));
            let least = matrix.singular_values().min();
            let floor = singular_floor(matrix.determinant().norm(), matrix.norm_squared());
            assert!(floor <= least * (1.0 + 1e-12), "{floor} {least}");
            closest = closest.max(floor / least);
        }
        // Equality holds for one small and three equal singular values: the bound is attained.
        assert!(closest > 0.5, "{closest}");
        let near = Matrix4::from_diagonal(&[1e-6, 1.0, 1.0, 1.0].map(Complex64::from).into());
        let floor = singular_floor(1e-6, near.norm_squared());
        assert!((floor / 1e-6 - 1.0).abs() < 1e-11, "{floor}");
    }

    #[test]
    fn multipliers_of_a_known_matrix() {
        // Companion matrix of (z − 0.9)(z + 0.5)(z² − 0.8z + 0.41), the last with roots 0.4 ± 0.5i.
        let m = Matrix4::new(
            1.2, -0.28, -0.196, 0.1845, //
            1.0, 0.0, 0.0, 0.0, //
            0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0,
        );
        let found = multipliers(&m).unwrap();
        let expected = [
            Complex64::new(0.9, 0.0),
            Complex64::new(0.4, 0.5),
            Complex64::new(0.4, -0.5),
            Complex64::new(-0.5, 0.0),
        ];
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).norm() < 1e-13, "{found:?}");
        }
    }

    #[test]
    fn a_grazing_impact_has_no_multipliers() {
        let (m, _) = monodromy(&Rig::thesis(), 0.2, &[0.0, 1.0, 0.0, 0.0], &[0.0, 1.0, 0.0, 2.0]);
        assert!(multipliers(&m).is_err());
    }
}
