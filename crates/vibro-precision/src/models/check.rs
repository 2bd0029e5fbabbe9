//! Judges the answers of the models by comparison with the true motion.

use super::ours::soft_forms;
use super::task::{Log, Task};
use super::truth::{PeriodicImpact, periodic_motion, settled};
use crate::{Outcome, OutcomeWithReason};
use std::f64::consts::TAU;
use std::fmt::Debug;
use vibro_model::{Orbit, State, orbits};

/// Largest error allowed to every method: for times as a share of a cycle, for speeds as a share of the
/// fastest approach speed. A method with a thousand fixed steps a cycle reaches this error within some
/// impacts.
const TOLERANCE: f64 = 0.01;
/// Approach speed in m/s above which an impact is compared; slower ones may be missing or additional.
const LEAST_SPEED: f64 = 1e-3;
/// Cycles within which a motion must become periodic, to be compared.
pub const SETTLED: f64 = 400.0;
/// Largest error of an orbit in closed form against the periodic motion that Newton's method finds from it
/// ([`PeriodicImpact::error_of`]).
const SAME_ORBIT: f64 = 1e-8;
/// Largest error of an orbit in closed form against the periodic motion on which a task settles.
const SAME_AS_SETTLED: f64 = 1e-4;

/// Judges a motion by its impacts and rests, one by one in their order. Each impact faster than
/// [`LEAST_SPEED`] must agree within [`TOLERANCE`]. Each rest longer than twice the time tolerance must begin
/// and end within this tolerance. This holds for both lists: none may be missing, and none additional.
pub fn motion(log: &Log, truth: &Log, task: &Task) -> OutcomeWithReason {
    let time_error = TOLERANCE * task.cycle();
    // An impact or rest that begins later may lie beyond the end of one of the lists.
    let last = task.until - 2.0 * time_error;
    let speed_error = TOLERANCE * truth.impacts.iter().map(|i| i.1).fold(LEAST_SPEED, f64::max);
    // Comparisons with NaN are false. So an impact with NaN counts but has no close partner: it is an error.
    let counts = |i: &(f64, f64)| !(i.0 >= last || i.1 <= LEAST_SPEED);
    let close =
        |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs() <= time_error && (a.1 - b.1).abs() <= speed_error;
    let lasts = |s: &[f64; 2]| !(s[0] >= last || s[1] - s[0] <= 2.0 * time_error);
    let same = |a: &[f64; 2], b: &[f64; 2]| {
        (a[0] - b[0]).abs() <= time_error && (a[1].min(last) - b[1].min(last)).abs() <= time_error
    };
    let impacts = in_order(&truth.impacts, &log.impacts, counts, close);
    let rests = in_order(&truth.sticks, &log.sticks, lasts, same);
    match (impacts, rests) {
        (Ok(n), Ok(m)) => {
            let why = format!("{n} impacts within {time_error:.0e} s and {speed_error:.0e} m/s, {m} rests");
            OutcomeWithReason::new(Outcome::Right, why)
        }
        (Err(why), _) => OutcomeWithReason::new(Outcome::Wrong, format!("impacts (s, m/s): {why}")),
        (_, Err(why)) => OutcomeWithReason::new(Outcome::Wrong, format!("rests (s): {why}")),
    }
}

/// Pairs the entries of `truth` and `log` that are `close`, in their order; returns the number of pairs.
/// Every entry for which `counts` is true must be in a pair; the error states the first that is not.
fn in_order<T: Debug>(
    truth: &[T],
    log: &[T],
    counts: impl Fn(&T) -> bool,
    close: impl Fn(&T, &T) -> bool,
) -> Result<usize, String> {
    let (mut i, mut j, mut pairs) = (0, 0, 0);
    loop {
        match (truth.get(i), log.get(j)) {
            (Some(a), Some(b)) if close(a, b) => (i, j, pairs) = (i + 1, j + 1, pairs + 1),
            (Some(a), _) if !counts(a) => i += 1,
            (_, Some(b)) if !counts(b) => j += 1,
            (None, None) => return Ok(pairs),
            (a, b) => {
                let shown = |x: Option<&T>| x.map_or("none".to_owned(), |x| format!("{x:.9?}"));
                return Err(format!("told is {}, true is {}", shown(b), shown(a)));
            }
        }
    }
}

/// Judges the time of the first impact, or that there is none.
pub fn first(log: &Log, truth: &Log, task: &Task) -> OutcomeWithReason {
    let [log, truth] = [log, truth].map(|motion| motion.impacts.first().map(|i| i.0));
    let right = match (log, truth) {
        (Some(log), Some(truth)) => (log - truth).abs() <= TOLERANCE * task.cycle(),
        (log, truth) => log.is_none() && truth.is_none(),
    };
    OutcomeWithReason::right_if(right, format!("time of the first impact in s: told {log:?}, true {truth:?}"))
}

