//! All motions with one impact a cycle, by their definition: matrix exponentials from impact to impact, and nothing of the closed form.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Matrix4, Vector4};

use super::super::task::Task;
use super::course::{Course, Met, Start};
use super::mode::LENGTH;
use super::repeats::Repeats;

/// How well a motion is known, in parts of its size: far above the rounding of 512 steps, 1e-12, and far below what anybody could measure.
pub(crate) const CLOSES: f64 = 1e-8;
/// Largest gain of one impact on the next up to which that holds.
const GAIN: f64 = 1e3;

/// What the definition has.
#[derive(Debug, Clone, PartialEq)]
pub struct Definite {
    /// Motions whose impact approaches.
    pub approaching: Vec<Repeats>,
    /// How many more there are where rounding decides whether it does.
    pub grazing: usize,
}

/// The motions of a task with one impact a cycle that approaches, whether the masses pass through each other or not.
///
/// A cycle takes the state behind an impact to A y + b cos φ + c sin φ before the next, φ being the force's phase there, and the impact takes it
/// back to the first by a matrix: for each φ one linear equation gives the only state that repeats, and it is a sine of φ, as is its
/// gap. Where the gap is zero the masses meet: at two phases, or none.
///
/// # Errors
/// Where rounding decides: the equation is all but singular, or the two phases all but meet.
pub fn impacts(task: &Task) -> Result<Definite, String> {
    let course = Course::new(task, None);
    let speed = LENGTH * TAU * task.frequency;
    let unit = Vector4::new(LENGTH, speed, LENGTH, speed);
    let (mode, rig) = (course.apart(), &task.rig);
    let steps = (task.cycle() / mode.duration(0)).round() as usize;
    // Over one cycle, from a state and the force of a phase, or none.
    let cycle = |state: [f64; 4], phase: Option<f64>| {
        let y = (0..steps).fold(state, |y, i| {
            let time = i as f64 * mode.duration(0);
            let mut at = mode.coordinates(phase.unwrap_or(0.0), time, &y);
            if phase.is_none() {
                (at[4], at[5]) = (0.0, 0.0);
            }
            mode.step(0, &at)
        });
        Vector4::from(y).component_div(&unit)
    };
    let mut free = Matrix4::zeros();
    for i in 0..4 {
        let mut y = [0.0; 4];
        y[i] = unit[i];
        free.set_column(i, &cycle(y, None));
    }
    // m₁v₁ + m₂v₂ = const, (v₁ − v₂)⁺ = −R(v₁ − v₂)⁻.
    let mut impact = Matrix4::identity();
    let whole = (1.0 + rig.restitution) / (rig.m1 + rig.m2);
    for (row, mass) in [(1, -rig.m2), (3, rig.m1)] {
        impact[(row, 1)] += mass * whole;
        impact[(row, 3)] -= mass * whole;
    }
    let back = (Matrix4::identity() - free * impact)
        .try_inverse()
        .filter(|inverse| inverse.norm() < GAIN)
        .ok_or("an impact a cycle after another is as large: the motion that repeats is not to be told by rounding")?;
    let [even, odd] = [0.0, FRAC_PI_2].map(|phase| back * cycle([0.0; 4], Some(phase)));
    let of = |weights: [f64; 4]| {
        let [even, odd] = [even, odd].map(|y| Vector4::from(weights).dot(&y));
        (even.hypot(odd), odd.atan2(even))
    };
    let (swing, crest) = of([1.0, 0.0, -1.0, 0.0]);
    let gap = rig.gap / LENGTH;
    let size = even.norm().hypot(odd.norm()).max(gap.abs());
    if (swing - gap.abs()).abs() < CLOSES * size {
        return Err("the two phases of the impact all but meet".to_owned());
    }
    let mut found = Definite { approaching: Vec::new(), grazing: 0 };
    // x₁ − x₂ = gap.
    for side in if swing > gap.abs() { vec![-1.0, 1.0] } else { Vec::new() } {
        let phase = crest + side * (gap / swing).acos();
        let y = (even * phase.cos() + odd * phase.sin()).component_mul(&unit);
        let one = Repeats { before: [y[0], y[1], y[2], y[3]], phase: phase.rem_euclid(TAU) };
        if one.speed().abs() < CLOSES * size * speed {
            found.grazing += 1;
        } else if one.speed() > 0.0 {
            found.approaching.push(one);
        }
    }
    Ok(found)
}

/// How disturbances of a motion that repeats grow from impact to impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// Coefficients c₁, … c₄ of the polynomial λ⁴ − c₁λ³ + c₂λ² − c₃λ + c₄ of the multipliers, and how far each may be off.
    pub polynomial: [[f64; 2]; 4],
    /// Largest modulus of a multiplier, and how far it may be off.
    pub largest: [f64; 2],
}

