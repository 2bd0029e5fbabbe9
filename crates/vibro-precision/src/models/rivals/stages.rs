//! Integration from event to event. Each impact, end of a contact and end of a rest is located, and the
//! integration starts again after each.

use super::super::task::{Log, Spring, Task};
use super::stepper::{IntegratorKind, Stepper, rk4};
use crate::OutcomeWithReason;

/// Stage of a motion between two events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// Not in contact.
    Apart,
    /// At rest against each other.
    Together,
    /// Pushed apart by spring and damper of the contact.
    Touching,
    /// After the contact force has fallen to zero. Spring and damper would pull, so the masses move without
    /// contact force while they still overlap.
    Released,
}

/// A function of time and state that ends a stage when it falls to zero.
#[derive(Debug, Clone, Copy)]
pub(super) enum Guard {
    /// weights·y + offset, with the weights and the offset.
    Linear([f64; 4], f64),
    /// The contact force that keeps the masses together, [`Task::holding_force`].
    HoldingForce,
}

impl Guard {
    /// Value of the function at the time `t` in the state `y`.
    pub fn value(&self, task: &Task, t: f64, y: &[f64; 4]) -> f64 {
        match self {
            Guard::Linear(w, offset) => w.iter().zip(y).map(|(w, y)| w * y).sum::<f64>() + offset,
            Guard::HoldingForce => task.holding_force(t, y),
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
            (Stage::Touching, Some(spring)) => spring.bilateral_force(self.task, y),
            (Stage::Together, _) => self.task.holding_force(t, y),
            _ => 0.0,
        };
        self.task.derivative(t, y, push)
    }

