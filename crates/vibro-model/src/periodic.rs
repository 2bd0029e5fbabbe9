//! Periodic motions with any number of impacts p in any number of cycles q under a sine force, stable or not.
//!
//! Newton's method with the exact Jacobian finds the phases and impulses of the impacts; between the impacts
//! everything is closed form. Each motion has the same verdicts as orbits with one impact ([`Validity`]).

mod search;
mod system;

pub use search::search;
pub(super) use system::System;

use super::excitation::Sine;
use super::flow::{Flight, State};
use super::orbit::Course;
use super::orbit::Judged;
use super::orbit::Validity;
use super::regime::Strike;
use super::rig::Rig;
use super::waves::Waves;
use nalgebra::{DVector, Matrix4};
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// One impact of a periodic motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Beat {
    /// Phase θ in rad of the force F₀ cos θ. It grows steadily over all cycles of the period, beyond 2π.
    pub phase: f64,
    /// Impulse J in N s.
    pub impulse: f64,
    /// Approach speed in m/s.
    pub approach_velocity: f64,
    /// Time to the next impact in s.
    pub interval: f64,
}

/// A periodic motion with p impacts in q cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicOrbit {
    /// The rig.
    pub rig: Rig,
    /// The force.
    pub sine: Sine,
    /// Cycles q of the force in a period.
    pub cycles: u32,
    /// The p impacts of a period.
    pub beats: Vec<Beat>,
    /// Complex amplitudes X₁, X₂ in m at the excitation frequency, phase counted from the first impact.
    pub fundamental: [Complex64; 2],
    /// Peak-to-peak values of x₁ and x₂ in m.
    pub peak_to_peak: [f64; 2],
    /// Floquet multipliers over the whole period, largest first; `None` where an impact grazes or does not
    /// exist.
    pub multipliers: Option<[Complex64; 4]>,
    /// Verdicts on whether the motion is physically possible and stable; each covers all impacts and flights.
    pub validity: Validity,
    /// Monodromy matrix over the period that starts just before the first impact.
    pub(super) monodromy: Option<Matrix4<f64>>,
    /// The motion after the first impact.
    course: Course,
}

/// Most steps of Newton's method; beyond these it is taken not to converge.
const NEWTON_STEPS: usize = 40;
/// Newton's method has converged when its largest step (in rad, or relative to the impulse) is below this.
const CONVERGED_STEP: f64 = 1e-11;
/// Two impacts of a motion are equal if their phases (rad) and impulses (relative) differ by less than this.
const EQUAL_IMPACTS: f64 = 1e-7;

impl PeriodicOrbit {
    /// The motion near `impacts`, pairs of phase (rad, over all `cycles`) and impulse (N s).
    ///
    /// # Errors
    /// If a parameter is impossible, there are no cycles or impacts, or no periodic motion is near.
    pub fn near(rig: &Rig, sine: &Sine, cycles: u32, impacts: &[(f64, f64)]) -> Result<PeriodicOrbit> {
        if cycles == 0 || impacts.is_empty() || sine.force == 0.0 {
            return Err(Error::usage(
                format!("{} impacts in {cycles} cycles under {} N", impacts.len(), sine.force),
                "at least one of each and a force above 0",
            ));
        }
        let system = System::new(rig, sine, cycles)?;
        let p = impacts.len();
        let u = newton(&system, system.unknowns(impacts)).ok_or_else(|| {
            Error::refused(format!(
                "no motion with {p} impacts in {cycles} cycles was found near the impacts given, at {} Hz",
                sine.frequency
            ))
            .hint("start from impacts of a settled simulation, or from an orbit at a nearby frequency")
        })?;
        Ok(PeriodicOrbit::build(&system, *sine, cycles, &u))
    }

    /// The periodic motion near the impacts of a settled simulation.
    ///
    /// # Errors
    /// As [`PeriodicOrbit::near`].
    pub(crate) fn from_strikes(
        rig: &Rig,
        sine: &Sine,
        cycles: u32,
        strikes: &[Strike],
    ) -> Result<PeriodicOrbit> {
        let phase = |s: &Strike| strikes[0].phase + sine.omega() * (s.time - strikes[0].time);
        let impacts: Vec<_> = strikes.iter().map(|s| (phase(s), s.impulse)).collect();
        PeriodicOrbit::near(rig, sine, cycles, &impacts)
    }

    /// The same motion over its shortest period: impacts that repeat within the period count once.
    ///
    /// # Errors
    /// As [`PeriodicOrbit::near`].
    pub fn shortest(self) -> Result<PeriodicOrbit> {
        let Some((d, q)) = self.shorter(EQUAL_IMPACTS) else { return Ok(self) };
        PeriodicOrbit::near(&self.rig, &self.sine, q as u32, &self.pairs()[..d])
    }

    /// Whether its impacts do not repeat within its period.
    pub fn is_shortest(&self) -> bool {
        self.shorter(EQUAL_IMPACTS).is_none()
    }

    /// Whether its impacts repeat within its period, with phases (rad) and impulses (relative) equal to
    /// within `tolerance`.
    pub(crate) fn repeats_within(&self, tolerance: f64) -> bool {
        self.shorter(tolerance).is_some()
    }

