//! The truth at a border, from the definition of the motion and by nothing that is asked there: matrix exponentials in short
//! steps, signs of gap and contact force, halving. Slow and plain.
//!
//! Between impacts, in rest and in a contact of spring and damper the motion is linear in its state and the exciting force, so that the exponential of
//! one matrix carries it over a step to rounding. An impact keeps momentum and turns the relative speed v into −Rv.

mod course;
mod mode;
mod repeats;

pub use repeats::{Repeats, impacts, repeats, settled};

use super::task::{Spring, Task, Told};
use course::{Course, Met};
use std::f64::consts::TAU;

/// The motion of a task with impacts at once, or with a `contact`.
pub fn motion(task: &Task, contact: Option<&Spring>) -> Told {
    let (mut told, mut touch) = (Told::default(), None);
    let course = Course::new(task, contact);
    let mut place = course.free(task.phase, &task.first());
    let start = task.phase / (TAU * task.frequency);
    let rests = |told: &mut Told, touch: Option<f64>, end: f64| {
        told.sticks.extend(contact.zip(touch).and_then(|(c, from)| c.rest(from, end)));
    };
    while let Some(met) = course.next(&mut place, start + task.until) {
        match met {
            Met::Impact(time, before) => {
                told.impacts.push((time - start, before[1] - before[3]));
                touch = Some(time - start);
            }
            Met::Stick(time) => told.sticks.push([time - start, f64::INFINITY]),
            Met::Release(time) if contact.is_some() => rests(&mut told, touch.take(), time - start),
            Met::Release(time) => told.release(time - start),
        }
    }
    rests(&mut told, touch, f64::INFINITY);
    told.impacts.retain(|i| i.0 < task.until);
    told
}

#[cfg(test)]
mod tests;
