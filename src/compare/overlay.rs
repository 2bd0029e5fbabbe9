//! Pairs of measured and predicted amplitudes, their peaks, and a score.

use super::observable::Observable;
use super::prediction::{Kind, Motion, Prediction};
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::peaks::{local_maxima, vertex};
use crate::measure::resonance::Resonance;
use crate::measure::response::Response;
use crate::model::Rig;
use crate::record::Direction;
use serde::Serialize;

/// One measured amplitude and its prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// Sweep.
    pub sweep: String,
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Measured amplitude in m.
    pub measured: Estimate,
    /// Predicted amplitude in m; `None` where no motion of the closed form can be seen.
    pub predicted: Option<f64>,
    /// Kind of the predicted motion.
    pub motion: Option<Kind>,
    /// Measured minus predicted in m.
    pub residual: Option<f64>,
}

/// A measured resonance and the predicted one nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakPair {
    /// Sweep.
    pub sweep: String,
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// `grazing`, `clapping` or `resonance`.
    pub kind: String,
    /// Measured frequency in Hz, with its uncertainty.
    pub measured_frequency: Estimate,
    /// Predicted frequency in Hz.
    pub predicted_frequency: Option<f64>,
    /// Measured minus predicted frequency in Hz.
    pub frequency_difference: Option<f64>,
    /// Measured amplitude in m.
    pub measured_amplitude: Estimate,
    /// Predicted amplitude in m.
    pub predicted_amplitude: Option<f64>,
    /// Measured over predicted amplitude, less one.
    pub amplitude_difference: Option<f64>,
}

/// How well one sweep is predicted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Sweep.
    pub sweep: String,
    /// Points with a prediction.
    pub n: usize,
    /// Points without.
    pub without: usize,
    /// Median of |measured/predicted − 1|; `None` without points.
    pub median_relative: Option<f64>,
    /// Root mean square of measured − predicted, in m.
    pub rms: Option<f64>,
}

/// A whole comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overlay {
    /// Force amplitude of the prediction in N.
    pub force: f64,
    /// Point by point.
    pub pairs: Vec<Pair>,
    /// Peak by peak.
    pub peaks: Vec<PeakPair>,
    /// Sweep by sweep.
    pub scores: Vec<Score>,
    /// What was assumed.
    pub warnings: Vec<String>,
    /// The curve for figures.
    #[serde(skip)]
    pub curve: Prediction,
}

/// Frequencies of the predicted curve.
const CURVE: usize = 1200;

/// Overlays measured displacement responses (fundamentals of spectra) on the closed-form prediction. `force` in N; `None`
/// takes the median of the measured force.
///
/// # Errors
/// If no response names its mass and direction, no force is known, or the rig is impossible.
pub fn overlay(rig: &Rig, force: Option<f64>, responses: &[Response]) -> Result<Overlay> {
    let usable: Vec<(&Response, u8, Direction)> = responses
        .iter()
        .filter(|r| r.quantity == "displacement")
        .filter_map(|r| Some((r, r.mass?, r.direction?)))
        .collect();
    let mut warnings = Vec::new();
    if usable.len() < responses.len() {
        warnings.push(format!(
            "{} response(s) are left out of the overlay: they do not name their mass, have no direction, or are no displacement.",
            responses.len() - usable.len()
        ));
    }
    let frequencies = || usable.iter().flat_map(|u| &u.0.points).map(|p| p.excitation);
    let (low, high) = frequencies().fold((f64::INFINITY, 0.0f64), |(a, b), f| (a.min(f), b.max(f)));
    if low > high {
        return Err(Error::refused("no response can be overlaid on the model")
            .hint("give `mass = 1` or `2` for each sweep, and three or more points in one direction"));
    }
    let force = choose_force(force, &usable, &mut warnings)?;
    let margin = 0.02 * (high - low);
    let range = ((low - margin).max(low / 2.0), high + margin);
    let curve = Prediction::over(rig, force, range, CURVE, Observable::Fundamental)?;
    let mut overlay =
        Overlay { force, pairs: Vec::new(), peaks: Vec::new(), scores: Vec::new(), warnings, curve };
    for (response, mass, direction) in usable {
        let pairs = pairs(rig, force, response, mass, direction)?;
        overlay.scores.push(score(&response.name, &pairs));
        overlay.pairs.extend(pairs);
        let peaks = peaks(response, mass, direction, &overlay.curve);
        overlay.peaks.extend(peaks);
    }
    let without: usize = overlay.scores.iter().map(|s| s.without).sum();
    if without > 0 {
        overlay.warnings.push(format!(
            "At {without} point(s) the closed form has no motion that can be seen (one impact a cycle, or none): nothing is predicted there."
        ));
    }
    Ok(overlay)
}

/// The stated force, checked against the measured one; the measured one where none is stated.
fn choose_force(
    stated: Option<f64>,
    usable: &[(&Response, u8, Direction)],
    warnings: &mut Vec<String>,
) -> Result<f64> {
    let mut measured: Vec<f64> = usable.iter().flat_map(|u| &u.0.points).filter_map(|p| p.force).collect();
    measured.sort_by(f64::total_cmp);
    let median = median(&measured);
    if let Some(force) = stated.or(median) {
        let worst = measured.iter().map(|m| (m / force - 1.0).abs()).fold(0.0, f64::max);
        if worst > 0.05 {
            warnings.push(format!(
                "The measured force strays by up to {:.0} % from the {force:.4} N of the prediction, which holds one force for all points.",
                100.0 * worst
            ));
        }
    }
    match (stated, median) {
        (Some(stated), median) => {
            if let Some(median) = median.filter(|m| (m / stated - 1.0).abs() > 0.02) {
                warnings.push(format!(
                    "The force is stated as {stated} N, but its measured median is {median:.4} N; the stated one is used."
                ));
            }
            Ok(stated)
        }
        (None, Some(median)) => {
            warnings.push(format!(
                "No force is stated: the prediction uses the median of the measured one, {median:.4} N."
            ));
            Ok(median)
        }
        (None, None) => Err(Error::refused("the force is neither stated nor measured")
            .hint("give [excitation] force = … in N in the campaign")),
    }
}

