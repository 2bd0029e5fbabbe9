//! Uncertainty of each parameter θ: from the Jacobian at the minimum of the sum of squares, and from its
//! profile.
//!
//! u is the fitted coordinate of a parameter: √(θ − lower bound), or between two bounds the logit of its
//! relative position ([`Coordinate`](super::unknown::Coordinate)).

use super::{LeastSquares, MotionKind, Problem};
use crate::error::{Error, Result};
use crate::model::Parameter;
use crate::record::uncertain;
use nalgebra::{DMatrix, DVector, SVD};
use rayon::prelude::*;
use serde::Serialize;

/// Normal deviate of a two-sided 95 % interval (Abramowitz & Stegun, table 26.1).
pub const NORMAL: f64 = 1.959_964;
/// Largest relative standard uncertainty of an identifiable parameter: beyond it, half or twice the value
/// would fit. For a parameter with two bounds the measure is instead the width of the 95 % interval divided
/// by the distance of the bounds.
const LOOSE: f64 = 0.5;
/// Correlation r beyond which two parameters are known only in combination: knowing one would divide the
/// uncertainty of the other by 1/√(1 − r²) = 3.
const TIED: f64 = 0.95;
/// Smallest singular value, relative to the largest, that a Jacobian by central differences distinguishes
/// from 0: about ε^(2/3).
const RESOLVED: f64 = 4e-11;
/// A parameter lies at its limit if their distance in u is at most this, times 1 + |u|: far below what data
/// resolve.
const AT_LIMIT: f64 = 1e-6;
/// Step inwards for the derivatives at a limit, relative to u there: larger steps err by curvature, smaller
/// by rounding.
const INWARDS: f64 = 1e-2;

/// Why a parameter is not identifiable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unidentified {
    /// No point shows a motion with impacts, and other motions do not depend on the parameter.
    NeedsImpacts,
    /// The parameter lies at a limit of its range, and the points are consistent with this limit.
    AtLimit,
    /// The points determine only a combination with other parameters.
    Combination,
    /// Half or twice its value, or most values between its bounds, would fit as well.
    TooUncertain,
    /// The whole answer is in doubt.
    InDoubt,
}

/// A parameter at the end of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Bound, in the unit of the parameter.
    pub value: f64,
    /// Distance beyond the bound to which the points would move the parameter, in standard deviations.
    pub pull: f64,
}

/// Uncertainties by the Jacobian at the minimum of the sum of squares.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Covariance of the coordinates u. The variance of a combination that the points do not determine is
    /// large, but finite.
    pub covariance: DMatrix<f64>,
    /// Relative standard uncertainty of each parameter.
    pub relative: Vec<f64>,
    /// Why a parameter is not identifiable; `None` for those that are.
    pub unidentified: Vec<Option<Unidentified>>,
    /// The limits at which parameters lie.
    pub limits: Vec<Option<Limit>>,
}

impl Uncertainty {
    /// Uncertainty of a minimum.
    ///
    /// The Jacobian ∂r/∂ln θ of the residuals r is for relative changes of the parameters, so that its
    /// singular values do not depend on units. With singular values s and right singular vectors v the
    /// variance of ln θᵢ is Σ vᵢ²/s².
    ///
    /// # Errors
    /// If the singular values cannot be computed.
    pub fn new(least: &LeastSquares<'_>) -> Result<Uncertainty> {
        let (problem, u) = (&least.problem, &least.minimum.parameters);
        let (setting, n) = (problem.setting(u), u.len());
        let mut jacobian = least.minimum.jacobian.clone();
        let at_limits: Vec<Option<(f64, f64)>> =
            (0..n).map(|i| at_limit(problem, u, i, &mut jacobian)).collect();
        // d ln |θ|/du of each parameter.
        let rates = DVector::from_fn(n, |i, _| {
            let unknown = &problem.unknowns[i];
            let rate = unknown.coordinate.slope(u[i]) / setting.get(unknown.parameter).abs();
            if rate.is_finite() && rate > 0.0 { rate } else { f64::MIN_POSITIVE.sqrt() }
        });
        let mut scaled = jacobian.clone().resize_vertically(jacobian.nrows().max(n), 0.0);
        for (mut column, rate) in scaled.column_iter_mut().zip(&rates) {
            column /= *rate;
        }
        let covariance = covariance(scaled)?.component_div(&(&rates * rates.transpose()));
        // Gauss–Newton step from the minimum: not 0 for a parameter that its limit keeps from the optimum.
        let step = -(&covariance * jacobian.tr_mul(&DVector::from_column_slice(&least.minimum.residuals)));
        let limit = |i: usize| {
            let (outwards, value) = at_limits[i]?;
            Some(Limit { value, pull: outwards * step[i] / covariance[(i, i)].sqrt() })
        };
        let mut found = Uncertainty {
            relative: (0..n).map(|i| covariance[(i, i)].sqrt() * rates[i]).collect(),
            limits: (0..n).map(limit).collect(),
            unidentified: Vec::new(),
            covariance,
        };
        found.unidentified = (0..n).map(|i| found.reason(problem, u, i)).collect();
        Ok(found)
    }

