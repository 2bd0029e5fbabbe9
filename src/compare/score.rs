//! How well a sweep is predicted, and where it is not.

use super::forcing::median;
use super::pair::Pair;
use crate::record::Finding;
use serde::Serialize;

/// How well one sweep is predicted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Sweep.
    pub sweep: String,
    /// Points with a prediction.
    pub n: usize,
    /// Points without.
    pub without: usize,
    /// Predicted points with nothing to compare: both amplitudes are below the noise floor.
    pub faint: usize,
    /// Median of |measured − predicted| over the larger of both, at points that are not faint; `None` without such points.
    pub median_relative: Option<f64>,
    /// The largest of them.
    pub max_relative: Option<f64>,
    /// Excitation frequency of the largest in Hz.
    pub max_at: Option<f64>,
    /// Root mean square of measured − predicted, in m.
    pub rms: Option<f64>,
}

impl Pair {
    /// |measured − predicted| over the larger of both: twice or half as much as predicted is 50 %. `None` without a
    /// prediction, and where both lie within the noise.
    fn deviation(&self) -> Option<f64> {
        let (predicted, residual) = (self.predicted?, self.residual?);
        let larger = predicted.max(self.measured.value);
        let faint = self.upper_limit.is_some_and(|limit| predicted <= limit);
        (!faint && larger > 0.0).then_some(residual.abs() / larger)
    }
}

pub(super) fn score(sweep: &str, pairs: &[Pair]) -> Score {
    let squares: Vec<f64> = pairs.iter().filter_map(|p| p.residual).map(|r| r * r).collect();
    let deviations = pairs.iter().filter_map(|p| Some((p.deviation()?, p.frequency)));
    let largest = deviations.clone().max_by(|a, b| a.0.total_cmp(&b.0));
    let relative: Vec<f64> = deviations.map(|d| d.0).collect();
    let n = squares.len();
    Score {
        sweep: sweep.to_owned(),
        n,
        without: pairs.len() - n,
        faint: n - relative.len(),
        median_relative: median(relative),
        max_relative: largest.map(|l| l.0),
        max_at: largest.map(|l| l.1),
        rms: (n > 0).then(|| (squares.iter().sum::<f64>() / n as f64).sqrt()),
    }
}

/// A point is an outlier beyond this part of the larger amplitude: a sensor's calibration and its mounting stay below …
const FAR: f64 = 0.05;
/// … where it is also beyond so many standard uncertainties: chance takes one point of 1.7 million there.
const SIGMAS: f64 = 5.0;

/// Points far off the prediction, which a median hides.
pub(super) fn outliers(sweep: &str, pairs: &[Pair]) -> Option<Finding> {
    let certain =
        |p: &&Pair| p.measured.std.is_none_or(|std| p.residual.is_some_and(|r| r.abs() > SIGMAS * std));
    let far = pairs.iter().filter(certain).filter_map(|p| Some((p.deviation()?, p))).filter(|f| f.0 > FAR);
    let (_, worst) = far.clone().max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(
        Finding::caution("points-off-prediction")
            .about(sweep)
            .count("n", far.count())
            .number("frequency", worst.frequency)
            .number("measured", worst.measured.value)
            .number("predicted", worst.predicted?),
    )
}
