//! Each method at each border.

use super::borders::{Asks, Border, STIFFNESS, borders, rigid, soft};
use super::check::{self, Found};
use super::ours;
use super::rivals::{Events, Kind, Loop, events, marched, penalty};
use super::scene_b::spring;
use super::task::{Fault, Task, Told};
use crate::Result;
use crate::compare::precision::watched::{PATIENCE, Watched, watched};
use crate::compare::precision::{Cell, FailureMap, Family, Outcome};
use crate::model::contact::conversion::damping_ratio;
use crate::model::{Compliance, Excitation, Sine, orbits, softened};

/// Error in s that one of this library's methods may have: what the truth itself is off after some impacts.
const OURS: f64 = 1e-7;

/// Methods in the order of the picture, and whether they are this library's.
const METHODS: [(&str, bool); 7] = [
    ("closed form", true),
    ("soft-corrected form", true),
    ("exact flights", true),
    ("exact Kelvin–Voigt", true),
    ("RK4 loop", false),
    ("RK45, sign test", false),
    ("stiff spring, RK45", false),
];

/// How a method follows a motion.
type Run<'a> = &'a dyn Fn(&Task) -> std::result::Result<Told, Fault>;

/// What a watched run comes to.
type Answer = Watched<std::result::Result<Option<Found>, Fault>>;

/// Asks every method at every border.
///
/// # Errors
/// If a scene cannot be built, or its truth not be computed.
pub fn failures(quick: bool) -> Result<FailureMap> {
    let mut cells = Vec::new();
    for border in borders(quick)? {
        let truths = match border.asks {
            Asks::Motion => [rigid(&border.task)?, Told::default()],
            _ => [Told::default(), Told::default()],
        };
        for (method, ours) in METHODS {
            let (own, truth) = (border.clone(), truths[0].clone());
            let answer: Answer = watched(PATIENCE, move || ask(method, &own, &truth));
            let (outcome, why) = match answer {
                Watched::Done(Ok(None)) => continue,
                Watched::Done(Ok(Some(found))) => found,
                Watched::Done(Err(Fault::Refused(why))) => (Outcome::Refused, why),
                Watched::Done(Err(Fault::Stalled(why))) => (Outcome::Stalled, why),
                Watched::Crashed(why) => (Outcome::Crashed, why),
                Watched::Stalled => (Outcome::Stalled, format!("no answer within {PATIENCE} s")),
            };
            cells.push(Cell {
                method: method.to_owned(),
                ours,
                border: border.name.to_owned(),
                scene: border.scene.clone(),
                outcome,
                why,
            });
        }
    }
    Ok(FailureMap { family: Family::Models, cells })
}

/// What a method makes of a border; nothing where the scene does not ask it.
fn ask(method: &str, border: &Border, truth: &Told) -> std::result::Result<Option<Found>, Fault> {
    let task = &border.task;
    let cycle = task.cycle();
    let (off, run): (f64, Run<'_>) = match method {
        "closed form" => {
            return match border.asks {
                Asks::Motion | Asks::Orbit => check::closed_form(task).map(Some),
                _ => Ok(None),
            };
        }
        "soft-corrected form" => {
            return match border.asks {
                Asks::Motion | Asks::Orbit => corrected(task),
                _ => Ok(None),
            };
        }
        "exact flights" => (OURS, &ours::flights),
        "exact Kelvin–Voigt" => (OURS, &soft_flights),
        "RK4 loop" => (2e-3 * cycle, &|t: &Task| marched(t, Loop::Rk4, 1000.0)),
        "RK45, sign test" => (1e-3 * cycle, &|t: &Task| events(t, &Events::ends(Kind::Rk45(1e-6)))),
        // The contact lasts 0.7 % of the period; what it changes is some percent of it.
        _ => (0.05 * cycle, &|t: &Task| penalty(t, &spring(&t.rig, STIFFNESS), Kind::Rk45(1e-6))),
    };
    Ok(match border.asks {
        Asks::First(time) => Some(check::first(&reported(method, task, run)?, time, off)),
        Asks::Cycles(cycles) if method == "exact flights" || cycles <= 1e4 => {
            Some(long(&run(task)?, method, task)?)
        }
        Asks::Orbit | Asks::Cycles(_) => None,
        Asks::Motion if method == "exact Kelvin–Voigt" => {
            let told = reported(method, task, run)?;
            // What integration cannot follow (a damper far beyond critical is stiff) is no truth.
            let Ok(truth) = soft(task) else { return Ok(None) };
            Some(check::motion(&told, &truth, task.until, off, false))
        }
        Asks::Motion => Some(check::motion(&run(task)?, truth, task.until, off, method == "exact flights")),
    })
}

