//! How the overlay's predictions are made.

use serde::Deserialize;

/// The table `[model]`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelEntry {
    /// Cycles that the simulated rig stays at each point of a sweep before it is read. Default 300.
    pub settle: Option<u32>,
    /// Cycles read. Default 64.
    pub measure: Option<u32>,
}

/// Cycles at a point beyond which a campaign is refused: a sweep of 40 points then takes some seconds.
const MOST: u32 = 1_000_000;

impl ModelEntry {
    /// The key that holds an impossible value, and why.
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
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