/// Judges the last approach speed by that of the periodic motion.
pub fn speed(log: &Log, truth: &Log) -> OutcomeWithReason {
    let [log, truth] = [log, truth].map(|motion| motion.impacts.last().map_or(f64::NAN, |i| i.1));
    let error = (log / truth - 1.0).abs();
    OutcomeWithReason::right_if(
        error <= TOLERANCE,
        format!("approach speed {error:.0e} off, allowed {TOLERANCE:.0e}"),
    )
}

/// Judges orbits in closed form by integration of the motion.
///
/// An admissible orbit must be a periodic motion of the integration. An inadmissible one, on which the masses
/// would pass through each other, must not be one. Orbits slower than [`LEAST_SPEED`] are not tested. If the
/// task settles on a motion with one impact a cycle, this must be one of the stable orbits.
pub fn closed_form(task: &Task) -> Result<OutcomeWithReason, OutcomeWithReason> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    judged(task, &found.orbits.iter().filter(|o| o.validity.exists).collect::<Vec<_>>())
}

/// As [`closed_form`], for these orbits.
fn judged(task: &Task, log: &[&Orbit]) -> Result<OutcomeWithReason, OutcomeWithReason> {
    for orbit in log.iter().filter(|o| o.approach_velocity > LEAST_SPEED) {
        let (speed, admissible) = (orbit.approach_velocity, orbit.validity.admissible);
        let motion = periodic_motion(task, None, orbit.period(), &impact_of(orbit));
        let is_periodic = motion.is_some_and(|one| one.error_of(speed, orbit.force_phase) < SAME_ORBIT);
        if is_periodic != admissible {
            let why = format!("an orbit of {speed:.6e} m/s: admissible {admissible}, repeated {is_periodic}");
            return Ok(OutcomeWithReason::new(Outcome::Wrong, why));
        }
    }
    let settled = settled(task, None, SETTLED)?;
    let is_stable_orbit = |one: &PeriodicImpact| {
        let stable = log.iter().filter(|o| o.validity.admissible && o.validity.stable != Some(false));
        stable.map(|o| one.error_of(o.approach_velocity, o.force_phase)).any(|error| error < SAME_AS_SETTLED)
    };
    Ok(match settled {
        Some(one) => OutcomeWithReason::right_if(
            is_stable_orbit(&one),
            format!("the motion settles at {:.6e} m/s", one.speed()),
        ),
        None => OutcomeWithReason::new(Outcome::Right, format!("{} orbits are as they say", log.len())),
    })
}

/// State and phase at the impact of an orbit with rigid impacts.
fn impact_of(orbit: &Orbit) -> PeriodicImpact {
    let State { x1, v1, x2, v2 } = orbit.before_impact();
    PeriodicImpact { before: [x1, v1, x2, v2], phase: orbit.force_phase }
}

