//! The library's own methods on a task.

use super::rivals::Spring;
use super::task::{Fault, Task, Told};
use vibro_model::{Chirp, Compliant, Event, Excitation, Law, Motion, Piece, Simulation, Sine};

/// Event by event on exact flights.
///
/// # Errors
/// As [`Simulation::from_state`] and [`Simulation::run`].
pub fn flights(task: &Task) -> Result<Told, Fault> {
    let sine = Sine { force: task.force, frequency: task.frequency };
    let mut motion = Simulation::from_state(&task.rig, &sine, task.start, task.phase)?;
    let mut told = Told::default();
    motion.run(task.until, |leg| match leg.event {
        Event::Impact(impact) => told.impacts.push((impact.time, impact.approach_velocity)),
        Event::Stick => told.sticks.push([leg.start + leg.duration, f64::INFINITY]),
        Event::Release => release(&mut told, leg.start + leg.duration),
        _ => {}
    })?;
    Ok(told)
}

/// As [`flights`], the frequency changing at the task's rate in steps whose phase deviates by up to `deviation` (rad).
///
/// # Errors
/// As [`flights`] and [`Chirp::advance`].
pub fn swept(task: &Task, deviation: f64) -> Result<Told, Fault> {
    let sine = Sine { force: task.force, frequency: task.frequency };
    let mut motion = Simulation::from_state(&task.rig, &sine, task.start, task.phase)?;
    let mut told = Told::default();
    Chirp { rate: task.rate, deviation }
        .advance(&mut motion, task.until, &mut |piece| take(&mut told, &piece))?;
    Ok(told)
}

/// Event by event with a contact of spring and damper.
///
/// # Errors
/// As [`Compliant::new`] and [`Compliant::advance`].
pub fn kelvin_voigt(task: &Task, spring: &Spring) -> Result<Told, Fault> {
    let excitation = Excitation::Sine(Sine { force: task.force, frequency: task.frequency });
    let law = Law::KelvinVoigt { stiffness: spring.stiffness, damping: spring.damping };
    let mut motion = Compliant::new(&task.rig, &excitation, law, task.start, task.phase)?;
    let mut told = Told::default();
    motion.advance(task.until, &mut |piece| {
        take(&mut told, &piece);
        if let Event::Impact(impact) = piece.event {
            told.sticks.extend(spring.rest(task, impact.time, piece.start + piece.duration));
        }
    })?;
    Ok(told)
}

fn take(told: &mut Told, piece: &Piece<'_>) {
    if let Event::Impact(impact) = piece.event {
        told.impacts.push((impact.time, impact.approach_velocity));
    }
}

fn release(told: &mut Told, time: f64) {
    if let Some(rest) = told.sticks.last_mut() {
        rest[1] = time;
    }
}
