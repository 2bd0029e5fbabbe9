//! Answers against the truth.

use super::task::{Fault, Task, Told};
use super::truth::{Course, settled};
use crate::compare::precision::Outcome;
use crate::model::{Orbit, Orbits, Rig, State, orbits};

/// An outcome and why.
pub type Found = (Outcome, String);

/// What every method may be off: this part of a cycle in times, this part of them in approach speeds. It is what a fixed step of a
/// thousandth of a cycle comes to within some impacts, and twenty times what a millimetre scale would show.
pub const ALLOWED: f64 = 0.01;

/// Approach speed in m/s from which an impact must be told.
const SLOW: f64 = 1e-3;
/// Cycles within which a motion may settle.
pub const SETTLED: f64 = 400.0;
/// How well an orbit in closed form has to close, in parts of its largest displacement: far above the 1e-13 to which the
/// exponentials are exact, far below what anybody could measure.
const CLOSES: f64 = 1e-8;

/// Every impact of either list that is not slow has to be in the other within [`ALLOWED`], and every rest of the truth that lasts
/// longer than twice that has to begin where it is told.
pub fn motion(told: &Told, truth: &Told, task: &Task) -> Found {
    let off = ALLOWED * task.cycle();
    let inside = |i: &&(f64, f64)| i.0 < task.until - 2.0 * off && i.1 > SLOW;
    let nearest = |list: &Told, time: f64| {
        list.impacts.iter().map(|i| (i.0 - time).abs()).fold(f64::INFINITY, f64::min)
    };
    let mut largest = 0.0_f64;
    for impact in truth.impacts.iter().filter(inside) {
        let error = nearest(told, impact.0);
        if error.is_nan() || error > off {
            return wrong(format!(
                "no impact at {:.9} s, where there is one of {:.2e} m/s",
                impact.0, impact.1
            ));
        }
        largest = largest.max(error);
    }
    if let Some(extra) = told.impacts.iter().filter(inside).find(|i| nearest(truth, i.0) > off) {
        return wrong(format!("an impact of {:.2e} m/s at {:.9} s, where there is none", extra.1, extra.0));
    }
    let lasting: Vec<_> =
        truth.sticks.iter().filter(|s| s[1] - s[0] > 2.0 * off && s[0] < task.until - 2.0 * off).collect();
    for rest in &lasting {
        if !told.sticks.iter().any(|s| (s[0] - rest[0]).abs() <= off) {
            return wrong(format!("the masses do not come to rest against each other at {:.9} s", rest[0]));
        }
    }
    let n = truth.impacts.iter().filter(inside).count();
    (
        Outcome::Right,
        format!("{n} impacts within {largest:.0e} s, {} rests; allowed {off:.0e} s", lasting.len()),
    )
}

/// The first impact, at the time of the truth or never.
pub fn first(told: &Told, truth: Option<f64>, task: &Task) -> Found {
    let allowed = ALLOWED * task.cycle();
    match (told.impacts.first(), truth) {
        (None, None) => (Outcome::Right, "no impact is seen where there is none".to_owned()),
        (Some(i), None) => wrong(format!("an impact at {:.9} s, where there is none", i.0)),
        (None, Some(t)) => wrong(format!("the impact at {t:.9} s is not seen")),
        (Some(i), Some(t)) => {
            let off = (i.0 - t).abs();
            let outcome = if off <= allowed { Outcome::Right } else { Outcome::Wrong };
            (outcome, format!("{off:.0e} s off, allowed {allowed:.0e} s"))
        }
    }
}

/// An approach speed (m/s) after many cycles against that of the motion that repeats.
pub fn speed(told: f64, truth: f64) -> Found {
    let error = (told / truth - 1.0).abs();
    let outcome = if error <= ALLOWED { Outcome::Right } else { Outcome::Wrong };
    (outcome, format!("approach speed {error:.0e} off, allowed {ALLOWED:.0e}"))
}

pub(super) fn wrong(why: String) -> Found {
    (Outcome::Wrong, why)
}

/// Orbits in closed form by their definition: the impact keeps momentum and turns the relative speed v into −Rv, matrix exponentials lead from behind it
/// to before the next, the masses pass through each other just where that is said; and what the motion settles on with one
/// impact a cycle is among the stable ones.
pub fn closed_form(task: &Task) -> Result<Found, Fault> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    let course = Course::new(task, None);
    for orbit in found.orbits.iter().filter(|o| o.validity.exists) {
        if let Some(why) = broken(&course, task, orbit) {
            return Ok(wrong(format!("an orbit of {:.3e} m/s {why}", orbit.approach_velocity)));
        }
    }
    let mut settles = "the motion does not settle on one";
    if let Some(truth) = settled(task, None, SETTLED).map_err(Fault::Stalled)? {
        settles = "the motion settles on one of them";
        let told = |o: &&Orbit| {
            (o.approach_velocity / truth.speed() - 1.0).abs() < CLOSES.sqrt()
                && o.validity.admissible
                && o.validity.stable != Some(false)
        };
        if !found.orbits.iter().any(|o| told(&o)) {
            return Ok(wrong(format!(
                "the motion settles at {:.6e} m/s, which is not among the stable orbits",
                truth.speed()
            )));
        }
    }
    Ok((Outcome::Right, format!("{} orbits close and clear as they say; {settles}", existing(&found))))
}

fn existing(found: &Orbits) -> usize {
    found.orbits.iter().filter(|o| o.validity.exists).count()
}

