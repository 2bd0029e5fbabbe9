//! How sweeps are predicted.

use super::forcing::Forcing;
use super::prediction::{Kind, Prediction};
use super::simulated::{Pace, Simulated, simulated};
use crate::measure::response::Response;
use crate::model::ladder::Model;
use crate::model::{Law, Rig};
use crate::record::Direction;

/// One sweep to be overlaid.
pub(super) struct Swept<'a> {
    pub response: &'a Response,
    pub mass: u8,
    pub direction: Direction,
    pub forcing: Forcing,
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

/// A predicted curve as a sweep follows it.
pub(super) struct Followed {
    pub frequency: Vec<f64>,
    pub amplitude: Vec<f64>,
    /// Whether the masses meet once a cycle.
    pub impacting: Vec<bool>,
}

impl Course<'_> {
    /// The curve that a sweep follows: of the closed form where impacts take no time, else simulated.
    pub fn followed(&self, sweep: &Swept<'_>, curve: &Prediction) -> Followed {
        let of = usize::from(sweep.mass) - 1;
        if self.law.is_none() {
            let followed = curve.followed(sweep.direction);
            return Followed {
                frequency: curve.frequency.clone(),
                amplitude: followed.iter().map(|m| m.map_or(f64::NAN, |m| m.amplitude[of])).collect(),
                impacting: followed.iter().map(|m| m.is_some_and(|m| m.kind == Kind::Impacting)).collect(),
            };
        }
        let step = curve.frequency.len().div_ceil(FOLLOWED).max(1);
        let mut points: Vec<(f64, f64)> =
            curve.frequency.iter().zip(&curve.force).map(|(f, n)| (*f, *n)).step_by(step).collect();
        if sweep.direction == Direction::Down {
            points.reverse();
        }
        let mut curve: Vec<(f64, Option<Simulated>)> = points
            .iter()
            .map(|p| p.0)
            .zip(simulated(self.rig, self.law, &points, PASSING).into_iter().map(Result::ok))
            .collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        Followed {
            frequency: curve.iter().map(|c| c.0).collect(),
            amplitude: curve.iter().map(|c| c.1.map_or(f64::NAN, |c| c.amplitude[of])).collect(),
            impacting: curve
                .iter()
                .map(|c| c.1.is_some_and(|c| Kind::of(c.regime) == Kind::Impacting))
                .collect(),
        }
    }
}
