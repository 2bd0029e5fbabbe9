//! A slow sweep over a vibro-impact resonance: the largest approach speed that it meets.

use super::entry::{Entries, Verdict};
use super::ours;
use super::rivals::{Events, Kind, Loop, events, marched, moreau};
use super::scene_b::steps;
use super::task::{Fault, Task, Told};
use crate::{Family, Scene};
use vibro_model::{Rig, orbits};
use vibro_record::Error;

/// Ends in Hz, rate in Hz/s, and the time in s before which the start is still felt.
const FROM: f64 = 10.2;
const TO: f64 = 10.8;
const RATE: f64 = 0.02;
const BEGUN: f64 = 5.0;

/// The sweep up from rest.
fn task() -> Task {
    Task { rate: RATE, ..Task::sine(Rig::thesis(), 0.5, FROM, (TO - FROM) / RATE) }
}

/// Largest approach speed behind the beginning.
fn largest(told: &Told) -> f64 {
    told.impacts.iter().filter(|i| i.0 > BEGUN).map(|i| i.1).fold(0.0, f64::max)
}

/// Measures every method.
///
/// # Errors
/// If the truth cannot be integrated, or exact flights in fine steps do not agree with it.
pub fn scene(quick: bool) -> vibro_record::Result<Scene> {
    let task = task();
    let lost = |fault: Fault| Error::refused(format!("the truth of the sweep: {fault}"));
    let truth = largest(&events(&task, &Events::dense(Kind::Dop853(1e-13))).map_err(lost)?);
    let fine = largest(&ours::swept(&task, 1e-7).map_err(lost)?);
    let apart = (fine / truth - 1.0).abs();
    if apart.is_nan() || apart > 1e-5 {
        return Err(Error::refused(format!(
            "exact flights and integration of the sweep differ by {apart:.1e}"
        )));
    }
    let off = |speed: f64| -> Verdict {
        if speed > 0.0 {
            Ok((speed / truth - 1.0).abs().max(apart.max(1e-16)))
        } else {
            Err("no impacts".to_owned())
        }
    };
    let judge = |told: &Told| off(largest(told));
    let mut entries = Entries::new(quick);
    let few = |all: &[f64]| if quick { all[..2].to_vec() } else { all.to_vec() };
    for n in few(&[11.0, 61.0]) {
        let peak = || {
            let mut peak = 0.0_f64;
            for i in 0..n as u32 {
                let frequency = FROM + (TO - FROM) * f64::from(i) / (n - 1.0);
                let found = orbits(&task.rig, task.force, frequency)?;
                peak = found.orbits.first().map_or(peak, |o| peak.max(o.approach_velocity));
            }
            Ok(peak)
        };
        entries.ours("closed form, no rate", &format!("{n} frequencies"), peak, |speed| off(*speed));
    }
    for deviation in few(&[0.1, 1e-2, 1e-3, 1e-4, 1e-5]) {
        let setting = format!("phase within {deviation:.0e} rad");
        entries.ours("exact flights", &setting, || ours::swept(&task, deviation), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Euler loop", &steps(n), || marched(&task, Loop::Euler, n), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("RK4 loop", &steps(n), || marched(&task, Loop::Rk4, n), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Moreau time stepping", &steps(n), || moreau(&task, n), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::ends(Kind::Rk45(r));
        entries.rival("RK45, sign test", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-6, 1e-9, 1e-12]) {
        let how = Events::dense(Kind::Dop853(r));
        entries.rival("DOP853, dense events", &how.kind.setting(), || events(&task, &how), judge);
    }
    Ok(Scene {
        name: "slow sweep".to_owned(),
        family: Family::Models,
        says: format!(
            "Up from {FROM} to {TO} Hz at {RATE} Hz/s, over the peak of the motion with one impact a cycle: the largest approach speed."
        ),
        error_of: "relative error of the largest approach speed".to_owned(),
        truth: format!(
            "order 8 with located events, tolerance 1e-13; exact flights in fine steps differ from it by {apart:.0e}, so smaller errors are told as \
             that"
        ),
        bound: None,
        methods: entries.done(),
    })
}