/// What is wrong with an orbit.
fn broken(course: &Course, task: &Task, orbit: &Orbit) -> Option<String> {
    let (before, after) = (orbit.before_impact(), orbit.state(0.0));
    let (mode, period) = (course.apart(), orbit.period());
    let h = mode.duration(0);
    let steps = (period / h).round() as usize;
    let mut y = list(&after);
    let (mut lowest, mut scale) = (f64::INFINITY, task.rig.gap.abs());
    for i in 0..steps {
        y = mode.step(0, &mode.coordinates(orbit.force_phase, i as f64 * h, &y));
        scale = scale.max(y[0].abs()).max(y[2].abs());
        // Beside the impacts themselves the gap is small without meaning anything.
        if i > 0 && i + 2 < steps {
            lowest = lowest.min(task.gap(&y));
        }
    }
    let omega = std::f64::consts::TAU * task.frequency;
    let end = list(&before);
    let off = [y[0] - end[0], y[2] - end[2], (y[1] - end[1]) / omega, (y[3] - end[3]) / omega, task.gap(&y)];
    let worst = off.iter().fold(0.0_f64, |worst, d| worst.max(d.abs()));
    if worst.is_nan() || worst > CLOSES * scale {
        return Some(format!("does not close: {worst:.1e} m"));
    }
    let lost = law(&task.rig, &before, &after, scale, omega * scale);
    if lost.is_nan() || lost > CLOSES {
        return Some(format!("breaks the impact law by {lost:.1e} of its speed"));
    }
    if lowest < -10.0 * CLOSES * scale && orbit.validity.admissible {
        return Some(format!("is called admissible and passes {:.1e} m through", -lowest));
    }
    (lowest > 10.0 * CLOSES * scale
        && !orbit.validity.admissible
        && orbit.validity.min_gap < -100.0 * CLOSES * scale)
        .then(|| "clears, and is called inadmissible".to_owned())
}

fn list(state: &State) -> [f64; 4] {
    [state.x1, state.v1, state.x2, state.v2]
}

/// By what part of the motion's largest displacement `place` (m) and speed `fast` (m/s) an impact is none: places kept, momentum kept,
/// (v₁ − v₂)⁺ = −R(v₁ − v₂)⁻.
fn law(rig: &Rig, before: &State, after: &State, place: f64, fast: f64) -> f64 {
    let momentum = rig.m1 * (after.v1 - before.v1) + rig.m2 * (after.v2 - before.v2);
    let back = after.v1 - after.v2 + rig.restitution * (before.v1 - before.v2);
    [
        (after.x1 - before.x1) / place,
        (after.x2 - before.x2) / place,
        momentum / ((rig.m1 + rig.m2) * fast),
        back / fast,
    ]
    .iter()
    .fold(0.0_f64, |worst, d| if d.is_nan() { f64::NAN } else { worst.max(d.abs()) })
}

#[cfg(test)]
mod tests {
    use super::super::scene_b;
    use super::*;

    #[test]
    fn an_impact_that_keeps_momentum_but_not_r_is_seen_and_one_that_keeps_both_is_none() {
        let rig = Rig::thesis();
        let before = State { x1: 1e-3, v1: 0.2, x2: 0.0, v2: -0.1 };
        let after = |r: f64| {
            let impulse = rig.reduced_mass() * (1.0 + r) * 0.3;
            State { v1: 0.2 - impulse / rig.m1, v2: -0.1 + impulse / rig.m2, ..before }
        };
        let law = |after: &State| law(&rig, &before, after, 1e-3, 0.3);
        assert!(law(&after(0.7)) < 1e-15);
        assert!(law(&after(0.7 + 1e-7)) > CLOSES);
        let pushed = State { v1: after(0.7).v1 + 1e-6, v2: after(0.7).v2 + 1e-6, ..before };
        assert!(law(&pushed) > CLOSES);
    }

    #[test]
    fn an_orbit_of_another_rig_does_not_close() {
        let task = scene_b::task(1.0);
        assert_eq!(closed_form(&task).unwrap().0, Outcome::Right);
        // Orbits of a rig whose damper differs by a millionth, judged by this one's equations.
        let other = Rig { c2: task.rig.c2 * (1.0 + 1e-6), ..task.rig };
        let course = Course::new(&task, None);
        for orbit in orbits(&other, task.force, task.frequency).unwrap().orbits {
            assert!(broken(&course, &task, &orbit).unwrap().contains("does not close"));
        }
        // And of one that rebounds otherwise.
        let other = Rig { restitution: 0.7 + 1e-6, ..task.rig };
        for orbit in orbits(&other, task.force, task.frequency).unwrap().orbits {
            assert!(broken(&course, &task, &orbit).unwrap().contains("impact law"));
        }
    }

    #[test]
    fn a_motion_with_an_impact_too_many_too_few_or_too_late_is_wrong() {
        let task = scene_b::task(1.0);
        let truth = super::super::truth::motion(&task, None).unwrap();
        assert_eq!(motion(&truth, &truth, &task).0, Outcome::Right);
        let changed = |change: &dyn Fn(&mut Told)| {
            let mut told = truth.clone();
            change(&mut told);
            motion(&told, &truth, &task).0
        };
        let cycle = task.cycle();
        assert_eq!(changed(&|t| t.impacts[2].0 += 0.5 * ALLOWED * cycle), Outcome::Right);
        assert_eq!(changed(&|t| t.impacts[2].0 += 1.5 * ALLOWED * cycle), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts.truncate(2)), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts.push((0.06, 0.1))), Outcome::Wrong);
        let rested = Told { sticks: vec![[0.5, 0.6]], ..truth.clone() };
        assert_eq!(motion(&truth, &rested, &task).0, Outcome::Wrong);
    }
}
