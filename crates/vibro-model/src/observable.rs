//! Observables: the numbers by which measured and predicted motions are compared.
//!
//! A measured displacement spectrum is compared with the complex fundamental |X| of the predicted motion, a
//! displacement trace with half its peak-to-peak value. These two differ by all harmonics that impacts cause,
//! and are never compared with each other.

use super::orbit::{Orbit, Softened};
use super::steady::NoImpact;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// How a motion was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observable {
    /// Line at the excitation of a displacement spectrum, peak amplitude in m.
    Fundamental,
    /// Half the peak-to-peak of a displacement trace in m.
    #[serde(rename = "peak")]
    HalfPeakToPeak,
    /// Approach speed in m/s of the fastest impact of a cycle, as the mean over the cycles with impacts; 0
    /// without impacts.
    ImpactSpeed,
    /// Impulse in N s of the fastest impact of a cycle, as the mean over the cycles with impacts.
    Impulse,
}

impl Observable {
    /// Name and unit of each.
    const TABLE: [(&'static str, &'static str); 4] =
        [("fundamental", "m"), ("peak", "m"), ("impact-speed", "m/s"), ("impulse", "N s")];

    /// `fundamental`, `peak`, `impact-speed` or `impulse`.
    pub fn name(self) -> &'static str {
        Observable::TABLE[self as usize].0
    }

    /// Its unit: `m`, `m/s` or `N s`.
    pub fn unit(self) -> &'static str {
        Observable::TABLE[self as usize].1
    }

    /// Whether it is one number for both masses, not one for each.
    pub fn is_of_impacts(self) -> bool {
        matches!(self, Observable::ImpactSpeed | Observable::Impulse)
    }

    /// Its value for an orbit: of x₁ and x₂ in m; of the impacts, which both masses share, the same number
    /// twice.
    pub fn of_orbit(self, orbit: &Orbit) -> [f64; 2] {
        let fundamental = orbit.fundamental.map(Complex64::norm);
        self.of(fundamental, orbit.peak_to_peak, orbit.approach_velocity, orbit.impulse)
    }

    /// Its value for an orbit corrected for the duration of its contact.
    pub(crate) fn of_softened(self, orbit: &Softened) -> [f64; 2] {
        self.of(orbit.fundamental, orbit.peak_to_peak, orbit.approach_velocity, orbit.impulse)
    }

    fn of(self, fundamental: [f64; 2], peak_to_peak: [f64; 2], speed: f64, impulse: f64) -> [f64; 2] {
        match self {
            Observable::Fundamental => fundamental,
            Observable::HalfPeakToPeak => peak_to_peak.map(|p| p / 2.0),
            Observable::ImpactSpeed => [speed; 2],
            Observable::Impulse => [impulse; 2],
        }
    }

    /// Its value for the motion without impacts: mass 1 moves, mass 2 is at rest.
    ///
    /// Under impulses or pulses the fundamental is also taken as half the peak-to-peak value.
    pub fn of_no_impact(self, motion: &NoImpact) -> [f64; 2] {
        if self.is_of_impacts() { [0.0; 2] } else { [motion.amplitude, 0.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::orbits;
    use crate::rig::Rig;

    #[test]
    fn an_impacting_motion_shows_more_in_a_trace_than_in_its_fundamental() {
        // Harmonics of an impact train add in phase at the impact, so here half the peak-to-peak value is
        // larger.
        let found = orbits(&Rig::thesis(), 0.5, 11.0).unwrap();
        let [line, _] = Observable::Fundamental.of_orbit(&found.orbits[0]);
        let [trace, _] = Observable::HalfPeakToPeak.of_orbit(&found.orbits[0]);
        assert!(trace > line, "{trace} against {line}");
        assert_eq!(Observable::Fundamental.of_no_impact(&found.no_impact)[1], 0.0);
        assert_eq!(Observable::ImpactSpeed.of_no_impact(&found.no_impact), [0.0; 2]);
    }
}