    /// Reason why parameter number `i` is not identifiable; `None` if it is.
    fn reason(&self, problem: &Problem<'_>, u: &[f64], i: usize) -> Option<Unidentified> {
        let parameter = problem.unknowns[i].parameter;
        let is_loose = |i: usize| {
            let coordinate = problem.unknowns[i].coordinate;
            let [low, high] = coordinate.interval(u[i], NORMAL * self.std(i));
            let width_share =
                coordinate.high.is_finite().then(|| (high - low) / (coordinate.high - coordinate.low));
            width_share.unwrap_or(self.relative[i]) > LOOSE
        };
        if !is_loose(i) && self.limits[i].is_none() {
            return None;
        }
        let without_impacts = !problem.kinds.contains(&Some(MotionKind::Impacting));
        Some(if parameter.needs_impacts() && without_impacts {
            Unidentified::NeedsImpacts
        } else if self.limits[i].is_some() {
            Unidentified::AtLimit
        } else if (0..u.len()).any(|j| j != i && is_loose(j) && self.is_tied(i, j)) {
            Unidentified::Combination
        } else {
            Unidentified::TooUncertain
        })
    }

    /// Standard uncertainty of coordinate number `i`.
    pub fn std(&self, i: usize) -> f64 {
        self.covariance[(i, i)].sqrt()
    }

    /// Correlation of two parameters.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)] / (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt()
    }

    /// Whether two parameters are known only in combination.
    pub(crate) fn is_tied(&self, i: usize, j: usize) -> bool {
        self.correlation(i, j).abs() > TIED
    }

    /// The parameter with the largest relative uncertainty.
    pub fn worst(&self) -> usize {
        (0..self.relative.len()).max_by(|a, b| self.relative[*a].total_cmp(&self.relative[*b])).unwrap_or(0)
    }
}

/// (JᵀJ)⁻¹ of a Jacobian with as many rows as columns or more. The variance of a combination that the
/// residuals do not determine is large, but finite.
///
/// # Errors
/// If the singular values cannot be computed.
pub fn covariance(jacobian: DMatrix<f64>) -> Result<DMatrix<f64>> {
    let not_computed = || Error::refused("the singular values of the fit were not found");
    if jacobian.iter().any(|v| !v.is_finite()) {
        return Err(not_computed());
    }
    // With an iteration limit, since the algorithm has no bound of its own.
    let svd = SVD::try_new(jacobian, false, true, f64::EPSILON, 10_000).ok_or_else(not_computed)?;
    let floor = (svd.singular_values.max() * RESOLVED).max(1e-12);
    let mut v = svd.v_t.ok_or_else(not_computed)?;
    for (mut row, s) in v.row_iter_mut().zip(&svd.singular_values) {
        row /= s.max(floor);
    }
    Ok(v.tr_mul(&v))
}

/// If parameter number `i` lies at a limit of its range, the direction outwards in u (1 or −1) and the bound;
/// else `None`.
///
/// The residuals are constant beyond a limit. So this replaces the parameter's column of the `jacobian` by
/// the derivative from the limit inwards.
fn at_limit(problem: &Problem<'_>, u: &[f64], i: usize, jacobian: &mut DMatrix<f64>) -> Option<(f64, f64)> {
    let (unknown, span) = (&problem.unknowns[i], AT_LIMIT * (1.0 + u[i].abs()));
    let (coordinate, limits) = (unknown.coordinate, unknown.limits(&problem.base));
    let [lowest, highest] = limits.map(|v| coordinate.of(v));
    let upper_bound = if coordinate.high.is_finite() { coordinate.high } else { limits[1] };
    let (limit, outwards, bound) = if u[i] <= lowest + span {
        (lowest, -1.0, coordinate.low)
    } else if u[i] >= highest - span {
        (highest, 1.0, upper_bound)
    } else {
        return None;
    };
    let h = -outwards * INWARDS * limit.abs().max(AT_LIMIT);
    let mut moved = u.to_vec();
    let mut residuals = |v: f64| {
        moved[i] = v;
        DVector::from_vec(problem.at(&moved))
    };
    jacobian.set_column(i, &((residuals(limit + h) - residuals(limit)) / h));
    Some((outwards, bound))
}

