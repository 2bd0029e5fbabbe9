//! Pairs of measured and predicted amplitudes, their peaks, and a score.

use super::forcing::{Forcing, levels};
use super::observable::Observable;
use super::prediction::{Kind, Motion, Prediction};
use super::score::{Score, far_off, score};
use super::simulated::{Contact, Pace, Simulated, simulated};
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::peaks::{local_maxima, vertex};
use crate::measure::resonance::Resonance;
use crate::measure::response::{Response, ResponsePoint};
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
    /// Predicted amplitude in m; `None` where the motion cannot be followed.
    pub predicted: Option<f64>,
    /// How far the predicted amplitude scatters from cycle to cycle, in m: 0 for what repeats every cycle.
    pub scatter: Option<f64>,
    /// Kind of the predicted motion.
    pub motion: Option<Kind>,
    /// Impacts/cycles of its pattern, or a word.
    pub regime: Option<String>,
    /// What predicted the amplitude: `closed form` where it has the motion that the simulated sweep comes to, else `simulated`.
    pub model: &'static str,
    /// Stable motions of the closed form at this point: with more than one, history decides.
    pub choices: usize,
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

/// Overlays measured displacement responses (fundamentals of spectra) on the motions of the rig. `force` in N; where it is `None` each
/// point is predicted for its own measured force, and the curve between points for the force between theirs.
///
/// Each point is predicted by a rig that is led through the points of its sweep in their order at this `pace`: where several motions are
/// possible, history decides as in the measurement. Where that comes to a motion of the closed form, the closed form gives the amplitude.
///
/// # Errors
/// If no response names its mass and direction, no force is known, or the rig is impossible.
pub fn overlay(rig: &Rig, force: Option<f64>, pace: Pace, responses: &[Response]) -> Result<Overlay> {
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
            let pairs = pairs(rig, sweep, pace)?;
            overlay.scores.push(score(&sweep.response.name, &pairs));
            overlay.warnings.extend(far_off(&sweep.response.name, &pairs));
            overlay.pairs.extend(pairs);
            let own = if sweep.forcing == mean { None } else { Some(curve(&sweep.forcing)?) };
            overlay.peaks.extend(peaks(sweep, own.as_ref().unwrap_or(&common)));
        }
        let sweeps = members.iter().map(|s| s.response.name.clone()).collect();
        overlay.levels.push(Level { force: mean.median(), sweeps, curve: common });
    }
    overlay.warnings.extend(doubts(&overlay.pairs, pace));
    Ok(overlay)
}

/// What is to be said of the predictions.
fn doubts(pairs: &[Pair], pace: Pace) -> Vec<String> {
    let count = |of: &dyn Fn(&Pair) -> bool| pairs.iter().filter(|p| of(p)).count();
    let several = count(&|p| p.choices > 1);
    let irregular = count(&|p| p.motion == Some(Kind::Irregular));
    let without = count(&|p| p.predicted.is_none());
    let mut said = Vec::new();
    if several > 0 {
        said.push(format!(
            "At {several} point(s) more than one motion is stable: predicted is the one that a sweep from rest through the same points \
             comes to, {} cycles at each.",
            pace.settle + pace.measure
        ));
    }
    if irregular > 0 {
        said.push(format!(
            "At {irregular} point(s) the predicted motion has no pattern: its amplitude is that of {} cycles, and others differ by about \
             its scatter.",
            pace.measure
        ));
    }
    if without > 0 {
        said.push(format!(
            "At {without} point(s) the motion cannot be followed: nothing is predicted there."
        ));
    }
    said
}

