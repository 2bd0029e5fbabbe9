//! Integration from event to event: each impact is located within its step, and the integration begins anew behind it.

use super::super::task::{Fault, Task, Told};
use super::stepper::rk4;
use super::{Kind, Stepper, Taken};

/// How an impact is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Locate {
    /// The gap's sign at the ends of steps, then halving: the event functions of the usual packages.
    Ends,
    /// The first root of the dense output, none missed.
    Dense,
}

/// An integration with events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Events {
    /// Integrator.
    pub kind: Kind,
    /// How impacts are looked for.
    pub locate: Locate,
    /// Approach speed in m/s below which masses that press each other stay together.
    pub sticks: Option<f64>,
}

impl Events {
    /// Impacts located by the dense output, no sticking.
    pub fn dense(kind: Kind) -> Events {
        Events { kind, locate: Locate::Dense, sticks: None }
    }

    /// Impacts located by sign tests, no sticking.
    pub fn ends(kind: Kind) -> Events {
        Events { locate: Locate::Ends, ..Events::dense(kind) }
    }

    /// Masses that press each other stay together below `speed` (m/s).
    pub fn sticking(self, speed: f64) -> Events {
        Events { sticks: Some(speed), ..self }
    }
}

/// Follows the motion.
///
/// # Errors
/// If the budget is spent or no step is small enough.
pub fn events(task: &Task, how: &Events) -> Result<Told, Fault> {
    let apart = |t: f64, y: &[f64; 4]| task.apart(t, y);
    let (mut t, mut y, mut told, mut left) = (0.0, task.first(), Told::default(), task.most);
    'flights: while t < task.until {
        let mut stepper = Stepper::new(how.kind, task, apart, t, y);
        let mut gap = task.gap(&y);
        loop {
            if left == 0 {
                return Err(task.stalled(t));
            }
            left -= 1;
            let step = stepper.step(apart, task.until)?;
            let met = match (how.locate, &step) {
                (Locate::Dense, Taken::Dense(dense)) => {
                    dense.first_fall(&[-1.0, 0.0, 1.0, 0.0], task.rig.gap)
                }
                _ => step.crossing(apart, gap, |_, y| task.gap(y)),
            };
            let Some(at) = met else {
                t = step.start() + step.duration();
                y = step.end();
                gap = task.gap(&y);
                if t >= task.until {
                    return Ok(told);
                }
                continue;
            };
            t = step.start() + at;
            y = step.at(apart, at);
            let approach = task.collide(&mut y);
            told.impacts.push((t, approach));
            if how.sticks.is_some_and(|speed| approach < speed) && task.hold(t, &y) > 0.0 {
                (t, y) = rest(task, how, t, y, &mut told, &mut left)?;
            }
            continue 'flights;
        }
    }
    Ok(told)
}

/// Both masses at contact with their common momentum.
pub(super) fn merged(task: &Task, y: &[f64; 4]) -> [f64; 4] {
    let rig = &task.rig;
    let v = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
    [y[0], v, y[0] - rig.gap, v]
}

/// Time and state shortly behind the release at `t`: the gap opens like the cube of time, and a ten-thousandth of a cycle passes unwatched,
/// until it is more than rounding.
pub(super) fn parted(task: &Task, t: f64, mut y: [f64; 4]) -> (f64, [f64; 4]) {
    let short = 1e-4 * task.cycle();
    y[0] = y[2] + task.rig.gap;
    (t + short, rk4(&|t: f64, y: &[f64; 4]| task.apart(t, y), t, &y, short))
}

/// Together from `t` until the force between the masses vanishes.
fn rest(
    task: &Task,
    how: &Events,
    t: f64,
    y: [f64; 4],
    told: &mut Told,
    left: &mut u64,
) -> Result<(f64, [f64; 4]), Fault> {
    let both = |t: f64, y: &[f64; 4]| task.together(t, y);
    told.sticks.push([t, f64::INFINITY]);
    let (mut t, mut y) = (t, merged(task, &y));
    let mut stepper = Stepper::new(how.kind, task, both, t, y);
    let mut force = task.hold(t, &y);
    while t < task.until {
        if *left == 0 {
            return Err(task.stalled(t));
        }
        *left -= 1;
        // The force bends with the excitation: its sign is tested eight times a cycle at least.
        let step = stepper.step(both, task.until.min(t + task.cycle() / 8.0))?;
        if let Some(at) = step.crossing(both, force, |t, y| task.hold(t, y)) {
            t = step.start() + at;
            y = step.at(both, at);
            if let Some(last) = told.sticks.last_mut() {
                last[1] = t;
            }
            return Ok(parted(task, t, y));
        }
        t = step.start() + step.duration();
        y = step.end();
        force = task.hold(t, &y);
    }
    Ok((t, y))
}