/// 95 % quantile of χ² with one degree of freedom (Abramowitz & Stegun, table 26.8).
const CHI2_95: f64 = 3.841;
/// Number of values of a profile on each side of the minimum.
const VALUES_PER_SIDE: i32 = 12;
/// Distance of the outermost values of a profile from the minimum, in standard uncertainties: twice that of
/// the ends of a 95 % interval.
const PROFILE_REACH: f64 = 4.0;

/// Profile of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Parameter.
    pub parameter: Parameter,
    /// Its SI unit.
    pub unit: &'static str,
    /// Values of the parameter in its unit, rising.
    pub value: Vec<f64>,
    /// Minimum of the sum of squares with the parameter fixed at each value, minus the overall minimum.
    pub rise: Vec<f64>,
    /// Rise at the ends of the 95 % confidence interval.
    pub limit: f64,
    /// 95 % confidence interval; `None` for an end that the profile does not reach, its rise below the limit
    /// at all values.
    pub interval: [Option<f64>; 2],
}

uncertain!(Profile: interval);

impl Profile {
    /// Depth of the lowest value of the profile below the minimum of the fit; 0 if none is lower.
    pub fn fall(&self) -> f64 {
        -self.rise.iter().copied().fold(0.0, f64::min)
    }
}

/// Profile likelihood of unknown number `which`, within its bounds (D. J. Venzon & S. H. Moolgavkar 1988).
pub fn profile(least: &LeastSquares<'_>, uncertainty: &Uncertainty, which: usize) -> Option<Profile> {
    let (problem, best) = (&least.problem, &least.minimum.parameters);
    let unknown = *problem.unknowns.get(which)?;
    let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let lowest = sum(&least.minimum.residuals);
    // Largest change of u: down to the lower bound; between two bounds, a factor of ten in the odds.
    let largest =
        if unknown.coordinate.high.is_infinite() { best[which].abs() } else { std::f64::consts::LN_10 };
    let reach = (PROFILE_REACH * uncertainty.std(which)).min(largest);
    let covariance = &uncertainty.covariance;
    let rise = |step: i32| {
        let offset = reach * f64::from(step) / f64::from(VALUES_PER_SIDE);
        let value = unknown.coordinate.value(best[which] + offset);
        let mut rest = problem.clone();
        rest.base = rest.base.with(unknown.parameter, value);
        rest.unknowns.remove(which);
        let prior = unknown.prior.map_or(0.0, |[v, s]| ((value - v) / s).powi(2));
        // The other coordinates start on the straight line along the valley of the sum of squares.
        let valley = covariance.column(which) * (offset / covariance[(which, which)]);
        let mut start: Vec<f64> = best.iter().zip(&valley).map(|(best, along)| best + along).collect();
        start.remove(which);
        let data = if start.is_empty() { rest.at(&[]) } else { rest.solve(&start).ok()?.residuals };
        Some((value, sum(&data) + prior - lowest))
    };
    let (value, rise): (Vec<f64>, Vec<f64>) =
        (-VALUES_PER_SIDE..=VALUES_PER_SIDE).into_par_iter().filter_map(rise).unzip();
    let middle = value.iter().position(|v| *v >= unknown.coordinate.value(best[which]))?;
    let below = crossing(value[..=middle].iter().zip(&rise[..=middle]).rev());
    let above = crossing(value[middle..].iter().zip(&rise[middle..]));
    Some(Profile {
        parameter: unknown.parameter,
        unit: unknown.parameter.unit(),
        value,
        rise,
        limit: CHI2_95,
        interval: [below, above],
    })
}

/// Value of the parameter at which the rise reaches [`CHI2_95`], by interpolation of its square root, which
/// is nearly linear.
fn crossing<'a>(points: impl Iterator<Item = (&'a f64, &'a f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.map(|(v, r)| (*v, r.max(0.0).sqrt())).collect();
    let (limit, above) = (CHI2_95.sqrt(), points.iter().position(|p| p.1 > CHI2_95.sqrt())?);
    let (a, b) = (points.get(above.checked_sub(1)?)?, points[above]);
    Some(a.0 + (limit - a.1) / (b.1 - a.1) * (b.0 - a.0))
}
