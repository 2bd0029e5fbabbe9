//! Overlay of measured sweeps on the model: pairs of amplitudes, peaks and scores.

use super::forcing::{Forcing, levels, range};
use super::pair::{Pair, PeakPair, Score, outliers, peaks, score};
use super::predicting::{Predicting, Predictor, Rungs, Swept, rungs};
use super::prediction::{MotionKind, Prediction};
use super::simulated::Pace;
use crate::error::Result;
use crate::measure::response::Response;
use crate::model::Rig;
use crate::model::ladder::Model;
use crate::record::{Direction, Finding};
use serde::Serialize;

/// Sweeps at about the same force, and their prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Median force amplitude in N.
    pub force: f64,
    /// Names of the sweeps.
    pub sweeps: Vec<String>,
    /// Curve for figures: at the stated force, else at the mean of the measured forces of these sweeps.
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
    /// Measured and predicted amplitudes, point by point.
    pub pairs: Vec<Pair>,
    /// Measured and predicted resonances, peak by peak.
    pub peaks: Vec<PeakPair>,
    /// Agreement, sweep by sweep.
    pub scores: Vec<Score>,
    /// The choice of a model for each level of force and direction; empty where a model is named.
    pub rungs: Vec<Rungs>,
    /// Model of the simulated predictions.
    #[serde(skip)]
    pub model: Model,
    /// Findings on the comparison.
    pub findings: Vec<Finding>,
}

/// Number of frequencies of the predicted curve: closer together than the width of a line in a figure.
const CURVE: usize = 1200;

/// Compares measured displacement responses (fundamentals of spectra) with the motions of the rig. `force`
/// is in N. With `None` each point is predicted for its own measured force, and the curve for forces
/// interpolated between the points.
///
/// Each point is predicted by a simulated sweep through the points in their order, so that coexisting
/// solutions are chosen by the history, as in the measurement. Where contacts are rigid and the sweep reaches
/// a motion of the closed form, the closed form gives the amplitude. The ladder of models decides whether
/// contacts are rigid, unless a model is named.
///
/// # Errors
/// If no response states its mass and direction, no force is known, or the rig is impossible; if the named
/// model needs unknown properties of the contact.
pub fn overlay(
    rig: &Rig,
    force: Option<f64>,
    predicting: &Predicting,
    responses: &[Response],
) -> Result<Overlay> {
    let (swept, mut findings) = Swept::all(force, responses)?;
    let left_out = responses.len() - swept.len();
    if left_out > 0 {
        findings.push(Finding::caution("responses-not-overlaid").count("n", left_out));
    }
    let (low, high) = frequencies(&swept);
    // The curve extends beyond the outermost points, to leave room for their markers.
    let margin = 0.03 * (high - low);
    let ends = ((low - margin).max(low / 2.0), high + margin);
    let curve = |forcing: &Forcing| Prediction::over(rig, forcing, ends, CURVE);
    let grouped = grouped(&swept);
    // The choice of a model for each level of force and direction.
    let mut choices = Vec::new();
    for (force, members) in grouped.iter().filter(|_| predicting.model.name.is_none()) {
        for direction in [Direction::Up, Direction::Down] {
            let (low, high) = frequencies(members.iter().copied().filter(|s| s.direction == direction));
            if low < high {
                choices.push(rungs(rig, predicting, force.median(), direction, (low, high))?);
            }
        }
    }
    let model = predicting.model(&choices);
    findings.extend(choices.iter().find_map(|r| r.finding.clone()).map(|f| f.name("model", model.name())));
    let course = Predictor { rig, law: predicting.law(rig, model)?, model, pace: predicting.pace() };
    let (mut pairs, mut found_peaks, mut scores, mut shown) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (mean, members) in grouped {
        let common = curve(&mean)?;
        for sweep in &members {
            let own = course.pairs(sweep)?;
            scores.push(score(&sweep.response.name, &own));
            findings.extend(outliers(&sweep.response.name, &own));
            pairs.extend(own);
            let own = if sweep.forcing == mean { None } else { Some(curve(&sweep.forcing)?) };
            found_peaks.extend(peaks(sweep, &course.followed(sweep, own.as_ref().unwrap_or(&common))));
        }
        let sweeps = members.iter().map(|s| s.response.name.clone()).collect();
        shown.push(Level { force: mean.median(), sweeps, curve: common });
    }
    findings.extend(of_motions(&pairs, course.pace));
    Ok(Overlay { force, levels: shown, pairs, peaks: found_peaks, scores, rungs: choices, model, findings })
}

