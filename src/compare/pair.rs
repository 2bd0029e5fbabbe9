//! Measured amplitudes and resonances beside their predictions, and how well they agree.

use super::predicting::{Followed, Predictor, Swept};
use super::prediction::{Motion, MotionKind, all_motions};
use super::simulated::{Simulated, simulated};
use crate::error::Result;
use crate::measure::Estimate;
use crate::measure::peaks::{local_maxima, vertex};
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::measure::response::ResponsePoint;
use crate::model::ladder::Model;
use crate::record::{Direction, Finding, median};
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
    /// Force amplitude in N for which the amplitude is predicted.
    pub force: f64,
    /// Measured amplitude in m.
    pub measured: Estimate,
    /// 95 % upper limit in m of an amplitude below the noise floor.
    pub upper_limit: Option<f64>,
    /// Predicted amplitude in m; `None` where the motion cannot be followed.
    pub predicted: Option<f64>,
    /// Standard deviation of the predicted amplitude from cycle to cycle in m; 0 for a motion that repeats
    /// every cycle.
    pub scatter: Option<f64>,
    /// Kind of the predicted motion.
    pub motion: Option<MotionKind>,
    /// Pattern of the predicted motion: impacts/cycles, or a word such as `irregular`.
    pub regime: Option<String>,
    /// Model that predicted the amplitude: the closed form if the simulated sweep reached one of its motions,
    /// else the simulated model.
    pub model: Model,
    /// Number of stable motions of the closed form at this point; with more than one, the history of the
    /// sweep decides which is reached.
    pub choices: usize,
    /// Measured minus predicted amplitude in m.
    pub residual: Option<f64>,
}

impl Predictor<'_> {
    /// Measured points of a sweep in their order, each with its prediction.
    pub fn pairs(&self, sweep: &Swept<'_>) -> Result<Vec<Pair>> {
        let Predictor { rig, law, model, pace } = *self;
        let Swept { response, mass, direction, ref forcing } = *sweep;
        let points = sweep.points();
        let driven: Vec<(f64, f64)> = points.iter().map(|p| (p.excitation, forcing.of(p).0)).collect();
        let (motions, simulated) = (all_motions(rig, &driven)?, simulated(rig, law, &driven, pace));
        let of = usize::from(mass) - 1;
        let pair = |((point, motions), simulated): ((&&ResponsePoint, &Vec<Motion>), &Result<Simulated>)| {
            let simulated = simulated.as_ref().ok();
            let closed = simulated.filter(|_| law.is_none()).and_then(|s| reached(s, motions));
            let amplitude = closed.map(|m| m.amplitude).or(simulated.map(|s| s.amplitude));
            let predicted = amplitude.map(|a| a[of]).filter(|p| p.is_finite());
            Pair {
                sweep: response.name.clone(),
                mass,
                direction,
                frequency: point.excitation,
                force: forcing.of(point).0,
                measured: point.amplitude.clone(),
                upper_limit: point.upper_limit,
                predicted,
                scatter: simulated.map(|s| if closed.is_some() { 0.0 } else { s.scatter[of] }),
                motion: simulated.map(|s| MotionKind::of(s.regime)),
                regime: simulated.map(|s| s.regime.to_string()),
                model: if closed.is_some() { Model::ClosedForm } else { model },
                choices: motions.iter().filter(|m| m.is_seen()).count(),
                residual: predicted.map(|p| point.amplitude.value - p).filter(|r| r.is_finite()),
            }
        };
        Ok(points.iter().zip(&motions).zip(&simulated).map(pair).collect())
    }
}

/// Largest relative difference between the amplitudes of a simulated motion and of the closed form that count
/// as the same motion. Near a border of stability, 300 cycles leave this much of the transient.
const SETTLED: f64 = 0.02;

/// The motion of the closed form that a simulation reached.
pub(super) fn reached<'a>(simulated: &Simulated, motions: &'a [Motion]) -> Option<&'a Motion> {
    let kind = MotionKind::of(simulated.regime);
    motions.iter().filter(|m| m.is_seen() && m.kind == kind).find(|m| {
        // A mass at rest in the closed form may still ring in the simulation: the difference is then
        // related to the amplitude of the other mass.
        let size = |i: usize| if m.amplitude[i] > 0.0 { m.amplitude[i] } else { m.amplitude[1 - i] };
        (0..2).all(|i| (simulated.amplitude[i] - m.amplitude[i]).abs() <= SETTLED * size(i))
    })
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
    /// Kind of the measured resonance.
    pub kind: ResonanceKind,
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
    /// Measured over predicted amplitude, minus one.
    pub amplitude_difference: Option<f64>,
}

