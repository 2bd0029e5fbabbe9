//! A low-pass, as typed.

/// A corner in Hz, or `none`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowPass {
    Corner(f64),
    Off,
}

impl LowPass {
    /// The corner in Hz, if there is one.
    pub fn corner(self) -> Option<f64> {
        if let LowPass::Corner(hz) = self { Some(hz) } else { None }
    }
}

/// Reads it.
pub fn low_pass(text: &str) -> Result<LowPass, String> {
    match text {
        "none" => Ok(LowPass::Off),
        _ => text.parse().map(LowPass::Corner).map_err(|_| "a corner in Hz, or none".to_owned()),
    }
}
