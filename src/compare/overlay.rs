//! Pairs of measured and predicted amplitudes, their peaks, and a score.

use super::forcing::{Forcing, levels};
use super::observable::Observable;
use super::prediction::{Kind, Motion, Prediction};
use super::score::{Score, far_off, score};
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
    /// Force amplitude of the prediction in N.
    pub force: f64,
    /// Measured amplitude in m.
    pub measured: Estimate,
    /// What the true amplitude stays below with 95 % confidence, in m, where it does not stand out of the noise.
    pub upper_limit: Option<f64>,
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

/// Sweeps of about one force, and the prediction for them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Median force amplitude in N.
    pub force: f64,
    /// Sweeps.
    pub sweeps: Vec<String>,
    /// The curve for figures: for the stated force, else for the mean of the measured forces of these sweeps.
    #[serde(skip)]
    pub curve: Prediction,
}

/// A whole comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overlay {
    /// Stated force amplitude in N; `None` where each point is predicted for its own measured force.
    pub force: Option<f64>,
    /// Levels of force.
    pub levels: Vec<Level>,
    /// Point by point.
    pub pairs: Vec<Pair>,
    /// Peak by peak.
    pub peaks: Vec<PeakPair>,
    /// Sweep by sweep.
    pub scores: Vec<Score>,
    /// What was assumed.
    pub warnings: Vec<String>,
}

/// Frequencies of the predicted curve.
const CURVE: usize = 1200;

/// One sweep to be overlaid.
struct Swept<'a> {
    response: &'a Response,
    mass: u8,
    direction: Direction,
    forcing: Forcing,
}

/// Overlays measured displacement responses (fundamentals of spectra) on the closed-form prediction. `force` in N; where it
/// is `None` each point is predicted for its own measured force, and the curve between points for the force between theirs.
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
    // Room for the markers of the outer points.
    let margin = 0.03 * (high - low);
    let range = ((low - margin).max(low / 2.0), high + margin);
    let curve = |forcing: &Forcing| Prediction::over(rig, forcing, range, CURVE, Observable::Fundamental);
    let forcings = Forcing::of_all(force, &usable.iter().map(|u| u.0).collect::<Vec<_>>(), &mut warnings)?;
    let medians: Vec<Option<f64>> = forcings.iter().map(|f| Some(f.median())).collect();
    let swept: Vec<Swept<'_>> = usable
        .into_iter()
        .zip(forcings)
        .map(|((response, mass, direction), forcing)| Swept { response, mass, direction, forcing })
        .collect();
    let mut overlay = Overlay {
        force,
        levels: Vec::new(),
        pairs: Vec::new(),
        peaks: Vec::new(),
        scores: Vec::new(),
        warnings,
    };
    for level in levels(&medians) {
        let members: Vec<&Swept<'_>> = level.iter().filter_map(|i| swept.get(*i)).collect();
        let forcings: Vec<&Forcing> = members.iter().map(|s| &s.forcing).collect();
        let Some(mean) = Forcing::mean(&forcings) else { continue };
        let common = curve(&mean)?;
        for sweep in &members {
            let pairs = pairs(rig, sweep)?;
            overlay.scores.push(score(&sweep.response.name, &pairs));
            overlay.warnings.extend(far_off(&sweep.response.name, &pairs));
            overlay.pairs.extend(pairs);
            let own = if sweep.forcing == mean { None } else { Some(curve(&sweep.forcing)?) };
            overlay.peaks.extend(peaks(sweep, own.as_ref().unwrap_or(&common)));
        }
        let sweeps = members.iter().map(|s| s.response.name.clone()).collect();
        overlay.levels.push(Level { force: mean.median(), sweeps, curve: common });
    }
    let without: usize = overlay.scores.iter().map(|s| s.without).sum();
    if without > 0 {
        overlay.warnings.push(format!(
            "At {without} point(s) the closed form has no motion that can be seen (one impact a cycle, or none): nothing is predicted there."
        ));
    }
    Ok(overlay)
}