fn pairs(rig: &Rig, sweep: &Swept<'_>, pace: Pace) -> Result<Vec<Pair>> {
    let Swept { response, mass, direction, ref forcing } = *sweep;
    let mut points: Vec<&ResponsePoint> = response.points.iter().collect();
    points.sort_by(|a, b| a.excitation.total_cmp(&b.excitation));
    let driven = |p: &&ResponsePoint| (p.excitation, forcing.of(p));
    let closed = Prediction::at(rig, points.iter().map(driven).collect(), Observable::Fundamental)?;
    let mut motions = closed.motions;
    if direction == Direction::Down {
        points.reverse();
        motions.reverse();
    }
    let passed: Vec<(f64, f64)> = points.iter().map(driven).collect();
    let came = simulated(rig, Contact::Restitution, &passed, pace);
    let of = usize::from(mass) - 1;
    let pair = |((point, motions), came): ((&&ResponsePoint, &Vec<Motion>), &Result<Simulated>)| {
        let came = came.as_ref().ok();
        let closed = came.and_then(|came| came_to(came, motions));
        let amplitude = closed.map(|m| m.amplitude).or(came.map(|c| c.amplitude));
        let predicted = amplitude.map(|a| a[of]).filter(|p| p.is_finite());
        Pair {
            sweep: response.name.clone(),
            mass,
            direction,
            frequency: point.excitation,
            force: forcing.of(point),
            measured: point.amplitude.clone(),
            upper_limit: point.upper_limit,
            predicted,
            scatter: came.map(|c| if closed.is_some() { 0.0 } else { c.scatter[of] }),
            motion: came.map(|c| Kind::of(c.regime)),
            regime: came.map(|c| c.regime.to_string()),
            model: if closed.is_some() { "closed form" } else { "simulated" },
            choices: motions.iter().filter(|m| m.is_seen()).count(),
            residual: predicted.map(|p| point.amplitude.value - p).filter(|r| r.is_finite()),
        }
    };
    Ok(points.iter().zip(&motions).zip(&came).map(pair).collect())
}

/// A simulated motion is one of the closed form where both amplitudes agree to this part: what 300 cycles leave of the start near a border
/// of stability.
const SETTLED: f64 = 0.02;

/// The motion of the closed form that a simulation came to.
pub(super) fn came_to<'a>(came: &Simulated, motions: &'a [Motion]) -> Option<&'a Motion> {
    let kind = Kind::of(came.regime);
    motions.iter().filter(|m| m.is_seen() && m.kind == kind).find(|m| {
        // What is left of the motion of a mass that comes to rest is held against the other's.
        let size = |i: usize| if m.amplitude[i] > 0.0 { m.amplitude[i] } else { m.amplitude[1 - i] };
        (0..2).all(|i| (came.amplitude[i] - m.amplitude[i]).abs() <= SETTLED * size(i))
    })
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
        let own = overlay(&rig, None, Pace::default(), &responses).unwrap();
        assert_eq!(own.force, None);
        let levels: Vec<&[String]> = own.levels.iter().map(|l| l.sweeps.as_slice()).collect();
        assert_eq!(levels, [&["weak".to_owned(), "weak again".to_owned()][..], &["strong".to_owned()][..]]);
        assert_eq!(own.pairs.len(), 90);
        for pair in &own.pairs {
            // Both are the same quotient, computed along different ways: a few roundings.
            let residual = pair.residual.unwrap();
            assert!(residual.abs() < 1e-12 * pair.measured.value, "{pair:?}");
        }
        assert!(!own.warnings.iter().any(|w| w.contains("off the prediction")), "{:?}", own.warnings);
        // With one force for all, the points at another are off by the ratio of forces.
        let stated = overlay(&rig, Some(0.1), Pace::default(), &responses[..1]).unwrap();
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
        let overlay = overlay(&rig, None, Pace::default(), &[sweep]).unwrap();
        let score = &overlay.scores[0];
        assert_eq!((score.n, score.faint, score.max_at), (30, 1, Some(23.5)));
        assert!((score.max_relative.unwrap() - 0.5).abs() < 1e-12 && score.median_relative.unwrap() < 1e-12);
        let said: Vec<&String> =
            overlay.warnings.iter().filter(|w| w.contains("off the prediction")).collect();
        assert!(
            said.len() == 1 && said[0].contains("1 point(s)") && said[0].contains("at 23.50 Hz"),
            "{said:?}"
        );
    }
}
