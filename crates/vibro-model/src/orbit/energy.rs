//! Energy of a period over the impulse, under a sine force (Magnus 1965; Babitsky 1998).

use super::check_not_zero;
use super::conditions::Conditions;
use crate::excitation::Sine;
use crate::rig::Rig;
use crate::steady::Steady;
use num_complex::Complex64;
use serde::Serialize;
use vibro_record::Result;

/// Energy of one period with one impact at each impulse J: the masses meet at the gap, and the impact law may
/// be broken. Where both energies are equal it holds: there the motion is an orbit.
#[derive(Debug, Clone, Copy)]
pub struct EnergyBalance {
    conditions: Conditions,
    steady: Steady,
    /// Receptance of mass 1 at the excitation frequency, in m/N.
    receptance: Complex64,
}

/// Energies of a period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergyPoint {
    /// Impulse in N s.
    pub impulse: f64,
    /// Work of the force, in J.
    pub supplied: f64,
    /// Loss in dampers and impact, in J.
    pub lost: f64,
}

impl EnergyBalance {
    /// Balance of one impact in `cycles` cycles of the force.
    ///
    /// # Errors
    /// As [`super::orbits_of`].
    pub fn new(rig: &Rig, sine: &Sine, cycles: u32) -> Result<EnergyBalance> {
        let steady = Steady::new(rig, sine)?;
        check_not_zero(sine.force)?;
        let conditions = Conditions::new(rig, sine.frequency, cycles, 0.0)?;
        Ok(EnergyBalance { conditions, steady, receptance: steady.response / sine.force })
    }

    /// Energies at `n` impulses from 0 to `most` (N s), as far as the masses can meet: |Δ + JC| ≤ A.
    pub fn curve(&self, n: usize, most: f64) -> Vec<EnergyPoint> {
        let (amplitude, gap) = (self.steady.amplitude(), self.conditions.rig.gap);
        let [a, b] = [-amplitude, amplitude].map(|y| (y - gap) / self.conditions.c);
        let (low, high) = (a.min(b).max(0.0), a.max(b).min(most));
        // The curves end like a square root: the points are dense there.
        let part = |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / (n - 1).max(1) as f64).cos();
        (0..n).filter_map(|k| self.at(low + (high - low) * part(k))).collect()
    }

    /// Energies at an impulse (N s); `None` where the masses cannot meet.
    pub fn at(&self, impulse: f64) -> Option<EnergyPoint> {
        let Conditions { rig, greens: [one, two], c, p, .. } = &self.conditions;
        let (omega, period) = (self.steady.omega, self.conditions.period());
        // Displacement and velocity of the forced motion of mass 1 at the impact.
        let meeting = rig.gap + impulse * c;
        let rest = self.steady.amplitude().powi(2) - meeting * meeting;
        let speed = (rest >= 0.0).then(|| (omega * rest.sqrt()).copysign(*p))?;
        let forced = Complex64::new(meeting, -speed / omega);
        let force = forced / self.receptance;
        let moved = forced - self.receptance * (2.0 * impulse / period);
        let supplied = -0.5 * omega * period * (force.conj() * moved).im;
        // The relative velocity falls by J/M in the impact; its mean times J leaves the motion there.
        let approach = speed - impulse * (one.slope_before + two.slope_before);
        let mass = rig.reduced_mass();
        let taken = impulse * (approach - 0.5 * impulse / mass);
        let by_law = impulse * (impulse / rig.exchange() - 0.5 * impulse / mass);
        Some(EnergyPoint { impulse, supplied, lost: supplied - taken + by_law })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Excitation;
    use crate::orbit::{Orbit, orbits_of};

    /// Work of the force and loss in the dampers by the midpoint rule over the orbit, and loss in the impact.
    fn summed(rig: &Rig, sine: &Sine, orbit: &Orbit) -> [f64; 2] {
        let n = 200_000;
        let step = orbit.period() / f64::from(n);
        let [mut supplied, mut lost] = [0.0; 2];
        for k in 0..n {
            let t = (f64::from(k) + 0.5) * step;
            let state = orbit.state(t);
            supplied += step * state.v1 * sine.force * (sine.omega() * t + orbit.force_phase).cos();
            lost += step * (rig.c1 * state.v1.powi(2) + rig.c2 * state.v2.powi(2));
        }
        let r = rig.restitution;
        [supplied, lost + 0.5 * rig.reduced_mass() * (1.0 - r * r) * orbit.approach_velocity.powi(2)]
    }

    #[test]
    fn energies_of_orbits_are_those_of_their_motion() {
        let mut seen = [0, 0];
        for (restitution, c1, force, frequency, cycles) in [
            (0.7, 0.1, 0.5, 11.0, 1),
            (1.0, 0.1, 0.1, 6.0, 1),
            (0.4, 0.0, 0.3, 8.0, 1),
            (0.9, 0.05, 0.9, 12.0, 2),
            (0.98, 0.1, 0.1, 10.5, 1),
        ] {
            let rig = Rig { c1, restitution, ..Rig::thesis() };
            let sine = Sine { force, frequency };
            let balance = EnergyBalance::new(&rig, &sine, cycles).unwrap();
            for orbit in orbits_of(&rig, &Excitation::Sine(sine), cycles).unwrap().orbits {
                if orbit.impulse <= 0.0 {
                    continue;
                }
                seen[usize::from(orbit.validity.energy_rule)] += 1;
                let found = balance.at(orbit.impulse).unwrap();
                let [supplied, lost] = summed(&rig, &sine, &orbit);
                // The midpoint rule errs by (ωh)²/24, here below 1e-8; the roots by 1e-15 times the
                // amplification near the fold.
                let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * supplied.abs().max(lost);
                assert!(
                    near(found.supplied, supplied) && near(found.lost, lost),
                    "{found:?} {supplied} {lost}"
                );
                assert!(near(found.supplied, found.lost));
                // The energy rule: a larger impulse takes more than is supplied.
                let more = balance.at(1.001 * orbit.impulse);
                assert!(more.is_none_or(|e| (e.lost > e.supplied) == orbit.validity.energy_rule), "{more:?}");
            }
        }
        assert!(seen[0] > 0 && seen[1] > 3, "{seen:?}");
    }
}