/// Largest ratio of the frequencies of a measured and a predicted peak that are paired: a stiffness is known
/// to about 20 %, so the frequency is known to 10 %.
const NEAR: f64 = 1.1;

/// Each measured resonance of a sweep with the predicted one nearest to it.
pub(super) fn peaks(sweep: &Swept<'_>, curve: &[Followed]) -> Vec<PeakPair> {
    let Swept { response, mass, direction, .. } = *sweep;
    // At the end of a branch its last point may be the peak: missing amplitudes beside it count as 0.
    let closed: Vec<f64> =
        curve.iter().map(|p| if p.amplitude.is_nan() { 0.0 } else { p.amplitude }).collect();
    // Maxima of the free motion are left out: its curve ends, without a peak, where impacts begin.
    let maxima = local_maxima(&closed, 1.2).into_iter().filter(|m| curve[m.at].impacting);
    let predicted: Vec<(f64, f64)> = maxima.map(|m| top(curve, &closed, m.at)).collect();
    let one = |r: &Resonance| {
        let ratio = |p: &(f64, f64)| (p.0 / r.frequency).max(r.frequency / p.0);
        let near = predicted.iter().copied().filter(|p| ratio(p) < NEAR);
        let near = near.min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        let method =
            if r.at_jump { "highest point before a jump" } else { "local curve through up to five points" };
        PeakPair {
            sweep: response.name.clone(),
            mass,
            direction,
            kind: r.kind,
            measured_frequency: Estimate::new(r.frequency, r.frequency_std, "Hz", 3, method),
            predicted_frequency: near.map(|p| p.0),
            frequency_difference: near.map(|p| r.frequency - p.0),
            measured_amplitude: Estimate::new(r.amplitude, r.amplitude_std, "m", 3, method),
            predicted_amplitude: near.map(|p| p.1),
            amplitude_difference: near.map(|p| r.amplitude / p.1 - 1.0),
        }
    };
    response.resonances.iter().filter(|r| r.kind.is_maximum()).map(one).collect()
}

/// Frequency in Hz and amplitude in m of a predicted peak at grid point `i`: the vertex of a parabola, or
/// the point itself where the branch ends beside it.
fn top(curve: &[Followed], closed: &[f64], i: usize) -> (f64, f64) {
    let near = [i - 1, i, i + 1];
    let heights = near.map(|k| closed[k]);
    vertex(near.map(|k| curve[k].frequency), heights, [0.0; 3])
        .filter(|_| heights[0].min(heights[2]) > 0.5 * heights[1])
        .map_or((curve[i].frequency, closed[i]), |v| (v.frequency, v.height))
}

/// Agreement of one sweep with its prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Sweep.
    pub sweep: String,
    /// Points with a prediction.
    pub n: usize,
    /// Points without a prediction.
    pub without: usize,
    /// Predicted points left out of the ratios: the measured amplitude is below the noise floor, and the
    /// predicted one below its 95 % upper limit.
    pub faint: usize,
    /// Median of |measured − predicted| over the larger of both, at points that are not faint; `None`
    /// without such points.
    pub median_relative: Option<f64>,
    /// Largest of these ratios.
    pub max_relative: Option<f64>,
    /// Excitation frequency in Hz of the largest ratio.
    pub max_at: Option<f64>,
    /// Root mean square of measured − predicted in m, over all points with a prediction.
    pub rms: Option<f64>,
}

impl Pair {
    /// |measured − predicted| over the larger of both: 0.5 for twice and for half the prediction. `None`
    /// without a prediction, and where the measured amplitude is below the noise floor and the predicted one
    /// below its 95 % upper limit.
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
        median_relative: Some(median(relative)).filter(|part| part.is_finite()),
        max_relative: largest.map(|l| l.0),
        max_at: largest.map(|l| l.1),
        rms: (n > 0).then(|| (squares.iter().sum::<f64>() / n as f64).sqrt()),
    }
}

/// Deviation over the larger amplitude above which a point may be an outlier: errors of the calibration and
/// the mounting of a sensor are smaller.
const FAR: f64 = 0.05;
/// Deviation in standard uncertainties above which a point is an outlier: by chance, one point in 1.7 million
/// of a normal distribution exceeds it.
const SIGMAS: f64 = 5.0;

/// Caution about points far from the prediction: the median of a sweep does not show them.
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
