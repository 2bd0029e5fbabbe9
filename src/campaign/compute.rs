//! What drives the rig in all sweeps, how it is predicted, and what is computed.

use crate::model::ladder::Model;
use serde::Deserialize;

/// A key with an impossible value, and why it is.
pub(super) type Fault = (&'static str, String);

/// What drives mass 1 in all sweeps.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// `sine`.
    #[serde(default)]
    pub kind: DriveKind,
    /// Force amplitude in N; left out, the measured force is taken.
    pub force: Option<f64>,
}

/// Kinds of excitation of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriveKind {
    /// Harmonic force.
    #[default]
    Sine,
}

/// What to compute, and how.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Compute {
    /// Overlay measured responses on the model. Default: where a rig is given.
    pub overlay: bool,
    /// Draw waterfalls. Default true.
    pub waterfall: bool,
    /// Lines on both sides of the excitation in which a peak is looked for. Default 3.
    pub band: usize,
    /// Cut-off in Hz. Default: two lines or a quarter of the lowest excitation.
    pub fmin: Option<f64>,
    /// Highest frequency in waterfalls, in Hz. Default: the base band.
    pub fmax: Option<f64>,
}

impl Compute {
    /// What cannot be: key and sentence.
    pub(super) fn check(&self) -> Result<(), Fault> {
        for (key, value) in [("fmin", self.fmin), ("fmax", self.fmax)] {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err((key, format!("{key} = {v} is not a finite number above 0")));
            }
        }
        if !(1..=1000).contains(&self.band) {
            return Err(("band", format!("band = {} is not between 1 and 1000 lines", self.band)));
        }
        Ok(())
    }
}

impl Default for Compute {
    fn default() -> Compute {
        Compute { overlay: true, waterfall: true, band: 3, fmin: None, fmax: None }
    }
}

/// The table `[model]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelEntry {
    /// The model that predicts. Left out, the ladder chooses.
    pub name: Option<Follows>,
    /// Relative change of an amplitude that does not matter when a model is chosen. Default 0.02.
    pub tolerance: f64,
    /// Cycles that the simulated rig stays at each point of a sweep before it is read. Default 300.
    pub settle: u32,
    /// Cycles read. Default 64.
    pub measure: u32,
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

impl Default for ModelEntry {
    /// On the thesis' rig a disturbance falls below e⁻⁸ within 300 cycles.
    fn default() -> ModelEntry {
        ModelEntry { name: None, tolerance: 0.02, settle: 300, measure: 64 }
    }
}

impl ModelEntry {
    /// What cannot be.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let tolerance = self.tolerance;
        if !(1e-4..=1.0).contains(&tolerance) {
            return Err(("tolerance", format!("tolerance = {tolerance}: expected a part from 0.0001 to 1")));
        }
        if self.measure == 0 {
            return Err(("measure", "measure = 0 cycles: nothing would be read".to_owned()));
        }
        for (key, cycles) in [("settle", self.settle), ("measure", self.measure)] {
            if cycles > MOST {
                return Err((key, format!("{key} = {cycles} cycles at each point, more than {MOST}")));
            }
        }
        Ok(())
    }
}
