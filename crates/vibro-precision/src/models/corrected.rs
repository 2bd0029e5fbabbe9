//! The soft-contact correction of an orbit against the motion with that contact.

use std::f64::consts::{PI, TAU};

use super::check::Found;
use super::scene_b::spring;
use super::task::{Fault, Task};
use super::truth::{Repeats, repeats};
use crate::Outcome;
use vibro_model::{Compliance, Excitation, Orbit, Sine, Softened, orbits, softened};

/// Every orbit that does not pass through the other mass, corrected, against the motion with the contact that repeats.
pub fn corrected(task: &Task) -> Result<Found, Fault> {
    let excitation = Excitation::Sine(Sine { force: task.force, frequency: task.frequency });
    let found = orbits(&task.rig, task.force, task.frequency)?;
    let compliance = Compliance::new(&task.rig, task.stiffness, None)?;
    let soft = softened(&task.rig, &excitation, &found, &compliance)?;
    let real: Vec<_> = found.orbits.iter().zip(&soft).filter(|(o, _)| o.validity.admissible).collect();
    if real.is_empty() {
        return Ok((Outcome::NotAsked, "no motion with one impact a cycle is to be corrected".to_owned()));
    }
    let (mut judged, mut withheld) = (Vec::new(), Vec::new());
    for (orbit, soft) in real {
        match (soft, counterpart(task, orbit)) {
            (Some(soft), Some(truth)) => {
                let fit = Fit::new(task, orbit, soft, &compliance, &truth);
                if fit.corrected.is_nan() || fit.corrected > fit.allowed() {
                    return Ok((Outcome::Wrong, fit.told()));
                }
                judged.push(fit.told());
            }
            (Some(soft), None) => {
                return Ok((
                    Outcome::Wrong,
                    format!("corrected to {:.3e} m/s, where no motion with this contact goes on from the orbit", soft.approach_velocity),
                ));
            }
            // That is what no correction stands for.
            (None, Some(truth)) => withheld.push(format!(
                "no correction: it has no orbit with this contact, or only one with a restitution above 1 (there is one of {:.3e} m/s)",
                truth.speed()
            )),
            (None, None) => judged.push("no orbit is left with this contact, as is told".to_owned()),
        }
    }
    if judged.is_empty() {
        return Err(Fault::Refused(withheld.join("; ")));
    }
    judged.extend(withheld);
    Ok((Outcome::Right, judged.join("; ")))
}

/// The motion that an orbit goes over into as its contact gives way, by the definition of a motion that repeats: its duration rises from
/// nothing to that of the task in steps, each guessed by going on straight from the two before.
fn counterpart(task: &Task, orbit: &Orbit) -> Option<Repeats> {
    let before = orbit.before_impact();
    let rigid = Repeats { before: [before.x1, before.v1, before.x2, before.v2], phase: orbit.force_phase };
    let (mut last, mut part) = ((0.0, rigid), (0.0, rigid));
    let mut step = FIRST;
    while part.0 < 1.0 {
        let next = (part.0 + step).min(1.0);
        let guess = straight(last, part, next);
        let contact = spring(&task.rig, task.stiffness / (next * next));
        let found = repeats(task, Some(&contact), orbit.period(), &guess);
        // Newton's method may end in another motion: it must not lead away from the guess.
        match found.filter(|f| (f.speed() / guess.speed() - 1.0).hypot(turn(f.phase - guess.phase)) < NEAR) {
            Some(found) => {
                (last, part) = (part, (next, found));
                step *= 1.5;
            }
            None if step > 0.01 * FIRST => step *= 0.5,
            None => return None,
        }
    }
    Some(part.1)
}

/// Part of the duration in the first step of a continuation, and how far a step may lead from its guess.
const FIRST: f64 = 0.05;
const NEAR: f64 = 0.05;

/// Going on from two motions at parts of the duration to a third part.
fn straight(last: (f64, Repeats), at: (f64, Repeats), next: f64) -> Repeats {
    let more = if at.0 > last.0 { (next - at.0) / (at.0 - last.0) } else { 0.0 };
    let on = |from: f64, to: f64| to + more * (to - from);
    Repeats {
        before: std::array::from_fn(|i| on(last.1.before[i], at.1.before[i])),
        phase: at.1.phase + more * turn(at.1.phase - last.1.phase),
    }
}

/// An angle in −π to π.
fn turn(phase: f64) -> f64 {
    (phase + PI).rem_euclid(TAU) - PI
}

/// How far the orbit with its correction and without is from the truth: approach speed relative and phase of the touch in rad together,
/// so that no single one of them is small by chance.
#[derive(Debug, Clone, Copy)]
struct Fit {
    corrected: f64,
    plain: f64,
    /// `ωt_c`, the phase in rad that passes in the contact.
    turn: f64,
}

impl Fit {
    fn new(task: &Task, orbit: &Orbit, soft: &Softened, compliance: &Compliance, truth: &Repeats) -> Fit {
        let omega = TAU * task.frequency;
        let apart = |speed: f64, phase: f64| (speed / truth.speed() - 1.0).hypot(turn(phase - truth.phase));
        let touch = orbit.force_phase + soft.timing - orbit.timing - omega * compliance.delay;
        Fit {
            corrected: apart(soft.approach_velocity, touch),
            plain: apart(orbit.approach_velocity, orbit.force_phase),
            turn: omega * compliance.duration,
        }
    }

    /// The correction is of first order in `ωt_c` in the restitution, the delay and the speed at the touch, and exact in all that follows from them: each
    /// leaves a second order, `(ωt_c)²`. It may never be half of the change: no correction at all is wrong.
    fn allowed(&self) -> f64 {
        (3.0 * self.turn.powi(2)).min(0.5 * self.plain)
    }

    fn told(&self) -> String {
        format!(
            "approach speed and phase {:.1e} off, allowed {:.1e}, {:.1e} without the correction",
            self.corrected,
            self.allowed(),
            self.plain
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene_b;
    use super::*;

    /// The rigid orbit itself, told as if it were corrected, is judged as any answer.
    #[test]
    fn no_correction_is_no_answer_at_any_stiffness() {
        let task = scene_b::task(1.0);
        for stiffness in [1e5, 1e6, 1e8] {
            let excitation = Excitation::Sine(Sine { force: task.force, frequency: task.frequency });
            let found = orbits(&task.rig, task.force, task.frequency).unwrap();
            let compliance = Compliance::new(&task.rig, stiffness, None).unwrap();
            let soft = softened(&task.rig, &excitation, &found, &compliance).unwrap();
            let (orbit, soft) = (&found.orbits[0], soft[0].unwrap());
            let truth = counterpart(&Task { stiffness, ..task }, orbit).unwrap();
            let fit = |soft: &Softened| Fit::new(&task, orbit, soft, &compliance, &truth);
            let corrected = fit(&soft);
            assert!(corrected.corrected <= corrected.allowed(), "{stiffness:e}: {}", corrected.told());
            let none = Softened {
                approach_velocity: orbit.approach_velocity,
                timing: orbit.timing + TAU * task.frequency * compliance.delay,
                ..soft
            };
            assert!(fit(&none).corrected > fit(&none).allowed(), "{stiffness:e}: {}", fit(&none).told());
        }
    }
}
