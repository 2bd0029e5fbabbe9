//! The sum of squares over one parameter, all others free.

use super::settle::Least;
use super::uncertainty::Uncertainty;
use crate::campaign::Parameter;
use rayon::prelude::*;
use serde::Serialize;

/// χ² of one degree of freedom that is exceeded in 5 % of cases (Abramowitz & Stegun, table 26.8).
const ONE: f64 = 3.841;
/// Values on each side of the least.
const SIDE: i32 = 12;
/// They reach so many standard uncertainties, twice what the interval needs.
const REACH: f64 = 4.0;

/// Profile of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Parameter.
    pub parameter: Parameter,
    /// Its SI unit.
    pub unit: &'static str,
    /// Values, rising.
    pub value: Vec<f64>,
    /// Least sum of squares at each value above the least of all.
    pub rise: Vec<f64>,
    /// The rise that the true value stays below with 95 % confidence.
    pub limit: f64,
    /// Values within which the rise stays below it. `None` for a side on which it is not reached in the values.
    pub interval: [Option<f64>; 2],
}

impl Profile {
    /// How far it falls below the answer: 0 where that is the least sum of squares.
    pub fn fall(&self) -> f64 {
        -self.rise.iter().copied().fold(0.0, f64::min)
    }
}

/// Profile of the unknown number `which`, but not beyond a bound (D. J. Venzon & S. H. Moolgavkar 1988).
pub fn profile(least: &Least<'_>, uncertainty: &Uncertainty, which: usize) -> Option<Profile> {
    let (problem, best) = (&least.problem, &least.minimum.parameters);
    let unknown = *problem.unknowns.get(which)?;
    let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let lowest = sum(&least.minimum.residuals);
    // Down to the lower bound, or a factor of ten in the odds between two.
    let most =
        if unknown.coordinate.high.is_infinite() { best[which].abs() } else { std::f64::consts::LN_10 };
    let reach = (REACH * uncertainty.std(which)).min(most);
    let covariance = &uncertainty.covariance;
    let rise = |step: i32| {
        let away = reach * f64::from(step) / f64::from(SIDE);
        let value = unknown.coordinate.value(best[which] + away);
        let mut rest = problem.clone();
        rest.base = rest.base.with(unknown.parameter, value);
        rest.unknowns.remove(which);
        let prior = unknown.prior.map_or(0.0, |[v, s]| ((value - v) / s).powi(2));
        // Along the valley, as far as it is straight.
        let valley = covariance.column(which) * (away / covariance[(which, which)]);
        let mut start: Vec<f64> = best.iter().zip(&valley).map(|(best, along)| best + along).collect();
        start.remove(which);
        let data = if start.is_empty() { rest.at(&[]) } else { rest.solve(&start).ok()?.residuals };
        Some((value, sum(&data) + prior - lowest))
    };
    let (value, rise): (Vec<f64>, Vec<f64>) = (-SIDE..=SIDE).into_par_iter().filter_map(rise).unzip();
    let middle = value.iter().position(|v| *v >= unknown.coordinate.value(best[which]))?;
    let below = crossing(value[..=middle].iter().zip(&rise[..=middle]).rev());
    let above = crossing(value[middle..].iter().zip(&rise[middle..]));
    Some(Profile {
        parameter: unknown.parameter,
        unit: unknown.parameter.unit(),
        value,
        rise,
        limit: ONE,
        interval: [below, above],
    })
}

/// Where the rise reaches [`ONE`]; its root is nearly straight.
fn crossing<'a>(points: impl Iterator<Item = (&'a f64, &'a f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.map(|(v, r)| (*v, r.max(0.0).sqrt())).collect();
    let (limit, above) = (ONE.sqrt(), points.iter().position(|p| p.1 > ONE.sqrt())?);
    let (a, b) = (points.get(above.checked_sub(1)?)?, points[above]);
    Some(a.0 + (limit - a.1) / (b.1 - a.1) * (b.0 - a.0))
}
