//! Periodic motions with one impact a period, in closed form.
//!
//! A solution of the impact conditions is a motion of the rig only if it is physically possible: it exists
//! (J > 0), and it is admissible (the masses do not pass through each other between the impacts). If it is
//! stable, too, it can be measured: [`Validity::real`].

mod conditions;
mod course;
mod driven;
mod energy;
mod sine;
mod soft;
mod train;
mod turns;
mod validity;

pub use energy::{EnergyBalance, EnergyPoint};
pub use sine::{ShownOrbit, backbone, shown};
pub use soft::{Compliance, Softened, softened};

pub use validity::{Loss, Validity};

pub(super) use course::Course;
pub(super) use validity::Judged;

use super::excitation::{Excitation, Sine};
use super::flow::State;
use super::rig::Rig;
use super::scales;
use super::steady::{NoImpact, Steady};
use conditions::Conditions;
use driven::PulseResponse;
use num_complex::Complex64;
use serde::{Serialize, Serializer};
use serde_json::json;
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// A periodic motion with one impact a period; its time counts from the impact.
///
/// Its JSON has all verdicts and amplitudes in one object; `stable` is false for a neutral motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Cycles of the excitation from impact to impact.
    pub cycles: u32,
    /// Impulse J in N s.
    pub impulse: f64,
    /// Under a sine force the phase φ in 0..2π of the forced part A cos(ωt + φ) of x₁; under impulses or
    /// pulses the time τ in s from the beginning of the last one to the impact.
    pub timing: f64,
    /// Phase in 0..2π of the excitation's cycle at the impact: of the force F₀ cos(ωt + θ), or 2πτ/T.
    pub force_phase: f64,
    /// Approach speed vᵣ in m/s.
    pub approach_velocity: f64,
    /// Complex amplitudes X₁, X₂ in m at the excitation frequency, as in spectra of x₁ and x₂; the phase
    /// counts from the impact.
    pub fundamental: [Complex64; 2],
    /// Peak-to-peak values of x₁ and x₂ in m.
    pub peak_to_peak: [f64; 2],
    /// Floquet multipliers, largest first; `None` where the motion does not exist or grazes.
    pub multipliers: Option<[Complex64; 4]>,
    /// Verdicts on whether the motion is physically possible and stable.
    pub validity: Validity,
    /// Whether it is the larger-impulse branch above the fold. On it a larger impulse would take more
    /// energy than the force provides.
    pub(crate) upper: bool,
    rig: Rig,
    excitation: Option<Excitation>,
    course: Course,
}

impl Serialize for Orbit {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut fields = json!({
            "frequency": self.frequency,
            "cycles": self.cycles,
            "impulse": self.impulse,
            "timing": self.timing,
            "timing_unit": self.timing_unit(),
            "force_phase": self.force_phase,
            "approach_velocity": self.approach_velocity,
            "multipliers": self.multipliers.map(|all| all.map(|z| [z.re, z.im])),
            "spectral_radius": self.spectral_radius(),
            "peak_to_peak": self.peak_to_peak,
            "fundamental": self.fundamental.map(Complex64::norm),
            "fundamental_phase": self.fundamental.map(Complex64::arg),
        });
        for (key, verdict) in self.validity.keys() {
            fields[key] = verdict;
        }
        fields.serialize(serializer)
    }
}

impl Orbit {
    /// Period in s.
    pub fn period(&self) -> f64 {
        f64::from(self.cycles) / self.frequency
    }

    /// State at `t` seconds after an impact, any `t`; at the impact itself, the state after it.
    pub fn state(&self, t: f64) -> State {
        self.course.state(t.rem_euclid(self.course.period))
    }

    /// State just before the impact.
    pub fn before_impact(&self) -> State {
        self.course.state(self.course.period)
    }

    /// Complex amplitudes X₁, X₂ in m of the spectral line at `n`/T, n ≥ 1, with the time T from impact to
    /// impact: the line n = `cycles` lies at the excitation frequency.
    ///
    /// X₁ = (F − 2J/T)L₁(iω), X₂ = (2J/T)L₂(iω), with the line F of the force.
    pub fn line(&self, n: u32) -> [Complex64; 2] {
        let period = self.period();
        let [l1, l2] = self.rig.receptances(TAU * f64::from(n) / period);
        // Every line of a train of impulses J has the amplitude 2J/T.
        let train = 2.0 * self.impulse / period;
        let force = match &self.excitation {
            Some(force) if n.is_multiple_of(self.cycles) => force.harmonic(n / self.cycles, self.force_phase),
            _ => Complex64::ZERO,
        };
        [(force - train) * l1, l2 * train]
    }

