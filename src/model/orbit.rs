//! Periodic motions with one impact a period, in closed form.

mod told;

use super::flow::Signal;
use super::{Flight, Green, NoImpact, Rig, Sine, State, Steady, Validity, floquet};
use crate::error::{Error, Result};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// One periodic motion with one impact a period; its time counts from the impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Cycles of the excitation from impact to impact.
    pub cycles: u32,
    /// Impulse J in N s.
    pub impulse: f64,
    /// φ in 0..2π of the forced part A cos(ωt + φ) of x₁.
    pub timing: f64,
    /// Phase in 0..2π of the force F₀ cos(ωt + θ) at the impact.
    pub force_phase: f64,
    /// Approach speed vᵣ in m/s.
    pub approach_velocity: f64,
    /// Complex amplitudes X₁, X₂ in m at the excitation frequency: what a spectrum shows of x₁ and x₂, its phase counted
    /// from the impact.
    pub fundamental: [Complex64; 2],
    /// Largest minus smallest x₁ and x₂ in m: what a displacement trace shows.
    pub peak_to_peak: [f64; 2],
    /// Floquet multipliers, largest first; `None` where the motion does not exist or grazes.
    pub multipliers: Option<[Complex64; 4]>,
    /// Is it real?
    pub validity: Validity,
    motion: Flight,
}

impl Orbit {
    /// Period in s.
    pub fn period(&self) -> f64 {
        f64::from(self.cycles) / self.frequency
    }

    /// State at `t` seconds after an impact, any `t`; at the impact itself, the state after it.
    pub fn state(&self, t: f64) -> State {
        self.motion.state(t.rem_euclid(self.period()))
    }

    /// State just before the impact.
    pub fn before_impact(&self) -> State {
        self.motion.state(self.period())
    }

    /// Largest modulus of the multipliers.
    pub fn spectral_radius(&self) -> Option<f64> {
        self.multipliers.map(|m| m[0].norm())
    }
}

/// All answers at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbits {
    /// One for each real root, the larger impulse first; each says whether it is real.
    pub orbits: Vec<Orbit>,
    /// The motion without impacts.
    pub no_impact: NoImpact,
}

/// All motions with one impact each cycle of the force `force` cos ωt (N) at `frequency` (Hz), and the one without impacts.
///
/// # Errors
/// If a parameter is impossible, or an undamped mass is driven at resonance.
pub fn orbits(rig: &Rig, force: f64, frequency: f64) -> Result<Orbits> {
    orbits_over(rig, &Sine { force, frequency }, 1)
}

/// As [`orbits`], with one impact in `cycles` cycles.
///
/// # Errors
/// As [`orbits`], and if `cycles` is 0 or the force is 0.
pub fn orbits_over(rig: &Rig, sine: &Sine, cycles: u32) -> Result<Orbits> {
    let steady = Steady::new(rig, sine)?;
    if cycles == 0 || sine.force == 0.0 {
        return Err(Error::usage(
            format!("{cycles} cycles between impacts under a force of {} N", sine.force),
            "at least one cycle and a force above 0",
        ));
    }
    let solver = Solver::new(rig, &steady, cycles)?;
    let orbits = solver.roots().map(|impulse| solver.orbit(impulse)).collect();
    Ok(Orbits { orbits, no_impact: NoImpact::new(&steady, rig.gap) })
}

/// What both roots share. Babitsky, *Theory of Vibro-Impact Systems* (1998), periodic Green's functions.
struct Solver<'a> {
    rig: &'a Rig,
    steady: &'a Steady,
    cycles: u32,
    period: f64,
    greens: [Green; 2],
    /// A in m.
    amplitude: f64,
    /// C = χ₁(0) + χ₂(0): gap at the impact is Δ + JC − A cos φ.
    c: f64,
    /// P/ω with P = 1/(M(1+R)) + χ̇₁(T⁻) + χ̇₂(T⁻): velocities meet where JP = −Aω sin φ.
    p: f64,
}

