//! Air cushion between the driving piston and the striker.

use super::flow::GAS_CONSTANT;
use super::machine::Machine;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Air cushion: its length is `L = L₀ + x_s − x_p`, its volume `V = A·L + V_d`.
///
/// A sealed cushion follows the polytrope pVⁿ = p₀V₀ⁿ: n = 1 is isothermal, n = 1.4 adiabatic for air.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Cushion {
    /// Area A of piston and striker in m².
    pub area: f64,
    /// Length L₀ in m with the piston at top dead centre and the striker at its origin.
    pub length: f64,
    /// Dead volume in m³.
    pub dead_volume: f64,
    /// Polytropic exponent n, 1 to 1.4.
    pub exponent: f64,
    /// Ambient pressure in Pa, on the far side of piston and striker.
    pub ambient: f64,
    /// Ambient temperature in K.
    pub temperature: f64,
}

impl Default for Cushion {
    fn default() -> Cushion {
        Machine::example().cushion
    }
}

impl Cushion {
    /// Volume in m³ with striker and piston at these positions (m).
    #[inline]
    pub fn volume(&self, striker: f64, piston: f64) -> f64 {
        self.area * (self.length + striker - piston) + self.dead_volume
    }

    /// Volume V₀ in m³ at which a sealed cushion has ambient pressure.
    pub fn rest_volume(&self) -> f64 {
        self.volume(0.0, 0.0)
    }

    /// Pressure in Pa of a sealed cushion of this volume (m³).
    pub fn sealed_pressure(&self, volume: f64) -> f64 {
        self.ambient * (self.rest_volume() / volume).powf(self.exponent)
    }

    /// Mass in kg of air in a cushion at ambient temperature.
    pub fn gas(&self, pressure: f64, volume: f64) -> f64 {
        pressure * volume / (GAS_CONSTANT * self.temperature)
    }

    /// Natural frequency in Hz of small motion of a striker of `mass` (kg) on the sealed cushion.
    pub fn natural_frequency(&self, mass: f64) -> f64 {
        (self.exponent * self.ambient * self.area * self.area / (mass * self.rest_volume())).sqrt() / TAU
    }

    /// Energy in J that the air gives by polytropic expansion to ambient pressure, against that pressure.
    ///
    /// ∫(p − pₐ)dV from V to V(p/pₐ)^{1/n}; with x = ln(p/pₐ)/n this is
    /// pV(1 − e^{−(n−1)x})/(n − 1) − pₐV(eˣ − 1).
    pub fn stored(&self, pressure: f64, volume: f64) -> f64 {
        let rise = (pressure / self.ambient).ln() / self.exponent;
        volume * (pressure * self.expansion(pressure) - self.ambient * rise.exp_m1())
    }

    /// (1 − (pₐ/p)^{(n−1)/n})/(n − 1), which is ∂E/∂p/V of the energy E of [`Cushion::stored`].
    pub(super) fn expansion(&self, pressure: f64) -> f64 {
        let n = self.exponent;
        let rise = (pressure / self.ambient).ln() / n;
        if n == 1.0 { rise } else { -(-(n - 1.0) * rise).exp_m1() / (n - 1.0) }
    }
}
