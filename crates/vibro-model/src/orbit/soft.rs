//! What a contact that gives way changes in an orbit, to first order in the duration of the contact.

use super::{Orbit, Orbits};
use crate::excitation::Excitation;
use crate::law::Law;
use crate::law::conversion;
use crate::rig::Rig;
use num_complex::Complex64;
use serde::Serialize;
use vibro_record::{Error, Result};

/// The longest part of the period in contact for which the correction was checked.
pub(crate) const LONGEST_CONTACT: f64 = 0.025;

/// A contact of spring k₃ and damper c₃ (Kelvin and Voigt) that cannot pull, as two masses M meet it alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Compliance {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// c₃ in N s/m.
    pub damping: f64,
    /// ζ = c₃/(2√(k₃M)).
    pub damping_ratio: f64,
    /// Restitution of this spring and damper.
    pub restitution: f64,
    /// Duration of the contact in s.
    pub duration: f64,
    /// Time t* in s by which an impact without duration would follow the first touch, to leave the masses on
    /// the same ways.
    pub delay: f64,
    /// Change of the restitution in s by the acceleration a that presses the masses together, per a/v: `(1 −
    /// R)t_c − 2d_r/v`.
    #[serde(skip)]
    pressed: f64,
}

impl Compliance {
    /// Contact of stiffness k₃ (N/m) on a rig; without `damping` (N s/m) the damper is the one that gives the
    /// rig's restitution.
    ///
    /// With ψ = asin ζ: `t_c = (π − 2ψ)/ω_d`, `R = e^{−ζω₀t_c}`; the masses part at the indentation `d_r = vR
    /// sin(2ψ)/ω_d`, where the force vanishes, and `t* = (d_r/v + Rt_c)/(1 + R)`.
    ///
    /// # Errors
    /// If stiffness or damping are impossible, the damper is critical or more, or no damper gives the rig's
    /// restitution.
    pub fn new(rig: &Rig, stiffness: f64, damping: Option<f64>) -> Result<Compliance> {
        rig.check()?;
        Law::KelvinVoigt { stiffness, damping: damping.unwrap_or(0.0) }.check()?;
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
        let left = restitution * (2.0 * ratio.asin()).sin() / (omega * (1.0 - ratio * ratio).sqrt());
        Ok(Compliance {
            stiffness,
            damping: 2.0 * ratio * mass * omega,
            damping_ratio: ratio,
            restitution,
            duration,
            delay: (left + restitution * duration) / (1.0 + restitution),
            pressed: (1.0 - restitution) * duration - 2.0 * left,
        })
    }
}

/// An orbit with the duration of its contact taken into account.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Softened {
    /// Impulse in N s.
    pub impulse: f64,
    /// φ in rad or τ in s of the impact without duration, `delay` after the first touch.
    pub timing: f64,
    /// Approach speed in m/s at the first touch.
    pub approach_velocity: f64,
    /// Restitution in m/s over m/s of the impact without duration: that of the contact, changed by what
    /// presses the masses together.
    pub restitution: f64,
    /// Largest minus smallest x₁ and x₂ in m; the way within the contact is not in it.
    pub peak_to_peak: [f64; 2],
    /// Amplitudes of x₁ and x₂ in m at the excitation frequency.
    pub fundamental: [f64; 2],
    /// Relative change of the impulse. Where it matters, so does the contact's stiffness.
    pub change: f64,
    /// Part of the period in contact.
    pub share: f64,
}

/// What `compliance` changes in each of the orbits `found` of this rig and excitation; `None` where the orbit
/// has no counterpart left, or only one whose restitution is none (above 1 or below 0).
///
/// The contact's force f over the masses' reduced one gives I = ∫f dt at the time t* = ∫tf dt/I after the
/// touch: an impact without duration then and of that size leaves the masses on the same ways. At that time
/// the ways already overlap by vt*, so C + t*/(M(1+R)) takes the place of C = χ₁(0) + χ₂(0). An acceleration
/// a that presses the masses together (to first order) lets them meet at the speed v + at* then, and makes
/// the restitution `R + (a/v)((1 − R)t_c − 2d_r/v)`. The rig's own dampers slow a relative speed u by κu, κ =
/// M(c₁/m₁² + c₂/m₂²): between touch and parting the two ways without duration lose `κt_c` of it, while in
/// the contact, where it turns round, its envelope falls by `κt_c/2`; so `R(1 + κt_c/2)` takes the place of
/// R, and a is what presses without the dampers.
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
        // κ = M(c₁/m₁² + c₂/m₂²): the rig's own dampers slow the masses' approach by κ times its speed.
        let [first, second] = rig.bodies().map(|body| body.damping / (body.mass * body.mass));
        let drag = rig.reduced_mass() * (first + second);
        // Each round leaves about the share in contact of the change that is left: 0.025⁸ is nothing.
        for _ in 0..8 {
            // The flights take κt_c off a relative speed that in the contact, where it turns round, falls by
            // half of that.
            let turned = rig.restitution * (1.0 + 0.5 * drag * compliance.duration);
            let [_, steady] = pressing(&at, drag);
            let changed = turned + compliance.pressed * steady / at.approach_velocity;
            if !(0.0..=1.0).contains(&changed) {
                return Ok(None);
            }
            restitution = changed;
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
            approach_velocity: at.approach_velocity - pressing(&at, drag)[0] * compliance.delay,
            restitution,
            peak_to_peak: at.peak_to_peak,
            fundamental: at.fundamental.map(Complex64::norm),
            change: at.impulse / orbit.impulse - 1.0,
            share: compliance.duration / orbit.period(),
        }))
    };
    found.orbits.iter().map(soften).collect()
}

/// Accelerations in m/s² that would press the masses together if they did not meet: just before the impact,
/// and that part of it that their approach, slowed by `drag` (1/s), does not change.
fn pressing(orbit: &Orbit, drag: f64) -> [f64; 2] {
    let (before, after) = orbit.course.rates();
    let [first, last] = [before, after].map(|rate| rate[1] - rate[3]);
    let speeds = before[0] - before[2] + (after[0] - after[2]);
    [first, f64::midpoint(first, last) + 0.5 * drag * speeds]
}
