//! Pairs of measured and predicted amplitudes, their peaks, and a score.

use super::course::{Course, Swept};
use super::forcing::{Forcing, levels};
use super::pair::Pair;
use super::peak_pair::{PeakPair, peaks};
use super::prediction::{Kind, Prediction};
use super::rungs::{Predicting, Rungs, rungs};
use super::score::{Score, far_off, score};
use super::simulated::Pace;
use crate::error::{Error, Result};
use crate::measure::response::Response;
use crate::model::ladder::Model;
use crate::model::{Observable, Rig};
use crate::record::Direction;
use serde::Serialize;

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
    /// What the ladder of models says of each level of force and direction; empty where a model is named.
    pub rungs: Vec<Rungs>,
    /// What was assumed.
    pub warnings: Vec<String>,
}

/// Frequencies of the predicted curve.
const CURVE: usize = 1200;

/// Overlays measured displacement responses (fundamentals of spectra) on the motions of the rig. `force` in N; where it is `None` each
/// point is predicted for its own measured force, and the curve between points for the force between theirs.
///
/// Each point is predicted by a rig that is led through the points of its sweep in their order: where several motions are possible, history
/// decides as in the measurement. Where impacts take no time and that comes to a motion of the closed form, the closed form gives the
/// amplitude. Whether impacts may take no time, the ladder says, unless a model is named.
///
/// # Errors
/// If no response names its mass and direction, no force is known, or the rig is impossible; if the model named needs what is not known
/// of the contact.
pub fn overlay(
    rig: &Rig,
    force: Option<f64>,
    predicting: &Predicting,
    responses: &[Response],
) -> Result<Overlay> {
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
    let asked =
        if predicting.model.is_some() { Vec::new() } else { climbed(rig, predicting, &swept, &medians)? };
    let model = predicting.model(&asked);
    if let Some(open) = asked.iter().find_map(|r| r.open.as_ref()) {
        let stated = predicting.contact.is_some_and(|c| c.stiffness.is_some());
        let why = if stated { "" } else { ", since nothing states [contact] stiffness" };
        warnings.push(format!("Where no model can be chosen {} is assumed{why}. {open}", model.name()));
    }
    let course = Course { rig, law: predicting.law(rig, model)?, model, pace: predicting.pace };
    let mut overlay = Overlay {
        force,
        levels: Vec::new(),
        pairs: Vec::new(),
        peaks: Vec::new(),
        scores: Vec::new(),
        rungs: asked,
        warnings,
    };
    for level in levels(&medians) {
        let members: Vec<&Swept<'_>> = level.iter().filter_map(|i| swept.get(*i)).collect();
        let forcings: Vec<&Forcing> = members.iter().map(|s| &s.forcing).collect();
        let Some(mean) = Forcing::mean(&forcings) else { continue };
        let common = curve(&mean)?;
        for sweep in &members {
            let pairs = course.pairs(sweep)?;
            overlay.scores.push(score(&sweep.response.name, &pairs));
            overlay.warnings.extend(far_off(&sweep.response.name, &pairs));
            overlay.pairs.extend(pairs);
            let own = if sweep.forcing == mean { None } else { Some(curve(&sweep.forcing)?) };
            let followed = course.followed(sweep, own.as_ref().unwrap_or(&common));
            overlay.peaks.extend(peaks(sweep, &followed));
        }
        let sweeps = members.iter().map(|s| s.response.name.clone()).collect();
        overlay.levels.push(Level { force: mean.median(), sweeps, curve: common });
    }
    overlay.warnings.extend(elsewhere(&overlay));
    overlay.warnings.extend(doubts(&overlay.pairs, predicting.pace));
    Ok(overlay)
}

