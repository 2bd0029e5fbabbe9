//! Cubic splines with even knots through scattered points, by least squares.

use std::ops::Range;

/// Coefficients of a cubic spline that a knot interval depends on.
const ORDER: usize = 4;

/// A uniform cubic B-spline (C. de Boor, *A Practical Guide to Splines*, 1978, ch. IX).
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    start: f64,
    step: f64,
    coefficients: Vec<f64>,
}

impl Spline {
    /// Least squares through points (x, y) with `knots` intervals of `step` from `start`; a slight penalty on curvature decides
    /// where there are no points. Time and memory grow with the knots and with the points. `None` where the points decide nothing.
    pub fn through(points: &[(f64, f64)], start: f64, step: f64, knots: usize) -> Option<Spline> {
        let n = knots + ORDER - 1;
        // Row i of the normal matrix: its diagonal, then what stands 1, 2, 3 places before it.
        let mut normal = vec![[0.0; ORDER]; n];
        let mut right = vec![0.0; n];
        for (x, y) in points {
            let Some((first, weights)) = basis((x - start) / step, knots) else { continue };
            for (i, a) in weights.iter().enumerate() {
                right[first + i] += a.0 * y;
                for (j, b) in weights[..=i].iter().enumerate() {
                    normal[first + i][i - j] += a.0 * b.0;
                }
            }
        }
        let penalty = 1e-6 * points.len() as f64 / n as f64;
        for last in 2..n {
            for (i, a) in [1.0, -2.0, 1.0].iter().enumerate() {
                for (j, b) in [1.0, -2.0, 1.0][..=i].iter().enumerate() {
                    normal[last - 2 + i][i - j] += penalty * a * b;
                }
            }
        }
        Some(Spline { start, step, coefficients: solved(normal, right)? })
    }

    /// Value and slope at `x`; beyond its ends the spline goes on straight, since a break there would keep a match from converging.
    pub fn at(&self, x: f64) -> (f64, f64) {
        let knots = self.coefficients.len() + 1 - ORDER;
        let u = (x - self.start) / self.step;
        let inside = u.clamp(0.0, knots as f64);
        let Some((first, weights)) = basis(inside, knots) else { return (0.0, 0.0) };
        let sum = |f: &dyn Fn(&(f64, f64)) -> f64| {
            weights.iter().zip(&self.coefficients[first..]).map(|(w, c)| f(w) * c).sum::<f64>()
        };
        let slope = sum(&|w| w.1);
        (sum(&|w| w.0) + slope * (u - inside), slope / self.step)
    }

    /// From the first to the last knot.
    pub fn span(&self) -> Range<f64> {
        self.start..self.start + self.step * (self.coefficients.len() + 1 - ORDER) as f64
    }
}

/// Solves a symmetric system of four bands by Cholesky's factors (Golub and Van Loan, *Matrix Computations*, 4.3.5).
fn solved(mut rows: Vec<[f64; ORDER]>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for i in 0..n {
        let reach = i.min(ORDER - 1);
        for k in (0..=reach).rev() {
            let known: f64 = (k + 1..=reach).map(|m| rows[i][m] * rows[i - k][m - k]).sum();
            let rest = rows[i][k] - known;
            rows[i][k] = if k > 0 { rest / rows[i - k][0] } else { rest.sqrt() };
        }
        if rows[i][0].is_nan() || rows[i][0] <= 0.0 {
            return None;
        }
        let known: f64 = (1..=reach).map(|k| rows[i][k] * right[i - k]).sum();
        right[i] = (right[i] - known) / rows[i][0];
    }
    for i in (0..n).rev() {
        let known: f64 = (1..=(n - 1 - i).min(ORDER - 1)).map(|k| rows[i + k][k] * right[i + k]).sum();
        right[i] = (right[i] - known) / rows[i][0];
    }
    Some(right)
}

/// First coefficient, and values and slopes of the four basis functions, at `u` knots from the start; `None` outside.
fn basis(u: f64, knots: usize) -> Option<(usize, [(f64, f64); ORDER])> {
    if !(0.0..=knots as f64).contains(&u) {
        return None;
    }
    let first = (u as usize).min(knots - 1);
    let x = u - first as f64;
    let y = 1.0 - x;
    Some((
        first,
        [
            (y * y * y / 6.0, -0.5 * y * y),
            ((3.0 * x - 6.0) * x * x / 6.0 + 2.0 / 3.0, (1.5 * x - 2.0) * x),
            ((3.0 * y - 6.0) * y * y / 6.0 + 2.0 / 3.0, -(1.5 * y - 2.0) * y),
            (x * x * x / 6.0, 0.5 * x * x),
        ],
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn bands_are_solved_as_the_whole_matrix_is() {
        let n = 9;
        let rows: Vec<[f64; ORDER]> =
            (0..n).map(|i| [6.0 + i as f64, -1.5, 0.7 - 0.1 * i as f64, 0.3]).collect();
        let right: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let whole = DMatrix::from_fn(n, n, |i, j| rows[i.max(j)].get(i.abs_diff(j)).copied().unwrap_or(0.0));
        let expected = whole.lu().solve(&DVector::from_vec(right.clone())).unwrap();
        for (a, b) in solved(rows, right).unwrap().iter().zip(expected.iter()) {
            // Some ten roundings of numbers below 1.
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
        assert!(solved(vec![[-1.0, 0.0, 0.0, 0.0]], vec![1.0]).is_none());
    }
}