/// A contact that gives way is told when it is over: the motion is followed for longer, and what began too late left out.
fn reported(method: &str, task: &Task, run: Run<'_>) -> std::result::Result<Told, Fault> {
    if method != "exact Kelvin–Voigt" {
        return run(task);
    }
    let mut told = run(&Task { until: task.until + 3.0 * task.cycle(), ..*task })?;
    told.impacts.retain(|i| i.0 < task.until);
    Ok(told)
}

fn soft_flights(task: &Task) -> std::result::Result<Told, Fault> {
    damping_ratio(task.rig.restitution)?;
    ours::kelvin_voigt(task, &spring(&task.rig, STIFFNESS))
}

/// The last approach speed of a long run against the orbit that it has settled on, in closed form or by its own contact.
fn long(told: &Told, method: &str, task: &Task) -> std::result::Result<Found, Fault> {
    let settled = |speed: f64, expected: f64, off: f64| {
        let error = (speed / expected - 1.0).abs();
        let outcome = if error < off { Outcome::Right } else { Outcome::Wrong };
        (outcome, format!("approach speed {error:.0e} off after {:.0e} s", task.until))
    };
    let Some(last) = told.impacts.last() else { return Ok((Outcome::Wrong, "no impacts".to_owned())) };
    // After 1000 cycles what is left of the start is 0.970¹⁰⁰⁰ = 6e-14.
    if method == "exact Kelvin–Voigt" {
        let short = soft(&Task { until: 1000.5 * task.cycle(), ..*task })?;
        let expected = short.impacts.last().map_or(f64::NAN, |i| i.1);
        return Ok(settled(last.1, expected, 1e-8));
    }
    let found = orbits(&task.rig, task.force, task.frequency)?;
    let expected = found.orbits.first().map_or(f64::NAN, |o| o.approach_velocity);
    let off = match method {
        "exact flights" => 1e-9,
        "RK45, sign test" => 1e-4,
        "RK4 loop" => 1e-2,
        _ => 0.3,
    };
    Ok(settled(last.1, expected, off))
}

/// The soft correction against the motion with that contact, where this settles with one impact a cycle near the orbit.
fn corrected(task: &Task) -> std::result::Result<Option<Found>, Fault> {
    let excitation = Excitation::Sine(Sine { force: task.force, frequency: task.frequency });
    let compliance = Compliance::new(&task.rig, STIFFNESS, None)?;
    let found = orbits(&task.rig, task.force, task.frequency)?;
    let soft = softened(&task.rig, &excitation, &found, &compliance)?;
    let told = soft_flights(&Task { until: 600.0 / task.frequency, ..*task })?;
    let last: Vec<_> = told.impacts.iter().rev().take(9).collect();
    let regular = last.len() == 9
        && last.windows(2).all(|w| {
            ((w[0].0 - w[1].0) * task.frequency - 1.0).abs() < 1e-6 && (w[0].1 / w[1].1 - 1.0).abs() < 1e-6
        });
    if !regular {
        return Ok(None);
    }
    let speed = last[0].1;
    let off = |v: f64| (v / speed - 1.0).abs();
    let near = found
        .orbits
        .iter()
        .zip(&soft)
        .filter_map(|(orbit, soft)| Some((orbit.approach_velocity, soft.as_ref()?)))
        .min_by(|a, b| off(a.1.approach_velocity).total_cmp(&off(b.1.approach_velocity)));
    let Some((plain, soft)) = near else {
        return Err(Fault::Refused(
            "no orbit is left with this contact, or only one that needs a restitution above 1".to_owned(),
        ));
    };
    // What is left is of second order in the share in contact, enlarged as the first order is.
    let allowed = off(plain).max(0.1) * 3.0 * soft.share + 1e-4;
    let error = off(soft.approach_velocity);
    let outcome = if error <= allowed { Outcome::Right } else { Outcome::Wrong };
    Ok(Some((
        outcome,
        format!("approach speed {error:.1e} off, {allowed:.1e} allowed, {:.1e} without it", off(plain)),
    )))
}