/// Median of sorted values.
fn median(sorted: &[f64]) -> Option<f64> {
    let middle = sorted.len() / 2;
    let upper = *sorted.get(middle)?;
    Some(if sorted.len().is_multiple_of(2) { f64::midpoint(sorted[middle - 1], upper) } else { upper })
}

fn pairs(rig: &Rig, force: f64, response: &Response, mass: u8, direction: Direction) -> Result<Vec<Pair>> {
    let mut order: Vec<usize> = (0..response.points.len()).collect();
    order.sort_by(|a, b| response.points[*a].excitation.total_cmp(&response.points[*b].excitation));
    let frequency: Vec<f64> = order.iter().map(|i| response.points[*i].excitation).collect();
    let prediction = Prediction::at(rig, force, frequency, Observable::Fundamental)?;
    let followed = prediction.followed(direction);
    let mut pairs: Vec<Pair> = order
        .iter()
        .zip(followed)
        .map(|(i, motion)| {
            let point = &response.points[*i];
            let predicted = motion.map(|m| m.amplitude[usize::from(mass) - 1]);
            Pair {
                sweep: response.name.clone(),
                mass,
                direction,
                frequency: point.excitation,
                measured: point.amplitude.clone(),
                predicted,
                motion: motion.map(|m| m.kind),
                residual: predicted.map(|p| point.amplitude.value - p).filter(|r| r.is_finite()),
            }
        })
        .collect();
    if direction == Direction::Down {
        pairs.reverse();
    }
    Ok(pairs)
}

fn score(sweep: &str, pairs: &[Pair]) -> Score {
    let mut relative: Vec<f64> = Vec::new();
    let mut squares = Vec::new();
    for pair in pairs {
        if let (Some(predicted), Some(residual)) = (pair.predicted, pair.residual) {
            squares.push(residual * residual);
            if predicted > 0.0 {
                relative.push((residual / predicted).abs());
            }
        }
    }
    relative.sort_by(f64::total_cmp);
    let n = squares.len();
    Score {
        sweep: sweep.to_owned(),
        n,
        without: pairs.len() - n,
        median_relative: median(&relative),
        rms: (n > 0).then(|| (squares.iter().sum::<f64>() / n as f64).sqrt()),
    }
}

/// A predicted peak belongs to a measured one within this ratio of frequencies.
const NEAR: f64 = 1.1;

fn peaks(response: &Response, mass: u8, direction: Direction, curve: &Prediction) -> Vec<PeakPair> {
    let followed = curve.followed(direction);
    let impacting = |i: usize| followed[i].is_some_and(|m| m.kind == Kind::Impacting);
    let amplitude: Vec<f64> = followed
        .iter()
        .map(|m: &Option<Motion>| m.map_or(f64::NAN, |m| m.amplitude[usize::from(mass) - 1]))
        .collect();
    // Where a branch ends, its last point is the peak: a missing value beside it counts as low.
    let closed: Vec<f64> = amplitude.iter().map(|a| if a.is_nan() { 0.0 } else { *a }).collect();
    let predicted: Vec<(f64, f64)> = local_maxima(&closed, 1.2)
        .into_iter()
        // Free motion has no peak in reach of the gap: its end is where impacts begin.
        .filter(|m| impacting(m.at))
        .map(|m| top(curve, &closed, m.at))
        .collect();
    let found =
        response.resonances.iter().filter(|r| !["antiresonance", "minimum"].contains(&r.kind.as_str()));
    found
        .map(|r: &Resonance| {
            let ratio = |f: f64| (f / r.frequency).max(r.frequency / f);
            let near = predicted
                .iter()
                .filter(|p| ratio(p.0) < NEAR)
                .min_by(|a, b| ratio(a.0).total_cmp(&ratio(b.0)))
                .copied();
            let method = if r.at_jump {
                "highest point before a jump"
            } else {
                "local curve through up to five points"
            };
            PeakPair {
                sweep: response.name.clone(),
                mass,
                direction,
                kind: r.kind.clone(),
                measured_frequency: Estimate::new(r.frequency, r.frequency_std, "Hz", 3, method),
                predicted_frequency: near.map(|p| p.0),
                frequency_difference: near.map(|p| r.frequency - p.0),
                measured_amplitude: Estimate::new(r.amplitude, r.amplitude_std, "m", 3, method),
                predicted_amplitude: near.map(|p| p.1),
                amplitude_difference: near.map(|p| r.amplitude / p.1 - 1.0),
            }
        })
        .collect()
}

/// Top of a predicted curve at its grid point `i`: the vertex, or the point itself where the branch ends beside it.
fn top(curve: &Prediction, closed: &[f64], i: usize) -> (f64, f64) {
    let near = [i - 1, i, i + 1];
    let heights = near.map(|k| closed[k]);
    vertex(near.map(|k| curve.frequency[k]), heights, [0.0; 3])
        .filter(|_| heights[0].min(heights[2]) > 0.5 * heights[1])
        .map_or((curve.frequency[i], closed[i]), |v| (v.frequency, v.height))
}
