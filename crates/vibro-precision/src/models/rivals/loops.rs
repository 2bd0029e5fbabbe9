//! Fixed steps without events: the loop that everybody writes first, and the time stepping of non-smooth dynamics.

use super::super::task::{Task, Told};
use super::stepper::rk4;
use crate::failure::Found;

/// A step that starts at time and state, of so many seconds: the state at its end, and time and approach speed of an impact in it.
pub type Stride = fn(&Task, f64, &[f64; 4], f64) -> ([f64; 4], Option<(f64, f64)>);

/// Follows the motion with `n` strides a cycle. Where impacts come step after step for twenty steps or more, the masses count as
/// resting against each other.
pub fn marched(task: &Task, stride: Stride, n: f64) -> Result<Told, Found> {
    let h = task.cycle() / n;
    let steps = (task.until / h).ceil();
    if steps > task.most as f64 {
        return Err(task.stalled(task.most as f64 * h));
    }
    let (mut y, mut told) = (task.start, Told::default());
    for i in 0..steps as u64 {
        let (next, impact) = stride(task, i as f64 * h, &y, h);
        y = next;
        told.impacts.extend(impact);
    }
    // Stretches without more than four steps from impact to impact.
    for pair in told.impacts.windows(2) {
        let (from, to) = (pair[0].0, pair[1].0);
        match told.sticks.last_mut() {
            _ if to - from > 4.5 * h => {}
            Some(rest) if rest[1] == from => rest[1] = to,
            _ => told.sticks.push([from, to]),
        }
    }
    told.sticks.retain(|r| r[1] - r[0] >= 20.0 * h);
    Ok(told)
}

/// Velocities by Euler's step, displacements by the new velocities.
pub fn euler(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    let rate = task.pushed(t, y, 0.0);
    let [v1, v2] = [y[1] + h * rate[1], y[3] + h * rate[3]];
    turned(task, t + h, [y[0] + h * v1, v1, y[2] + h * v2, v2])
}

/// Runge and Kutta's fourth order.
pub fn classical(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    turned(task, t + h, rk4(&|t: f64, y: &[f64; 4]| task.pushed(t, y, 0.0), t, y, h))
}

/// Velocities turned round where the masses overlap and approach at the end of a step.
fn turned(task: &Task, t: f64, mut y: [f64; 4]) -> ([f64; 4], Option<(f64, f64)>) {
    let impact = (task.gap(&y) < 0.0 && y[1] > y[3]).then(|| (t, task.collide(&mut y)));
    (y, impact)
}

/// Moreau's midpoint scheme (J. J. Moreau, 1999, *Comput. Methods Appl. Mech. Eng.* 177, 329): half a step of the displacements, then
/// the velocities of the whole step with an impulse where the masses overlap there, so large that they part with R times what they
/// approached by, then the other half.
pub fn moreau(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    let (rig, middle) = (&task.rig, t + h / 2.0);
    let (x1, x2) = (y[0] + h / 2.0 * y[1], y[2] + h / 2.0 * y[3]);
    let rate = task.pushed(middle, &[x1, y[1], x2, y[3]], 0.0);
    let (v1, v2, before) = (y[1] + h * rate[1], y[3] + h * rate[3], y[1] - y[3]);
    // u⁺ ≥ −R u⁻, u being the speed of approach, and the impulse not below zero.
    let needed = rig.reduced_mass() * (v1 - v2 + rig.restitution * before);
    let impulse = if rig.gap + x2 - x1 <= 0.0 { needed.max(0.0) } else { 0.0 };
    let (v1, v2) = (v1 - impulse / rig.m1, v2 + impulse / rig.m2);
    let end = [x1 + h / 2.0 * v1, v1, x2 + h / 2.0 * v2, v2];
    (end, (impulse > 0.0).then_some((middle, before)))
}