/// Follows `at` from its impact to the next, each of place, speeds and phase disturbed by a little to both sides, and by twice that.
///
/// # Errors
/// If a disturbed motion does not come back after a cycle.
pub fn growth(task: &Task, at: &Repeats) -> Result<Growth, String> {
    let course = Course::new(task, None);
    let unit = LENGTH * TAU * task.frequency;
    let next = |u: &Vector4<f64>| -> Result<Vector4<f64>, String> {
        let x1 = u[0] * LENGTH;
        let before = [x1, u[1] * unit, x1 - task.rig.gap, u[2] * unit];
        let mut met = None;
        course.run(u[3], Start::Meeting(before), 1.5 * task.cycle(), &mut |m| {
            if let Met::Impact(time, y) = m {
                met = Some((*time, *y));
            }
            met.is_none()
        })?;
        let (time, y) = met
            .filter(|m| (m.0 * task.frequency - 1.0).abs() < 0.1)
            .ok_or("the next impact does not come a cycle later")?;
        Ok(Vector4::new(y[0] / LENGTH, y[1] / unit, y[3] / unit, u[3] + TAU * (task.frequency * time - 1.0)))
    };
    let y = at.before;
    let u = Vector4::new(y[0] / LENGTH, y[1] / unit, y[3] / unit, at.phase);
    let slope = |by: f64| -> Result<Matrix4<f64>, String> {
        let mut slope = Matrix4::zeros();
        for i in 0..4 {
            let (mut up, mut down) = (u, u);
            up[i] += by;
            down[i] -= by;
            slope.set_column(i, &((next(&up)? - next(&down)?) / (2.0 * by)));
        }
        Ok(slope)
    };
    // Nowhere more than a thousandth of what the impact approaches by.
    let by = SMALL * (at.speed() / unit).min(1.0);
    let [near, far] = [slope(by)?, slope(2.0 * by)?];
    // Differences of twice the step are four times as far off: how far apart both are covers what the smaller is off, three times. The rounding of a
    // cycle grows by the step.
    let (rounding, size) = (ROUNDING / by, near.amax().max(1.0));
    let polynomial = |m: &Matrix4<f64>| {
        // Newton's identities from the traces of the powers.
        let mut power = Matrix4::identity();
        let mut traces = [0.0; 4];
        for trace in &mut traces {
            power *= m;
            *trace = power.trace();
        }
        let mut c = [1.0; 5];
        for k in 1..=4 {
            let sum: f64 =
                (1..=k).map(|i| (if i % 2 == 1 { 1.0 } else { -1.0 }) * c[k - i] * traces[i - 1]).sum();
            c[k] = sum / k as f64;
        }
        [c[1], c[2], c[3], c[4]]
    };
    let [c, coarse] = [polynomial(&near), polynomial(&far)];
    let radius = |m: &Matrix4<f64>| m.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max);
    let [largest, about] = [radius(&near), radius(&far)];
    Ok(Growth {
        // There are 4, 6, 4 and 1 minors of order k, sums of k! products of k entries, each of which is rounded.
        polynomial: std::array::from_fn(|k| {
            let entries = [4.0, 24.0, 72.0, 96.0][k] * size.powi(k as i32);
            [c[k], (coarse[k] - c[k]).abs() + entries * rounding]
        }),
        largest: [largest, (about - largest).abs() + 4.0 * rounding],
    })
}

/// Rounding of a state in these units over the 512 steps of a cycle, the place of the impact by halving included.
const ROUNDING: f64 = 1e-13;
/// Change of the unknowns for a derivative, in units of 1 mm, 1 mm·ω and 1 rad: the third part of the digits.
const SMALL: f64 = 1e-5;

#[cfg(test)]
mod tests {
    use super::super::super::scene_b;
    use super::super::repeats;
    use super::*;
    use vibro_model::{Rig, Sine, Steady};

    /// Scene B just before it reaches the gap by itself, where two motions with an impact exist.
    fn two() -> Task {
        let task = scene_b::task(1.0);
        let unit =
            Steady::new(&task.rig, &Sine { force: 1.0, frequency: task.frequency }).unwrap().amplitude();
        Task { force: task.rig.gap / unit * (1.0 - 1e-3), ..task }
    }

    #[test]
    fn motions_of_the_definition_repeat() {
        for (task, n) in
            [(scene_b::task(1.0), 1), (two(), 2), (Task { force: 1e-3, ..scene_b::task(1.0) }, 0)]
        {
            let found = impacts(&task).unwrap();
            assert_eq!((found.approaching.len(), found.grazing), (n, 0));
            for one in found.approaching {
                // Newton's method on the motion itself stays where it begins.
                let again = repeats(&task, None, task.cycle(), &one).unwrap();
                assert!((again.speed() / one.speed() - 1.0).abs() < CLOSES, "{one:?} {again:?}");
                assert!((again.phase - one.phase).abs() < CLOSES, "{one:?} {again:?}");
            }
        }
    }

    /// All volumes shrink by the dampers and twice by the restitution: the product of the multipliers is R²e^{−(c₁/m₁ + c₂/m₂)T}.
    #[test]
    fn volumes_of_disturbances_shrink_by_dampers_and_restitution() {
        for task in [scene_b::task(1.0), two()] {
            let rig = Rig { restitution: 0.6, ..task.rig };
            let task = Task { rig, ..task };
            let volume =
                rig.restitution.powi(2) * (-(rig.c1 / rig.m1 + rig.c2 / rig.m2) * task.cycle()).exp();
            for one in impacts(&task).unwrap().approaching {
                let [found, allowed] = growth(&task, &one).unwrap().polynomial[3];
                assert!((found - volume).abs() <= allowed, "{found} {volume} {allowed}");
                // Near grazing differences of differences tell little of the product.
                assert!(allowed < 1e-4 || one.speed() < 0.1, "{allowed}");
            }
        }
    }
}