    /// The functions that can end a stage; the first to fall to zero ends it.
    pub fn guards(&self, stage: Stage) -> [Option<Guard>; 2] {
        let gap = self.task.rig.gap;
        let (k, c) = self.spring.map_or((0.0, 0.0), |s| (s.stiffness, s.damping));
        match stage {
            Stage::Apart => [Some(Guard::Linear([-1.0, 0.0, 1.0, 0.0], gap)), None],
            Stage::Together => [Some(Guard::HoldingForce), None],
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
    /// A change of sign between the ends of a step, then bisection, as in the usual packages.
    Ends,
    /// The first root of the dense output. No root is missed.
    Dense,
    /// As `Dense`, and a chatter that ends in rest is cut short: its last flights, from the separation speed
    /// w against the pressing acceleration a, are summed as a geometric series of duration 2w/(a(1 − R)).
    Summed,
}

/// A motion that is followed from event to event, with its log and its present state.
pub struct Trajectory<'a> {
    pub(super) system: System<'a>,
    kind: IntegratorKind,
    locate: Locate,
    /// Approach speed in m/s below which masses that press each other stay together.
    rest_speed: f64,
    /// Number of steps that may still be taken.
    steps_left: u64,
    pub log: Log,
    pub t: f64,
    pub(super) y: [f64; 4],
    pub(super) stage: Stage,
}

impl<'a> Trajectory<'a> {
    /// The start of a task, with rigid impacts or with a contact. Impacts count as rest below the speed
    /// √(2gh) at which a bounce is as high as the integrator's error h, 1 mm times its relative tolerance, at
    /// g = 10 m/s².
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
            steps_left: task.most,
            log: Log::default(),
            t: 0.0,
            y: task.start,
            stage: Stage::Apart,
        }
    }

    /// Follows the motion to the next event, the end of its stage. Returns the number of the guard that fell
    /// to zero, the time in s and the state; `None` if the task ends before.
    pub fn next(&mut self) -> Result<Option<(usize, f64, [f64; 4])>, OutcomeWithReason> {
        let (system, stage) = (self.system, self.stage);
        let (task, guards) = (system.task, system.guards(stage));
        let f = |t: f64, y: &[f64; 4]| system.rate(stage, t, y);
        let mut stepper = Stepper::new(self.kind, task, f, self.t, self.y);
        while self.t < task.until {
            if self.steps_left == 0 {
                return Err(task.stalled(self.t));
            }
            self.steps_left -= 1;
            // The holding force varies with the excitation: its sign is tested at least eight times a cycle.
            let longest = if stage == Stage::Together { task.cycle() / 8.0 } else { f64::INFINITY };
            let step = stepper.step(f, task.until.min(self.t + longest))?;
            let events = guards.iter().flatten().enumerate().filter_map(|(which, guard)| {
                let at = match (self.locate, guard) {
                    (Locate::Dense | Locate::Summed, Guard::Linear(w, offset)) => step.first_fall(w, *offset),
                    _ => step.crossing(f, guard.value(task, self.t, &self.y), |t, y| guard.value(task, t, y)),
                };
                Some((which, at?))
            });
            if let Some((which, at)) = events.min_by(|a, b| a.1.total_cmp(&b.1)) {
                return Ok(Some((which, step.start + at, step.at(f, at))));
            }
            (self.t, self.y) = (step.start + step.duration, step.end);
        }
        Ok(None)
    }

    /// Logs the contact from the last impact to `until` (s) as a rest if long enough ([`Spring::rest`]).
    fn log_rest(&mut self, until: f64) {
        let last = self.log.impacts.last();
        self.log.sticks.extend(self.system.spring.zip(last).and_then(|(c, from)| c.rest(from.0, until)));
    }

    /// Whether the masses are apart: the next event is then an impact.
    pub fn is_apart(&self) -> bool {
        self.stage == Stage::Apart
    }

    /// Begins the next stage after guard number `which` has fallen to zero at the time `t` (s) in the state
    /// `y`: applies the impact law, if any, and logs the impact or rest.
    pub fn apply_event(&mut self, which: usize, t: f64, mut y: [f64; 4]) {
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
                let (rig, holding_force) = (&task.rig, task.holding_force(t, &y));
                if approach < self.rest_speed && holding_force > 0.0 {
                    let v = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
                    let separation = y[3] - y[1];
                    y = [y[0], v, y[0] - rig.gap, v];
                    if self.locate == Locate::Summed {
                        let chatter =
                            2.0 * separation * rig.reduced_mass() / (holding_force * (1.0 - rig.restitution));
                        y = rk4(
                            &|t: f64, y: &[f64; 4]| self.system.rate(Stage::Together, t, y),
                            t,
                            &y,
                            chatter,
                        );
                        self.t += chatter;
                    }
                    self.log.sticks.push([self.t, f64::INFINITY]);
                    Stage::Together
                } else {
                    Stage::Apart
                }
            }
            (Stage::Together, _) => {
                self.log.release(t);
                // The gap opens with the cube of time and is first below rounding. So no event is searched
                // during the first 1e-4 of a cycle.
                let skipped = 1e-4 * task.cycle();
                y[0] = y[2] + task.rig.gap;
                y = rk4(&|t: f64, y: &[f64; 4]| task.derivative(t, y, 0.0), t, &y, skipped);
                self.t = t + skipped;
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
) -> Result<Log, OutcomeWithReason> {
    let mut trajectory = Trajectory::new(task, spring, kind, locate);
    while let Some((which, t, y)) = trajectory.next()? {
        trajectory.apply_event(which, t, y);
    }
    if !trajectory.is_apart() {
        trajectory.log_rest(f64::INFINITY);
    }
    Ok(trajectory.log)
}

/// Integrates through the contacts of a spring that never pulls, with steps from the error control alone: no
/// step ends at an event. Times of touch and parting are located within the steps afterwards.
pub fn through(task: &Task, kind: IntegratorKind) -> Result<Log, OutcomeWithReason> {
    let spring = task.spring();
    let force = |y: &[f64; 4]| if task.gap(y) < 0.0 { spring.bilateral_force(task, y).max(0.0) } else { 0.0 };
    let f = |t: f64, y: &[f64; 4]| task.derivative(t, y, force(y));
    let (mut log, mut touch, mut steps_left) = (Log::default(), None, task.most);
    let mut stepper = Stepper::new(kind, task, f, 0.0, task.start);
    let (mut t, mut gap) = (0.0, task.gap(&task.start));
    while t < task.until {
        if steps_left == 0 {
            return Err(task.stalled(t));
        }
        steps_left -= 1;
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