impl<'a> Solver<'a> {
    fn new(rig: &'a Rig, steady: &'a Steady, cycles: u32) -> Result<Solver<'a>> {
        let period = f64::from(cycles) * TAU / steady.omega;
        let [first, second] = rig.oscillators();
        let greens = [Green::new(rig.m1, first, period)?, Green::new(rig.m2, second, period)?];
        let [chi1, chi2] = &greens;
        let contact = 1.0 / (rig.reduced_mass() * (1.0 + rig.restitution));
        Ok(Solver {
            rig,
            steady,
            cycles,
            period,
            amplitude: steady.amplitude(),
            c: chi1.start + chi2.start,
            p: (contact + chi1.slope_before + chi2.slope_before) / steady.omega,
            greens,
        })
    }

    /// Square of the half distance of the roots times a = C² + (P/ω)², written so that it does not cancel.
    fn discriminant(&self) -> f64 {
        self.amplitude.powi(2) * (self.c * self.c + self.p * self.p) - (self.rig.gap * self.p).powi(2)
    }

    /// Real roots of (C² + (P/ω)²)J² + 2ΔCJ + Δ² − A² = 0, larger first.
    fn roots(&self) -> impl Iterator<Item = f64> + use<> {
        let a = self.c * self.c + self.p * self.p;
        let half = self.rig.gap * self.c;
        let product = (self.rig.gap - self.amplitude) * (self.rig.gap + self.amplitude) / a;
        let discriminant = self.discriminant();
        let pair = (a > 0.0 && discriminant >= 0.0).then(|| {
            // The root in which the terms add up first, the other from their product.
            let first = -(half + discriminant.sqrt().copysign(half)) / a;
            let second = if first == 0.0 { 0.0 } else { product / first };
            [first.max(second), first.min(second)]
        });
        pair.into_iter().flatten()
    }

    fn orbit(&self, impulse: f64) -> Orbit {
        let (rig, omega) = (self.rig, self.steady.omega);
        let [chi1, chi2] = &self.greens;
        let cosine = (rig.gap + impulse * self.c) / self.amplitude;
        let sine = -impulse * self.p / self.amplitude;
        let timing = f64::atan2(sine, cosine).rem_euclid(TAU);
        let forced = Complex64::from_polar(self.amplitude, timing);
        let free = [
            (-impulse * chi1.start, -impulse * chi1.slope_after),
            (impulse * chi2.start, impulse * chi2.slope_after),
        ];
        let motion = Flight::from_parts(rig.oscillators(), forced, omega, rig.gap, free);
        // Every harmonic of a train of impulses J has the amplitude 2J/T.
        let train = 2.0 * impulse / self.period;
        let [l1, l2] = rig.receptances(omega);
        let spread = |signal| {
            let (low, high) = motion.range(signal, self.period);
            high - low
        };
        // From the quadratic: (aJ + ΔC) dJ = −(CJ + Δ) dΔ.
        let sensitivity = (self.c * impulse + rig.gap).abs() / self.discriminant().max(0.0).sqrt();
        let (mut multipliers, mut stable) = (None, Some(false));
        if impulse > 0.0 {
            let (before, after) = (motion.rate(self.period), motion.rate(0.0));
            let monodromy = floquet::monodromy(rig, self.period, &before, &after);
            multipliers = floquet::multipliers(&monodromy).ok();
            // Roundings of gap and amplitude reach the impulse through its sensitivity.
            let amplified = 1.0 + (rig.gap.abs() + self.amplitude) * sensitivity / impulse;
            let rounding = amplified * floquet::rounding(rig, self.period, &before, &after);
            stable = multipliers.as_ref().map_or(stable, |m| floquet::inside(&monodromy, m, rounding));
        }
        Orbit {
            frequency: omega / TAU,
            cycles: self.cycles,
            impulse,
            timing,
            force_phase: (timing - self.steady.response.arg()).rem_euclid(TAU),
            approach_velocity: impulse / (rig.reduced_mass() * (1.0 + rig.restitution)),
            fundamental: [forced - l1 * train, l2 * train],
            peak_to_peak: [spread(Signal::X1), spread(Signal::X2)],
            validity: Validity::judge(impulse, sensitivity, &motion, self.period, stable),
            multipliers,
            motion,
        }
    }
}

#[cfg(test)]
mod tests;
