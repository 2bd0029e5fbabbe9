//! What drives the rig in all sweeps, and what is computed of them.

use serde::Deserialize;

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
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
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
