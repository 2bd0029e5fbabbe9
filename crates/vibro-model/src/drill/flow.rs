//! Flow between the cushion and the ambient air, by ISO 6358-1:2013.
//!
//! From p₁ to p₂ < p₁ flows ṁ = Cρ₀p₁√(T₀/T₁)ψ, with ψ = 1 for p₂/p₁ ≤ b and
//! ψ² = 1 − ((p₂/p₁ − b)/(1 − b))² above. The standard's slope is infinite at equal pressures. Within 0.5 %
//! of them the flow is linear in the pressure difference, and the temperature goes over from one side's to
//! the other's.

use super::machine::Machine;
use serde::{Deserialize, Serialize};

/// Gas constant of the standard reference atmosphere in J/(kg K).
pub const GAS_CONSTANT: f64 = 288.0;
/// Density ρ₀ in kg/m³ of the standard reference atmosphere, at 100 kPa and T₀.
const REFERENCE_DENSITY: f64 = 1.185;
/// Temperature T₀ in K of the standard reference atmosphere.
const REFERENCE_TEMPERATURE: f64 = 293.15;
/// Ratio of the pressures above which the flow is linear.
pub(super) const LINEAR_RATIO: f64 = 0.995;
/// Choked mass flow of an ideal nozzle of air, over A p₁/√(RT₁): √κ (2/(κ + 1))^{(κ+1)/(2κ−2)}, κ = 1.4.
const NOZZLE: f64 = 0.684_731_456_377_270_5;

/// Vent area at a position of the striker.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Vent {
    /// Position of the striker in m.
    pub position: f64,
    /// Effective area in m²: the open area times its discharge coefficient.
    pub area: f64,
}

/// Openings of the cushion: a constant leakage, and vents that the striker opens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Flow {
    /// Sonic conductance C of the leakage in m³/(s Pa).
    pub leakage: f64,
    /// Critical pressure ratio b of leakage and vents.
    pub critical_ratio: f64,
    /// Vent area over the striker's position, rising in position. It is linear between the rows and constant
    /// outside. Empty without vents.
    pub vents: Vec<Vent>,
}

/// Regime of the flow. Each has a smooth law that holds a little beyond its borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FlowRegime {
    ChokedOut,
    Out,
    Even,
    In,
    ChokedIn,
}

impl Default for Flow {
    fn default() -> Flow {
        Machine::example().flow
    }
}

impl Flow {
    /// No opening.
    pub const SEALED: Flow = Flow { leakage: 0.0, critical_ratio: 0.5, vents: Vec::new() };

    /// Whether nothing ever flows.
    pub fn is_sealed(&self) -> bool {
        self.leakage == 0.0 && self.vents.iter().all(|vent| vent.area == 0.0)
    }

    /// Sonic conductance in m³/(s Pa) of an effective area of 1 m².
    pub fn conductance_of_area() -> f64 {
        NOZZLE / (REFERENCE_DENSITY * (GAS_CONSTANT * REFERENCE_TEMPERATURE).sqrt())
    }

    /// Index of the stretch of the vents that holds a position (m): 0 before the first row.
    pub(super) fn stretch(&self, position: f64) -> usize {
        self.vents.iter().take_while(|vent| vent.position <= position).count()
    }

    /// Sonic conductance at the position 0 and its slope, of the line that holds in a stretch.
    pub(super) fn conductance(&self, stretch: usize) -> [f64; 2] {
        let factor = Flow::conductance_of_area();
        let before = stretch.checked_sub(1).and_then(|i| self.vents.get(i));
        let [start, slope] = match (before, self.vents.get(stretch)) {
            (Some(a), Some(b)) => {
                let slope = (b.area - a.area) / (b.position - a.position);
                [a.area - slope * a.position, slope]
            }
            (Some(end), None) | (None, Some(end)) => [end.area, 0.0],
            (None, None) => [0.0, 0.0],
        };
        [self.leakage + factor * start, factor * slope]
    }

    /// Mass flow in kg/s into the cushion, and the temperature in K of what flows. `conductance` in
    /// m³/(s Pa), pressures in Pa, temperatures in K; `outside` belongs to the ambient air.
    #[inline]
    pub(super) fn rate(
        &self,
        regime: FlowRegime,
        conductance: f64,
        [pressure, outside]: [f64; 2],
        [temperature, temperature_outside]: [f64; 2],
    ) -> [f64; 2] {
        let psi = |ratio: f64| {
            let part = (ratio - self.critical_ratio) / (1.0 - self.critical_ratio);
            (1.0 - part * part).max(0.0).sqrt()
        };
        let (driven, at) = match regime {
            FlowRegime::ChokedOut => (-pressure, temperature),
            FlowRegime::Out => (-pressure * psi(outside / pressure), temperature),
            FlowRegime::Even => {
                let [low, high] = [LINEAR_RATIO * outside, outside / LINEAR_RATIO];
                let part = (pressure - low) / (high - low);
                let at = temperature_outside + part * (temperature - temperature_outside);
                ((outside - pressure) / (1.0 - LINEAR_RATIO) * psi(LINEAR_RATIO), at)
            }
            FlowRegime::In => (outside * psi(pressure / outside), temperature_outside),
            FlowRegime::ChokedIn => (outside, temperature_outside),
        };
        let flow = conductance * REFERENCE_DENSITY * driven * (REFERENCE_TEMPERATURE / at).sqrt();
        [flow, at]
    }

