//! Integration from event to event: each impact, end of a contact or release is located, and the integration begins anew behind it.

use super::super::task::{Spring, Task, Told};
use super::stepper::{Kind, Stepper, rk4};
use crate::failure::Found;

/// Where the masses are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    Apart,
    /// At rest against each other.
    Together,
    /// Pushed apart by spring and damper of the contact.
    Touching,
    /// The contact's force is zero, its surfaces are not yet back at their rest.
    Released,
}

/// What ends a stage when it falls to zero.
#[derive(Debug, Clone, Copy)]
pub(super) enum Guard {
    /// Weights·y + offset.
    Linear([f64; 4], f64),
    /// The force that keeps the masses together.
    Hold,
}

impl Guard {
    pub fn value(&self, task: &Task, t: f64, y: &[f64; 4]) -> f64 {
        match self {
            Guard::Linear(w, offset) => w.iter().zip(y).map(|(w, y)| w * y).sum::<f64>() + offset,
            Guard::Hold => task.hold(t, y),
        }
    }
}

/// A task with impacts at once, or with a contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct System<'a> {
    pub task: &'a Task,
    pub spring: Option<Spring>,
}

impl System<'_> {
    /// Rate of the state in a stage.
    #[inline]
    pub fn rate(&self, stage: Stage, t: f64, y: &[f64; 4]) -> [f64; 4] {
        let push = match (stage, &self.spring) {
            (Stage::Touching, Some(spring)) => spring.bound(self.task, y),
            (Stage::Together, _) => self.task.hold(t, y),
            _ => 0.0,
        };
        self.task.pushed(t, y, push)
    }

    /// What ends a stage, whichever falls first.
    pub fn guards(&self, stage: Stage) -> [Option<Guard>; 2] {
        let gap = self.task.rig.gap;
        let (k, c) = self.spring.map_or((0.0, 0.0), |s| (s.stiffness, s.damping));
        match stage {
            Stage::Apart => [Some(Guard::Linear([-1.0, 0.0, 1.0, 0.0], gap)), None],
            Stage::Together => [Some(Guard::Hold), None],
            Stage::Touching => [Some(Guard::Linear([k, c, -k, -c], -k * gap)), None],
            Stage::Released => [
                Some(Guard::Linear([1.0, 0.0, -1.0, 0.0], -gap)),
                Some(Guard::Linear([-k, -c, k, c], k * gap)),
            ],
        }
    }
}

/// How far a motion has been followed.
pub(super) struct Course<'a> {
    pub system: System<'a>,
    /// Approach speed in m/s below which masses that press each other stay together.
    sticks: f64,
    pub told: Told,
    pub t: f64,
    pub y: [f64; 4],
    pub stage: Stage,
}

impl<'a> Course<'a> {
    /// The start of a task. Its rule for rest is the speed at which a bounce is as high as the integrator's error, 1 mm times its
    /// `relative` tolerance.
    pub fn new(task: &'a Task, spring: Option<Spring>, relative: f64) -> Course<'a> {
        let sticks = if task.rests { (0.02 * relative).sqrt() } else { 0.0 };
        let (system, told, y) = (System { task, spring }, Told::default(), task.first());
        Course { system, sticks, told, t: 0.0, y, stage: Stage::Apart }
    }

    /// What follows where a guard has fallen at time and state.
    pub fn meet(&mut self, which: usize, t: f64, mut y: [f64; 4]) {
        let System { task, spring } = self.system;
        self.t = t;
        self.stage = match (self.stage, which) {
            (Stage::Apart, _) if spring.is_some() => {
                self.told.impacts.push((t, y[1] - y[3]));
                Stage::Touching
            }
            (Stage::Apart, _) => {
                let approach = task.collide(&mut y);
                self.told.impacts.push((t, approach));
                if approach < self.sticks && task.hold(t, &y) > 0.0 {
                    self.told.sticks.push([t, f64::INFINITY]);
                    let rig = &task.rig;
                    let v = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
                    y = [y[0], v, y[0] - rig.gap, v];
                    Stage::Together
                } else {
                    Stage::Apart
                }
            }
            (Stage::Together, _) => {
                self.told.release(t);
                // The gap opens like the cube of time: a ten-thousandth of a cycle passes unwatched, until it is more than rounding.
                let short = 1e-4 * task.cycle();
                y[0] = y[2] + task.rig.gap;
                y = rk4(&|t: f64, y: &[f64; 4]| task.pushed(t, y, 0.0), t, &y, short);
                self.t = t + short;
                Stage::Apart
            }
            (Stage::Touching, _) => Stage::Released,
            (Stage::Released, 0) => Stage::Apart,
            (Stage::Released, _) => Stage::Touching,
        };
        self.y = y;
    }
}

/// How an event is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Locate {
    /// Signs at the ends of steps, then halving: the event functions of the usual packages.
    Ends,
    /// The first root of the dense output, none missed.
    Dense,
}

