//! Measured sweeps, and how they are predicted.

use super::forcing::Forcing;
use super::prediction::{Kind, Prediction};
use super::simulated::{Pace, simulated};
use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponsePoint};
use crate::model::ladder::Model;
use crate::model::{Law, Rig};
use crate::record::{Direction, Finding};

/// One sweep to be compared with the model.
pub(super) struct Swept<'a> {
    pub response: &'a Response,
    pub mass: u8,
    pub direction: Direction,
    pub forcing: Forcing,
}

impl<'a> Swept<'a> {
    /// All displacement responses that name their mass and direction, with findings of their force, of which `stated` is in N.
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
        points.sort_by(|a, b| a.excitation.total_cmp(&b.excitation));
        if self.direction == Direction::Down {
            points.reverse();
        }
        points
    }
}

/// How all sweeps are predicted.
#[derive(Clone, Copy)]
pub(super) struct Course<'a> {
    pub rig: &'a Rig,
    pub model: Model,
    pub law: Option<Law>,
    pub pace: Pace,
}

/// Points of a simulated curve: their distance is far below the width of a resonance.
const FOLLOWED: usize = 400;
/// Cycles at each: fewer than at a measured point, since the motion goes on from one to the next.
const PASSING: Pace = Pace { settle: 100, measure: 16 };

/// A point of a predicted curve as a sweep follows it.
pub(super) struct Followed {
    pub frequency: f64,
    /// NaN where the motion cannot be followed.
    pub amplitude: f64,
    /// Whether the masses meet once a cycle.
    pub impacting: bool,
}

impl Course<'_> {
    /// The curve that a sweep follows, in order of rising frequency: of the closed form where impacts take no time, else simulated.
    pub fn followed(&self, sweep: &Swept<'_>, curve: &Prediction) -> Vec<Followed> {
        let point = |frequency: f64, motion: Option<(Kind, [f64; 2])>| Followed {
            frequency,
            amplitude: motion.map_or(f64::NAN, |(_, amplitude)| amplitude[usize::from(sweep.mass) - 1]),
            impacting: motion.is_some_and(|(kind, _)| kind == Kind::Impacting),
        };
        if self.law.is_none() {
            let motions =
                curve.followed(sweep.direction).into_iter().map(|m| m.map(|m| (m.kind, m.amplitude)));
            return curve.frequency.iter().zip(motions).map(|(f, motion)| point(*f, motion)).collect();
        }
        let step = curve.frequency.len().div_ceil(FOLLOWED).max(1);
        let mut points: Vec<(f64, f64)> =
            curve.frequency.iter().step_by(step).map(|f| (*f, sweep.forcing.at(*f))).collect();
        if sweep.direction == Direction::Down {
            points.reverse();
        }
        let simulated = simulated(self.rig, self.law, &points, PASSING).into_iter();
        let motions = simulated.map(|s| s.ok().map(|s| (Kind::of(s.regime), s.amplitude)));
        let mut followed: Vec<Followed> =
            points.iter().zip(motions).map(|((f, _), motion)| point(*f, motion)).collect();
        followed.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        followed
    }
}