/// Where the ladder takes the motion without impacts and the sweep that is led from rest comes to one with them.
fn elsewhere(overlay: &Overlay) -> Vec<String> {
    let mut said = Vec::new();
    for rungs in &overlay.rungs {
        for stretch in rungs.stretches.iter().filter(|s| s.chosen == Some(Model::Linear)) {
            let within = |p: &&Pair| {
                p.direction == rungs.direction
                    && (stretch.from..=stretch.to).contains(&p.frequency)
                    && levels(&[Some(p.force), Some(rungs.force)]).len() == 1
            };
            let strikes =
                overlay.pairs.iter().filter(within).filter(|p| p.motion != Some(Kind::Free)).count();
            if strikes > 0 {
                said.push(format!(
                    "{strikes} point(s) from {:.2} to {:.2} Hz, sweeping {}: led from rest at the first point the rig strikes there; led from \
                     farther off to the frequencies at which the ladder was asked, it does not, and the choice of a model is for that \
                     motion.",
                    stretch.from,
                    stretch.to,
                    rungs.direction.name()
                ));
            }
        }
    }
    said
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

/// What the ladder says of each level of force and direction.
fn climbed(
    rig: &Rig,
    predicting: &Predicting,
    swept: &[Swept<'_>],
    medians: &[Option<f64>],
) -> Result<Vec<Rungs>> {
    let mut asked = Vec::new();
    for level in levels(medians) {
        let members: Vec<&Swept<'_>> = level.iter().filter_map(|i| swept.get(*i)).collect();
        let forcings: Vec<&Forcing> = members.iter().map(|s| &s.forcing).collect();
        let Some(force) = Forcing::mean(&forcings).map(|f| f.median()) else { continue };
        for direction in [Direction::Up, Direction::Down] {
            let points = members.iter().filter(|s| s.direction == direction).flat_map(|s| &s.response.points);
            let (low, high) =
                points.map(|p| p.excitation).fold((f64::INFINITY, 0.0f64), |(a, b), f| (a.min(f), b.max(f)));
            if low < high {
                asked.push(rungs(rig, predicting, force, direction, (low, high))?);
            }
        }
    }
    Ok(asked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Estimate;
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
                force_std: None,
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
            // Both are the same quotient, computed along different ways: a few roundings.
            let residual = pair.residual.unwrap();
            assert!(residual.abs() < 1e-12 * pair.measured.value, "{pair:?}");
        }
        assert!(!own.warnings.iter().any(|w| w.contains("off the prediction")), "{:?}", own.warnings);
        // With one force for all, the points at another are off by the ratio of forces.
        let stated = overlay(&rig, Some(0.1), &Predicting::default(), &responses[..1]).unwrap();
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
        let overlay = overlay(&rig, None, &Predicting::default(), &[sweep]).unwrap();
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

    #[test]
    fn a_mass_that_rings_on_rests_in_the_closed_form() {
        // From impacts at 5 Hz up over the fold at 10.66 Hz (0.1 N, R 0.98): behind it the masses part and the struck one rings on.
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let mut sweep = free("m", &rig, 0.1);
        sweep.direction = Some(Direction::Up);
        for (i, point) in sweep.points.iter_mut().enumerate() {
            point.excitation = 5.0 + 0.25 * i as f64;
            point.force = Some(0.1);
        }
        let overlay = overlay(&rig, None, &Predicting::default(), &[sweep]).unwrap();
        let kinds: Vec<Option<Kind>> = overlay.pairs.iter().map(|p| p.motion).collect();
        assert!(kinds.contains(&Some(Kind::Impacting)) && kinds.contains(&Some(Kind::Free)), "{kinds:?}");
        for pair in overlay.pairs.iter().filter(|p| p.motion == Some(Kind::Free)) {
            assert_eq!(pair.model, "closed-form", "{pair:?}");
        }
    }

    #[test]
    fn a_start_from_rest_that_strikes_where_a_long_sweep_would_not_is_said() {
        // At 58 Hz both motions are possible; at full force from rest the first cycles overshoot the gap.
        let rig =
            Rig { m1: 0.5, m2: 1.0, k1: 3e4, k2: 8e4, c1: 10.0, c2: 20.0, restitution: 0.5, ..Rig::thesis() };
        let mut sweep = free("m", &rig, 30.0);
        for (i, point) in sweep.points.iter_mut().enumerate() {
            point.excitation = 57.0 + 0.1 * i as f64;
            point.force = Some(30.0);
        }
        let contact = Some(crate::model::ContactKeys { stiffness: Some(1e9), ..Default::default() });
        let predicting = Predicting { contact, ..Predicting::default() };
        let overlay = overlay(&rig, None, &predicting, &[sweep]).unwrap();
        assert!(overlay.pairs.iter().any(|p| p.motion == Some(Kind::Impacting)));
        let linear = overlay.rungs.iter().flat_map(|r| &r.stretches).any(|s| s.chosen == Some(Model::Linear));
        assert!(linear && overlay.warnings.iter().any(|w| w.contains("led from rest")), "{overlay:?}");
    }
}