    /// Numbers of impacts and of cycles of a period shorter than the stated one, with impacts equal to within
    /// `tolerance`; `None` without one.
    fn shorter(&self, tolerance: f64) -> Option<(usize, usize)> {
        let p = self.beats.len();
        let cycles =
            |d: usize| (self.cycles as usize * d).is_multiple_of(p).then(|| self.cycles as usize * d / p);
        let repeats = |d: usize, q: usize| {
            (0..p - d).all(|i| {
                let (a, b) = (self.beats[i], self.beats[i + d]);
                (b.phase - a.phase - TAU * q as f64).abs() < tolerance
                    && (b.impulse - a.impulse).abs() < tolerance * a.impulse
            })
        };
        (1..p)
            .filter(|d| p.is_multiple_of(*d))
            .find_map(|d| Some((d, cycles(d)?)).filter(|(d, q)| repeats(*d, *q)))
    }

    /// Impacts p in a period.
    pub fn impacts(&self) -> u32 {
        self.beats.len() as u32
    }

    /// Period in s.
    pub fn period(&self) -> f64 {
        f64::from(self.cycles) / self.sine.frequency
    }

    /// State at `t` seconds after the first impact, any `t`; at an impact, the state after it.
    pub fn state(&self, t: f64) -> State {
        self.course.state(t.rem_euclid(self.period()))
    }

    /// Largest modulus of the multipliers over the period.
    pub fn spectral_radius(&self) -> Option<f64> {
        self.multipliers.map(|m| m[0].norm())
    }

    /// Phase and impulse of each impact.
    pub(super) fn pairs(&self) -> Vec<(f64, f64)> {
        self.beats.iter().map(|b| (b.phase, b.impulse)).collect()
    }

    /// The motion with its verdicts, from the solution `u`; phases rise within the period.
    pub(super) fn build(system: &System, sine: Sine, cycles: u32, u: &DVector<f64>) -> PeriodicOrbit {
        let (rig, p, unit, omega) = (&system.rig, u.len() / 2, system.impulse(), system.omega);
        let round = TAU * f64::from(cycles);
        let interval = |i: usize| {
            let next = if i + 1 < p { u[i + 1] } else { u[0] + round };
            (next - u[i]) / omega
        };
        let beats: Vec<Beat> = (0..p)
            .map(|i| {
                let impulse = u[p + i] * unit;
                let approach_velocity = impulse * system.contact;
                Beat { phase: u[i], impulse, approach_velocity, interval: interval(i) }
            })
            .collect();
        let flights: Vec<Course> = (0..p)
            .map(|i| {
                let forced = Waves::one(system.response * Complex64::cis(u[i]), omega);
                let flight = Flight::of(rig.oscillators(), forced, 0.0, rig.gap, system.free_after(u, i));
                Course::smooth(beats[i].interval.max(0.0), &flight)
            })
            .collect();
        let sensitivity = sensitivity(system, u);
        let reach = rig.gap.abs() + system.response.norm();
        let amplified = beats
            .iter()
            .zip(&sensitivity)
            .fold(1.0_f64, |most, (b, s)| most.max(1.0 + reach * s.abs() / b.impulse.abs()));
        let exists = beats.iter().all(|b| b.impulse > 0.0 && b.interval > 0.0);
        let own = beats.iter().zip(&sensitivity).map(|(beat, s)| beat.impulse.abs() / s.abs());
        let own = own.fold(f64::INFINITY, f64::min);
        let judged = Judged::new(rig, &flights, exists, None, own, Some(amplified));
        // Line of a train of several impulses: 2/T times the sum of the impulses with their phases.
        let train: Complex64 = beats.iter().map(|b| Complex64::from_polar(b.impulse, u[0] - b.phase)).sum();
        let [l1, l2] = rig.receptances(omega);
        let train = train * (2.0 / system.period);
        PeriodicOrbit {
            rig: *rig,
            sine,
            cycles,
            fundamental: [system.response * Complex64::cis(u[0]) - l1 * train, l2 * train],
            peak_to_peak: judged.peak_to_peak,
            validity: judged.validity,
            multipliers: judged.multipliers,
            monodromy: judged.monodromy,
            course: Course {
                period: system.period,
                stretches: flights.into_iter().flat_map(|flight| flight.stretches).collect(),
            },
            beats,
        }
    }
}

/// Newton's method from `u`; `None` where it does not converge, or the order of the impacts changes.
fn newton(system: &System, mut u: DVector<f64>) -> Option<DVector<f64>> {
    for _ in 0..NEWTON_STEPS {
        let (left, jacobian) = system.evaluate(&u);
        let mut step = jacobian.lu().solve(&left)?;
        let size = step.amax();
        if !size.is_finite() {
            return None;
        }
        // At most a fifth of a radian or of an impulse a step, so that poor guesses do not jump to other
        // motions.
        if size > 0.2 {
            step *= 0.2 / size;
        }
        u -= step;
        if size < CONVERGED_STEP {
            return ordered(system, &u).then_some(u);
        }
    }
    None
}

/// Whether the phases rise within one period.
pub(super) fn ordered(system: &System, u: &DVector<f64>) -> bool {
    let p = u.len() / 2;
    let round = system.omega * system.period;
    (1..p).all(|i| u[i] > u[i - 1]) && (p < 2 || u[p - 1] < u[0] + round)
}

/// dJᵢ/dΔ in N s/m, the change of each impulse with the gap; infinite at a fold.
fn sensitivity(system: &System, u: &DVector<f64>) -> Vec<f64> {
    let p = u.len() / 2;
    let (_, jacobian) = system.evaluate(u);
    let pull = DVector::from_fn(2 * p, |k, _| if k < p { -1.0 / system.length } else { 0.0 });
    jacobian
        .lu()
        .solve(&pull)
        .map_or_else(|| vec![f64::INFINITY; p], |d| (0..p).map(|i| d[p + i] * system.impulse()).collect())
}

#[cfg(test)]
mod tests;
