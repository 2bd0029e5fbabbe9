//! Parameters that went to the end of where they may lie.

use super::problem::Problem;
use super::unknown::{Unknown, limits};
use nalgebra::{DMatrix, DVector};

/// What is known of a parameter at its edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The edge itself.
    pub value: f64,
    /// ∂r/∂u from the edge inwards: across it nothing changes any more.
    pub column: DVector<f64>,
    /// The way outwards in u, 1 or −1.
    pub outwards: f64,
}

/// The edges at which parameters lie.
pub fn edges(problem: &Problem<'_>, u: &[f64]) -> Vec<Option<Edge>> {
    let one = |(i, unknown): (usize, &Unknown)| {
        let [low, high] = limits(&problem.base, unknown);
        let [least, most] = [low, high].map(|v| unknown.coordinate.of(v));
        let span = STEP * (1.0 + u[i].abs());
        let (edge, outwards) = if u[i] <= least + span {
            (least, -1.0)
        } else if u[i] >= most - span {
            (most, 1.0)
        } else {
            return None;
        };
        let at = |v: f64| {
            let mut u = u.to_vec();
            u[i] = v;
            DVector::from_vec(problem.at(&u))
        };
        let h = -outwards * INWARDS * edge.abs().max(STEP);
        let bound = if outwards < 0.0 { unknown.coordinate.low } else { unknown.coordinate.high };
        let value = if bound.is_finite() { bound } else { high };
        Some(Edge { value, column: (at(edge + h) - at(edge)) / h, outwards })
    };
    problem.unknowns.iter().enumerate().map(one).collect()
}

/// How near to its edge a parameter lies at it: far below what any point could tell.
const STEP: f64 = 1e-6;
/// Step inwards, as a part of u.
const INWARDS: f64 = 1e-2;
/// Standard deviations by which the points must pull a parameter over its edge to contradict it.
const PULLED: f64 = 3.0;

/// A sentence for each edge over which the points pull a parameter, all others following; `jacobian` and `residuals` those at the least.
///
/// With the column c of the parameter, less what the others' columns span of it, the sum of squares would be least at −cᵀr/cᵀc, which
/// has the standard deviation 1/|c|.
pub fn pulled(
    problem: &Problem<'_>,
    jacobian: &DMatrix<f64>,
    residuals: &[f64],
    edges: &[Option<Edge>],
) -> Vec<String> {
    let r = DVector::from_column_slice(residuals);
    let one = |(i, edge): (usize, &Option<Edge>)| {
        let edge = edge.as_ref()?;
        let others = jacobian.clone().remove_column(i);
        let own = if others.ncols() == 0 {
            edge.column.clone()
        } else {
            let svd = others.clone().svd(true, true);
            let part = svd.solve(&edge.column, 1e-9 * svd.singular_values.max()).ok()?;
            &edge.column - others * part
        };
        let z = -edge.outwards * own.dot(&r) / own.norm();
        (z > PULLED).then(|| {
            format!(
                "the points would have {} beyond {}, where it may not lie",
                problem.unknowns[i].parameter.name(),
                edge.value
            )
        })
    };
    edges.iter().enumerate().filter_map(one).collect()
}
