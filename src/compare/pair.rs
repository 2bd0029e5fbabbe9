//! Measured amplitudes and their predictions, point by point.

use super::course::{Course, Swept};
use super::prediction::{Kind, Motion, all_motions};
use super::simulated::{Simulated, simulated};
use crate::error::Result;
use crate::measure::Estimate;
use crate::measure::response::ResponsePoint;
use crate::model::ladder::Model;
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
    /// Force amplitude of the prediction in N.
    pub force: f64,
    /// Measured amplitude in m.
    pub measured: Estimate,
    /// 95 % upper limit in m of an amplitude below the noise floor.
    pub upper_limit: Option<f64>,
    /// Predicted amplitude in m; `None` where the motion cannot be followed.
    pub predicted: Option<f64>,
    /// How far the predicted amplitude scatters from cycle to cycle, in m: 0 for what repeats every cycle.
    pub scatter: Option<f64>,
    /// Kind of the predicted motion.
    pub motion: Option<Kind>,
    /// Impacts/cycles of its pattern, or a word.
    pub regime: Option<String>,
    /// What predicted the amplitude: the closed form where it has the motion of the simulated sweep, else the model that was simulated.
    pub model: Model,
    /// Stable motions of the closed form at this point: with more than one, history decides.
    pub choices: usize,
    /// Measured minus predicted in m.
    pub residual: Option<f64>,
}

impl Course<'_> {
    /// The points of a sweep in their order, each with its prediction.
    pub fn pairs(&self, sweep: &Swept<'_>) -> Result<Vec<Pair>> {
        let Course { rig, law, model, pace } = *self;
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
                motion: simulated.map(|s| Kind::of(s.regime)),
                regime: simulated.map(|s| s.regime.to_string()),
                model: if closed.is_some() { Model::ClosedForm } else { model },
                choices: motions.iter().filter(|m| m.is_seen()).count(),
                residual: predicted.map(|p| point.amplitude.value - p).filter(|r| r.is_finite()),
            }
        };
        Ok(points.iter().zip(&motions).zip(&simulated).map(pair).collect())
    }
}

/// A simulated motion is one of the closed form where both amplitudes agree to this part: what 300 cycles leave of the start near a border
/// of stability.
const SETTLED: f64 = 0.02;

/// The motion of the closed form that a simulation reached.
pub(super) fn reached<'a>(simulated: &Simulated, motions: &'a [Motion]) -> Option<&'a Motion> {
    let kind = Kind::of(simulated.regime);
    motions.iter().filter(|m| m.is_seen() && m.kind == kind).find(|m| {
        // The ringing of a mass that comes to rest is compared with the other's amplitude.
        let size = |i: usize| if m.amplitude[i] > 0.0 { m.amplitude[i] } else { m.amplitude[1 - i] };
        (0..2).all(|i| (simulated.amplitude[i] - m.amplitude[i]).abs() <= SETTLED * size(i))
    })
}
