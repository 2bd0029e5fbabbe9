//! What all orbits of a rig at one period share.

use super::Orbit;
use super::course::Course;
use super::drive::Drive;
use crate::{Green, Rig, Validity, floquet};
use std::f64::consts::{PI, TAU};
use vibro_record::{Error, Result};

/// The most half swings of a mass, or half cycles of the force, that a period may hold.
const MOST_SWINGS: f64 = 1e5;

/// With y the steady motion of mass 1 alone, the masses meet where y = Δ + JC and part as the impact law says where ẏ = JP (Babitsky,
/// *Theory of Vibro-Impact Systems* (1998), periodic Green's functions).
#[derive(Debug, Clone, Copy)]
pub struct Conditions<'a> {
    pub rig: &'a Rig,
    pub cycles: u32,
    /// Cycles of the excitation a second, in Hz.
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
    /// J in N s.
    pub impulse: f64,
    /// φ in rad or τ in s.
    pub timing: f64,
    /// Phase of the excitation's cycle at the impact, in rad.
    pub force_phase: f64,
    /// |dJ/dΔ| in N s/m.
    pub sensitivity: f64,
    /// Size of the terms of y = Δ + JC, in m.
    pub size: f64,
    /// Whether a larger impulse would take more energy than the force then gives: the side of the fold.
    pub upper: bool,
}

impl<'a> Conditions<'a> {
    /// Conditions of one impact in `cycles` cycles at `frequency` (Hz).
    ///
    /// # Errors
    /// If `cycles` is 0, the period holds too many swings, or an undamped mass meets its own period.
    pub fn new(rig: &'a Rig, frequency: f64, cycles: u32) -> Result<Conditions<'a>> {
        if cycles == 0 {
            return Err(Error::usage("0 cycles between impacts", "at least one cycle"));
        }
        let period = f64::from(cycles) / frequency;
        let oscillators = rig.oscillators();
        let swings =
            oscillators.iter().map(|o| o.omega2().sqrt()).fold(TAU * frequency, f64::max) * period / PI;
        if swings.is_nan() || swings > MOST_SWINGS {
            return Err(Error::refused(format!(
                "{cycles} cycles at {frequency} Hz last {period} s, {swings:.0} half swings: more than {MOST_SWINGS:.0} are \
                 not followed"
            ))
            .hint("ask for fewer cycles or a higher frequency"));
        }
        let greens =
            [Green::new(rig.m1, oscillators[0], period)?, Green::new(rig.m2, oscillators[1], period)?];
        let [first, second] = &greens;
        Ok(Conditions {
            rig,
            cycles,
            frequency,
            c: first.start + second.start,
            p: 1.0 / rig.exchange() + first.slope_before + second.slope_before,
            greens,
        })
    }

    /// The same conditions for impacts that follow the first touch by `delay` (s): the ways then overlap by vᵣ times it.
    pub fn delayed(mut self, delay: f64) -> Conditions<'a> {
        self.c += delay / self.rig.exchange();
        self
    }

    /// T in s.
    pub fn period(&self) -> f64 {
        self.greens[0].period()
    }

    /// The orbit of a root, with its verdicts.
    pub fn orbit(&self, root: &Root, course: &Course, drive: Drive) -> Orbit {
        let (rig, period) = (self.rig, self.period());
        let (mut multipliers, mut stable) = (None, Some(false));
        if drive == Drive::None {
            // One of a family of free motions: it neither dies away nor grows.
            stable = None;
        } else if root.impulse > 0.0 {
            let (before, after) = course.rates();
            let monodromy = floquet::monodromy(rig, period, &before, &after);
            multipliers = floquet::multipliers(&monodromy).ok();
            // Roundings of the terms reach the impulse through its sensitivity.
            let amplified = 1.0 + root.size * root.sensitivity / root.impulse;
            let rounding = amplified * floquet::rounding(rig, period, &before, &after);
            stable = multipliers.as_ref().map_or(stable, |m| floquet::inside(&monodromy, m, rounding));
        }
        let survey = course.survey();
        let mut orbit = Orbit {
            frequency: self.frequency,
            cycles: self.cycles,
            impulse: root.impulse,
            timing: root.timing,
            force_phase: root.force_phase,
            approach_velocity: root.impulse / rig.exchange(),
            fundamental: Default::default(),
            peak_to_peak: survey.spread,
            validity: Validity::judge(root, course, survey.closest, stable, multipliers.as_ref()),
            multipliers,
            upper: root.upper,
            rig: *rig,
            drive,
            course: *course,
        };
        orbit.fundamental = orbit.line(self.cycles);
        orbit
    }
}
