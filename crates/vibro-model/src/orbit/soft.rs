//! Correction of an orbit for a compliant contact, to first order in the duration of the contact.

use super::{Orbit, Orbits};
use crate::excitation::Excitation;
use crate::law::Law;
use crate::law::conversion;
use crate::rig::Rig;
use num_complex::Complex64;
use serde::Serialize;
use vibro_record::{Error, Result};

/// Largest contact duration as a share of the period: the correction was checked up to this share.
pub(crate) const LONGEST_CONTACT: f64 = 0.025;

/// A contact of spring k₃ and damper c₃ (Kelvin–Voigt) that cannot pull, and how the reduced mass M of the
/// rig rebounds from it without other forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Compliance {
    /// Stiffness k₃ in N/m.
    pub stiffness: f64,
    /// Damping c₃ in N s/m.
    pub damping: f64,
    /// Damping ratio ζ = c₃/(2√(k₃M)).
    pub damping_ratio: f64,
    /// Restitution of this spring and damper.
    pub restitution: f64,
    /// Duration of the contact in s.
    pub duration: f64,
    /// Time t* in s from the first touch to the equivalent rigid impact, which gives the same motion after
    /// the contact.
    pub delay: f64,
    /// dR/d(a/v) in s, `(1 − R)t_c − 2d_r/v`: sensitivity of the restitution to the quotient of the
    /// acceleration a that presses the masses together and the approach speed v.
    #[serde(skip)]
    restitution_slope: f64,
}

impl Compliance {
    /// Contact of stiffness k₃ (N/m) on a rig. `damping` is c₃ in N s/m; `None` computes the one that gives
    /// the rig's restitution.
    ///
    /// Approach speed v, natural frequency `ω₀ = √(k₃/M)`, damped one `ω_d = ω₀√(1 − ζ²)`, ψ = asin ζ:
    /// - duration `t_c = (π − 2ψ)/ω_d` and restitution `R = e^{−ζω₀t_c}`;
    /// - indentation at which the force vanishes and the masses part: `d_r = vR sin(2ψ)/ω_d`;
    /// - delay of the equivalent rigid impact: `t* = (d_r/v + Rt_c)/(1 + R)`.
    ///
    /// # Errors
    /// If stiffness or damping are impossible, the damper is critical or more, or no damper gives the rig's
    /// restitution.
    pub fn new(rig: &Rig, stiffness: f64, damping: Option<f64>) -> Result<Compliance> {
        rig.check()?;
        Law::spring(stiffness, damping.unwrap_or(0.0)).check()?;
        let mass = rig.reduced_mass();
        let omega = (stiffness / mass).sqrt();
        let ratio = match damping {
            Some(c) => c / (2.0 * mass * omega),
            None => conversion::damping_ratio(rig.restitution)?,
        };
        if ratio >= 1.0 {
            return Err(Error::refused(format!(
                "the contact's damper is {ratio:.3} of the critical one: it creeps apart, and has no correction"
            ))
            .hint("simulate the motion with a contact of spring and damper"));
        }
        let (restitution, duration) =
            (conversion::restitution(ratio), conversion::duration(ratio, stiffness, mass));
        // Indentation at parting per approach speed, d_r/v in s.
        let parting = restitution * (2.0 * ratio.asin()).sin() / (omega * (1.0 - ratio * ratio).sqrt());
        Ok(Compliance {
            stiffness,
            damping: 2.0 * ratio * mass * omega,
            damping_ratio: ratio,
            restitution,
            duration,
            delay: (parting + restitution * duration) / (1.0 + restitution),
            restitution_slope: (1.0 - restitution) * duration - 2.0 * parting,
        })
    }
}

/// An orbit corrected for the duration of its contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Softened {
    /// Impulse in N s.
    pub impulse: f64,
    /// φ in rad or τ in s of the equivalent rigid impact, `delay` after the first touch.
    pub timing: f64,
    /// Approach speed in m/s at the first touch.
    pub approach_velocity: f64,
    /// Restitution of the equivalent rigid impact: that of the contact, changed by the acceleration that
    /// presses the masses together.
    pub restitution: f64,
    /// Peak-to-peak values of x₁ and x₂ in m, without the indentation of the contact.
    pub peak_to_peak: [f64; 2],
    /// Amplitudes of x₁ and x₂ in m at the excitation frequency.
    pub fundamental: [f64; 2],
    /// Relative change of the impulse. Where it is too large to neglect, the contact's stiffness matters.
    pub change: f64,
    /// Contact duration as a fraction of the period.
    pub share: f64,
}

