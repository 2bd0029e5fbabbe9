//! A spring and damper in place of the impact: integrated straight through, or from touch to parting.

use super::super::task::{Fault, Task, Told};
use super::{Kind, Stepper, Taken};

/// A contact spring k₃ with its damper c₃.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// c₃ in N s/m.
    pub damping: f64,
}

/// A contact that lasts so many times as long as that of the spring alone, π√(M/k₃), counts as rest.
const RESTS: f64 = 10.0;

impl Spring {
    /// Force in N of spring and damper alone, which may pull.
    pub(super) fn bound(&self, task: &Task, y: &[f64; 4]) -> f64 {
        -self.stiffness * task.gap(y) + self.damping * (y[1] - y[3])
    }

    /// The rest in a contact between these times in s, if it lasts long enough to be one.
    pub fn rest(&self, task: &Task, from: f64, to: f64) -> Option<[f64; 2]> {
        let alone = std::f64::consts::PI * (task.rig.reduced_mass() / self.stiffness).sqrt();
        (to - from > RESTS * alone).then_some([from, to])
    }

    /// Force in N, never pulling.
    fn force(&self, task: &Task, y: &[f64; 4]) -> f64 {
        if task.gap(y) < 0.0 { self.bound(task, y).max(0.0) } else { 0.0 }
    }
}

/// Integrates straight through contacts, step sizes left to the error control; touches are read off afterwards.
///
/// # Errors
/// If the budget is spent or no step is small enough.
pub fn penalty(task: &Task, spring: &Spring, kind: Kind) -> Result<Told, Fault> {
    let f = |t: f64, y: &[f64; 4]| task.pushed(t, y, spring.force(task, y));
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
            told.impacts.push((step.start() + at, y[1] - y[3]));
            touch = Some(step.start() + at);
        }
        let after = task.gap(&step.end());
        t = step.start() + step.duration();
        if let Some(from) = touch.filter(|_| after > 0.0 || t >= task.until) {
            let parts = step.crossing(f, -gap, |_, y| -task.gap(y)).map_or(t, |at| step.start() + at);
            told.sticks.extend(spring.rest(task, from, if after > 0.0 { parts } else { f64::INFINITY }));
            touch = None;
        }
        gap = after;
    }
    Ok(told)
}

/// Where a contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Apart,
    Touching,
    /// The force is zero, the surfaces are not yet back at their rest.
    Released,
}

/// Integrates from touch to the end of the force to parting, each located on the dense output: every piece is smooth.
///
/// # Errors
/// If the budget is spent, no step is small enough, or the steps have no dense output.
pub(crate) fn sprung(task: &Task, spring: &Spring, kind: Kind) -> Result<Told, Fault> {
    let (k, c, gap) = (spring.stiffness, spring.damping, task.rig.gap);
    let pushes = [k, c, -k, -c];
    let negative = |w: [f64; 4]| w.map(|w| -w);
    let opens = [-1.0, 0.0, 1.0, 0.0];
    let (mut t, mut y, mut told, mut left) = (0.0, task.first(), Told::default(), task.most);
    let mut stage = Stage::Apart;
    while t < task.until {
        let f = |t: f64, y: &[f64; 4]| {
            task.pushed(t, y, if stage == Stage::Touching { spring.bound(task, y) } else { 0.0 })
        };
        let mut stepper = Stepper::new(kind, task, f, t, y);
        let mut next = None;
        while next.is_none() && t < task.until {
            if left == 0 {
                return Err(task.stalled(t));
            }
            left -= 1;
            let Taken::Dense(step) = stepper.step(f, task.until)? else {
                return Err(Fault::Refused("these steps have no dense output".to_owned()));
            };
            let fall =
                |weights: [f64; 4], offset: f64, to: Stage| Some((step.first_fall(&weights, offset)?, to));
            let found = match stage {
                Stage::Apart => fall(opens, gap, Stage::Touching),
                Stage::Touching => fall(pushes, -k * gap, Stage::Released),
                Stage::Released => [
                    fall(negative(opens), -gap, Stage::Apart),
                    fall(negative(pushes), k * gap, Stage::Touching),
                ]
                .into_iter()
                .flatten()
                .min_by(|a, b| a.0.total_cmp(&b.0)),
            };
            (t, y) = match found {
                Some((at, to)) => {
                    next = Some(to);
                    (step.start + at, step.at(at))
                }
                None => (step.start + step.duration, step.end),
            };
        }
        if let Some(to) = next {
            if stage == Stage::Apart {
                told.impacts.push((t, y[1] - y[3]));
            }
            stage = to;
        }
    }
    Ok(told)
}
