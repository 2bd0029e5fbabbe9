//! The sum of squares over one parameter, all others free.

use super::held::Held;
use super::settle::Settled;
use super::unknown::Unknown;
use crate::campaign::Parameter;
use rayon::prelude::*;
use serde::Serialize;

/// χ² of one degree of freedom that is exceeded in 5 % of cases (Abramowitz & Stegun, table 26.8).
const ONE: f64 = 3.841;
/// Values on each side of the minimum.
const SIDE: i32 = 12;

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
    /// Coordinates of all unknowns where the rise is least.
    #[serde(skip)]
    pub lowest: Vec<f64>,
}

/// A profile that falls so far below the answer has found a better one.
const LOWER: f64 = 0.1;
/// By one the sum rises within one standard uncertainty.
const MISSED: f64 = 1.0;

impl Profile {
    /// How far the profile falls below the answer.
    fn fall(&self) -> f64 {
        -self.rise.iter().copied().fold(0.0, f64::min)
    }

    /// Coordinates of a better answer, where the profile has found one.
    pub fn lower(&self) -> Option<&[f64]> {
        (self.fall() > LOWER).then_some(self.lowest.as_slice())
    }

    /// That the answer is not the least sum of squares, where it is not.
    pub fn missed(&self) -> Option<String> {
        (self.fall() > MISSED).then(|| {
            format!(
                "beside the answer {} has values of a smaller sum of squares, by {:.1}: the least was not found",
                self.parameter.name(),
                self.fall()
            )
        })
    }
}

/// Profile of the unknown number `which`, over four standard uncertainties on both sides, but not beyond a bound.
pub fn profile(settled: &Settled<'_>, held: &Held, which: usize) -> Option<Profile> {
    let problem = &settled.problem;
    let best = &settled.minimum.parameters;
    let unknown = *problem.unknowns.get(which)?;
    let std = held.covariance[(which, which)].sqrt();
    // Down to the lower bound, or a factor of ten in the odds between two.
    let most =
        if unknown.coordinate.high.is_infinite() { best[which].abs() } else { std::f64::consts::LN_10 };
    let reach = (4.0 * std).min(most);
    let least: f64 = settled.minimum.residuals.iter().map(|r| r * r).sum();
    let others: Vec<Unknown> =
        problem.unknowns.iter().enumerate().filter(|(i, _)| *i != which).map(|(_, k)| *k).collect();
    let rise = |step: i32| {
        let away = reach * f64::from(step) / f64::from(SIDE);
        let value = unknown.coordinate.value(best[which] + away);
        let mut rest = problem.clone();
        rest.base = rest.base.with(unknown.parameter, value);
        rest.unknowns.clone_from(&others);
        let prior = unknown.prior.map_or(0.0, |[v, s]| ((value - v) / s).powi(2));
        // Along the valley, as far as it is straight.
        let start: Vec<f64> = (0..best.len())
            .filter(|j| *j != which)
            .map(|j| best[j] + away * (held.covariance[(j, which)] / held.covariance[(which, which)]))
            .collect();
        let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let (sum, mut u) = if others.is_empty() {
            (sum(&rest.at(&[])), Vec::new())
        } else {
            let minimum = rest.solve(&start).ok()?;
            (sum(&minimum.residuals), minimum.parameters)
        };
        u.insert(which, best[which] + away);
        Some((value, sum + prior - least, u))
    };
    let points: Vec<(f64, f64, Vec<f64>)> = (-SIDE..=SIDE).into_par_iter().filter_map(rise).collect();
    let lowest = points.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|p| p.2.clone())?;
    let (value, rise): (Vec<f64>, Vec<f64>) = points.into_iter().map(|p| (p.0, p.1)).unzip();
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
        lowest,
    })
}

/// Where the rise reaches [`ONE`]; its root is nearly straight.
fn crossing<'a>(points: impl Iterator<Item = (&'a f64, &'a f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.map(|(v, r)| (*v, r.max(0.0).sqrt())).collect();
    let limit = ONE.sqrt();
    points.windows(2).find(|w| w[0].1 <= limit && w[1].1 > limit).map(|w| {
        let part = (limit - w[0].1) / (w[1].1 - w[0].1);
        w[0].0 + part * (w[1].0 - w[0].0)
    })
}
