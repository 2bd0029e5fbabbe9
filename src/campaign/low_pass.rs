//! A low-pass in a campaign: a corner, or none.

use serde::Deserialize;

/// Low-pass of average and displacement of a drill, or of the instrument of a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a corner in Hz, or \"none\"")]
pub enum LowPass {
    /// Corner in Hz.
    Corner(f64),
    /// `none`.
    Off(Word),
}

impl LowPass {
    /// The corner in Hz, if there is one.
    pub fn corner(self) -> Option<f64> {
        if let LowPass::Corner(hz) = self { Some(hz) } else { None }
    }
}

/// The word for no low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Word {
    /// `none`.
    None,
}
