//! Motions that repeat, by their definition: after a period the masses meet again as they met.

use super::super::task::{Spring, Task};
use super::course::{Course, Met};
use super::mode::{LENGTH, Mode, STEPS};
use nalgebra::{Matrix4, Vector4};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rounds of Newton's method.
const ROUNDS: usize = 30;
/// Change of the unknowns for a derivative, in units of 1 mm, 1 mm·ω and 1 rad: half the digits.
const SMALL: f64 = 1e-7;
/// A motion closes where it misses by no more than this in these units: rounding of a few hundred steps, enlarged by what near grazing
/// does so.
const CLOSED: f64 = 1e-9;
/// What is left of the start, relative, where Newton's method takes over.
const NEARLY: f64 = 1e-3;
/// Where two numbers in parts of the motion's size are closer than this, rounding decides.
const ROUNDING: f64 = 1e-8;
/// Largest gain of one impact on the next up to which that holds.
const GAIN: f64 = 1e3;

/// A motion with one impact a period, as the masses meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// State at the first touch.
    pub before: [f64; 4],
    /// Phase in rad of the exciting force there.
    pub phase: f64,
}

impl Repeats {
    /// Approach speed in m/s.
    pub fn speed(&self) -> f64 {
        self.before[1] - self.before[3]
    }

    /// How far off an impact of this approach speed (m/s) at this phase (rad) is: relative and in rad together, so that no single one
    /// of them is small by chance.
    pub fn off(&self, speed: f64, phase: f64) -> f64 {
        let turn = (phase - self.phase + PI).rem_euclid(TAU) - PI;
        (speed / self.speed() - 1.0).hypot(turn)
    }
}

/// The motion with one impact in `period` (s) of a task, with impacts at once or a contact, that Newton's method reaches from `guess`.
pub fn repeats(task: &Task, contact: Option<&Spring>, period: f64, guess: &Repeats) -> Option<Repeats> {
    let course = Course::new(task, contact);
    let omega = TAU * task.frequency;
    let speed = LENGTH * omega;
    let of = |u: &Vector4<f64>| Repeats {
        before: [u[0] * LENGTH, u[1] * speed, u[0] * LENGTH - task.rig.gap, u[2] * speed],
        phase: u[3],
    };
    let missed = |u: &Vector4<f64>| -> Option<Vector4<f64>> {
        let Repeats { before: y, phase } = of(u);
        let (mut place, start) = (course.meeting(phase, &y), phase / omega);
        loop {
            if let Met::Impact(time, then) = course.next(&mut place, start + 1.5 * period)? {
                let late = omega * (time - start - period);
                let [x1, v1, _, v2] = std::array::from_fn(|i| then[i] - y[i]);
                return Some(Vector4::new(x1 / LENGTH, v1 / speed, v2 / speed, late));
            }
        }
    };
    let y = guess.before;
    let mut u = Vector4::new(y[0] / LENGTH, y[1] / speed, y[3] / speed, guess.phase);
    let mut off = missed(&u)?;
    for _ in 0..ROUNDS {
        let mut slope = Matrix4::zeros();
        for i in 0..4 {
            let (mut up, mut down) = (u, u);
            up[i] += SMALL;
            down[i] -= SMALL;
            slope.set_column(i, &((missed(&up)? - missed(&down)?) / (2.0 * SMALL)));
        }
        let step = slope.lu().solve(&off)?;
        // Half the way, and half of that, where the whole leads further off; until rounding is all that is left.
        let nearer = (0..8).find_map(|halvings| {
            let tried = u - step * 0.5_f64.powi(halvings);
            let missed = missed(&tried)?;
            (missed.norm() < off.norm()).then_some((tried, missed))
        });
        let Some(nearer) = nearer else { break };
        (u, off) = nearer;
    }
    let Repeats { before, phase } = of(&u);
    (off.amax() < CLOSED).then_some(Repeats { before, phase: phase.rem_euclid(TAU) })
}

/// The motion with one impact a cycle on which a task settles within so many `cycles`, if it does.
pub fn settled(task: &Task, contact: Option<&Spring>, cycles: f64) -> Option<Repeats> {
    let course = Course::new(task, contact);
    let mut place = course.free(task.phase, &task.first());
    let (omega, mut impacts) = (TAU * task.frequency, Vec::new());
    while let Some(met) = course.next(&mut place, task.phase / omega + cycles * task.cycle()) {
        if let Met::Impact(time, before) = met {
            impacts.push((time, Repeats { before, phase: omega * time }));
        }
    }
    let last = &impacts[impacts.len().checked_sub(9)?..];
    let regular = last.windows(2).all(|w| {
        ((w[1].0 - w[0].0) * task.frequency - 1.0).abs() < NEARLY
            && (w[1].1.speed() / w[0].1.speed() - 1.0).abs() < NEARLY
    });
    if regular { repeats(task, contact, task.cycle(), &last[8].1) } else { None }
}

