//! Answers against the truth.

use std::f64::consts::TAU;

use super::ours;
use super::rivals::{Kind, Stepper};
use super::task::{Fault, Task, Told};
use crate::compare::precision::Outcome;
use crate::model::{Orbit, Orbits, orbits};

/// An outcome and why.
pub type Found = (Outcome, String);

/// Approach speed in m/s from which an impact must be told.
const SLOW: f64 = 1e-3;

/// Every impact of either list that is not slow has to be in the other, within `off` (s), and every rest of the truth that
/// lasts to begin where it is told, if rests are told at all.
pub fn motion(told: &Told, truth: &Told, until: f64, off: f64, rests: bool) -> Found {
    let inside = |i: &&(f64, f64)| i.0 < until - 2.0 * off && i.1 > SLOW;
    let near = |list: &Told, time: f64| list.impacts.iter().any(|i| (i.0 - time).abs() <= off);
    if let Some(lost) = truth.impacts.iter().filter(inside).find(|i| !near(told, i.0)) {
        return wrong(format!("no impact at {:.9} s, where there is one of {:.2e} m/s", lost.0, lost.1));
    }
    if let Some(extra) = told.impacts.iter().filter(inside).find(|i| !near(truth, i.0)) {
        return wrong(format!("an impact of {:.2e} m/s at {:.9} s, where there is none", extra.1, extra.0));
    }
    let lasting = truth.sticks.iter().filter(|s| s[1] - s[0] > 1e-3 && s[0] < until - 2.0 * off);
    for rest in lasting.clone().filter(|_| rests) {
        if !told.sticks.iter().any(|s| (s[0] - rest[0]).abs() <= off) {
            return wrong(format!("the masses do not come to rest against each other at {:.9} s", rest[0]));
        }
    }
    let n = truth.impacts.iter().filter(inside).count();
    (Outcome::Right, format!("{n} impacts and {} rests within {off:.0e} s", lasting.count()))
}

/// The first impact, at the time of the truth or never.
pub fn first(told: &Told, truth: Option<f64>, off: f64) -> Found {
    match (told.impacts.first(), truth) {
        (None, None) => (Outcome::Right, "no impact is seen where there is none".to_owned()),
        (Some(i), None) => wrong(format!("an impact at {:.9} s, where there is none", i.0)),
        (None, Some(t)) => wrong(format!("the impact at {t:.9} s is not seen")),
        (Some(i), Some(t)) if (i.0 - t).abs() <= off => {
            (Outcome::Right, format!("{:.0e} s off", (i.0 - t).abs()))
        }
        (Some(i), Some(t)) => wrong(format!("the impact is {:.0e} s off", (i.0 - t).abs())),
    }
}

fn wrong(why: String) -> Found {
    (Outcome::Wrong, why)
}

/// Orbits in closed form: each leads from its impact to its impact under the equations of motion; the masses pass through each
/// other just where that is said; and what exact flights settle on with one impact a cycle is among the stable ones.
pub fn closed_form(task: &Task) -> Result<Found, Fault> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    for orbit in found.orbits.iter().filter(|o| o.validity.exists) {
        if let Some(why) = closes(task, orbit)? {
            return Ok(wrong(why));
        }
    }
    if let Some(speed) = settled(task) {
        let told = |o: &&Orbit| {
            (o.approach_velocity / speed - 1.0).abs() < 1e-6
                && o.validity.admissible
                && o.validity.stable != Some(false)
        };
        if !found.orbits.iter().any(|o| told(&o)) {
            return Ok(wrong(format!(
                "the motion settles at {speed:.6e} m/s, which is not among the stable orbits"
            )));
        }
    }
    Ok((Outcome::Right, format!("{} orbits close and clear as they say", existing(&found))))
}

fn existing(found: &Orbits) -> usize {
    found.orbits.iter().filter(|o| o.validity.exists).count()
}

/// What is wrong with an orbit, by integration of order 8 to 1e-13.
fn closes(task: &Task, orbit: &Orbit) -> Result<Option<String>, Fault> {
    let period = orbit.period();
    let start = orbit.state(0.0);
    let own = Task { start, phase: orbit.force_phase, until: period, ..*task };
    let f = |t: f64, y: &[f64; 4]| own.apart(t, y);
    let mut stepper = Stepper::new(Kind::Dop853(1e-13), &own, f, 0.0, own.first());
    let (mut lowest, mut scale, mut t) = (f64::INFINITY, task.rig.gap.abs(), 0.0);
    let mut y = own.first();
    while t < period {
        let step = stepper.step(f, period)?;
        for k in 1..=16 {
            let part = f64::from(k) / 16.0 * step.duration();
            let y = step.at(f, part);
            scale = scale.max(y[0].abs()).max(y[2].abs());
            // Beside the impacts themselves the gap is small without meaning anything.
            if step.start() + part > 1e-3 * period && step.start() + part < (1.0 - 1e-3) * period {
                lowest = lowest.min(own.gap(&y));
            }
        }
        t = step.start() + step.duration();
        y = step.end();
    }
    let before = orbit.before_impact();
    let omega = TAU * task.frequency;
    let off = [
        y[0] - before.x1,
        y[2] - before.x2,
        (y[1] - before.v1) / omega,
        (y[3] - before.v2) / omega,
        own.gap(&y),
    ];
    let worst = off.iter().fold(0.0_f64, |worst, d| worst.max(d.abs()));
    if worst.is_nan() || worst > 1e-8 * scale {
        return Ok(Some(format!(
            "an orbit of {:.3e} m/s does not close: {worst:.1e} m",
            orbit.approach_velocity
        )));
    }
    let through = lowest < -1e-7 * scale;
    if through && orbit.validity.admissible {
        return Ok(Some(format!("an orbit called admissible passes {:.1e} m through", -lowest)));
    }
    if lowest > 1e-7 * scale && !orbit.validity.admissible && orbit.validity.min_gap < -1e-6 * scale {
        return Ok(Some("an orbit that clears is called inadmissible".to_owned()));
    }
    Ok(None)
}

/// Approach speed of the motion with one impact a cycle that exact flights settle on, where they do within 400 cycles.
fn settled(task: &Task) -> Option<f64> {
    let told = ours::flights(&Task { until: 400.0 / task.frequency, ..*task }).ok()?;
    let last: Vec<_> = told.impacts.iter().rev().take(9).collect();
    let regular = last.len() == 9
        && last.windows(2).all(|w| {
            ((w[0].0 - w[1].0) * task.frequency - 1.0).abs() < 1e-8 && (w[0].1 / w[1].1 - 1.0).abs() < 1e-8
        });
    regular.then(|| last[0].1)
}
