//! Measured sweeps, their prediction, and the models of the ladder that the prediction needs.

use super::forcing::Forcing;
use super::prediction::{MotionKind, Prediction, in_order};
use super::simulated::{Pace, simulated};
use crate::campaign::ModelEntry;
use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponsePoint};
use crate::model::ladder::{self, Choice, Model, Need, Question, Stretch, choose_over};
use crate::model::{ContactKeys, Excitation, Law, Observable, Rig, Scene, Sine};
use crate::record::{Direction, Finding, sort_by_number};
use serde::Serialize;

/// One sweep to be compared with the model.
pub(super) struct Swept<'a> {
    pub response: &'a Response,
    pub mass: u8,
    pub direction: Direction,
    pub forcing: Forcing,
}

impl<'a> Swept<'a> {
    /// All displacement responses that state mass and direction, with findings on their force. `stated` is
    /// the force in N.
    ///
    /// # Errors
    /// If there is no such response, or no force is known.
    pub fn all(stated: Option<f64>, responses: &'a [Response]) -> Result<(Vec<Swept<'a>>, Vec<Finding>)> {
        let displacement = responses.iter().filter(|r| r.quantity == "displacement");
        let usable: Vec<(&Response, u8, Direction)> = displacement
            .filter_map(|r| Some((r, r.mass.filter(|m| [1, 2].contains(m))?, r.direction?)))
            .collect();
        if usable.iter().all(|u| u.0.points.is_empty()) {
            return Err(Error::refused("no response can be compared with the model")
                .hint("state `mass = 1` or `2` for each sweep, with three or more points in one direction"));
        }
        let (forcings, findings) = Forcing::of_all(stated, &usable.iter().map(|u| u.0).collect::<Vec<_>>())?;
        let swept = usable.into_iter().zip(forcings);
        let swept =
            swept.map(|((response, mass, direction), forcing)| Swept { response, mass, direction, forcing });
        Ok((swept.collect(), findings))
    }

    /// Points in the order of their measurement.
    pub fn points(&self) -> Vec<&'a ResponsePoint> {
        let mut points: Vec<&ResponsePoint> = self.response.points.iter().collect();
        sort_by_number(&mut points, |a| a.excitation);
        in_order(self.direction, points)
    }
}

/// Rig, model and pace of the prediction of all sweeps.
#[derive(Clone, Copy)]
pub(super) struct Predictor<'a> {
    pub rig: &'a Rig,
    pub model: Model,
    pub law: Option<Law>,
    pub pace: Pace,
}

/// Largest number of points of a simulated curve, spaced far below the width of a resonance.
const CURVE_POINTS: usize = 400;
/// Cycles at each point of a simulated curve: fewer than at a measured point, since the next point is close.
const CURVE_PACE: Pace = Pace { settle: 100, measure: 16 };

/// A point of the predicted curve that a sweep follows.
pub(super) struct Followed {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Amplitude in m of the mass of the sweep; NaN where the motion cannot be followed.
    pub amplitude: f64,
    /// Whether the masses meet once a cycle.
    pub impacting: bool,
}

impl Predictor<'_> {
    /// The curve that a sweep follows, by rising frequency: by the closed form where impacts take no time,
    /// else simulated.
    pub fn followed(&self, sweep: &Swept<'_>, curve: &Prediction) -> Vec<Followed> {
        let point = |frequency: f64, motion: Option<(MotionKind, [f64; 2])>| Followed {
            frequency,
            amplitude: motion.map_or(f64::NAN, |(_, amplitude)| amplitude[usize::from(sweep.mass) - 1]),
            impacting: motion.is_some_and(|(kind, _)| kind == MotionKind::Impacting),
        };
        if self.law.is_none() {
            let motions =
                curve.followed(sweep.direction).into_iter().map(|m| m.map(|m| (m.kind, m.amplitude)));
            return curve.frequency.iter().zip(motions).map(|(f, motion)| point(*f, motion)).collect();
        }
        let step = curve.frequency.len().div_ceil(CURVE_POINTS).max(1);
        let points = curve.frequency.iter().step_by(step).map(|f| (*f, sweep.forcing.at(*f)));
        let points = in_order(sweep.direction, points.collect());
        let simulated = simulated(self.rig, self.law, &points, CURVE_PACE).into_iter();
        let motions = simulated.map(|s| s.ok().map(|s| (MotionKind::of(s.regime), s.amplitude)));
        let followed = points.iter().zip(motions).map(|((f, _), motion)| point(*f, motion));
        in_order(sweep.direction, followed.collect())
    }
}

/// Settings of predictions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Predicting {
    /// Model, tolerance of its choice, and pace.
    pub model: ModelEntry,
    /// Known properties of the contact.
    pub contact: Option<ContactKeys>,
}

/// The choice of a model for sweeps in one direction at one force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rungs {
    /// Force in N.
    pub force: f64,
    /// Direction of the sweep.
    pub direction: Direction,
    /// The adequate rung by frequency range.
    pub stretches: Vec<Stretch>,
    /// Keys of the scene that must be stated where no model can be chosen.
    pub open: Option<String>,
    /// The finding on these keys, at the frequency where they change the answer most.
    #[serde(skip)]
    pub finding: Option<Finding>,
}

/// Number of frequencies at which the ladder is evaluated: two per Hz in the range of both resonances of the
/// thesis' rig.
const LADDER_POINTS: usize = 24;

