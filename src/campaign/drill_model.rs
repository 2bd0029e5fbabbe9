//! The table `[drill_model]`: the model that the joined bodies of a hammer drill are compared with.

use crate::error::Error;
use crate::model::drill::{MachineDraft, Rung};
use serde::Deserialize;
use std::path::PathBuf;

/// The table `[drill_model]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrillModelEntry {
    /// File with a table `[drill]`.
    pub file: PathBuf,
    /// Model. If left out, the ladder of models chooses it.
    #[serde(default)]
    pub rung: Option<Rung>,
    /// Angle of the crank in ° after top dead centre at its pulse. If left out, it is found from the turn.
    #[serde(default)]
    pub pulse_angle: Option<f64>,
    /// Keys of the drill that are fitted to the joined turn; if empty, none is.
    #[serde(default)]
    pub fit: Vec<String>,
    /// Relative standard uncertainty of the velocity scale of each record. Default 0.01, with a caution.
    #[serde(default)]
    pub calibration: Option<f64>,
    /// Turns from rest that are discarded. Default 60.
    #[serde(default)]
    pub settle: Option<usize>,
}

/// Largest number of turns that are discarded.
const MOST_TURNS: usize = 1000;

impl DrillModelEntry {
    /// Checks the values; the error comes with its key.
    pub(super) fn check(&self) -> Result<(), (&'static str, Error)> {
        if let Some(angle) = self.pulse_angle.filter(|angle| !(-360.0..=360.0).contains(angle)) {
            let error = Error::usage(format!("pulse_angle = {angle}"), "degrees from -360 to 360");
            return Err(("pulse_angle", error));
        }
        if let Some(part) = self.calibration.filter(|part| !(0.0..0.5).contains(part)) {
            let expected = "a part from 0 to 0.5: 0.01 is 1 %";
            return Err(("calibration", Error::usage(format!("calibration = {part}"), expected)));
        }
        if let Some(turns) = self.settle.filter(|turns| *turns > MOST_TURNS) {
            let error = Error::usage(format!("settle = {turns} turns"), format!("{MOST_TURNS} at most"));
            return Err(("settle", error));
        }
        for (i, key) in self.fit.iter().enumerate() {
            if key == "crank.frequency" {
                let expected = "another key: the speed is that of the records";
                return Err(("fit", Error::usage("a fit of crank.frequency", expected)));
            }
            if self.fit[..i].contains(key) {
                let error = Error::usage(format!("{key} is fitted twice"), "each key once");
                return Err(("fit", error));
            }
            MachineDraft::default().put(key, 1.0).map_err(|error| ("fit", error))?;
        }
        Ok(())
    }
}