    /// Regime at a pressure (Pa) in the cushion.
    pub(super) fn regime(&self, pressure: f64, outside: f64) -> FlowRegime {
        let b = self.critical_ratio;
        match pressure / outside {
            ratio if ratio * b >= 1.0 => FlowRegime::ChokedOut,
            ratio if ratio * LINEAR_RATIO >= 1.0 => FlowRegime::Out,
            ratio if ratio > LINEAR_RATIO => FlowRegime::Even,
            ratio if ratio > b => FlowRegime::In,
            _ => FlowRegime::ChokedIn,
        }
    }

    /// Borders of a regime: the pressure over the ambient one, whether the pressure leaves by rising, and the
    /// regime beyond.
    pub(super) fn borders(&self, regime: FlowRegime) -> [Option<(f64, bool, FlowRegime)>; 2] {
        use FlowRegime::{ChokedIn, ChokedOut, Even, In, Out};
        let (choked, even) = (self.critical_ratio, LINEAR_RATIO);
        match regime {
            ChokedOut => [Some((1.0 / choked, false, Out)), None],
            Out => [Some((1.0 / even, false, Even)), Some((1.0 / choked, true, ChokedOut))],
            Even => [Some((even, false, In)), Some((1.0 / even, true, Out))],
            In => [Some((choked, false, ChokedIn)), Some((even, true, Even))],
            ChokedIn => [Some((choked, true, In)), None],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_is_that_of_the_standard_and_continuous() {
        let flow = Flow { leakage: 1e-9, critical_ratio: 0.4, vents: Vec::new() };
        let ambient = 1e5;
        let rate = |p: f64| flow.rate(flow.regime(p, ambient), 1e-9, [p, ambient], [350.0, 293.15])[0];
        // Choked outwards: Cρ₀p√(T₀/T); inwards at T₀.
        assert!((rate(4e5) / (-1e-9 * 1.185 * 4e5 * (293.15_f64 / 350.0).sqrt()) - 1.0).abs() < 1e-14);
        assert!((rate(3e4) / (1e-9 * 1.185 * 1e5) - 1.0).abs() < 1e-14);
        // Subsonic inwards at p₂/p₁ = 0.7: ψ = √(1 − 0.5²).
        assert!((rate(7e4) / (1e-9 * 1.185 * 1e5 * 0.75_f64.sqrt()) - 1.0).abs() < 1e-14);
        assert_eq!(rate(ambient), 0.0);
        for regime in
            [FlowRegime::ChokedOut, FlowRegime::Out, FlowRegime::Even, FlowRegime::In, FlowRegime::ChokedIn]
        {
            for (ratio, rising, beyond) in flow.borders(regime).into_iter().flatten() {
                let p = ratio * ambient;
                let [here, there] =
                    [regime, beyond].map(|r| flow.rate(r, 1e-9, [p, ambient], [350.0, 293.15])[0]);
                // The square root near choked flow turns a rounding ε into √ε.
                assert!((here - there).abs() < 1e-7 * here.abs(), "{regime:?} {beyond:?}");
                let ahead = if rising { 1.0 + 1e-9 } else { 1.0 - 1e-9 };
                assert!(flow.regime(p * ahead, ambient) == beyond);
            }
        }
    }

    #[test]
    fn vents_open_along_their_rows() {
        let vents = vec![Vent { position: 0.01, area: 0.0 }, Vent { position: 0.02, area: 2e-6 }];
        let flow = Flow { leakage: 1e-10, critical_ratio: 0.5, vents };
        let at = |x: f64| {
            let [start, slope] = flow.conductance(flow.stretch(x));
            start + slope * x
        };
        // An ideal nozzle of 1 mm² has some 0.2 dm³/(s bar) = 2e-9 m³/(s Pa).
        let nozzle = Flow::conductance_of_area() * 1e-6;
        assert!((1.9e-9..2.1e-9).contains(&nozzle), "{nozzle}");
        for (x, area) in [(0.0, 0.0), (0.01, 0.0), (0.015, 1.0), (0.02, 2.0), (0.03, 2.0)] {
            assert!((at(x) - 1e-10 - area * nozzle).abs() < 1e-22, "{x}");
        }
    }
}