/// Evaluates the ladder at evenly spaced frequencies (Hz) of a sweep: whether a model is adequate for the
/// fundamental of the displacement.
///
/// # Errors
/// As [`choose_over`].
pub fn rungs(
    rig: &Rig,
    predicting: &Predicting,
    force: f64,
    direction: Direction,
    (low, high): (f64, f64),
) -> Result<Rungs> {
    let scene = predicting.scene(rig, force, low);
    let question = Question {
        tolerance: predicting.model.tolerance,
        history: Some(direction),
        ..Question::new(Observable::Fundamental)
    };
    let survey = choose_over(&scene, low, high, LADDER_POINTS, &question)?;
    let moves = |p: &&Choice| p.sensitivity.iter().map(|s| s.change.abs()).fold(0.0, f64::max);
    let open = survey.points.iter().filter(|p| p.chosen.is_none());
    let open = open.max_by(|a, b| moves(a).total_cmp(&moves(b)));
    let needs = open.map(|p| Need::names(&p.needs));
    let finding = open.map(|p| {
        let finding = Finding::caution("model-not-chosen").number("frequency", p.frequency);
        let finding = finding.name("needs", Need::names(&p.needs));
        if p.sensitivity.is_empty() { finding } else { finding.number("part", moves(&p)) }
    });
    Ok(Rungs { force, direction, stretches: survey.stretches, open: needs, finding })
}

impl Predicting {
    /// Cycles of the simulated rig at each point.
    pub fn pace(&self) -> Pace {
        Pace { settle: self.model.settle, measure: self.model.measure }
    }

    fn scene(&self, rig: &Rig, force: f64, frequency: f64) -> Scene {
        let excitation = Some(Excitation::Sine(Sine { force, frequency }));
        Scene { rig: *rig, excitation, contact: self.contact, buffer: None, springs: None, uncertainty: None }
    }

    /// The model of all sweeps: the named one, else the highest chosen in any frequency range. Rigid
    /// impacts replace lower rungs, and are assumed where none can be chosen.
    pub fn model(&self, choices: &[Rungs]) -> Model {
        if let Some(named) = self.model.name {
            return named.model();
        }
        let highest = choices.iter().flat_map(|r| &r.stretches).filter_map(|s| s.chosen).max();
        let contact = self.contact.unwrap_or_default();
        let curved = contact.exponent.is_some_and(|n| n != 1.0);
        match highest {
            // Without a stated damping a curved contact has no restitution that holds for all speeds.
            Some(Model::HuntCrossley) if curved && contact.damping.is_some() => Model::HuntCrossley,
            // A contact of spring and damper includes in full what the soft correction has to first order.
            Some(Model::SoftCorrected | Model::KelvinVoigt | Model::HuntCrossley) if !curved => {
                Model::KelvinVoigt
            }
            _ => Model::Restitution,
        }
    }

    /// The law of the contact of `model`.
    ///
    /// # Errors
    /// As [`ladder::law`].
    pub fn law(&self, rig: &Rig, model: Model) -> Result<Option<Law>> {
        ladder::law(&self.scene(rig, 1.0, 1.0), model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Follows;

    #[test]
    fn a_soft_contact_asks_for_a_richer_model_than_a_stiff_one() {
        let rig = Rig::thesis();
        let asked = |stiffness: f64| {
            let contact = Some(ContactKeys { stiffness: Some(stiffness), ..ContactKeys::default() });
            let predicting = Predicting { contact, ..Predicting::default() };
            let found = rungs(&rig, &predicting, 0.5, Direction::Up, (10.0, 10.6)).unwrap();
            predicting.model(&[found])
        };
        // 1e4 N/m keeps the masses together for 7 % of the cycle, 1e9 N/m for 0.02 %.
        assert_eq!(asked(1e4), Model::KelvinVoigt);
        assert_eq!(asked(1e9), Model::Restitution);
    }

    #[test]
    fn history_goes_past_a_stretch_where_the_impacting_motion_is_unstable() {
        // Between 7.0 and 7.3 Hz the motion with one impact a cycle is unstable and the one without impacts
        // exists. A sweep up keeps impacting to the fold at 10.66 Hz; a sweep down stays free.
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let contact = Some(ContactKeys { stiffness: Some(1e9), ..ContactKeys::default() });
        let predicting = Predicting { contact, ..Predicting::default() };
        let chosen = |direction, range| {
            let found = rungs(&rig, &predicting, 0.1, direction, range).unwrap();
            found.stretches.iter().map(|s| s.chosen).collect::<Vec<_>>()
        };
        assert!(!chosen(Direction::Up, (9.0, 10.5)).contains(&Some(Model::Linear)));
        assert_eq!(chosen(Direction::Down, (9.0, 10.5)), [Some(Model::Linear)]);
    }

    #[test]
    fn an_unknown_stiffness_is_said_and_a_named_model_is_taken() {
        let rig = Rig::thesis();
        let found = rungs(&rig, &Predicting::default(), 0.5, Direction::Up, (10.0, 10.6)).unwrap();
        assert_eq!(found.open.as_deref(), Some("contact.stiffness"));
        // Between 1e4 N/m (in contact for 7 % of the cycle) and 1e9 N/m the answer changes by more than the
        // tolerated 2 %.
        assert!(found.finding.as_ref().is_some_and(|f| f.get("part").unwrap() > 0.02), "{found:?}");
        assert_eq!(Predicting::default().model(&[found]), Model::Restitution);
        let model = ModelEntry { name: Some(Follows::KelvinVoigt), ..ModelEntry::default() };
        let named = Predicting { model, ..Predicting::default() };
        assert!(named.law(&rig, named.model(&[])).unwrap_err().to_string().contains("contact.stiffness"));
    }
}
