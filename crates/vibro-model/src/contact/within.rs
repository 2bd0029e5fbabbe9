//! Numerical integration of contacts whose force is not linear.

use crate::flow::State;
use crate::forcing::Forcing;
use crate::law::Law;
use crate::linear::Linear;
use crate::motion::Path;
use crate::rig::Rig;
use vibro_math::runge_kutta::{Dop853, Integrator, Step, Tolerance};
use vibro_record::Result;

/// Error allowed in a step, relative to the state or to its floor, whichever is larger.
const RELATIVE: f64 = 1e-13;

/// Size of the integrated state: two displacements, two velocities, and the impulse since the step's start.
const SIZE: usize = 5;

/// The present contact and its integration.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Within {
    /// `None` where contacts are linear.
    pub law: Option<Law>,
    inverse: [f64; 2],
    gap: f64,
    reduced_mass: f64,
    /// Approach speed in m/s at the start of the contact.
    speed: f64,
    /// Time scale of the contact in s, computed as for a rebound without losses.
    scale: f64,
    /// Step in s that the next integration tries first.
    next: f64,
}

impl Within {
    pub fn new(rig: &Rig, law: Option<Law>, reduced_mass: f64) -> Within {
        let law = law.filter(|law| !law.is_linear());
        let inverse = rig.masses().map(|mass| 1.0 / mass);
        Within { law, inverse, gap: rig.gap, reduced_mass, speed: 0.0, scale: 0.0, next: 0.0 }
    }

    /// Starts a contact with the approach speed `speed` (m/s).
    pub fn begin(&mut self, speed: f64) {
        let (stiffness, exponent) = self.spring();
        // At least 1 nm/s: the speed only scales the step and the errors.
        self.speed = speed.max(1e-9);
        // Time scale T of the speed V: V² = k(VT)^{n+1}/M.
        self.scale = (self.reduced_mass / stiffness).powf(1.0 / (exponent + 1.0))
            * self.speed.powf((1.0 - exponent) / (exponent + 1.0));
        self.next = 1e-3 * self.scale;
    }

    /// Stiffness k and exponent n.
    fn spring(&self) -> (f64, f64) {
        self.law.map_or((0.0, 1.0), |law| (law.stiffness, law.exponent))
    }

    /// Smallest sizes that the relative error refers to: the indentation and the speed of the contact, but at
    /// least X/50 and ωX/50, with X = |x₁| + |x₂| + |Δ| and the contact's angular frequency ω. An indentation
    /// is rounded to εX and a speed to εωX; the error allowed at X/50 and ωX/50 is nine times these.
    fn floor(&self, state: &State) -> [f64; SIZE] {
        let (stiffness, exponent) = self.spring();
        let depth = (state.x1 - state.x2 - self.gap).max(self.speed * self.scale);
        let omega = (exponent * stiffness * depth.powf(exponent - 1.0) / self.reduced_mass).sqrt();
        let size = (state.x1.abs() + state.x2.abs() + self.gap.abs()) / 50.0;
        let (way, speed) = (depth.max(size), self.speed.max(omega * size));
        [way, speed, way, speed, speed * self.reduced_mass]
    }

    /// One step of at most `span` > 0 seconds from `state`; `mode` gives the accelerations without the
    /// contact. The last component is the impulse of the contact in N s since the start of the step.
    pub fn step(&mut self, mode: &Linear, drive: &Forcing, state: &State, span: f64) -> Result<Step<SIZE>> {
        let law = self.law;
        let [inverse1, inverse2] = self.inverse;
        let gap = self.gap;
        let rate = |t: f64, y: &[f64; SIZE]| {
            let state = State { x1: y[0], v1: y[1], x2: y[2], v2: y[3] };
            let push = law.map_or(0.0, |law| law.force(y[0] - y[2] - gap, y[1] - y[3]));
            let [a1, a2] = mode.accelerations(&state, drive.force(t));
            [y[1], a1 - push * inverse1, y[3], a2 + push * inverse2, push]
        };
        let tolerance = Tolerance { relative: RELATIVE, floor: self.floor(state) };
        let start = [state.x1, state.v1, state.x2, state.v2, 0.0];
        let mut integrator = Integrator::<Dop853, SIZE>::new(rate, 0.0, start, self.next, tolerance);
        let step = integrator.step(rate, span)?;
        self.next = integrator.next_step();
        Ok(step)
    }

    /// Time in s from the start of the step at which the surfaces separate.
    pub fn first_fall(&self, step: &Step<SIZE>) -> Option<f64> {
        step.first_fall(&[1.0, 0.0, -1.0, 0.0, 0.0], -self.gap)
    }
}

impl Path for Step<SIZE> {
    fn state(&self, t: f64) -> State {
        let [x1, v1, x2, v2, _] = self.at(t);
        State { x1, v1, x2, v2 }
    }
}
