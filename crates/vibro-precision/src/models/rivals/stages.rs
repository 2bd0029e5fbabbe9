//! Integration from event to event: each impact, end of a contact and release is located, and the integration
//! starts again after it.

use super::super::task::{Log, Spring, Task};
use super::stepper::{IntegratorKind, Stepper, rk4};
use crate::Found;

/// Stage of a motion between two events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// Not in contact.
    Apart,
    /// At rest against each other.
    Together,
    /// Pushed apart by spring and damper of the contact.
    Touching,
    /// After the contact force has become zero, while the surfaces have not yet recovered their shape.
    Released,
}

/// A function that ends a stage when it falls to zero.
#[derive(Debug, Clone, Copy)]
pub(super) enum Guard {
    /// Weights·y + offset.
    Linear([f64; 4], f64),
    /// The contact force that keeps the masses together.
    Hold,
}

impl Guard {
    /// Value of the function at the time `t` in the state `y`.
    pub fn value(&self, task: &Task, t: f64, y: &[f64; 4]) -> f64 {
        match self {
            Guard::Linear(w, offset) => w.iter().zip(y).map(|(w, y)| w * y).sum::<f64>() + offset,
            Guard::Hold => task.hold(t, y),
        }
    }
}

/// A task with rigid impacts, or with a contact spring.
#[derive(Debug, Clone, Copy)]
pub(super) struct System<'a> {
    pub task: &'a Task,
    pub spring: Option<Spring>,
}

impl System<'_> {
    /// Time derivative of the state in a stage.
    #[inline]
    pub fn rate(&self, stage: Stage, t: f64, y: &[f64; 4]) -> [f64; 4] {
        let push = match (stage, &self.spring) {
            (Stage::Touching, Some(spring)) => spring.bound(self.task, y),
            (Stage::Together, _) => self.task.hold(t, y),
            _ => 0.0,
        };
        self.task.pushed(t, y, push)
    }

    /// The functions that end a stage; the first to fall ends it.
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

/// Method of locating events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Locate {
    /// Signs at the ends of steps, then bisection, as in the usual packages.
    Ends,
    /// The first root of the dense output, none missed.
    Dense,
    /// As `Dense`. The rest of a chatter that ends in rest is summed as a geometric series of flights, which
    /// takes 2w/(a(1 − R)).
    Summed,
}

/// A motion as far as it has been followed.
pub struct Trajectory<'a> {
    pub(super) system: System<'a>,
    kind: IntegratorKind,
    locate: Locate,
    /// Approach speed in m/s below which masses that press each other stay together.
    rest_speed: f64,
    /// Steps that may still be taken.
    left: u64,
    pub log: Log,
    pub t: f64,
    pub(super) y: [f64; 4],
    pub(super) stage: Stage,
}