/// Follows the motion with impacts at once, or with a contact.
pub fn events(task: &Task, spring: Option<Spring>, kind: Kind, locate: Locate) -> Result<Told, Found> {
    let (mut now, mut left) = (Course::new(task, spring, kind.relative()), task.most);
    while now.t < task.until {
        let (system, stage) = (now.system, now.stage);
        let f = |t: f64, y: &[f64; 4]| system.rate(stage, t, y);
        let guards = system.guards(stage);
        let mut stepper = Stepper::new(kind, task, f, now.t, now.y);
        let (mut t, mut y) = (now.t, now.y);
        let met = loop {
            if t >= task.until {
                return Ok(now.told);
            }
            if left == 0 {
                return Err(task.stalled(t));
            }
            left -= 1;
            // The holding force bends with the excitation: its sign is tested eight times a cycle at least.
            let longest = if stage == Stage::Together { task.cycle() / 8.0 } else { f64::INFINITY };
            let step = stepper.step(f, task.until.min(t + longest))?;
            let fallen = guards.iter().flatten().enumerate().filter_map(|(which, guard)| {
                let at = match (locate, guard) {
                    (Locate::Dense, Guard::Linear(weights, offset)) => step.first_fall(weights, *offset),
                    _ => step.crossing(f, guard.value(task, t, &y), |t, y| guard.value(task, t, y)),
                };
                Some((which, at?))
            });
            let first = fallen.min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((which, at)) = first {
                break (which, step.start + at, step.at(f, at));
            }
            (t, y) = (step.start + step.duration, step.end);
        };
        now.meet(met.0, met.1, met.2);
    }
    Ok(now.told)
}

/// Integrates straight through contacts of a spring that never pulls, step sizes left to the error control; touches are read off
/// afterwards.
pub fn through(task: &Task, spring: &Spring, kind: Kind) -> Result<Told, Found> {
    let force = |y: &[f64; 4]| if task.gap(y) < 0.0 { spring.bound(task, y).max(0.0) } else { 0.0 };
    let f = |t: f64, y: &[f64; 4]| task.pushed(t, y, force(y));
    let (mut told, mut left) = (Told::default(), task.most);
    let mut stepper = Stepper::new(kind, task, f, 0.0, task.first());
    let (mut t, mut gap) = (0.0, task.gap(&task.first()));
    let mut touch = None;
    while t < task.until {
        if left == 0 {
            return Err(task.stalled(t));
        }
        left -= 1;
        let step = stepper.step(f, task.until)?;
        if gap > 0.0
            && let Some(at) = step.crossing(f, gap, |_, y| task.gap(y))
        {
            let y = step.at(f, at);
            told.impacts.push((step.start + at, y[1] - y[3]));
            touch = Some(step.start + at);
        }
        t = step.start + step.duration;
        let after = task.gap(&step.end);
        if after > 0.0
            && let Some(from) = touch.take()
        {
            let parts = step.crossing(f, -gap, |_, y| -task.gap(y)).map_or(t, |at| step.start + at);
            told.sticks.extend(spring.rest(from, parts));
        }
        gap = after;
    }
    told.sticks.extend(touch.and_then(|from| spring.rest(from, f64::INFINITY)));
    Ok(told)
}