fn pairs(rig: &Rig, sweep: &Swept<'_>) -> Result<Vec<Pair>> {
    let Swept { response, mass, direction, ref forcing } = *sweep;
    let mut order: Vec<usize> = (0..response.points.len()).collect();
    order.sort_by(|a, b| response.points[*a].excitation.total_cmp(&response.points[*b].excitation));
    let points = order.iter().map(|i| &response.points[*i]).map(|p| (p.excitation, forcing.of(p)));
    let prediction = Prediction::at(rig, points.collect(), Observable::Fundamental)?;
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
                force: forcing.of(point),
                measured: point.amplitude.clone(),
                upper_limit: point.upper_limit,
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

/// A predicted peak belongs to a measured one within this ratio of frequencies.
const NEAR: f64 = 1.1;

fn peaks(sweep: &Swept<'_>, curve: &Prediction) -> Vec<PeakPair> {
    let Swept { response, mass, direction, .. } = *sweep;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::response::ResponsePoint;

    /// A sweep of mass 1 whose force rises from `force` by half a thousandth a step, with the amplitudes of the closed form
    /// without impacts, F/|k − ω²m + iωc|.
    fn free(name: &str, rig: &Rig, force: f64) -> Response {
        let point = |i: i32| {
            let (excitation, force) = (20.0 + 0.5 * f64::from(i), force * (1.0 + 5e-4 * f64::from(i)));
            let w = 2.0 * std::f64::consts::PI * excitation;
            let amplitude = force / (rig.k1 - w * w * rig.m1).hypot(w * rig.c1);
            ResponsePoint {
                excitation,
                excitation_std: None,
                force: Some(force),
                frequency: excitation,
                frequency_std: None,
                amplitude: Estimate::new(amplitude, None, "m", 1, "closed form"),
                upper_limit: None,
                harmonics: Vec::new(),
                subharmonics: Vec::new(),
                largest_elsewhere: false,
                largest_at: excitation,
            }
        };
        Response {
            name: name.to_owned(),
            direction: Some(Direction::Down),
            mass: Some(1),
            quantity: "displacement",
            unit: "m",
            fmin: 0.0,
            points: (0..30).map(point).collect(),
            resonances: Vec::new(),
            jumps: Vec::new(),
            warnings: Vec::new(),
            history: Vec::new(),
        }
    }

    #[test]
    fn each_point_is_predicted_for_its_own_force() {
        let rig = Rig::thesis();
        let responses =
            [free("weak", &rig, 0.05), free("strong", &rig, 0.1), free("weak again", &rig, 0.052)];
        let own = overlay(&rig, None, &responses).unwrap();
        assert_eq!(own.force, None);
        let levels: Vec<&[String]> = own.levels.iter().map(|l| l.sweeps.as_slice()).collect();
        assert_eq!(levels, [&["weak".to_owned(), "weak again".to_owned()][..], &["strong".to_owned()][..]]);
        assert_eq!(own.pairs.len(), 90);
        for pair in &own.pairs {
            // Both are the same quotient, computed along different ways: a few roundings.
            let residual = pair.residual.unwrap();
            assert!(residual.abs() < 1e-12 * pair.measured.value, "{pair:?}");
        }
        assert!(!own.warnings.iter().any(|w| w.contains("off the closed form")), "{:?}", own.warnings);
        // With one force for all, the points at another are off by the ratio of forces.
        let stated = overlay(&rig, Some(0.1), &responses[..1]).unwrap();
        assert_eq!(stated.force, Some(0.1));
        let worst = stated.pairs.iter().map(|p| p.measured.value / p.predicted.unwrap()).fold(1.0, f64::min);
        assert!((worst - 0.5).abs() < 1e-12, "{worst}");
        assert!((stated.scores[0].max_relative.unwrap() - 0.5).abs() < 1e-12, "{:?}", stated.scores);
        assert!(stated.warnings.iter().any(|w| w.starts_with("weak: 30 point(s)")), "{:?}", stated.warnings);
        assert!(stated.warnings.iter().any(|w| w.contains("strays by up to 50 %")), "{:?}", stated.warnings);
    }
    #[test]
    fn one_wrong_point_is_named_and_a_faint_one_is_not_compared() {
        let rig = Rig::thesis();
        let mut sweep = free("m", &rig, 0.1);
        sweep.points[7].amplitude.value *= 2.0;
        // Within its uncertainty, and below its limit.
        sweep.points[9].amplitude.value *= 1.2;
        sweep.points[9].amplitude.std = Some(sweep.points[9].amplitude.value);
        sweep.points[11].amplitude.value *= 0.5;
        sweep.points[11].upper_limit = Some(1.0);
        let overlay = overlay(&rig, None, &[sweep]).unwrap();
        let score = &overlay.scores[0];
        assert_eq!((score.n, score.faint, score.max_at), (30, 1, Some(23.5)));
        assert!((score.max_relative.unwrap() - 0.5).abs() < 1e-12 && score.median_relative.unwrap() < 1e-12);
        let said: Vec<&String> =
            overlay.warnings.iter().filter(|w| w.contains("off the closed form")).collect();
        assert!(
            said.len() == 1 && said[0].contains("1 point(s)") && said[0].contains("at 23.50 Hz"),
            "{said:?}"
        );
    }
}
