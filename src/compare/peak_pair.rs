//! Measured resonances and the predicted ones nearest to them.

use super::course::{Followed, Swept};
use crate::measure::Estimate;
use crate::measure::peaks::{local_maxima, vertex};
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::record::Direction;
use serde::Serialize;

/// A measured resonance and the predicted one nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakPair {
    /// Sweep.
    pub sweep: String,
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// What the measured one is.
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
    /// Measured over predicted amplitude, less one.
    pub amplitude_difference: Option<f64>,
}

/// A predicted peak belongs to a measured one within this ratio of frequencies: a stiffness is known to a fifth.
const NEAR: f64 = 1.1;

/// Each measured resonance of a sweep with the predicted one nearest to it.
pub(super) fn peaks(sweep: &Swept<'_>, curve: &[Followed]) -> Vec<PeakPair> {
    let Swept { response, mass, direction, .. } = *sweep;
    // Where a branch ends, its last point is the peak: a missing value beside it counts as low.
    let closed: Vec<f64> =
        curve.iter().map(|p| if p.amplitude.is_nan() { 0.0 } else { p.amplitude }).collect();
    // Free motion has no peak in reach of the gap: its end is where impacts begin.
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

/// Top of a predicted curve at its grid point `i`: the vertex, or the point itself where the branch ends beside it.
fn top(curve: &[Followed], closed: &[f64], i: usize) -> (f64, f64) {
    let near = [i - 1, i, i + 1];
    let heights = near.map(|k| closed[k]);
    vertex(near.map(|k| curve[k].frequency), heights, [0.0; 3])
        .filter(|_| heights[0].min(heights[2]) > 0.5 * heights[1])
        .map_or((curve[i].frequency, closed[i]), |v| (v.frequency, v.height))
}
