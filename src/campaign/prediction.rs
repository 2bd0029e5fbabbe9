//! How the overlay's predictions are made.

use crate::model::ladder::Model;
use serde::Deserialize;

/// The table `[model]`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelEntry {
    /// The model that predicts. Left out, the ladder chooses.
    pub name: Option<Follows>,
    /// Relative change of an amplitude that does not matter when a model is chosen. Default 0.02.
    pub tolerance: Option<f64>,
    /// Cycles that the simulated rig stays at each point of a sweep before it is read. Default 300.
    pub settle: Option<u32>,
    /// Cycles read. Default 64.
    pub measure: Option<u32>,
}

/// Models that can follow a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Follows {
    /// Impacts without duration.
    Restitution,
    /// A contact of spring and damper.
    KelvinVoigt,
    /// A contact whose force is no straight line.
    HuntCrossley,
}

impl Follows {
    /// The rung of the ladder.
    pub fn model(self) -> Model {
        match self {
            Follows::Restitution => Model::Restitution,
            Follows::KelvinVoigt => Model::KelvinVoigt,
            Follows::HuntCrossley => Model::HuntCrossley,
        }
    }
}

/// Cycles at a point beyond which a campaign is refused: a sweep of 40 points then takes some seconds.
const MOST: u32 = 1_000_000;

impl ModelEntry {
    /// The key that holds an impossible value, and why.
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
        if let Some(tolerance) = self.tolerance.filter(|t| !(1e-4..=1.0).contains(t)) {
            return Err(("tolerance", format!("tolerance = {tolerance}: expected a part from 0.0001 to 1")));
        }
        if self.measure == Some(0) {
            return Err(("measure", "measure = 0 cycles: nothing would be read".to_owned()));
        }
        for (key, cycles) in [("settle", self.settle), ("measure", self.measure)] {
            if let Some(cycles) = cycles.filter(|c| *c > MOST) {
                return Err((key, format!("{key} = {cycles} cycles at each point, more than {MOST}")));
            }
        }
        Ok(())
    }
}
