//! Time integrators for comparison: plain loops of fixed steps without event location, as in a first script,
//! Moreau's time stepping, and one interface to integrators of fixed or controlled step size.

use super::super::task::{Log, Task};
use crate::OutcomeWithReason;
use vibro_math::bisected;
use vibro_math::runge_kutta::{Dop853, DormandPrince, Integrator, Step, Tolerance};

/// Values of x₁, v₁, x₂, v₂ in m and m/s below which the error is controlled absolutely: the relative
/// tolerance then refers to these values.
pub(super) const FLOOR: [f64; 4] = [1e-3, 0.05, 1e-3, 0.05];

/// First step in s from the state `y` at `t` (s): a hundredth of a cycle. After a rebound at speed w against
/// a pressing acceleration a it is also at most a tenth of the flight time 2w/a, since a sign test misses a
/// flight that ends within its first step.
pub(super) fn first_step(task: &Task, t: f64, y: &[f64; 4]) -> f64 {
    let (rebound, pressing) = (y[3] - y[1], task.holding_force(t, y) / task.rig.reduced_mass());
    let flight = if rebound > 0.0 && pressing > 0.0 { 2.0 * rebound / pressing } else { f64::INFINITY };
    (task.cycle() / 100.0).min(flight / 10.0)
}

/// An integrator and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntegratorKind {
    /// Classical Runge–Kutta of order 4 with this number of steps per cycle of the excitation.
    Rk4(f64),
    /// Dormand and Prince's order 5 with this relative tolerance.
    Rk45(f64),
    /// Order 8 of Hairer, Nørsett and Wanner with this relative tolerance.
    Dop853(f64),
}

impl IntegratorKind {
    /// Relative tolerance; for fixed steps h, (ωh)⁴ with the angular frequency ω of the excitation, as the
    /// order is 4.
    pub fn relative(self) -> f64 {
        match self {
            IntegratorKind::Rk4(n) => (std::f64::consts::TAU / n).powi(4),
            IntegratorKind::Rk45(r) | IntegratorKind::Dop853(r) => r,
        }
    }
}

/// An integration of the rig's motion.
pub enum Stepper {
    /// Order 4 with fixed steps: time in s, state, step size in s.
    Fixed(f64, [f64; 4], f64),
    /// Order 5.
    Five(Integrator<DormandPrince, 4>),
    /// Order 8.
    Eight(Integrator<Dop853, 4>),
}

/// One step of an integration.
pub struct SolverStep {
    /// Time in s at the start of the step.
    pub start: f64,
    /// Step size in s.
    pub duration: f64,
    /// State at the end of the step.
    pub end: [f64; 4],
    /// State at the start of the step, for steps without dense output.
    from: [f64; 4],
    /// Step with dense output; `None` for order 4.
    dense: Option<Step<4>>,
}

impl Stepper {
    /// Starts at the time `t` (s) in the state `y`; below [`FLOOR`] errors are controlled absolutely.
    pub fn new(
        kind: IntegratorKind,
        task: &Task,
        f: impl Fn(f64, &[f64; 4]) -> [f64; 4],
        t: f64,
        y: [f64; 4],
    ) -> Stepper {
        let (first, tolerance) =
            (first_step(task, t, &y), Tolerance { relative: kind.relative(), floor: FLOOR });
        match kind {
            IntegratorKind::Rk4(n) => Stepper::Fixed(t, y, task.cycle() / n),
            IntegratorKind::Rk45(_) => Stepper::Five(Integrator::new(f, t, y, first, tolerance)),
            IntegratorKind::Dop853(_) => Stepper::Eight(Integrator::new(f, t, y, first, tolerance)),
        }
    }

    /// Takes one step, at most to the time `until` (s).
    pub fn step(
        &mut self,
        f: impl Fn(f64, &[f64; 4]) -> [f64; 4],
        until: f64,
    ) -> Result<SolverStep, OutcomeWithReason> {
        let step = match self {
            Stepper::Fixed(t, y, h) => {
                let (start, from, duration) = (*t, *y, h.min(until - *t));
                (*t, *y) =
                    (if duration < *h { until } else { start + duration }, rk4(&f, start, y, duration));
                return Ok(SolverStep { start, duration, end: *y, from, dense: None });
            }
            Stepper::Five(integrator) => integrator.step(f, until)?,
            Stepper::Eight(integrator) => integrator.step(f, until)?,
        };
        let Step { start, duration, end, .. } = step;
        Ok(SolverStep { start, duration, end, from: end, dense: Some(step) })
    }
}

impl SolverStep {
    /// State at `t` (s) after the start of the step.
    pub fn at(&self, f: impl Fn(f64, &[f64; 4]) -> [f64; 4], t: f64) -> [f64; 4] {
        self.dense.as_ref().map_or_else(|| rk4(&f, self.start, &self.from, t), |step| step.at(t))
    }

    /// First time in s after the start at which weights·y + offset falls to zero. The value at the start must
    /// not be negative. `None` if it does not fall to zero, or without dense output.
    pub fn first_fall(&self, weights: &[f64; 4], offset: f64) -> Option<f64> {
        self.dense.as_ref()?.first_fall(weights, offset)
    }