impl<'a> Trajectory<'a> {
    /// The start of a task, with rigid impacts or with a contact. Impacts count as rest below the speed at
    /// which a bounce is as high as the integrator's error, 1 mm times its relative tolerance.
    pub fn new(
        task: &'a Task,
        spring: Option<Spring>,
        kind: IntegratorKind,
        locate: Locate,
    ) -> Trajectory<'a> {
        Trajectory {
            system: System { task, spring },
            kind,
            locate,
            rest_speed: if task.rests { (0.02 * kind.relative()).sqrt() } else { f64::NEG_INFINITY },
            left: task.most,
            log: Log::default(),
            t: 0.0,
            y: task.start,
            stage: Stage::Apart,
        }
    }

    /// Follows the motion to the end of its stage. Returns which guard fell, when, and the state there;
    /// `None` where the task ends before.
    pub fn next(&mut self) -> Result<Option<(usize, f64, [f64; 4])>, Found> {
        let (system, stage) = (self.system, self.stage);
        let (task, guards) = (system.task, system.guards(stage));
        let f = |t: f64, y: &[f64; 4]| system.rate(stage, t, y);
        let mut stepper = Stepper::new(self.kind, task, f, self.t, self.y);
        while self.t < task.until {
            if self.left == 0 {
                return Err(task.stalled(self.t));
            }
            self.left -= 1;
            // The holding force varies with the excitation: its sign is tested at least eight times a cycle.
            let longest = if stage == Stage::Together { task.cycle() / 8.0 } else { f64::INFINITY };
            let step = stepper.step(f, task.until.min(self.t + longest))?;
            let fallen = guards.iter().flatten().enumerate().filter_map(|(which, guard)| {
                let at = match (self.locate, guard) {
                    (Locate::Dense | Locate::Summed, Guard::Linear(w, offset)) => step.first_fall(w, *offset),
                    _ => step.crossing(f, guard.value(task, self.t, &self.y), |t, y| guard.value(task, t, y)),
                };
                Some((which, at?))
            });
            if let Some((which, at)) = fallen.min_by(|a, b| a.1.total_cmp(&b.1)) {
                return Ok(Some((which, step.start + at, step.at(f, at))));
            }
            (self.t, self.y) = (step.start + step.duration, step.end);
        }
        Ok(None)
    }

    /// Logs the contact since the last impact, which ends at `until` in s, as a rest if it was long enough.
    fn log_rest(&mut self, until: f64) {
        let last = self.log.impacts.last();
        self.log.sticks.extend(self.system.spring.zip(last).and_then(|(c, from)| c.rest(from.0, until)));
    }

    /// Whether the masses are apart: the next event is then an impact.
    pub fn apart(&self) -> bool {
        self.stage == Stage::Apart
    }

    /// Goes on to the next stage, after guard `which` has fallen at the time `t` in the state `y`; logs the
    /// impact or rest.
    pub fn meet(&mut self, which: usize, t: f64, mut y: [f64; 4]) {
        let System { task, spring } = self.system;
        self.t = t;
        self.stage = match (self.stage, which) {
            (Stage::Apart, _) if spring.is_some() => {
                self.log.impacts.push((t, y[1] - y[3]));
                Stage::Touching
            }
            (Stage::Apart, _) => {
                let approach = task.collide(&mut y);
                self.log.impacts.push((t, approach));
                let (rig, hold) = (&task.rig, task.hold(t, &y));
                if approach < self.rest_speed && hold > 0.0 {
                    let v = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
                    let apart = y[3] - y[1];
                    y = [y[0], v, y[0] - rig.gap, v];
                    if self.locate == Locate::Summed {
                        let left = 2.0 * apart * rig.reduced_mass() / (hold * (1.0 - rig.restitution));
                        y = rk4(&|t: f64, y: &[f64; 4]| self.system.rate(Stage::Together, t, y), t, &y, left);
                        self.t += left;
                    }
                    self.log.sticks.push([self.t, f64::INFINITY]);
                    Stage::Together
                } else {
                    Stage::Apart
                }
            }
            (Stage::Together, _) => {
                self.log.release(t);
                // The gap opens with the cube of time: events are not looked for during 1e-4 of a cycle,
                // until the gap exceeds rounding.
                let short = 1e-4 * task.cycle();
                y[0] = y[2] + task.rig.gap;
                y = rk4(&|t: f64, y: &[f64; 4]| task.pushed(t, y, 0.0), t, &y, short);
                self.t = t + short;
                Stage::Apart
            }
            (Stage::Touching, _) => Stage::Released,
            (Stage::Released, 0) => {
                self.log_rest(t);
                Stage::Apart
            }
            (Stage::Released, _) => Stage::Touching,
        };
        self.y = y;
    }
}

/// Follows the motion with rigid impacts, or with a contact.
pub fn events(
    task: &Task,
    spring: Option<Spring>,
    kind: IntegratorKind,
    locate: Locate,
) -> Result<Log, Found> {
    let mut course = Trajectory::new(task, spring, kind, locate);
    while let Some((which, t, y)) = course.next()? {
        course.meet(which, t, y);
    }
    if !course.apart() {
        course.log_rest(f64::INFINITY);
    }
    Ok(course.log)
}

/// Integrates through the contacts of a spring that never pulls, with steps from the error control alone;
/// touches are read off afterwards.
pub fn through(task: &Task, kind: IntegratorKind) -> Result<Log, Found> {
    let spring = task.spring();
    let force = |y: &[f64; 4]| if task.gap(y) < 0.0 { spring.bound(task, y).max(0.0) } else { 0.0 };
    let f = |t: f64, y: &[f64; 4]| task.pushed(t, y, force(y));
    let (mut log, mut touch, mut left) = (Log::default(), None, task.most);
    let mut stepper = Stepper::new(kind, task, f, 0.0, task.start);
    let (mut t, mut gap) = (0.0, task.gap(&task.start));
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
            log.impacts.push((step.start + at, y[1] - y[3]));
            touch = Some(step.start + at);
        }
        t = step.start + step.duration;
        let after = task.gap(&step.end);
        if after > 0.0 {
            let parts = step.crossing(f, -gap, |_, y| -task.gap(y)).map_or(t, |at| step.start + at);
            log.sticks.extend(touch.take().and_then(|from| spring.rest(from, parts)));
        }
        gap = after;
    }
    log.sticks.extend(touch.and_then(|from| spring.rest(from, f64::INFINITY)));
    Ok(log)
}
