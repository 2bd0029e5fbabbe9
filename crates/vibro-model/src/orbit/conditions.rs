//! Conditions for orbits with one impact per period, and the orbit of each solution.

use super::validity::Judged;
use super::{Course, Orbit};
use crate::excitation::Excitation;
use crate::green::Green;
use crate::rig::Rig;
use crate::scales;
use num_complex::Complex64;
use vibro_record::{Error, Result};

/// Largest number of swings of a mass in a period: each is searched for contacts, so it limits the work.
const MOST_SWINGS: f64 = 5e4;

/// Conditions of an impact J, with the steady motion y of mass 1 alone: the masses meet where y = Δ + JC, and
/// part by the impact law where ẏ = JP (Babitsky, *Theory of Vibro-Impact Systems* (1998), periodic Green's
/// functions).
#[derive(Debug, Clone, Copy)]
pub struct Conditions {
    pub rig: Rig,
    pub cycles: u32,
    /// Excitation frequency in Hz.
    pub frequency: f64,
    pub greens: [Green; 2],
    /// C = χ₁(0) + χ₂(0) in m/(N s).
    pub c: f64,
    /// P = 1/(M(1+R)) + χ̇₁(T⁻) + χ̇₂(T⁻) in 1/kg.
    pub p: f64,
}

/// A solution of the conditions.
#[derive(Debug, Clone, Copy)]
pub struct Root {
    /// Impulse J in N s.
    pub impulse: f64,
    /// Timing of the impact: φ in rad under a sine force, τ in s under impulses or pulses.
    pub timing: f64,
    /// Phase of the excitation's cycle at the impact, in rad.
    pub force_phase: f64,
    /// |dJ/dΔ| in N s/m.
    pub sensitivity: f64,
    /// Size in m of the terms of y = Δ + JC; rounding is relative to it.
    pub size: f64,
    /// Whether a larger impulse would take more energy than the force provides: the side of the fold.
    pub upper: bool,
}

impl Conditions {
    /// Conditions of one impact in `cycles` cycles at `frequency` (Hz). The impact follows the first touch by
    /// `delay` (s): by then the rigid motions overlap by the approach speed times the delay.
    ///
    /// # Errors
    /// If `cycles` is 0, the period has too many swings, or the period resonates with an undamped mass.
    pub fn new(rig: &Rig, frequency: f64, cycles: u32, delay: f64) -> Result<Conditions> {
        if cycles == 0 {
            return Err(Error::usage("0 cycles in a period", "1 or more").hint("1").setting("cycles"));
        }
        let period = f64::from(cycles) / frequency;
        scales::check_swings(rig, 1.0 / period, MOST_SWINGS)?;
        let ([first, second], [m1, m2]) = (rig.oscillators(), rig.masses());
        let greens = [Green::new(m1, first, period)?, Green::new(m2, second, period)?];
        let [first, second] = &greens;
        Ok(Conditions {
            rig: *rig,
            cycles,
            frequency,
            c: first.start + second.start + delay / rig.exchange(),
            p: 1.0 / rig.exchange() + first.slope_before + second.slope_before,
            greens,
        })
    }

    /// Period T in s.
    pub fn period(&self) -> f64 {
        self.greens[0].period
    }

    /// The orbit of a root, with its verdicts. Without an excitation the orbit is a free motion.
    pub fn orbit(&self, root: &Root, course: Course, excitation: Option<Excitation>) -> Orbit {
        let rig = &self.rig;
        // Rounding of the terms changes the impulse in proportion to its sensitivity.
        let amplified = excitation.is_some().then(|| 1.0 + root.size * root.sensitivity / root.impulse);
        let (exists, own) = (root.impulse > 0.0, root.impulse.abs() / root.sensitivity);
        let courses = std::slice::from_ref(&course);
        let Judged { validity, multipliers, peak_to_peak, .. } =
            Judged::new(rig, courses, exists, Some(root.upper), own, amplified);
        let mut orbit = Orbit {
            frequency: self.frequency,
            cycles: self.cycles,
            impulse: root.impulse,
            timing: root.timing,
            force_phase: root.force_phase,
            approach_velocity: root.impulse / rig.exchange(),
            fundamental: [Complex64::ZERO; 2],
            peak_to_peak,
            multipliers,
            validity,
            upper: root.upper,
            rig: *rig,
            excitation,
            course,
        };
        orbit.fundamental = orbit.line(self.cycles);
        orbit
    }
}