/// The motions of a task with one impact a cycle that approaches, and how deep (m) the masses pass through each other in each; none
/// where rounding decides.
///
/// A cycle takes the state behind an impact to A y + b cos φ + c sin φ before the next, φ being the force's phase there, and the impact takes it
/// back to the first by a matrix: for each φ one linear equation gives the only state that repeats, and it is a sine of φ, as is its
/// gap. Where the gap is zero the masses meet: at two phases, or none.
pub fn impacts(task: &Task) -> Option<Vec<(Repeats, f64)>> {
    let (mode, rig) = (Course::new(task, None).apart, &task.rig);
    let still = Course::new(&Task { force: 0.0, ..*task }, None).apart;
    let speed = LENGTH * TAU * task.frequency;
    let unit = Vector4::new(LENGTH, speed, LENGTH, speed);
    // Over one cycle from a state at a phase of the force: the state at the end, and the smallest gap between the ends.
    let cycle = |mode: &Mode, phase: f64, y: &[f64]| {
        let (mut at, mut lowest) = (mode.instant(phase / (TAU * task.frequency), y), f64::INFINITY);
        for i in 0..STEPS {
            at = mode.step(0, &at);
            // Beside the impacts themselves the gap is small without meaning anything.
            if (1..STEPS - 2).contains(&i) {
                lowest = lowest.min(rig.gap + at.1[2] - at.1[0]);
            }
        }
        (Vector4::from_column_slice(&at.1[..4]).component_div(&unit), lowest)
    };
    let mut free = Matrix4::zeros();
    for i in 0..4 {
        let mut y = [0.0; 4];
        y[i] = unit[i];
        free.set_column(i, &cycle(&still, 0.0, &y).0);
    }
    // m₁v₁ + m₂v₂ = const, (v₁ − v₂)⁺ = −R(v₁ − v₂)⁻.
    let mut impact = Matrix4::identity();
    let whole = (1.0 + rig.restitution) / (rig.m1 + rig.m2);
    for (row, mass) in [(1, -rig.m2), (3, rig.m1)] {
        impact[(row, 1)] += mass * whole;
        impact[(row, 3)] -= mass * whole;
    }
    let back = (Matrix4::identity() - free * impact).try_inverse().filter(|inverse| inverse.norm() < GAIN)?;
    let [even, odd] = [0.0, FRAC_PI_2].map(|phase| back * cycle(&mode, phase, &[0.0; 4]).0);
    let gaps = [even, odd].map(|y| y[0] - y[2]);
    let (swing, crest, gap) = (gaps[0].hypot(gaps[1]), gaps[1].atan2(gaps[0]), rig.gap / LENGTH);
    let size = even.norm().hypot(odd.norm()).max(gap.abs());
    if (swing - gap.abs()).abs() < ROUNDING * size {
        return None;
    }
    let mut found = Vec::new();
    // x₁ − x₂ = gap.
    for side in if swing > gap.abs() { &[-1.0, 1.0][..] } else { &[] } {
        let phase = (crest + side * (gap / swing).acos()).rem_euclid(TAU);
        let y = even * phase.cos() + odd * phase.sin();
        let before: [f64; 4] = y.component_mul(&unit).into();
        let one = Repeats { before, phase };
        if one.speed().abs() < ROUNDING * size * speed {
            return None;
        }
        if one.speed() > 0.0 {
            let after: [f64; 4] = (impact * y).component_mul(&unit).into();
            found.push((one, -cycle(&mode, phase, &after).1));
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::super::super::scenes::task_b;
    use super::*;
    use vibro_model::{Sine, Steady};

    #[test]
    fn motions_of_the_definition_repeat() {
        // Just before scene B reaches the gap by itself two motions with an impact exist.
        let task = task_b(1.0);
        let unit =
            Steady::new(&task.rig, &Sine { force: 1.0, frequency: task.frequency }).unwrap().amplitude();
        for (force, n) in [(0.5, 1), (task.rig.gap / unit * (1.0 - 1e-3), 2), (1e-3, 0)] {
            let task = Task { force, ..task };
            let found = impacts(&task).unwrap();
            assert_eq!(found.len(), n);
            for (one, _) in found {
                // Newton's method on the motion itself stays where it begins.
                let again = repeats(&task, None, task.cycle(), &one).unwrap();
                assert!(one.off(again.speed(), again.phase) < 1e-8, "{one:?} {again:?}");
            }
        }
    }
}
