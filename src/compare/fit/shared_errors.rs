//! Errors that several residuals share.

use nalgebra::{DMatrix, SVD};

/// Errors that move several residuals at once: frequency and force of a step, the calibrations of all points of a mass.
///
/// With W the change of the residuals, in their standard deviations, by one standard uncertainty of each error, their covariance is
/// `I + WWᵀ`. With `W = VSQᵀ` they are multiplied by its inverse square root `I − V (I − (I + S²)^(−1/2)) Vᵀ`: generalised least squares
/// (A. C. Aitken 1935), as if each error were an unknown with a prior, found with the rest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SharedErrors {
    /// Columns of V, each of length 1, and S.
    directions: Vec<(Vec<f64>, f64)>,
}

impl SharedErrors {
    /// From the columns of W; none where all are 0.
    pub fn new(columns: &[Vec<f64>]) -> SharedErrors {
        let rows = columns.first().map_or(0, Vec::len);
        let w = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]);
        let usable = rows > 0 && w.iter().all(|v| v.is_finite()) && w.amax() > 0.0;
        // With an iteration limit, since the algorithm has no bound of its own.
        let Some(svd) = usable.then(|| SVD::try_new(w, true, false, f64::EPSILON, 10_000)).flatten() else {
            return SharedErrors::default();
        };
        let v = svd.u.iter().flat_map(|u| u.column_iter().map(|c| c.iter().copied().collect::<Vec<f64>>()));
        SharedErrors { directions: v.zip(svd.singular_values.iter().copied()).collect() }
    }

    /// Whitens residuals in units of standard deviations that are `widened` times as large as stated.
    pub(crate) fn whiten(&self, residuals: &mut [f64], widened: f64) {
        for (v, s) in &self.directions {
            // V's columns are orthogonal: each takes off its own part.
            let along: f64 = v.iter().zip(residuals.iter()).map(|(v, r)| v * r).sum();
            let off = along * (1.0 - 1.0 / (s / widened).hypot(1.0));
            residuals.iter_mut().zip(v).for_each(|(r, v)| *r -= off * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition: rᵀ(I + WWᵀ)⁻¹r by a plain inverse, for columns that are neither at right angles nor small.
    #[test]
    fn squares_sum_to_the_definition() {
        let columns: [Vec<f64>; 3] =
            [vec![1.0, 2.0, -0.5, 3.0, 0.1], vec![0.5, 2.0, 0.0, 2.5, -1.0], vec![0.0, 0.0, 30.0, 1.0, 0.0]];
        let r = [0.3, -1.0, 2.0, 0.7, -0.2];
        for widened in [1.0, 2.5] {
            let w = DMatrix::from_fn(5, 3, |i, j| columns[j][i] / widened);
            let covariance = DMatrix::identity(5, 5) + &w * w.transpose();
            let column = nalgebra::DVector::from_row_slice(&r);
            let expected = column.dot(&(covariance.try_inverse().unwrap() * &column));
            let mut white = r;
            SharedErrors::new(&columns).whiten(&mut white, widened);
            let sum: f64 = white.iter().map(|r| r * r).sum();
            // The largest eigenvalue of the covariance, 900, times rounding.
            assert!((sum / expected - 1.0).abs() < 1e-12, "{sum} {expected}");
        }
    }

    #[test]
    fn without_errors_nothing_changes() {
        for columns in [&[][..], &[vec![0.0; 4]], &[vec![f64::NAN; 4]]] {
            let mut r = [1.0, 2.0, 3.0, 4.0];
            SharedErrors::new(columns).whiten(&mut r, 1.0);
            assert_eq!(r, [1.0, 2.0, 3.0, 4.0]);
        }
    }

    /// Against the definition for two residuals, C^(−1/2) C C^(−1/2) = I, for errors small and large, along each other and not.
    #[test]
    fn the_covariance_of_white_residuals_is_one() {
        for errors in [
            [[0.0, 0.0], [0.0, 0.0]],
            [[3.0, 0.0], [0.1, 0.0]],
            [[0.3, -0.2], [1.0, 2.0]],
            [[1e3, 2e3], [5e2, 1e3]],
            [[1e4, 1.0], [-1.0, 1e4]],
        ] {
            let shared = SharedErrors::new(&errors.map(|w| w.to_vec()));
            let c = |i: usize, j: usize| {
                f64::from(u8::from(i == j)) + errors.iter().map(|w| w[i] * w[j]).sum::<f64>()
            };
            let columns = [[1.0, 0.0], [0.0, 1.0]].map(|mut column| {
                shared.whiten(&mut column, 1.0);
                column
            });
            for (i, a) in columns.iter().enumerate() {
                for (j, b) in columns.iter().enumerate() {
                    let pairs = (0..2).flat_map(|k| (0..2).map(move |l| (k, l)));
                    let sum: f64 = pairs.map(|(k, l)| a[k] * c(k, l) * b[l]).sum();
                    // Sums of C that cancel down to 1: three roundings in each whitened entry, two in a product, three in the sum.
                    let tolerance = 11.0 * f64::EPSILON * (c(0, 0) + c(1, 1));
                    assert!(
                        (sum - f64::from(u8::from(i == j))).abs() < tolerance,
                        "{errors:?}: {i} {j} {sum}"
                    );
                }
            }
        }
    }
}
