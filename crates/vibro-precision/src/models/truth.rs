//! The truth at a border, from the definition of the motion and by nothing that is asked there: matrix exponentials in short
//! steps, signs of gap and contact force, halving. Slow and plain.
//!
//! Between impacts, in rest and in a contact of spring and damper the motion is linear in its state and the exciting force, so that the exponential of
//! one matrix carries it over a step to rounding. An impact keeps momentum and turns the relative speed v into −Rv.

mod course;
mod definition;
mod guard;
mod mode;
mod repeats;

pub use course::{Course, Met, Start};
pub(crate) use definition::CLOSES;
pub use definition::{Growth, growth, impacts};
pub use repeats::{Repeats, repeats, settled};

use super::rivals::Spring;
use super::task::{Task, Told};

/// The motion of a task with impacts at once, or with a `contact`; or why there is none.
///
/// # Errors
/// As [`Course::run`].
pub fn motion(task: &Task, contact: Option<&Spring>) -> Result<Told, String> {
    let mut told = Told::default();
    let mut touch = None;
    let rest = |touch: Option<f64>, until| contact.zip(touch).and_then(|(c, from)| c.rest(task, from, until));
    Course::new(task, contact).run(task.phase, Start::Free(task.first()), task.until, &mut |met| {
        match met {
            Met::Impact(time, before) => {
                told.impacts.push((*time, before[1] - before[3]));
                touch = Some(*time);
            }
            Met::Stick(time) => told.sticks.push([*time, f64::INFINITY]),
            Met::Release(time) if contact.is_some() => told.sticks.extend(rest(touch.take(), *time)),
            Met::Release(time) => {
                if let Some(rest) = told.sticks.last_mut() {
                    rest[1] = *time;
                }
            }
        }
        true
    })?;
    told.sticks.extend(rest(touch, f64::INFINITY));
    told.impacts.retain(|i| i.0 < task.until);
    Ok(told)
}

#[cfg(test)]
mod tests;
