//! Steps of a fixed or a controlled size behind one face.

use super::super::task::{Fault, Task};
use vibro_math::runge_kutta::{Dop853, DormandPrince, Integrator, Step, Tolerance};

/// Displacements in m and speeds in m/s below which errors are not counted against the state itself.
pub(super) const FLOOR: [f64; 4] = [1e-3, 0.05, 1e-3, 0.05];

/// First step in s from `y` at `t`: a hundredth of a cycle, behind an impact that is followed by another no more than a tenth of the
/// flight 2w/a, since a sign test does not see a flight that ends within its first step.
pub(super) fn first_step(task: &Task, t: f64, y: &[f64; 4]) -> f64 {
    let (apart, pressed) = (y[3] - y[1], task.hold(t, y) / task.rig.reduced_mass());
    let flight = if apart > 0.0 && pressed > 0.0 { 2.0 * apart / pressed } else { f64::INFINITY };
    (task.cycle() / 100.0).min(flight / 10.0)
}

/// An integrator and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Runge and Kutta's four stages, so many steps a cycle of the excitation.
    Rk4(f64),
    /// Dormand and Prince's order 5 with this relative tolerance.
    Rk45(f64),
    /// Order 8 of Hairer, Nørsett and Wanner with this relative tolerance.
    Dop853(f64),
}

impl Kind {
    /// Its setting in words.
    pub fn setting(self) -> String {
        match self {
            Kind::Rk4(n) => format!("{n} steps a cycle"),
            Kind::Rk45(r) | Kind::Dop853(r) => format!("tolerance {r:.0e}"),
        }
    }

    /// Its relative tolerance; of fixed steps, what a step of order 4 leaves.
    pub fn relative(self) -> f64 {
        match self {
            Kind::Rk4(n) => (std::f64::consts::TAU / n).powi(4).max(1e-14),
            Kind::Rk45(r) | Kind::Dop853(r) => r,
        }
    }
}

/// An integration of the rig's motion.
#[derive(Debug, Clone)]
pub enum Stepper {
    /// Time, state, size of a step.
    Fixed(f64, [f64; 4], f64),
    /// Order 5.
    Five(Integrator<DormandPrince, 4>),
    /// Order 8.
    Eight(Integrator<Dop853, 4>),
}

/// One step.
#[derive(Debug, Clone, Copy)]
#[allow(clippy::large_enum_variant)]
pub enum Taken {
    /// Start, state there, size, state at the end.
    Fixed(f64, [f64; 4], f64, [f64; 4]),
    /// With dense output.
    Dense(Step<4>),
}

impl Stepper {
    /// Starts at `t` with `y`; errors of the state count against [`FLOOR`] where it is smaller than that.
    pub fn new<F: Fn(f64, &[f64; 4]) -> [f64; 4]>(
        kind: Kind,
        task: &Task,
        f: F,
        t: f64,
        y: [f64; 4],
    ) -> Stepper {
        let (floor, first) = (FLOOR, first_step(task, t, &y));
        match kind {
            Kind::Rk4(n) => Stepper::Fixed(t, y, task.cycle() / n),
            Kind::Rk45(relative) => {
                Stepper::Five(Integrator::new(f, t, y, first, Tolerance { relative, floor }))
            }
            Kind::Dop853(relative) => {
                Stepper::Eight(Integrator::new(f, t, y, first, Tolerance { relative, floor }))
            }
        }
    }

    /// One step, at most to `until`.
    pub fn step<F: Fn(f64, &[f64; 4]) -> [f64; 4]>(&mut self, f: F, until: f64) -> Result<Taken, Fault> {
        Ok(match self {
            Stepper::Fixed(t, y, h) => {
                let step = h.min(until - *t);
                let taken = Taken::Fixed(*t, *y, step, rk4(&f, *t, y, step));
                (*t, *y) = (if step < *h { until } else { *t + step }, taken.end());
                taken
            }
            Stepper::Five(integrator) => Taken::Dense(integrator.step(f, until)?),
            Stepper::Eight(integrator) => Taken::Dense(integrator.step(f, until)?),
        })
    }
}

impl Taken {
    /// Time of its start.
    pub fn start(&self) -> f64 {
        match self {
            Taken::Fixed(t, ..) => *t,
            Taken::Dense(step) => step.start,
        }
    }

    /// Its size in s.
    pub fn duration(&self) -> f64 {
        match self {
            Taken::Fixed(_, _, h, _) => *h,
            Taken::Dense(step) => step.duration,
        }
    }

    /// State at its end.
    pub fn end(&self) -> [f64; 4] {
        match self {
            Taken::Fixed(.., end) => *end,
            Taken::Dense(step) => step.end,
        }
    }

    /// State at `t` after its start.
    pub fn at<F: Fn(f64, &[f64; 4]) -> [f64; 4]>(&self, f: F, t: f64) -> [f64; 4] {
        match self {
            Taken::Fixed(start, y, ..) => rk4(&f, *start, y, t),
            Taken::Dense(step) => step.at(t),
        }
    }

    /// Where `height`, not negative at the start, is zero if it is not positive at the end: a sign test and halving.
    pub fn crossing<F: Fn(f64, &[f64; 4]) -> [f64; 4]>(
        &self,
        f: F,
        start: f64,
        height: impl Fn(f64, &[f64; 4]) -> f64,
    ) -> Option<f64> {
        if !(start >= 0.0 && height(self.start() + self.duration(), &self.end()) <= 0.0) {
            return None;
        }
        let (mut low, mut high) = (0.0, self.duration());
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                break;
            }
            if height(self.start() + middle, &self.at(&f, middle)) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high)
    }
}

/// One step of the classical fourth order.
#[inline]
pub(super) fn rk4<F: Fn(f64, &[f64; 4]) -> [f64; 4]>(f: &F, t: f64, y: &[f64; 4], h: f64) -> [f64; 4] {
    let to = |k: &[f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let a = f(t, y);
    let b = f(t + h / 2.0, &to(&a, h / 2.0));
    let c = f(t + h / 2.0, &to(&b, h / 2.0));
    let d = f(t + h, &to(&c, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
}
