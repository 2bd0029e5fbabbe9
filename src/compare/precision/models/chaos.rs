//! A chaotic window: no method can follow the motion, all can be asked for its statistics.

use super::entry::Entries;
use super::ours;
use super::rivals::{Events, Kind, Loop, events, marched, moreau, penalty};
use super::scene_b::{spring, steps};
use super::task::{Fault, Task, Told};
use crate::Error;
use crate::compare::precision::measured::quartiles;
use crate::compare::precision::{Family, Scene};
use crate::model::{Rig, State};

/// Starts whose answers are read one by one.
const STARTS: usize = 5;
/// Cycles left out at the beginning, and cycles read by every method but where a setting says otherwise.
const SETTLE: f64 = 100.0;
const READ: f64 = 1000.0;

/// The window: irregular for every start tried, and by a positive Lyapunov exponent.
pub fn task(cycles: f64, start: usize) -> Task {
    let rig = Rig { restitution: RESTITUTION, ..Rig::thesis() };
    let task = Task::sine(rig, FORCE, FREQUENCY, (SETTLE + cycles) / FREQUENCY);
    Task { start: State { x1: -1e-3 * start as f64, ..State::REST }, most: 3_000_000, ..task }
}

/// Force in N, frequency in Hz and restitution of the window.
const FORCE: f64 = 0.5;
const FREQUENCY: f64 = 13.0;
const RESTITUTION: f64 = 0.7;

/// Mean approach speed behind the beginning.
fn mean(told: &Told) -> Option<f64> {
    let speeds: Vec<f64> = told.impacts.iter().filter(|i| i.0 > SETTLE / FREQUENCY).map(|i| i.1).collect();
    (speeds.len() > 10).then(|| speeds.iter().sum::<f64>() / speeds.len() as f64)
}

/// Measures every method.
///
/// # Errors
/// If the long run has no impacts.
pub fn scene(quick: bool) -> crate::Result<Scene> {
    let long = if quick { 2e5 } else { 2e6 };
    let told = ours::flights(&task(long, 0)).map_err(|f| Error::refused(f.to_string()))?;
    let truth = mean(&told).ok_or_else(|| Error::refused("the chaotic window has no impacts"))?;
    // Means of windows as long as the methods read.
    let window = |k: usize| {
        let from = (SETTLE + READ * k as f64) / FREQUENCY;
        let in_it = told.impacts.iter().filter(|i| i.0 > from && i.0 <= from + READ / FREQUENCY);
        let (n, sum) = in_it.fold((0.0, 0.0), |(n, sum), i| (n + 1.0, sum + i.1));
        (sum / n / truth - 1.0).abs()
    };
    let scatter = quartiles(&mut (0..100).map(window).filter(|v| v.is_finite()).collect::<Vec<_>>())[1];
    let judge = |told: &Vec<Told>| -> Result<Vec<f64>, String> {
        told.iter()
            .map(|t| Ok((mean(t).ok_or("the impacts die out")? / truth - 1.0).abs().max(1e-16)))
            .collect()
    };
    let all = |cycles: f64, run: &dyn Fn(&Task) -> Result<Told, Fault>| -> Result<Vec<Told>, Fault> {
        (1..=STARTS).map(|start| run(&task(cycles, start))).collect()
    };
    let mut entries = Entries::new(quick).shared(STARTS);
    let few = |all: &[f64]| if quick { all[..1].to_vec() } else { all.to_vec() };
    for cycles in if quick { vec![READ, 1e4] } else { vec![100.0, READ, 1e4, 1e5] } {
        let setting = format!("{cycles} cycles");
        entries.several(true, "exact flights", &setting, || all(cycles, &ours::flights), judge);
    }
    for n in few(&[100.0, 1e3]) {
        entries.several(false, "Euler loop", &steps(n), || all(READ, &|t| marched(t, Loop::Euler, n)), judge);
        entries.several(false, "RK4 loop", &steps(n), || all(READ, &|t| marched(t, Loop::Rk4, n)), judge);
        entries.several(false, "Moreau time stepping", &steps(n), || all(READ, &|t| moreau(t, n)), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9]) {
        let how = Events::ends(Kind::Rk45(r));
        entries.several(
            false,
            "RK45, sign test",
            &how.kind.setting(),
            || all(READ, &|t| events(t, &how)),
            judge,
        );
    }
    for r in few(&[1e-6, 1e-9]) {
        let how = Events::dense(Kind::Dop853(r));
        entries.several(
            false,
            "DOP853, dense events",
            &how.kind.setting(),
            || all(READ, &|t| events(t, &how)),
            judge,
        );
    }
    for k in few(&[1e6]) {
        let run = |t: &Task| penalty(t, &spring(&t.rig, k), Kind::Rk45(1e-6));
        let setting = format!("k₃ {k:.0e} N/m");
        entries.several(false, "stiff spring, RK45", &setting, || all(READ, &run), judge);
    }
    let mut methods = entries.done();
    // Settings of one method one after another.
    let order: Vec<String> = methods.iter().map(|m| m.method.clone()).collect();
    methods.sort_by_key(|m| order.iter().position(|o| *o == m.method));
    Ok(Scene {
        name: "chaotic window".to_owned(),
        family: Family::Models,
        says: format!(
            "At {FREQUENCY} Hz and {FORCE} N no two computations agree for long: the mean approach speed over {READ} cycles (or as many \
             as the setting says) from {STARTS} starts. Over {READ} cycles it scatters by {:.1} % by itself.",
            100.0 * scatter
        ),
        error_of: "relative error of the mean approach speed".to_owned(),
        truth: format!("exact flights over {long:.0e} cycles"),
        bound: None,
        methods,
    })
}
