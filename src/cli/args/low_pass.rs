//! A low-pass, as typed.

/// A corner in Hz, or `none`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowPass {
    Corner(f64),
    Off,
}

/// Reads it.
pub fn low_pass(text: &str) -> Result<LowPass, String> {
    match text {
        "none" => Ok(LowPass::Off),
        _ => text.parse().map(LowPass::Corner).map_err(|_| "a corner in Hz, or none".to_owned()),
    }
}
