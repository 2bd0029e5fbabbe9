//! Near grazing: is an impact seen that only just happens, and is none seen that only just does not?

use std::f64::consts::TAU;

use super::entry::{Entries, Verdict};
use super::ours;
#[cfg(feature = "diffsol")]
use super::rivals::{Diffsol, impacts};
use super::rivals::{Events, Kind, Loop, events, marched, moreau};
use super::scene_b::steps;
use super::task::{Fault, Task, Told};
use crate::{Family, Scene};
use vibro_model::{Rig, Sine, State, Steady};

/// Starts in each direction.
const STARTS: usize = 8;

/// A motion that reaches `depth` (m) into the other mass, or misses it by −`depth`, and the time of its impact in s.
///
/// Mass 1 is on its forced motion `A cos ω(t − t_p)` and mass 2 rests, so with the gap A − d they meet at
/// `t_p − 2 asin(√(d/2A))/ω`, or never. The difference A − Δ is exact, so the truth knows the d that the rounded gap leaves.
///
/// # Errors
/// As [`Steady::new`].
pub(crate) fn task(depth: f64, start: usize) -> vibro_record::Result<(Task, Option<f64>)> {
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    let steady = Steady::new(&rig, &Sine { force: 0.5, frequency })?;
    let (amplitude, omega) = (steady.amplitude(), steady.omega);
    let gap = amplitude - depth;
    // Peaks at places of the cycle that no step size favours.
    let peak = (0.3 + 0.043_217 * start as f64) / frequency;
    let turn = omega * peak;
    let task = Task {
        rig: Rig { gap, ..rig },
        phase: -turn - steady.response.arg(),
        start: State { x1: amplitude * turn.cos(), v1: amplitude * omega * turn.sin(), x2: 0.0, v2: 0.0 },
        ..Task::sine(rig, 0.5, frequency, peak + 0.25 / frequency)
    };
    let reached = amplitude - gap;
    let time = (reached > 0.0).then(|| peak - 2.0 * (reached / (2.0 * amplitude)).sqrt().asin() / omega);
    Ok((task, time))
}

/// Median error of the time of the first impact in s, or what was not seen, or seen where it is not.
fn judge(told: &[Told], truth: &[Option<f64>]) -> Verdict {
    let (mut missed, mut invented, mut errors) = (0, 0, Vec::new());
    for (told, truth) in told.iter().zip(truth) {
        match (told.impacts.first(), truth) {
            (Some(found), Some(truth)) => errors.push((found.0 - truth).abs().max(1e-17)),
            (None, Some(_)) => missed += 1,
            (Some(_), None) => invented += 1,
            (None, None) => {}
        }
    }
    if missed + invented > 0 {
        return Err(format!(
            "{missed} of {STARTS} impacts are not seen, {invented} of {STARTS} seen that are none"
        ));
    }
    errors.sort_by(f64::total_cmp);
    Ok(errors[errors.len() / 2])
}

/// Measures every method at `depth` (m) on both sides.
///
/// # Errors
/// As [`task`].
pub fn scene(depth: f64, quick: bool) -> vibro_record::Result<Scene> {
    let mut tasks = Vec::new();
    for sign in [1.0, -1.0] {
        for start in 0..STARTS {
            tasks.push(task(sign * depth, start)?);
        }
    }
    let truth: Vec<Option<f64>> = tasks.iter().map(|t| t.1).collect();
    let judge = |told: &Vec<Told>| judge(told, &truth);
    let all = |run: &dyn Fn(&Task) -> Result<Told, Fault>| -> Result<Vec<Told>, Fault> {
        tasks.iter().map(|t| run(&t.0)).collect()
    };
    let mut entries = Entries::new(quick).shared(tasks.len());
    let few = |all: &[f64]| if quick { all[..2].to_vec() } else { all.to_vec() };
    entries.ours("exact flights", "", || all(&ours::flights), judge);
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Euler loop", &steps(n), || all(&|t| marched(t, Loop::Euler, n)), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("RK4 loop", &steps(n), || all(&|t| marched(t, Loop::Rk4, n)), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Moreau time stepping", &steps(n), || all(&|t| moreau(t, n)), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        let how = Events::ends(Kind::Rk4(n));
        entries.rival("RK4, sign test", &how.kind.setting(), || all(&|t| events(t, &how)), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::ends(Kind::Rk45(r));
        entries.rival("RK45, sign test", &how.kind.setting(), || all(&|t| events(t, &how)), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::dense(Kind::Rk45(r));
        entries.rival("RK45, dense events", &how.kind.setting(), || all(&|t| events(t, &how)), judge);
    }
    for r in few(&[1e-6, 1e-9, 1e-12, 1e-14]) {
        let how = Events::dense(Kind::Dop853(r));
        entries.rival("DOP853, dense events", &how.kind.setting(), || all(&|t| events(t, &how)), judge);
    }
    #[cfg(feature = "diffsol")]
    for how in few(&[1e-4, 1e-6, 1e-9, 1e-12]).into_iter().map(Diffsol::Tsit45) {
        entries.rival("diffsol TSIT45, sign test", &how.setting(), || all(&|t| impacts(t, how, None)), judge);
    }
    Ok(Scene {
        name: format!("grazing {depth:.0e} m"),
        family: Family::Models,
        says: format!(
            "A motion that reaches {depth:.0e} m into the other mass, and one that misses it by as much, each from {STARTS} starts: is \
             the impact seen, and when?"
        ),
        error_of: "median error of the impact's time (s)".to_owned(),
        truth: "the forced motion A cos ω(t − tₚ) meets the gap A − d at tₚ − 2 asin(√(d/2A))/ω".to_owned(),
        bound: None,
        methods: entries.done(),
    })
}