    /// Time in s after the start of the step at which `height` falls to zero, by bisection. `initial` is the
    /// height at the start; `None` if it is negative or the height at the end is positive.
    pub fn crossing(
        &self,
        f: impl Fn(f64, &[f64; 4]) -> [f64; 4],
        initial: f64,
        height: impl Fn(f64, &[f64; 4]) -> f64,
    ) -> Option<f64> {
        if !(initial >= 0.0 && height(self.start + self.duration, &self.end) <= 0.0) {
            return None;
        }
        let is_positive = |t| height(self.start + t, &self.at(&f, t)) > 0.0;
        Some(bisected(0.0, self.duration, 60, is_positive).1)
    }
}

/// One step of size `h` (s) of the classical Runge–Kutta method of order 4 for y′ = f(t, y).
#[inline]
pub(super) fn rk4(f: &impl Fn(f64, &[f64; 4]) -> [f64; 4], t: f64, y: &[f64; 4], h: f64) -> [f64; 4] {
    let moved = |k: &[f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let a = f(t, y);
    let b = f(t + h / 2.0, &moved(&a, h / 2.0));
    let c = f(t + h / 2.0, &moved(&b, h / 2.0));
    let d = f(t + h, &moved(&c, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
}

/// One step of a plain loop, from time (s), state and step size (s). Returns the state at the end of the
/// step; and time (s) and approach speed (m/s) of an impact in the step, if any.
pub type StepFunction = fn(&Task, f64, &[f64; 4], f64) -> ([f64; 4], Option<(f64, f64)>);

/// Runs a loop of `n` fixed steps per cycle. A run of impacts at most four steps apart that lasts twenty
/// steps or more is logged as a rest of the masses against each other.
pub fn fixed_step_loop(task: &Task, step: StepFunction, n: f64) -> Result<Log, OutcomeWithReason> {
    let h = task.cycle() / n;
    let steps = (task.until / h).ceil();
    if steps > task.most as f64 {
        return Err(task.stalled(task.most as f64 * h));
    }
    let (mut y, mut log) = (task.start, Log::default());
    for i in 0..steps as u64 {
        let (next, impact) = step(task, i as f64 * h, &y, h);
        y = next;
        log.impacts.extend(impact);
    }
    // Joins impacts at most four steps apart to runs, with half a step of tolerance for rounding.
    for pair in log.impacts.windows(2) {
        let (from, to) = (pair[0].0, pair[1].0);
        match log.sticks.last_mut() {
            _ if to - from > 4.5 * h => {}
            Some(rest) if rest[1] == from => rest[1] = to,
            _ => log.sticks.push([from, to]),
        }
    }
    log.sticks.retain(|r| r[1] - r[0] >= 20.0 * h);
    Ok(log)
}

/// Semi-implicit Euler: velocities first, then displacements with the new velocities.
pub fn euler(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    let rate = task.derivative(t, y, 0.0);
    let [v1, v2] = [y[1] + h * rate[1], y[3] + h * rate[3]];
    with_impact(task, t + h, [y[0] + h * v1, v1, y[2] + h * v2, v2])
}

/// Classical Runge–Kutta of order 4.
pub fn classical(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    with_impact(task, t + h, rk4(&|t: f64, y: &[f64; 4]| task.derivative(t, y, 0.0), t, y, h))
}

/// Applies the impact law at the end of a step, the time `t`, if the masses overlap and approach. Returns the
/// state, and time (s) and approach speed (m/s) of the impact.
fn with_impact(task: &Task, t: f64, mut y: [f64; 4]) -> ([f64; 4], Option<(f64, f64)>) {
    let impact = (task.gap(&y) < 0.0 && y[1] > y[3]).then(|| (t, task.collide(&mut y)));
    (y, impact)
}

/// Moreau's midpoint scheme (J. J. Moreau, 1999, *Comput. Methods Appl. Mech. Eng.* 177, 329): half a step of
/// the displacements, the whole step of the velocities, the other half of the displacements. Where the masses
/// overlap at the midpoint, an impulse makes them part at R times the approach speed.
pub fn moreau(task: &Task, t: f64, y: &[f64; 4], h: f64) -> ([f64; 4], Option<(f64, f64)>) {
    let (rig, middle) = (&task.rig, t + h / 2.0);
    let (x1, x2) = (y[0] + h / 2.0 * y[1], y[2] + h / 2.0 * y[3]);
    let rate = task.derivative(middle, &[x1, y[1], x2, y[3]], 0.0);
    let (v1, v2, before) = (y[1] + h * rate[1], y[3] + h * rate[3], y[1] - y[3]);
    // The approach speed u after the step is at most −R times that before it; the impulse is not negative.
    let needed = rig.reduced_mass() * (v1 - v2 + rig.restitution * before);
    let impulse = if rig.gap + x2 - x1 <= 0.0 { needed.max(0.0) } else { 0.0 };
    let (v1, v2) = (v1 - impulse / rig.m1, v2 + impulse / rig.m2);
    let end = [x1 + h / 2.0 * v1, v1, x2 + h / 2.0 * v2, v2];
    (end, (impulse > 0.0).then_some((middle, before)))
}
