//! Answers against the truth.

use super::in_order::in_order;
use super::task::{Fault, Task, Told};
use super::truth::{CLOSES, Course, Growth, Repeats, growth, impacts, settled};
use crate::Outcome;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_model::{Orbit, Rig, State, orbits};

/// An outcome and why.
pub type Found = (Outcome, String);

/// What every method may be off: this part of a cycle in times, this part of the fastest approach speed in all of them. It is what a fixed step of a
/// thousandth of a cycle comes to within some impacts, and twenty times what a millimetre scale would show.
pub(crate) const ALLOWED: f64 = 0.01;

/// Approach speed in m/s from which an impact must be told.
const SLOW: f64 = 1e-3;
/// Cycles within which a motion may settle.
pub const SETTLED: f64 = 400.0;

/// Impacts and rests of either list one by one in their order: every impact that is not slow, within [`ALLOWED`] of a cycle and of the fastest approach
/// speed; every rest that lasts longer than twice that part of a cycle, begun and ended within it.
pub fn motion(told: &Told, truth: &Told, task: &Task) -> Found {
    let off = ALLOWED * task.cycle();
    let seen = task.until - 2.0 * off;
    let fastest = truth.impacts.iter().map(|i| i.1).fold(SLOW, f64::max);
    // Written so that what is not a number counts, and is like nothing.
    let counts = |i: &(f64, f64)| !(i.0 >= seen || i.1 <= SLOW);
    let alike =
        |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs() <= off && (a.1 - b.1).abs() <= ALLOWED * fastest;
    let impacts = match in_order(&truth.impacts, &told.impacts, counts, alike) {
        Ok(pairs) => pairs,
        Err([i, j]) => {
            let one = |list: &Told, i: usize| {
                list.impacts
                    .get(i)
                    .map_or("none follows".to_owned(), |i| format!("{:.3e} m/s at {:.9} s", i.1, i.0))
            };
            return wrong(format!("impacts: told is {}, true is {}", one(told, j), one(truth, i)));
        }
    };
    let lasts = |s: &[f64; 2]| !(s[0] >= seen || s[1] - s[0] <= 2.0 * off);
    let same = |a: &[f64; 2], b: &[f64; 2]| {
        let end = |s: &[f64; 2]| s[1].min(seen);
        (a[0] - b[0]).abs() <= off && (end(a) - end(b)).abs() <= off
    };
    let rests = match in_order(&truth.sticks, &told.sticks, lasts, same) {
        Ok(pairs) => pairs,
        Err([i, j]) => {
            let one = |list: &Told, i: usize| {
                list.sticks
                    .get(i)
                    .map_or("none follows".to_owned(), |s| format!("from {:.9} to {:.9} s", s[0], s[1]))
            };
            return wrong(format!("rests: told is {}, true is {}", one(told, j), one(truth, i)));
        }
    };
    let worst = |error: &dyn Fn((f64, f64), (f64, f64)) -> f64| {
        let pairs = impacts.iter().map(|&[i, j]| (truth.impacts[i], told.impacts[j]));
        pairs.filter(|(a, _)| counts(a)).map(|(a, b)| error(a, b).abs()).fold(0.0_f64, f64::max)
    };
    let n = truth.impacts.iter().filter(|i| counts(i)).count();
    (
        Outcome::Right,
        format!(
            "{n} impacts within {:.0e} s and {:.0e} m/s, {} rests; allowed {off:.0e} s, {:.0e} m/s",
            worst(&|a, b| a.0 - b.0),
            worst(&|a, b| a.1 - b.1),
            rests.len(),
            ALLOWED * fastest
        ),
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

/// Orbits in closed form by their definition. The impact keeps momentum and turns the relative speed v into −Rv, matrix exponentials lead from behind it
/// to before the next; there are as many as the definition has, the masses pass through each other just where that is said, disturbances grow as the
/// multipliers say; and what the motion settles on with one impact a cycle is among the stable ones.
pub fn closed_form(task: &Task) -> Result<Found, Fault> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    judged(task, &found.orbits.iter().filter(|o| o.validity.exists).collect::<Vec<_>>())
}

fn judged(task: &Task, told: &[&Orbit]) -> Result<Found, Fault> {
    let course = Course::new(task, None);
    for orbit in told {
        if let Some(why) = broken(&course, task, orbit) {
            return Ok(wrong(format!("an orbit of {:.3e} m/s {why}", orbit.approach_velocity)));
        }
    }
    let all = match impacts(task) {
        Ok(all) => all,
        Err(why) => return Ok((Outcome::NotAsked, format!("no truth: {why}"))),
    };
    let turn = |a: f64, b: f64| (a - b + PI).rem_euclid(TAU) - PI;
    let missing = all.approaching.iter().find(|one| {
        let same = |o: &&&Orbit| {
            (o.approach_velocity / one.speed() - 1.0).hypot(turn(o.force_phase, one.phase)) < CLOSES.sqrt()
        };
        told.iter().filter(same).count() != 1
    });
    if let Some(one) = missing {
        return Ok(wrong(format!("an orbit of {:.6e} m/s is not told, or told more than once", one.speed())));
    }
    if told.len() > all.approaching.len() + all.grazing {
        return Ok(wrong(format!(
            "{} orbits are told, {} of which there are",
            told.len(),
            all.approaching.len()
        )));
    }
    let (mut grown, mut why) = (0, String::new());
    for orbit in told.iter().filter(|o| o.validity.admissible) {
        match growth(task, &told_by(orbit)) {
            Ok(growth) => {
                if let Some(why) = unlike(orbit, &growth) {
                    return Ok(wrong(format!("an orbit of {:.3e} m/s {why}", orbit.approach_velocity)));
                }
                grown += 1;
            }
            Err(undecided) => why = format!(", one not, since {undecided}"),
        }
    }
    let mut settles = "the motion does not settle on one";
    if let Some(truth) = settled(task, None, SETTLED).map_err(Fault::Stalled)? {
        settles = "the motion settles on one of them";
        let same = |o: &&&Orbit| {
            (o.approach_velocity / truth.speed() - 1.0).abs() < CLOSES.sqrt()
                && o.validity.admissible
                && o.validity.stable != Some(false)
        };
        if !told.iter().any(|o| same(&o)) {
            return Ok(wrong(format!(
                "the motion settles at {:.6e} m/s, which is not among the stable orbits",
                truth.speed()
            )));
        }
    }
    let n = told.len();
    Ok((
        Outcome::Right,
        format!(
            "all {n} orbits that there are close and clear as they say, disturbances of {grown} grow as they say{why}; {settles}"
        ),
    ))
}

/// What an orbit says of its impact.
fn told_by(orbit: &Orbit) -> Repeats {
    Repeats { before: list(&orbit.before_impact()), phase: orbit.force_phase }
}

/// What an orbit says of its disturbances, if they grow otherwise.
fn unlike(orbit: &Orbit, growth: &Growth) -> Option<String> {
    let Some(z) = orbit.multipliers else { return Some("has no multipliers".to_owned()) };
    // Sums of products of one, two, three and four of them.
    let mut c = [Complex64::ONE, Complex64::ZERO, Complex64::ZERO, Complex64::ZERO, Complex64::ZERO];
    for z in z {
        for k in (1..5).rev() {
            let before = c[k - 1];
            c[k] += z * before;
        }
    }
    for (k, [value, allowed]) in growth.polynomial.iter().enumerate() {
        let off = (c[k + 1] - value).norm();
        if off.is_nan() || off > *allowed {
            return Some(format!(
                "has multipliers {z:.6?}; disturbances grow otherwise: c{} {value:.9}, {off:.1e} off, allowed {allowed:.1e}",
                k + 1
            ));
        }
    }
    let [largest, off] = growth.largest;
    let verdict = match orbit.validity.stable {
        Some(true) => largest - off < 1.0,
        Some(false) => largest + off > 1.0,
        None => (largest - 1.0).abs() <= off.max(CLOSES.sqrt()),
    };
    (!verdict).then(|| {
        format!(
            "is called {}, and disturbances grow by {largest:.9} a cycle",
            orbit.validity.stability.name()
        )
    })
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
    let omega = TAU * task.frequency;
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
    use vibro_model::{Sine, Steady};

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
    fn an_orbit_that_is_not_told_or_has_other_verdicts_is_wrong() {
        let task = scene_b::task(1.0);
        // Just below the force that reaches the gap by itself there are two, one of them unstable.
        let unit =
            Steady::new(&task.rig, &Sine { force: 1.0, frequency: task.frequency }).unwrap().amplitude();
        let task = Task { force: task.rig.gap / unit * (1.0 - 1e-3), ..task };
        let found = orbits(&task.rig, task.force, task.frequency).unwrap().orbits;
        let [first, second] = &found[..] else { panic!("{}", found.len()) };
        let outcome = |told: &[&Orbit]| judged(&task, told).unwrap().0;
        assert_eq!(outcome(&[first, second]), Outcome::Right);
        assert_eq!(outcome(&[first]), Outcome::Wrong);
        assert_eq!(outcome(&[second]), Outcome::Wrong);
        assert_eq!(outcome(&[]), Outcome::Wrong);
        assert_eq!(outcome(&[first, first]), Outcome::Wrong);
        assert_eq!(outcome(&[first, second, second]), Outcome::Wrong);
        let changed = |change: &dyn Fn(&mut Orbit)| {
            [first.clone(), second.clone()].map(|mut orbit| {
                change(&mut orbit);
                unlike(&orbit, &growth(&task, &told_by(&orbit)).unwrap()).is_some()
            })
        };
        assert_eq!(changed(&|_| ()), [false; 2]);
        assert_eq!(changed(&|o| o.validity.stable = o.validity.stable.map(|s| !s)), [true; 2]);
        assert_eq!(changed(&|o| o.validity.stable = None), [true; 2]);
        assert_eq!(changed(&|o| o.multipliers = None), [true; 2]);
        assert_eq!(changed(&|o| o.multipliers.as_mut().unwrap()[0] *= 1.01), [true; 2]);
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
        // A phantom beside a true one, one for two, another speed, and what is no number.
        let phantom = (truth.impacts[2].0 + 0.1 * ALLOWED * cycle, truth.impacts[2].1);
        assert_eq!(changed(&|t| t.impacts.insert(3, phantom)), Outcome::Wrong);
        let doubled = Told {
            impacts: [&truth.impacts[..3], &[phantom], &truth.impacts[3..]].concat(),
            ..truth.clone()
        };
        assert_eq!(motion(&truth, &doubled, &task).0, Outcome::Wrong);
        let fastest = truth.impacts.iter().map(|i| i.1).fold(0.0, f64::max);
        assert_eq!(changed(&|t| t.impacts[2].1 += 0.5 * ALLOWED * fastest), Outcome::Right);
        assert_eq!(changed(&|t| t.impacts[2].1 += 1.5 * ALLOWED * fastest), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts[2].1 = f64::NAN), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts[2].0 = f64::NAN), Outcome::Wrong);
    }

    #[test]
    fn a_rest_that_is_not_told_is_invented_or_ends_at_another_time_is_wrong() {
        let task = scene_b::task(1.0);
        let off = ALLOWED * task.cycle();
        let rests = |sticks: &[[f64; 2]]| Told { sticks: sticks.to_vec(), ..Told::default() };
        let judged = |told: &[[f64; 2]], truth: &[[f64; 2]]| motion(&rests(told), &rests(truth), &task).0;
        assert_eq!(judged(&[], &[[0.5, 0.6]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, 0.6]], &[]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, 0.6 + 0.5 * off]], &[[0.5, 0.6]]), Outcome::Right);
        assert_eq!(judged(&[[0.5, 0.6 + 1.5 * off]], &[[0.5, 0.6]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, 0.6]]), Outcome::Wrong);
        // Beyond the end both last for ever.
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, 0.99]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, task.until - off]]), Outcome::Right);
        // Too short to be told, or not.
        assert_eq!(judged(&[], &[[0.5, 0.5 + 1.9 * off]]), Outcome::Right);
        assert_eq!(judged(&[[0.5, 0.5 + 2.1 * off]], &[[0.5, 0.5 + 1.9 * off]]), Outcome::Right);
    }
}
