//! Time stepping without events, as non-smooth dynamics does it.

use super::super::task::{Fault, Task, Told};
use super::loops::rests;

/// Moreau's midpoint scheme (J. J. Moreau, 1999, *Comput. Methods Appl. Mech. Eng.* 177, 329) with `n` steps a cycle: half a
/// step of the displacements, then the velocities of the whole step with an impulse where the masses overlap there, so large
/// that they part with R times what they approached by, then the other half.
///
/// # Errors
/// If the budget is spent.
pub(crate) fn moreau(task: &Task, n: f64) -> Result<Told, Fault> {
    let h = task.cycle() / n;
    let steps = (task.until / h).ceil();
    if steps > task.most as f64 {
        return Err(task.stalled(task.most as f64 * h));
    }
    let rig = &task.rig;
    let (mut y, mut told) = (task.first(), Told::default());
    for i in 0..steps as u64 {
        let middle = (i as f64 + 0.5) * h;
        let (x1, x2) = (y[0] + h / 2.0 * y[1], y[2] + h / 2.0 * y[3]);
        let rate = task.apart(middle, &[x1, y[1], x2, y[3]]);
        let (mut v1, mut v2) = (y[1] + h * rate[1], y[3] + h * rate[3]);
        if rig.gap + x2 - x1 <= 0.0 {
            // u⁺ ≥ −R u⁻, u being the speed of approach, and the impulse not below zero.
            let before = y[1] - y[3];
            let impulse = rig.reduced_mass() * (v1 - v2 + rig.restitution * before);
            if impulse > 0.0 {
                v1 -= impulse / rig.m1;
                v2 += impulse / rig.m2;
                told.impacts.push((middle, before));
            }
        }
        y = [x1 + h / 2.0 * v1, v1, x2 + h / 2.0 * v2, v2];
    }
    told.sticks = rests(&told.impacts, h);
    Ok(told)
}