/// Compares every admissible orbit, corrected for a soft contact, with the periodic motion with this contact.
///
/// The correction is of first order in the phase `ωt_c` of the contact time. So restitution, delay and speed
/// at the touch keep errors of second order, `3(ωt_c)²` in all. The error must also be below half the error
/// without the correction; otherwise an orbit without any correction could pass.
pub fn corrected(task: &Task) -> Result<OutcomeWithReason, OutcomeWithReason> {
    let (found, soft, compliance) = soft_forms(task)?;
    let omega = TAU * task.frequency;
    let (mut judged, mut withheld) = (Vec::new(), 0);
    for (orbit, soft) in found.orbits.iter().zip(soft).filter(|(o, _)| o.validity.admissible) {
        let Some(truth) = periodic_motion(task, Some(task.spring()), orbit.period(), &impact_of(orbit))
        else {
            continue;
        };
        let Some(soft) = soft else {
            withheld += 1;
            continue;
        };
        let touch = orbit.force_phase + soft.timing - orbit.timing - omega * compliance.delay;
        let error = truth.error_of(soft.approach_velocity, touch);
        let uncorrected = truth.error_of(orbit.approach_velocity, orbit.force_phase);
        let allowed = (3.0 * (omega * compliance.duration).powi(2)).min(0.5 * uncorrected);
        let why = format!(
            "approach speed and phase {error:.1e} off, allowed {allowed:.1e}, {uncorrected:.1e} without the correction"
        );
        if error.is_nan() || error > allowed {
            return Ok(OutcomeWithReason::new(Outcome::Wrong, why));
        }
        judged.push(why);
    }
    Ok(match (judged.is_empty(), withheld) {
        (false, _) => OutcomeWithReason::new(Outcome::Right, judged.join("; ")),
        (true, 0) => {
            OutcomeWithReason::new(Outcome::NotAsked, "no motion with one impact a cycle is to be corrected")
        }
        (true, n) => OutcomeWithReason::new(
            Outcome::Refused,
            format!("{n} orbits have no correction with this contact"),
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::super::scenes::task_b;
    use super::*;
    use crate::models::truth;
    use vibro_model::{Rig, Sine, Steady};

    #[test]
    fn what_the_motion_settles_on_is_told_and_stable_and_what_is_told_is_as_it_says() {
        let task = task_b(1.0);
        // Just below the force at which the forced motion alone reaches the gap there are two orbits, one
        // of them
        // unstable.
        let unit =
            Steady::new(&task.rig, &Sine { force: 1.0, frequency: task.frequency }).unwrap().amplitude();
        let force = task.rig.gap / unit * (1.0 - 1e-3);
        let task = Task { force, start: [-1e-3, 0.0, 0.0, 0.0], ..task };
        let found = orbits(&task.rig, task.force, task.frequency).unwrap().orbits;
        let [first, second] = &found[..] else { panic!("{}", found.len()) };
        let outcome = |log: &[&Orbit]| judged(&task, log).unwrap().outcome;
        assert_eq!(outcome(&[first, second]), Outcome::Right);
        assert_eq!(outcome(&[]), Outcome::Wrong);
        for change in
            [|o: &mut Orbit| o.validity.admissible ^= true, |o: &mut Orbit| o.validity.stable = Some(false)]
        {
            let changed = [first.clone(), second.clone()].map(|mut orbit| {
                change(&mut orbit);
                orbit
            });
            assert_eq!(outcome(&[&changed[0], &changed[1]]), Outcome::Wrong);
        }
    }

    #[test]
    fn an_orbit_of_another_rig_is_wrong() {
        let task = task_b(1.0);
        assert_eq!(closed_form(&task).unwrap().outcome, Outcome::Right);
        // A damper and a restitution that differ by a millionth.
        let others =
            [Rig { c2: task.rig.c2 * (1.0 + 1e-6), ..task.rig }, Rig { restitution: 0.7 + 1e-6, ..task.rig }];
        for other in others {
            let found = orbits(&other, task.force, task.frequency).unwrap().orbits;
            assert_eq!(judged(&task, &found.iter().collect::<Vec<_>>()).unwrap().outcome, Outcome::Wrong);
        }
    }

    #[test]
    fn a_motion_with_an_impact_too_many_too_few_or_too_late_is_wrong() {
        let task = task_b(1.0);
        let truth = truth::motion(&task, None).unwrap();
        assert_eq!(motion(&truth, &truth, &task).outcome, Outcome::Right);
        let changed = |change: &dyn Fn(&mut Log)| {
            let mut log = truth.clone();
            change(&mut log);
            motion(&log, &truth, &task).outcome
        };
        let cycle = task.cycle();
        assert_eq!(changed(&|t| t.impacts[2].0 += 0.5 * TOLERANCE * cycle), Outcome::Right);
        assert_eq!(changed(&|t| t.impacts[2].0 += 1.5 * TOLERANCE * cycle), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts.truncate(2)), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts.push((0.06, 0.1))), Outcome::Wrong);
        // An additional impact close to a true one, one impact for two, another speed, and NaN.
        let phantom = (truth.impacts[2].0 + 0.1 * TOLERANCE * cycle, truth.impacts[2].1);
        assert_eq!(changed(&|t| t.impacts.insert(3, phantom)), Outcome::Wrong);
        let doubled =
            Log { impacts: [&truth.impacts[..3], &[phantom], &truth.impacts[3..]].concat(), ..truth.clone() };
        assert_eq!(motion(&truth, &doubled, &task).outcome, Outcome::Wrong);
        let fastest = truth.impacts.iter().map(|i| i.1).fold(0.0, f64::max);
        assert_eq!(changed(&|t| t.impacts[2].1 += 0.5 * TOLERANCE * fastest), Outcome::Right);
        assert_eq!(changed(&|t| t.impacts[2].1 += 1.5 * TOLERANCE * fastest), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts[2].1 = f64::NAN), Outcome::Wrong);
        assert_eq!(changed(&|t| t.impacts[2].0 = f64::NAN), Outcome::Wrong);
    }

    #[test]
    fn a_rest_that_is_not_told_is_invented_or_ends_at_another_time_is_wrong() {
        let task = task_b(1.0);
        let off = TOLERANCE * task.cycle();
        let rests = |sticks: &[[f64; 2]]| Log { sticks: sticks.to_vec(), ..Log::default() };
        let judged = |log: &[[f64; 2]], truth: &[[f64; 2]]| motion(&rests(log), &rests(truth), &task).outcome;
        assert_eq!(judged(&[], &[[0.5, 0.6]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, 0.6]], &[]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, 0.6 + 0.5 * off]], &[[0.5, 0.6]]), Outcome::Right);
        assert_eq!(judged(&[[0.5, 0.6 + 1.5 * off]], &[[0.5, 0.6]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, 0.6]]), Outcome::Wrong);
        // A rest that ends close to the end of the task equals one without end.
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, 0.99]]), Outcome::Wrong);
        assert_eq!(judged(&[[0.5, f64::INFINITY]], &[[0.5, task.until - off]]), Outcome::Right);
        // Rests near the shortest that counts may be missing or not.
        assert_eq!(judged(&[], &[[0.5, 0.5 + 1.9 * off]]), Outcome::Right);
        assert_eq!(judged(&[[0.5, 0.5 + 2.1 * off]], &[[0.5, 0.5 + 1.9 * off]]), Outcome::Right);
    }
}
