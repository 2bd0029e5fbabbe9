//! What an instrument shows of a motion.
//!
//! A measured displacement spectrum is compared with the complex fundamental |X| of the predicted motion, a displacement
//! trace with half its peak-to-peak. The two differ by all harmonics that impacts make; one is never compared with the
//! other.

use crate::model::{NoImpact, Orbit};

/// How the displacement was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observable {
    /// Line at the excitation of a displacement spectrum, peak amplitude in m.
    Fundamental,
    /// Half the peak-to-peak of a displacement trace in m.
    HalfPeakToPeak,
}

impl Observable {
    /// What it shows of an orbit: x₁ and x₂ in m.
    pub fn of_orbit(self, orbit: &Orbit) -> [f64; 2] {
        match self {
            Observable::Fundamental => orbit.fundamental.map(num_complex::Complex::norm),
            Observable::HalfPeakToPeak => orbit.peak_to_peak.map(|p| p / 2.0),
        }
    }

    /// What it shows of the motion without impacts: a sine of mass 1, while mass 2 rests.
    pub fn of_no_impact(self, motion: &NoImpact) -> [f64; 2] {
        [motion.amplitude, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Rig, orbits};

    #[test]
    fn an_impacting_motion_shows_more_in_a_trace_than_in_its_fundamental() {
        // Harmonics of an impact train add in phase at the impact, so half the peak-to-peak is the larger one here.
        let found = orbits(&Rig::thesis(), 0.5, 11.0).unwrap();
        let [line, _] = Observable::Fundamental.of_orbit(&found.orbits[0]);
        let [trace, _] = Observable::HalfPeakToPeak.of_orbit(&found.orbits[0]);
        assert!(trace > line, "{trace} against {line}");
        assert_eq!(Observable::Fundamental.of_no_impact(&found.no_impact)[1], 0.0);
    }
}
