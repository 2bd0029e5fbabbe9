//! Orbits under a sine force, or without force: roots of a quadratic equation in the impulse.

use super::conditions::{Conditions, Root};
use super::{Course, Orbit, check_not_zero};
use crate::excitation::{Excitation, Sine};
use crate::flow::Flight;
use crate::least::{NumberRange, number};
use crate::rig::Rig;
use crate::scales::check_values;
use crate::steady::Steady;
use crate::waves::Waves;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Result;

/// (C² + (P/ω)²)J² + 2ΔCJ + Δ² − A² = 0, from y = A cos φ = Δ + JC and ẏ = −Aω sin φ = JP.
#[derive(Debug, Clone, Copy)]
struct Quadratic {
    /// C² + (P/ω)².
    a: f64,
    /// ΔC.
    half: f64,
    /// Discriminant half² − a(Δ² − A²), written without cancellation; negative beyond the fold.
    discriminant: f64,
    /// Product of the roots.
    product: f64,
}

impl Quadratic {
    /// Equation for these conditions, with the steady motion of mass 1 alone of `amplitude` (m) at `omega`
    /// (rad/s).
    fn new(conditions: &Conditions, amplitude: f64, omega: f64) -> Quadratic {
        let (c, p, gap) = (conditions.c, conditions.p / omega, conditions.rig.gap);
        let a = c * c + p * p;
        Quadratic {
            a,
            half: gap * c,
            discriminant: amplitude.powi(2) * a - (gap * p).powi(2),
            product: (gap - amplitude) * (gap + amplitude) / a,
        }
    }

    /// Whether its roots are real.
    fn has_roots(&self) -> bool {
        self.a > 0.0 && self.discriminant >= 0.0
    }

    /// The roots, the larger first; beyond the fold both are −ΔC/a, as for the double root at the fold.
    fn roots(&self) -> [f64; 2] {
        // First the root that is computed without cancellation, then the other from the product of both.
        let root = self.discriminant.max(0.0).sqrt();
        let first = -(self.half + root.copysign(self.half)) / self.a;
        let second = match (first == 0.0, self.discriminant > 0.0) {
            (true, _) => 0.0,
            (false, true) => self.product / first,
            (false, false) => first,
        };
        [first.max(second), first.min(second)]
    }
}

/// The motion after an impact J: mass 1 moves by its forced motion `forced` minus Jχ₁, mass 2 by Jχ₂.
fn course(conditions: &Conditions, impulse: f64, forced: Waves) -> Course {
    let [one, two] = &conditions.greens;
    let free = [
        (-impulse * one.start, -impulse * one.slope_after),
        (impulse * two.start, impulse * two.slope_after),
    ];
    let rig = &conditions.rig;
    Course::smooth(conditions.period(), &Flight::of(rig.oscillators(), forced, 0.0, rig.gap, free))
}

/// Orbits under the force `sine`, with the steady motion `steady` of mass 1 alone; larger impulse first.
pub fn orbits(conditions: &Conditions, steady: &Steady, sine: &Sine) -> Vec<Orbit> {
    let (c, p, gap) = (conditions.c, conditions.p / steady.omega, conditions.rig.gap);
    let amplitude = steady.amplitude();
    let quadratic = Quadratic::new(conditions, amplitude, steady.omega);
    if !quadratic.has_roots() {
        return Vec::new();
    }
    let one = |(impulse, upper): (f64, bool)| {
        let timing = f64::atan2(-impulse * p / amplitude, (gap + impulse * c) / amplitude).rem_euclid(TAU);
        let root = Root {
            impulse,
            timing,
            force_phase: (timing - steady.response.arg()).rem_euclid(TAU),
            // From the quadratic: (aJ + ΔC) dJ = −(CJ + Δ) dΔ.
            sensitivity: (c * impulse + gap).abs() / quadratic.discriminant.sqrt(),
            size: gap.abs() + amplitude,
            upper,
        };
        let course =
            course(conditions, impulse, Waves::one(Complex64::from_polar(amplitude, timing), steady.omega));
        conditions.orbit(&root, course, Some(Excitation::Sine(*sine)))
    };
    let [larger, smaller] = quadratic.roots();
    [(larger, true), (smaller, false)].map(one).into()
}