/// Corrects each of the orbits `found` of this rig and excitation for `compliance`; `None` where the
/// corrected orbit does not exist, or needs a restitution above 1 or below 0.
///
/// A rigid impact is equivalent to a contact force f(t) if its impulse is ∫f dt and its time the centroid
/// t* = ∫tf dt/∫f dt after the first touch: the motion after the contact is the same. Three corrections:
/// 1. Timing. At t* the rigid motions overlap by vt*. So C + t*/(M(1+R)) replaces C = χ₁(0) + χ₂(0), with the
///    periodic impulse responses χᵢ of both masses (`Green`).
/// 2. Pressing. An acceleration a that presses the masses together raises the approach speed to v + at* at
///    the impact. It changes the restitution to `R + (a/v)((1 − R)t_c − 2d_r/v)`, to first order.
/// 3. The rig's dampers. They slow a relative speed u by κu per second, κ = M(c₁/m₁² + c₂/m₂²). The rigid
///    flights lose the share `κt_c` of u between touch and parting. In the contact u reverses, and its
///    envelope loses only half of that. So `R(1 + κt_c/2)` replaces R, and a is taken without the dampers.
///
/// # Errors
/// If the contact lasts longer than `LONGEST_CONTACT` of the period.
pub fn softened(
    rig: &Rig,
    excitation: &Excitation,
    found: &Orbits,
    compliance: &Compliance,
) -> Result<Vec<Option<Softened>>> {
    let Some(first) = found.orbits.first() else { return Ok(Vec::new()) };
    let share = compliance.duration / first.period();
    if share > LONGEST_CONTACT {
        return Err(Error::refused(format!(
            "the contact lasts {:.1} % of the period; its correction is good up to {:.1} %",
            100.0 * share,
            100.0 * LONGEST_CONTACT
        ))
        .hint("simulate the motion with a contact of spring and damper"));
    }
    let soften = |orbit: &Orbit| {
        if orbit.impulse <= 0.0 {
            return Ok(None);
        }
        let (mut at, mut restitution) = (orbit.clone(), rig.restitution);
        // κ in 1/s of correction 3: the rate at which the rig's dampers slow a relative speed.
        let [first, second] = rig.bodies().map(|body| body.damping / (body.mass * body.mass));
        let kappa = rig.reduced_mass() * (first + second);
        // Each iteration multiplies the remaining error by about the contact's share of the period: 0.025⁸ is
        // negligible.
        for _ in 0..8 {
            let damped = rig.restitution * (1.0 + 0.5 * kappa * compliance.duration);
            let [_, undamped_mean] = pressing(&at, kappa);
            let corrected = damped + compliance.restitution_slope * undamped_mean / at.approach_velocity;
            if !(0.0..=1.0).contains(&corrected) {
                return Ok(None);
            }
            restitution = corrected;
            let soft =
                super::solve(&Rig { restitution, ..*rig }, excitation, orbit.cycles, compliance.delay)?;
            match orbit.continued(&soft.orbits) {
                Some(next) if next.impulse > 0.0 => at = next.clone(),
                _ => return Ok(None),
            }
        }
        Ok(Some(Softened {
            impulse: at.impulse,
            timing: at.timing,
            approach_velocity: at.approach_velocity - pressing(&at, kappa)[0] * compliance.delay,
            restitution,
            peak_to_peak: at.peak_to_peak,
            fundamental: at.fundamental.map(Complex64::norm),
            change: at.impulse / orbit.impulse - 1.0,
            share: compliance.duration / orbit.period(),
        }))
    };
    found.orbits.iter().map(soften).collect()
}

/// Two accelerations in m/s² at which the masses would approach each other without contact: the one just
/// before the impact, and the mean of those just before and just after it. The mean leaves out the dampers'
/// part −κ × relative speed.
fn pressing(orbit: &Orbit, kappa: f64) -> [f64; 2] {
    let (before, after) = orbit.course.rates();
    let [first, last] = [before, after].map(|rate| rate[1] - rate[3]);
    let speeds = before[0] - before[2] + (after[0] - after[2]);
    [first, f64::midpoint(first, last) + 0.5 * kappa * speeds]
}
