//! What a spectrum shows of the orbit of the larger root, without its verdicts: for fits, which ask for it a million times.

use super::conditions::Conditions;
use super::driven;
use super::sine::Quadratic;
use crate::{Rig, Sine, Steady};
use num_complex::Complex64;
use vibro_record::Result;

/// The orbit of the larger root as a spectrum shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Impulse J in N s.
    pub impulse: f64,
    /// Amplitudes of x₁ and x₂ in m at the excitation frequency.
    pub amplitude: [f64; 2],
    /// Whether the orbit exists: its root is real and J > 0. Beyond the fold the numbers are those of the place where the roots would
    /// have met, so that they change continuously; whether the orbit is admissible and stable, [`super::orbits`] tells.
    pub exists: bool,
}

/// The orbit of the larger root with one impact a cycle under a sine force; X₁ = Ae^{iφ} − (2J/T)L₁, X₂ = (2J/T)L₂.
///
/// # Errors
/// As [`super::orbits`].
pub fn shown(rig: &Rig, sine: &Sine) -> Result<Shown> {
    let steady = Steady::new(rig, sine)?;
    driven(sine.force)?;
    let conditions = Conditions::new(rig, sine.frequency, 1)?;
    let omega = steady.omega;
    let quadratic = Quadratic::new(&conditions, steady.amplitude(), omega);
    let [impulse, _] = quadratic.roots();
    let [l1, l2] = rig.receptances(omega);
    let train = 2.0 * impulse * sine.frequency;
    // cos φ and sin φ times A; beyond the fold their squares do not add up to A².
    let forced = Complex64::new(rig.gap + impulse * conditions.c, -impulse * conditions.p / omega);
    let forced = forced * (steady.amplitude() / forced.norm());
    Ok(Shown {
        impulse,
        amplitude: [(forced - train * l1).norm(), (train * l2).norm()],
        exists: quadratic.has_roots() && impulse > 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbits;

    #[test]
    fn it_is_the_fundamental_of_the_upper_orbit() {
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let (mut compared, mut beyond) = (0, 0);
        for i in 0..200 {
            let frequency = 4.013 + 0.05 * f64::from(i);
            let sine = Sine { force: 0.1, frequency };
            let all = orbits(&rig, sine.force, frequency).unwrap();
            let shown = shown(&rig, &sine).unwrap();
            let Some(orbit) = all.orbits.first() else {
                assert!(!shown.exists && shown.amplitude.iter().all(|a| a.is_finite()), "{shown:?}");
                beyond += 1;
                continue;
            };
            assert_eq!(shown.exists, orbit.validity.exists);
            // The phase goes through an angle and back there: rounded to ε, and x₁ is a difference of parts that are up to so much larger.
            for (a, x) in shown.amplitude.iter().zip(orbit.fundamental) {
                let parts = 1.0 + all.no_impact.amplitude / x.norm();
                assert!((a / x.norm() - 1.0).abs() < 64.0 * f64::EPSILON * parts, "{frequency}: {a} {x}");
            }
            compared += 1;
        }
        assert!(compared > 100 && beyond > 20, "{compared} {beyond}");
    }

    #[test]
    fn beyond_the_fold_it_goes_on_without_a_step() {
        // The fold is found by halving between a frequency with roots and one without.
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let at = |frequency| shown(&rig, &Sine { force: 0.1, frequency }).unwrap();
        let (mut low, mut high) = (10.0, 11.0);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if at(middle).exists { low = middle } else { high = middle }
        }
        let (before, behind) = (at(low), at(high));
        assert!(before.exists && !behind.exists);
        // Beside a fold the root goes as the square root of the distance, here one rounding of the frequency.
        for (a, b) in before.amplitude.iter().zip(behind.amplitude) {
            assert!((a / b - 1.0).abs() < 64.0 * f64::EPSILON.sqrt(), "{a} {b}");
        }
        assert!(shown(&rig, &Sine { force: 0.0, frequency: 5.0 }).is_err());
    }
}
