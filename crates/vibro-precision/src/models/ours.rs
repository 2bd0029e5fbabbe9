//! The library's own methods, run on a task.

use super::task::{Log, Spring, Task};
use crate::OutcomeWithReason;
use vibro_model::contact::conversion::damping_ratio;
use vibro_model::{
    Chirp, Compliance, Compliant, Event, Excitation, Law, Motion, Orbits, Piece, Simulation, Sine, State,
};
use vibro_model::{Softened, orbits, softened};

/// The excitation of a task.
fn sine(task: &Task) -> Sine {
    Sine { force: task.force, frequency: task.frequency }
}

/// The state of a task at time 0.
fn start(task: &Task) -> State {
    let [x1, v1, x2, v2] = task.start;
    State { x1, v1, x2, v2 }
}

/// Follows the task's motion with [`Simulation`]: closed-form flights from impact to impact.
pub fn flights(task: &Task) -> Result<Log, OutcomeWithReason> {
    let mut log = Log::default();
    Simulation::from_state(&task.rig, &sine(task), start(task), task.phase)?
        .advance(task.until, &mut |piece| log.take(&piece))?;
    Ok(log)
}

/// As [`flights`], with the frequency changing at the task's rate in steps whose phase deviates by up to
/// `deviation` in rad.
pub fn swept(task: &Task, deviation: f64) -> Result<Log, OutcomeWithReason> {
    let mut motion = Simulation::from_state(&task.rig, &sine(task), start(task), task.phase)?;
    let mut log = Log::default();
    Chirp { rate: task.rate, deviation }.advance(&mut motion, task.until, &mut |piece| log.take(&piece))?;
    Ok(log)
}

/// Follows the task's motion with [`Compliant`]: a contact of spring and damper.
pub fn kelvin_voigt(task: &Task) -> Result<Log, OutcomeWithReason> {
    damping_ratio(task.rig.restitution)?;
    let Spring { stiffness, damping, .. } = task.spring();
    let law = Law::spring(stiffness, damping);
    let mut motion = Compliant::new(&task.rig, &Excitation::Sine(sine(task)), law, start(task), task.phase)?;
    let mut log = Log::default();
    // A soft contact is reported when it is over: the motion is followed for longer, and contacts that begin
    // after the end of the task are left out.
    motion.advance(task.until + 3.0 * task.cycle(), &mut |piece| {
        if let Event::Impact(impact) = piece.event
            && impact.time < task.until
        {
            log.take(&piece);
            log.sticks.extend(task.spring().rest(impact.time, piece.start + piece.duration));
        }
    })?;
    Ok(log)
}

/// Logs one impact at time 0: that of the first orbit with one impact a cycle, in closed form.
pub fn closed_form(task: &Task) -> Result<Log, OutcomeWithReason> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    Ok(Log::of(found.orbits.iter().take(1).map(|o| (0.0, o.approach_velocity))))
}

/// As [`closed_form`], corrected for the contact of the task.
pub fn soft_form(task: &Task) -> Result<Log, OutcomeWithReason> {
    let (_, soft, _) = soft_forms(task)?;
    Ok(Log::of(soft.iter().take(1).flatten().map(|o| (0.0, o.approach_velocity))))
}

/// All orbits, their corrections for a soft contact, and this contact.
pub fn soft_forms(task: &Task) -> Result<(Orbits, Vec<Option<Softened>>, Compliance), OutcomeWithReason> {
    let found = orbits(&task.rig, task.force, task.frequency)?;
    let compliance = Compliance::new(&task.rig, task.stiffness, None)?;
    let soft = softened(&task.rig, &Excitation::Sine(sine(task)), &found, &compliance)?;
    Ok((found, soft, compliance))
}

/// Quasi-static sweep: logs the impact of the steady orbit at each of `n` frequencies, at the time at which
/// the sweep passes it.
pub fn standing(task: &Task, n: f64) -> Result<Log, OutcomeWithReason> {
    let mut log = Log::default();
    for i in 0..n as u32 {
        let time = task.until * f64::from(i) / (n - 1.0);
        let frequency = task.frequency + task.rate * time;
        let found = orbits(&task.rig, task.force, frequency)?;
        log.impacts.extend(found.orbits.first().map(|o| (time, o.approach_velocity)));
    }
    Ok(log)
}

impl Log {
    /// Adds the event at the end of a piece of the motion.
    fn take(&mut self, piece: &Piece<'_>) {
        let end = piece.start + piece.duration;
        match piece.event {
            Event::Impact(impact) => self.impacts.push((impact.time, impact.approach_velocity)),
            Event::Stick => self.sticks.push([end, f64::INFINITY]),
            Event::Release => self.release(end),
            _ => {}
        }
    }
}