/// Amplitudes in m that a model predicts at the points of all sweeps, in the order of the pairs of an
/// [`overlay`]; `None` where the motion cannot be followed.
///
/// # Errors
/// As [`overlay`].
pub fn predicted(
    rig: &Rig,
    force: Option<f64>,
    (model, predicting): (Model, &Predicting),
    responses: &[Response],
) -> Result<Vec<Option<f64>>> {
    let (swept, _) = Swept::all(force, responses)?;
    let course = Predictor { rig, law: predicting.law(rig, model)?, model, pace: predicting.pace() };
    let mut predicted = Vec::new();
    for sweep in grouped(&swept).into_iter().flat_map(|(_, members)| members) {
        predicted.extend(course.pairs(sweep)?.into_iter().map(|pair| pair.predicted));
    }
    Ok(predicted)
}

/// Sweeps by level of force, with the mean of their forces.
fn grouped<'a>(swept: &'a [Swept<'a>]) -> Vec<(Forcing, Vec<&'a Swept<'a>>)> {
    let medians: Vec<Option<f64>> = swept.iter().map(|s| Some(s.forcing.median())).collect();
    let of_level = |level: Vec<usize>| {
        let members: Vec<&Swept<'_>> = level.iter().filter_map(|i| swept.get(*i)).collect();
        Some((Forcing::mean(&members.iter().map(|s| &s.forcing).collect::<Vec<_>>())?, members))
    };
    levels(&medians).into_iter().filter_map(of_level).collect()
}

/// Lowest and highest excitation frequency in Hz.
fn frequencies<'a>(swept: impl IntoIterator<Item = &'a Swept<'a>>) -> (f64, f64) {
    range(swept.into_iter().flat_map(|s| &s.response.points).map(|p| p.excitation))
}

