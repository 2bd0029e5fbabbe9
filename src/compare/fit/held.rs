//! How well the points hold each parameter.

use super::super::prediction::Kind;
use super::coordinate::Coordinate;
use super::edge::Edge;
use super::problem::Problem;
use super::unknown::Unknown;
use crate::campaign::Parameter;
use crate::error::{Error, Result};
use nalgebra::{DMatrix, SVD};

/// A relative standard uncertainty beyond which a parameter, or a combination, is not held: half its value.
const LOOSE: f64 = 0.5;
/// A parameter between two bounds is not held where it may lie, with 95 % confidence, in more than this part of what is between them.
const WIDE: f64 = 0.5;
/// Normal deviate that is exceeded on both sides together in 5 % of cases.
pub const NORMAL: f64 = 1.959_964;
/// A part of a direction that makes a parameter belong to it.
const BELONGS: f64 = 0.2;
/// A parameter found below this part of where it started has gone to its lower bound.
const NOTHING: f64 = 1e-2;
/// Smallest singular value over the largest that a Jacobian by central differences can tell from 0, ε^(2/3).
const RESOLVED: f64 = 4e-11;

/// What the Jacobian at the minimum says.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Covariance of the coordinates u; directions that are not held have a large variance, not an infinite one.
    pub covariance: DMatrix<f64>,
    /// Why a parameter is not held; `None` for those that are.
    pub loose: Vec<Option<String>>,
    /// Relative standard uncertainty of each parameter.
    pub relative: Vec<f64>,
    /// Where a parameter lies at the end of where it may.
    pub edges: Vec<Option<Edge>>,
}

impl Held {
    /// From the Jacobian ∂r/∂u of residuals of unit variance.
    ///
    /// The columns are taken for relative changes of the parameters, ∂r/∂ln θ, so that units do not decide what is small. With singular
    /// values s and right vectors v the variance of ln θᵢ is Σ vᵢ²/s²: a direction of 1/s above one half is not held by the points, and a
    /// parameter that gets most of its variance from such directions isn't either.
    ///
    /// # Errors
    /// If the singular values cannot be found.
    pub fn new(
        problem: &Problem<'_>,
        u: &[f64],
        jacobian: &DMatrix<f64>,
        edges: Vec<Option<Edge>>,
    ) -> Result<Held> {
        let setting = problem.setting(u);
        let n = u.len();
        // d ln θ/du.
        let rates: Vec<f64> = problem
            .unknowns
            .iter()
            .zip(u)
            .map(|(k, u)| k.coordinate.slope(*u) / setting.get(k.parameter).abs())
            .map(|rate| if rate.is_finite() && rate > 0.0 { rate } else { f64::MIN_POSITIVE.sqrt() })
            .collect();
        let mut scaled = DMatrix::zeros(jacobian.nrows().max(n), n);
        for (i, rate) in rates.iter().enumerate() {
            for row in 0..jacobian.nrows() {
                scaled[(row, i)] = jacobian[(row, i)] / rate;
            }
        }
        let unfound = || Error::refused("the singular values of the fit were not found");
        if scaled.iter().any(|v| !v.is_finite()) {
            return Err(unfound());
        }
        // An iteration limit, since the algorithm has no bound of its own.
        let svd = SVD::try_new(scaled, false, true, f64::EPSILON, 10_000).ok_or_else(unfound)?;
        let v = svd.v_t.ok_or_else(unfound)?;
        let floor = (svd.singular_values.max() * RESOLVED).max(1e-12);
        let s: Vec<f64> = svd.singular_values.iter().map(|s| s.max(floor)).collect();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let sum: f64 = s.iter().enumerate().map(|(k, s)| v[(k, i)] * v[(k, j)] / (s * s)).sum();
            sum / (rates[i] * rates[j])
        });
        let relative: Vec<f64> = (0..n).map(|i| covariance[(i, i)].sqrt() * rates[i]).collect();
        let names: Vec<&str> = problem.unknowns.iter().map(|k| k.parameter.name()).collect();
        let reason = |i: usize| {
            // The direction from which it gets most of its variance.
            let share = |k: &usize| (v[(*k, i)] / s[*k]).abs();
            let k = (0..n).max_by(|a, b| share(a).total_cmp(&share(b)))?;
            let influence = jacobian.column(i).norm() / rates[i];
            let alone = || {
                Some(alone(
                    problem,
                    i,
                    setting.get(problem.unknowns[i].parameter),
                    influence,
                    edges[i].as_ref(),
                ))
            };
            if edges[i].is_some() {
                return alone();
            }
            let Unknown { coordinate, .. } = problem.unknowns[i];
            if coordinate.high.is_finite() {
                let [low, high] = coordinate.interval(u[i], NORMAL * covariance[(i, i)].sqrt());
                let part = (high - low) / (coordinate.high - coordinate.low);
                if part <= WIDE {
                    return None;
                }
            } else if relative[i] <= LOOSE {
                return None;
            }
            let others: Vec<usize> = (0..n).filter(|j| *j != i && v[(k, *j)].abs() > BELONGS).collect();
            if others.is_empty() || v[(k, i)].abs() <= BELONGS || 1.0 / s[k] <= LOOSE {
                return alone();
            }
            let others: Vec<String> =
                others.iter().map(|j| format!("{} by {:+.2} %", names[*j], v[(k, *j)] / v[(k, i)])).collect();
            Some(format!(
                "the points hold only a combination of {} with others: they stay as they are where it changes by +1 % and {}",
                names[i],
                others.join(", ")
            ))
        };
        let loose = (0..n).map(reason).collect();
        Ok(Held { covariance, loose, relative, edges })
    }

    /// Correlation of two parameters.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)] / (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt()
    }

    /// The parameter that is known worst.
    pub fn worst(&self) -> usize {
        (0..self.relative.len()).max_by(|a, b| self.relative[*a].total_cmp(&self.relative[*b])).unwrap_or(0)
    }
}

/// Why the parameter number `i` is not held on its own account; `influence` is the length of ∂r/∂ln θ at its `value`.
fn alone(problem: &Problem<'_>, i: usize, value: f64, influence: f64, edge: Option<&Edge>) -> String {
    let parameter = problem.unknowns[i].parameter;
    let impacts = problem.kinds.contains(&Some(Kind::Impacting));
    let needs = matches!(
        parameter,
        Parameter::Restitution | Parameter::C2 | Parameter::K2 | Parameter::Gap | Parameter::M2
    );
    if !impacts && needs {
        return "no point of the fit shows a motion with impacts, and the others do not depend on it"
            .to_owned();
    }
    let Coordinate { low, high } = problem.unknowns[i].coordinate;
    if value < NOTHING * problem.base.get(parameter) {
        return format!("the points do not tell it from {low}");
    }
    if influence < 1e-6 {
        return "no point of the fit depends on it".to_owned();
    }
    if let Some(edge) = edge {
        return format!("the points do not tell it from {}, farther than which it does not go", edge.value);
    }
    if high.is_finite() {
        return format!("with 95 % confidence it lies in more than half of all from {low} to {high}");
    }
    "twice or half of it would leave the points within their uncertainty".to_owned()
}
