//! Errors that all points of a mass share.

use nalgebra::{DMatrix, SVD};

/// Directions in which calibrations move all residuals at once, and how far.
///
/// A sensor's calibration errs by one factor for all its points, and by a slope over the frequencies. With W the change of the residuals by
/// one standard uncertainty of each, their covariance is `I + WWᵀ`, and with `W = VSQᵀ` they are multiplied by its inverse square root
/// `I − V (I − (I + S²)^(−1/2)) Vᵀ`: as if each error were an unknown with a prior, and found with the rest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Calibration {
    /// Columns of V, each of length 1, and S.
    directions: Vec<(Vec<f64>, f64)>,
}

impl Calibration {
    /// From the columns of W; none where all are 0.
    pub fn new(columns: &[Vec<f64>]) -> Calibration {
        let rows = columns.first().map_or(0, Vec::len);
        let w = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]);
        let usable = rows > 0 && w.iter().all(|v| v.is_finite()) && w.amax() > 0.0;
        let Some(svd) = usable.then(|| SVD::try_new(w, true, false, f64::EPSILON, 10_000)).flatten() else {
            return Calibration::default();
        };
        let v = svd.u.iter().flat_map(|u| u.column_iter().map(|c| c.iter().copied().collect::<Vec<f64>>()));
        Calibration { directions: v.zip(svd.singular_values.iter().copied()).collect() }
    }

    /// Residuals in units of standard deviations that are `widened` as much, with these errors allowed for.
    pub fn allow(&self, residuals: &mut [f64], widened: f64) {
        for (v, s) in &self.directions {
            // V's columns are at right angles: each takes off its own part.
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
            let mut allowed = r;
            Calibration::new(&columns).allow(&mut allowed, widened);
            let sum: f64 = allowed.iter().map(|r| r * r).sum();
            // The largest eigenvalue of the covariance, 900, times rounding.
            assert!((sum / expected - 1.0).abs() < 1e-12, "{sum} {expected}");
        }
    }

    #[test]
    fn without_errors_nothing_changes() {
        for columns in [&[][..], &[vec![0.0; 4]], &[vec![f64::NAN; 4]]] {
            let mut r = [1.0, 2.0, 3.0, 4.0];
            Calibration::new(columns).allow(&mut r, 1.0);
            assert_eq!(r, [1.0, 2.0, 3.0, 4.0]);
        }
    }
}