/// Findings on coexisting solutions, irregular motions, and points without a prediction.
fn of_motions(pairs: &[Pair], pace: Pace) -> Vec<Finding> {
    let count = |of: &dyn Fn(&Pair) -> bool| pairs.iter().filter(|p| of(p)).count();
    let cycles = (pace.settle + pace.measure) as usize;
    [
        Finding::caution("coexisting-solutions")
            .count("n", count(&|p| p.choices > 1))
            .count("cycles", cycles),
        Finding::caution("irregular-motion")
            .count("n", count(&|p| p.motion == Some(MotionKind::Irregular)))
            .count("cycles", pace.measure as usize),
        Finding::caution("motion-not-predicted").count("n", count(&|p| p.predicted.is_none())),
    ]
    .into_iter()
    .filter(|f| f.get("n") > Some(0.0))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Estimate;
    use crate::measure::response::ResponsePoint;
    use crate::model::ladder::Model;

    /// A sweep of mass 1 whose force rises from `force` by 0.05 % a step, with amplitudes of the closed
    /// form without impacts, F/|k − ω²m + iωc|.
    fn free(name: &str, rig: &Rig, force: f64) -> Response {
        let point = |i: i32| {
            let (excitation, force) = (20.0 + 0.5 * f64::from(i), force * (1.0 + 5e-4 * f64::from(i)));
            let w = 2.0 * std::f64::consts::PI * excitation;
            let amplitude = force / (rig.k1 - w * w * rig.m1).hypot(w * rig.c1);
            ResponsePoint {
                excitation,
                excitation_std: None,
                force: Some(force),
                force_std: None,
                frequency: excitation,
                frequency_std: None,
                amplitude: Estimate::new(amplitude, None, "m", 1, "closed form"),
                upper_limit: None,
                phase: None,
                receptance: None,
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
            findings: Vec::new(),
            history: Vec::new(),
        }
    }

    #[test]
    fn each_point_is_predicted_for_its_own_force() {
        let rig = Rig::thesis();
        let responses =
            [free("weak", &rig, 0.05), free("strong", &rig, 0.1), free("weak again", &rig, 0.052)];
        let own = overlay(&rig, None, &Predicting::default(), &responses).unwrap();
        assert_eq!(own.force, None);
        let levels: Vec<&[String]> = own.levels.iter().map(|l| l.sweeps.as_slice()).collect();
        assert_eq!(levels, [&["weak".to_owned(), "weak again".to_owned()][..], &["strong".to_owned()][..]]);
        assert_eq!(own.pairs.len(), 90);
        for pair in &own.pairs {
            // Measurement and prediction are the same quotient, computed in two ways: a few roundings.
            let residual = pair.residual.unwrap();
            assert!(residual.abs() < 1e-12 * pair.measured.value, "{pair:?}");
        }
        assert!(!own.findings.iter().any(|f| f.code == "points-off-prediction"), "{:?}", own.findings);
        // With one stated force for all points, a point at another force is off by the ratio of the forces.
        let stated = overlay(&rig, Some(0.1), &Predicting::default(), &responses[..1]).unwrap();
        assert_eq!(stated.force, Some(0.1));
        let worst = stated.pairs.iter().map(|p| p.measured.value / p.predicted.unwrap()).fold(1.0, f64::min);
        assert!((worst - 0.5).abs() < 1e-12, "{worst}");
        assert!((stated.scores[0].max_relative.unwrap() - 0.5).abs() < 1e-12, "{:?}", stated.scores);
        let of = |code: &str| stated.findings.iter().find(|f| f.code == code).unwrap();
        assert_eq!(of("points-off-prediction").get("n"), Some(30.0));
        // The force is half of the stated one, and rises by 0.05 % a step.
        assert!((of("stated-force-differs").get("part").unwrap() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn one_wrong_point_is_named_and_a_faint_one_is_not_compared() {
        let rig = Rig::thesis();
        let mut sweep = free("m", &rig, 0.1);
        sweep.points[7].amplitude.value *= 2.0;
        // Point 9 is off by less than its uncertainty; the prediction of point 11 is below its upper limit.
        sweep.points[9].amplitude.value *= 1.2;
        sweep.points[9].amplitude.std = Some(sweep.points[9].amplitude.value);
        sweep.points[11].amplitude.value *= 0.5;
        sweep.points[11].upper_limit = Some(1.0);
        let overlay = overlay(&rig, None, &Predicting::default(), &[sweep]).unwrap();
        let score = &overlay.scores[0];
        assert_eq!((score.n, score.faint, score.max_at), (30, 1, Some(23.5)));
        assert!((score.max_relative.unwrap() - 0.5).abs() < 1e-12 && score.median_relative.unwrap() < 1e-12);
        let off: Vec<&Finding> =
            overlay.findings.iter().filter(|f| f.code == "points-off-prediction").collect();
        assert_eq!(off.len(), 1);
        assert_eq!((off[0].get("n"), off[0].get("frequency")), (Some(1.0), Some(23.5)));
    }

    #[test]
    fn a_mass_that_rings_on_rests_in_the_closed_form() {
        // A sweep up from impacts at 5 Hz past the fold at 10.66 Hz (0.1 N, R 0.98): above the fold the
        // impacts cease and mass 2 rings on.
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let mut sweep = free("m", &rig, 0.1);
        sweep.direction = Some(Direction::Up);
        for (i, point) in sweep.points.iter_mut().enumerate() {
            point.excitation = 5.0 + 0.25 * i as f64;
            point.force = Some(0.1);
        }
        let overlay = overlay(&rig, None, &Predicting::default(), &[sweep]).unwrap();
        let kinds: Vec<Option<MotionKind>> = overlay.pairs.iter().map(|p| p.motion).collect();
        assert!(
            kinds.contains(&Some(MotionKind::Impacting)) && kinds.contains(&Some(MotionKind::Free)),
            "{kinds:?}"
        );
        for pair in overlay.pairs.iter().filter(|p| p.motion == Some(MotionKind::Free)) {
            assert_eq!(pair.model, Model::ClosedForm, "{pair:?}");
        }
    }
}