/// Amplitudes of the orbit with the larger impulse, without verdicts. This is fast: fits compute it a million
/// times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownOrbit {
    /// Impulse J in N s.
    pub impulse: f64,
    /// Amplitudes of x₁ and x₂ in m at the excitation frequency.
    pub amplitude: [f64; 2],
    /// Whether the orbit exists: its root is real and J > 0. Beyond the fold the numbers are those of the
    /// double root, so that they change continuously. [`super::orbits`] tells whether the orbit is admissible
    /// and stable.
    pub exists: bool,
}

/// Computes the orbit of the larger root with one impact a cycle under a sine force; X₁ = Ae^{iφ} − (2J/T)L₁,
/// X₂ = (2J/T)L₂.
///
/// # Errors
/// As [`super::orbits`].
pub fn shown(rig: &Rig, sine: &Sine) -> Result<ShownOrbit> {
    let steady = Steady::new(rig, sine)?;
    check_not_zero(sine.force)?;
    let conditions = Conditions::new(rig, sine.frequency, 1, 0.0)?;
    let omega = steady.omega;
    let quadratic = Quadratic::new(&conditions, steady.amplitude(), omega);
    let [impulse, _] = quadratic.roots();
    let [l1, l2] = rig.receptances(omega);
    let train = 2.0 * impulse * sine.frequency;
    // A cos φ and A sin φ. Beyond the fold their squares do not add up to A², so they are scaled to A.
    let forced = Complex64::new(rig.gap + impulse * conditions.c, -impulse * conditions.p / omega);
    let forced = forced * (steady.amplitude() / forced.norm());
    Ok(ShownOrbit {
        impulse,
        amplitude: [(forced - train * l1).norm(), (train * l2).norm()],
        exists: quadratic.has_roots() && impulse > 0.0,
    })
}

/// The free motion with one impact a cycle at `frequency` (Hz) of the rig without dampers and impact losses;
/// `None` where there is none.
///
/// Without losses P = 0, every impulse satisfies the impact law, and the masses meet where Δ + JC = 0
/// (Babitsky, *Theory of Vibro-Impact Systems* (1998)). Resonances of the driven rig lie along this curve.
///
/// # Errors
/// If a parameter is impossible, or the frequency is a natural frequency divided by a whole number.
pub fn backbone(rig: &Rig, frequency: f64) -> Result<Option<Orbit>> {
    number("frequency", frequency, "Hz", NumberRange::AboveZero)?;
    check_values(rig, [frequency])?;
    let lossless = Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..*rig };
    let conditions = Conditions::new(&lossless, frequency, 1, 0.0)?;
    let impulse = -rig.gap / conditions.c;
    if !(impulse.is_finite() && impulse > 0.0) {
        return Ok(None);
    }
    let root = Root {
        impulse,
        timing: 0.0,
        force_phase: 0.0,
        sensitivity: 1.0 / conditions.c.abs(),
        size: rig.gap.abs(),
        upper: false,
    };
    Ok(Some(conditions.orbit(&root, course(&conditions, impulse, Waves::default()), None)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::orbits;
    use vibro_math::bisected;

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
            // The phase is converted to an angle and back, with a rounding of ε. x₁ is a difference of terms
            // that are larger than x₁ by the factor `parts`, which amplifies the rounding.
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
        // The fold is located by bisection between a frequency with roots and one without.
        let rig = Rig { restitution: 0.98, ..Rig::thesis() };
        let at = |frequency| shown(&rig, &Sine { force: 0.1, frequency }).unwrap();
        let (low, high) = bisected(10.0, 11.0, 60, |frequency| at(frequency).exists);
        let (before, behind) = (at(low), at(high));
        assert!(before.exists && !behind.exists);
        // Near a fold the root changes as the square root of the distance, here one rounding of the
        // frequency.
        for (a, b) in before.amplitude.iter().zip(behind.amplitude) {
            assert!((a / b - 1.0).abs() < 64.0 * f64::EPSILON.sqrt(), "{a} {b}");
        }
        assert!(shown(&rig, &Sine { force: 0.0, frequency: 5.0 }).is_err());
    }
}
