//! What drives mass 1.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Excitation of mass 1, told apart by its `kind`.
///
/// ```
/// use vibroimpact::model::{Excitation, Sine};
/// let e: Excitation = toml::from_str("kind = \"sine\"\nforce = 0.5\nfrequency = 11.0")?;
/// assert_eq!(e, Excitation::Sine(Sine { force: 0.5, frequency: 11.0 }));
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Excitation {
    /// F₀ cos(ωt + θ).
    Sine(Sine),
}

/// Sine force F₀ cos(ωt + θ); its phase θ belongs to the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Force amplitude F₀ in N.
    pub force: f64,
    /// Frequency in Hz.
    pub frequency: f64,
}

impl Sine {
    /// Checks that amplitude and frequency are finite, the amplitude not negative and the frequency above 0.
    ///
    /// # Errors
    /// If one of them is not.
    pub fn check(&self) -> Result<()> {
        if !(self.force.is_finite() && self.force >= 0.0) {
            return Err(Error::usage(
                format!("force is {} N", self.force),
                "a finite amplitude of 0 or more",
            ));
        }
        if !(self.frequency.is_finite() && self.frequency > 0.0) {
            return Err(Error::usage(
                format!("frequency is {} Hz", self.frequency),
                "a finite value above 0",
            ));
        }
        Ok(())
    }

    /// Angular frequency ω in rad/s.
    pub fn omega(&self) -> f64 {
        TAU * self.frequency
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_kinds_and_keys_are_refused() {
        let text = "kind = \"sine\"\nforce = 0.5\nfrequency = 11.0\nphase = 0.1";
        assert!(toml::from_str::<Excitation>(text).unwrap_err().to_string().contains("phase"));
        assert!(toml::from_str::<Excitation>("kind = \"saw\"").unwrap_err().to_string().contains("saw"));
    }

    #[test]
    fn impossible_values_are_named() {
        for (force, frequency, start) in [
            (-1.0, 5.0, "force is -1 N"),
            (f64::NAN, 5.0, "force is NaN N"),
            (1.0, 0.0, "frequency is 0 Hz"),
            (1.0, f64::INFINITY, "frequency is inf Hz"),
        ] {
            let text = Sine { force, frequency }.check().unwrap_err().to_string();
            assert!(text.starts_with(start), "{text}");
        }
    }
}