    /// The orbit among `others` that this one changes into continuously; they belong to the same excitation
    /// at a nearby frequency (or contact). It is on the same side of the fold, and within a sixth of a cycle
    /// in timing.
    pub fn continued<'a>(&self, others: &'a [Orbit]) -> Option<&'a Orbit> {
        let same_side = others.iter().filter(|other| other.upper == self.upper);
        if self.timing_unit() == "rad" {
            // Under a sine force there is one orbit on each side of the fold.
            return same_side.min_by(|a, b| a.impulse.total_cmp(&b.impulse));
        }
        let phase_distance = |other: &Orbit| {
            let difference = (other.force_phase - self.force_phase).rem_euclid(TAU);
            difference.min(TAU - difference)
        };
        same_side
            .filter(|other| phase_distance(other) < TAU / 6.0)
            .min_by(|a, b| phase_distance(a).total_cmp(&phase_distance(b)))
    }

    /// Whether the motion can be measured ([`Validity::real`]), and still can where the gap differs by up to
    /// `gap_uncertainty` (m). For this its [`Validity::grazing_distance`] must be larger, and the orbits
    /// with the gap at both ends of the uncertainty and half-way to them must be measurable, too.
    pub fn robust(&self, gap_uncertainty: f64) -> bool {
        if !self.validity.real() || self.validity.grazing_distance <= gap_uncertainty {
            return false;
        }
        let Some(excitation) = &self.excitation else { return false };
        gap_uncertainty == 0.0
            || [-1.0, -0.5, 0.5, 1.0].iter().all(|part| {
                let rig = Rig { gap: self.rig.gap + part * gap_uncertainty, ..self.rig };
                orbits_of(&rig, excitation, self.cycles)
                    .is_ok_and(|found| self.continued(&found.orbits).is_some_and(|o| o.validity.real()))
            })
    }

    /// Unit of [`Orbit::timing`]: `rad` or `s`.
    pub fn timing_unit(&self) -> &'static str {
        match self.excitation {
            None | Some(Excitation::Sine(_)) => "rad",
            Some(_) => "s",
        }
    }

    /// Largest modulus of the multipliers.
    pub fn spectral_radius(&self) -> Option<f64> {
        self.multipliers.map(|m| m[0].norm())
    }
}

/// All motions at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Orbits {
    /// One for each real root of the impact conditions, in the order of [`orbits_of`]; its verdicts state
    /// whether the motion can be measured.
    pub orbits: Vec<Orbit>,
    /// The motion without impacts.
    pub no_impact: NoImpact,
}

/// All motions with one impact each cycle of the force `force` cos ωt (N) at `frequency` (Hz), and the one
/// without impacts.
///
/// # Errors
/// If a parameter is impossible, or an undamped mass is driven at resonance.
pub fn orbits(rig: &Rig, force: f64, frequency: f64) -> Result<Orbits> {
    orbits_of(rig, &Excitation::Sine(Sine { force, frequency }), 1)
}

/// All motions with one impact in `cycles` cycles of the excitation, and the one without impacts.
///
/// Under a sine force the larger impulse comes first, under impulses and pulses the earlier impact.
///
/// # Errors
/// If a parameter is impossible, an undamped mass is driven at resonance, the excitation is 0, or it is a sum
/// of several sines, for which there is no closed form.
pub fn orbits_of(rig: &Rig, excitation: &Excitation, cycles: u32) -> Result<Orbits> {
    solve(rig, excitation, cycles, 0.0)
}

/// The motion without impacts.
///
/// # Errors
/// As [`orbits_of`].
pub fn no_impact(rig: &Rig, excitation: &Excitation) -> Result<NoImpact> {
    scales::check(rig, excitation)?;
    match excitation {
        Excitation::Sine(sine) => Ok(NoImpact::new(&Steady::new(rig, sine)?, rig.gap)),
        _ => Ok(train(rig, excitation)?.no_impact(rig.gap)),
    }
}

/// As [`orbits_of`], with the impact `delay` (s) after the first touch: for a soft contact, whose
/// equivalent rigid impact lies at the centroid of its force.
fn solve(rig: &Rig, excitation: &Excitation, cycles: u32, delay: f64) -> Result<Orbits> {
    scales::check(rig, excitation)?;
    let conditions = || Conditions::new(rig, excitation.frequency(), cycles, delay);
    if let Excitation::Sine(sine) = excitation {
        let steady = Steady::new(rig, sine)?;
        check_not_zero(sine.force)?;
        let orbits = sine::orbits(&conditions()?, &steady, sine);
        return Ok(Orbits { orbits, no_impact: NoImpact::new(&steady, rig.gap) });
    }
    let response = train(rig, excitation)?;
    let orbits = train::orbits(&conditions()?, &response, excitation);
    Ok(Orbits { orbits, no_impact: response.no_impact(rig.gap) })
}

/// Response of mass 1 alone to a train of impulses or pulses.
fn train(rig: &Rig, excitation: &Excitation) -> Result<PulseResponse> {
    check_not_zero(excitation.size())?;
    let (m, oscillator, cycle) = (rig.masses()[0], rig.oscillators()[0], 1.0 / excitation.frequency());
    match *excitation {
        Excitation::Impulse(train) => PulseResponse::impulse(m, oscillator, cycle, train.impulse),
        Excitation::Pulse(train) => PulseResponse::pulse(m, oscillator, cycle, train.force, train.width),
        Excitation::Sine(_) | Excitation::Sines(_) => {
            Err(Error::refused("several sines at once have no closed form")
                .hint("follow the motion by simulating it"))
        }
    }
}

/// Checks that the size of an excitation is not 0.
pub(super) fn check_not_zero(size: f64) -> Result<()> {
    if size == 0.0 {
        let expected = "a value other than 0: nothing moves the masses";
        return Err(Error::usage("a force or impulse of 0", expected).setting("force").setting("impulse"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod limits_tests;
