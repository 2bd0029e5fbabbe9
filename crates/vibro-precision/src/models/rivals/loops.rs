//! The loop that everybody writes first: a step, and where the masses overlap after it, the velocities are turned round.

use super::super::task::{Fault, Task, Told};
use super::stepper::rk4;

/// How the loop steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Velocities by Euler's step, displacements by the new velocities.
    Euler,
    /// Runge and Kutta's fourth order.
    Rk4,
}

/// Follows the motion with `n` steps a cycle; an impact is seen at the end of a step in which the masses overlap and approach.
///
/// Where impacts come step after step for twenty steps or more, the masses count as resting against each other.
///
/// # Errors
/// If the budget is spent.
pub(crate) fn marched(task: &Task, kind: Loop, n: f64) -> Result<Told, Fault> {
    let h = task.cycle() / n;
    let steps = (task.until / h).ceil();
    if steps > task.most as f64 {
        return Err(task.stalled(task.most as f64 * h));
    }
    let f = |t: f64, y: &[f64; 4]| task.apart(t, y);
    let (mut y, mut told) = (task.first(), Told::default());
    for i in 0..steps as u64 {
        let t = i as f64 * h;
        y = match kind {
            Loop::Rk4 => rk4(&f, t, &y, h),
            Loop::Euler => {
                let rate = f(t, &y);
                let [v1, v2] = [y[1] + h * rate[1], y[3] + h * rate[3]];
                [y[0] + h * v1, v1, y[2] + h * v2, v2]
            }
        };
        if task.gap(&y) < 0.0 && y[1] > y[3] {
            let approach = task.collide(&mut y);
            told.impacts.push((t + h, approach));
        }
    }
    told.sticks = rests(&told.impacts, h);
    Ok(told)
}

/// Stretches of at least twenty steps `h` without more than four steps from impact to impact.
pub(super) fn rests(impacts: &[(f64, f64)], h: f64) -> Vec<[f64; 2]> {
    let mut rests: Vec<[f64; 2]> = Vec::new();
    for pair in impacts.windows(2) {
        let (from, to) = (pair[0].0, pair[1].0);
        if to - from > 4.5 * h {
            continue;
        }
        match rests.last_mut() {
            Some(rest) if rest[1] == from => rest[1] = to,
            _ => rests.push([from, to]),
        }
    }
    rests.retain(|r| r[1] - r[0] >= 20.0 * h);
    rests
}
