//! The task of a method (a rig, its excitation, a start and an end), and the log that it returns.

use crate::{Outcome, OutcomeWithReason};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vibro_model::Rig;
use vibro_model::contact::conversion::damping_ratio;

/// A motion to be followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// The rig.
    pub rig: Rig,
    /// Force amplitude in N.
    pub force: f64,
    /// Frequency at time 0 in Hz.
    pub frequency: f64,
    /// Rate of the frequency in Hz/s.
    pub rate: f64,
    /// Phase at time 0 in rad: the force is F₀ cos(phase) there.
    pub phase: f64,
    /// State (x₁, v₁, x₂, v₂) at time 0.
    pub start: [f64; 4],
    /// Stiffness of the contact in N/m, for methods with a soft contact.
    pub stiffness: f64,
    /// Time in s at which the motion ends.
    pub until: f64,
    /// Most steps that a method may take before it counts as stalled.
    pub most: u64,
    /// Whether methods with events let the masses rest against each other after an impact slower than their
    /// tolerance resolves, if the masses press each other.
    pub rests: bool,
}

/// Impacts and rests of a motion, as a method reports them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// Time in s and approach speed in m/s of each impact.
    pub impacts: Vec<(f64, f64)>,
    /// Start and end in s of each rest of the masses against each other; the end is ∞ where they do not part.
    pub sticks: Vec<[f64; 2]>,
}

impl Log {
    /// Impacts without rests.
    pub fn of(impacts: impl IntoIterator<Item = (f64, f64)>) -> Log {
        Log { impacts: impacts.into_iter().collect(), sticks: Vec::new() }
    }

    /// Sets the end of the last rest to `time` (s).
    pub fn release(&mut self, time: f64) {
        if let Some(rest) = self.sticks.last_mut() {
            rest[1] = time;
        }
    }
}

/// A contact spring k₃ with its damper c₃.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// c₃ in N s/m.
    pub damping: f64,
    /// Duration in s of a contact of the spring without damper and other forces, π√(M/k₃).
    pub undamped_duration: f64,
}

/// A contact longer than this multiple of a contact of the undamped spring alone counts as rest.
const LEAST_REST_RATIO: f64 = 10.0;

impl Spring {
    /// A spring whose damper gives the restitution of the rig. R = 0 needs an infinite damper: critical
    /// damping is used, as is usual, which rebounds with e⁻².
    pub fn new(rig: &Rig, stiffness: f64) -> Spring {
        let mass = rig.reduced_mass();
        let ratio = damping_ratio(rig.restitution).unwrap_or(1.0);
        let damping = 2.0 * ratio * (stiffness * mass).sqrt();
        Spring { stiffness, damping, undamped_duration: PI * (mass / stiffness).sqrt() }
    }

    /// Force in N of spring and damper in the state `y`, as if fastened to both masses: negative where it
    /// pulls.
    pub fn bilateral_force(&self, task: &Task, y: &[f64; 4]) -> f64 {
        -self.stiffness * task.gap(y) + self.damping * (y[1] - y[3])
    }

    /// The contact between these times in s as a rest, if longer than [`LEAST_REST_RATIO`] states.
    pub fn rest(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        (to - from > LEAST_REST_RATIO * self.undamped_duration).then_some([from, to])
    }
}

impl Task {
    /// A motion under F₀ sin ωt from rest; at most twenty million steps, and a soft contact of 1e6 N/m.
    pub fn sine(rig: Rig, force: f64, frequency: f64, until: f64) -> Task {
        Task {
            rig,
            force,
            frequency,
            rate: 0.0,
            phase: -FRAC_PI_2,
            start: [0.0; 4],
            stiffness: 1e6,
            until,
            most: 20_000_000,
            rests: false,
        }
    }

    /// The contact of the task's stiffness with the restitution of the rig.
    pub fn spring(&self) -> Spring {
        Spring::new(&self.rig, self.stiffness)
    }

    /// Duration of a cycle at time 0 in s.
    pub fn cycle(&self) -> f64 {
        1.0 / self.frequency
    }

    /// Time derivative of the state (x₁, v₁, x₂, v₂) at the time `t` (s), with the contact force `contact` in
    /// N between the masses, positive in compression.
    #[inline]
    pub fn derivative(&self, t: f64, y: &[f64; 4], contact: f64) -> [f64; 4] {
        let rig = &self.rig;
        let drive = self.force * (TAU * t * (self.frequency + self.rate / 2.0 * t) + self.phase).cos();
        [
            y[1],
            (drive - rig.c1 * y[1] - rig.k1 * y[0] - contact) / rig.m1,
            y[3],
            (contact - rig.c2 * y[3] - rig.k2 * y[2]) / rig.m2,
        ]
    }

    /// Contact force in N at which the relative acceleration of the masses vanishes, so that they stay in
    /// contact; negative where the contact would have to pull.
    pub fn holding_force(&self, t: f64, y: &[f64; 4]) -> f64 {
        let [_, first, _, second] = self.derivative(t, y, 0.0);
        self.rig.reduced_mass() * (first - second)
    }

    /// Gap in m; negative where the masses overlap.
    #[inline]
    pub fn gap(&self, y: &[f64; 4]) -> f64 {
        self.rig.gap + y[2] - y[0]
    }

    /// Exchanges momentum by the impact law; returns the approach speed in m/s.
    #[inline]
    pub fn collide(&self, y: &mut [f64; 4]) -> f64 {
        let approach = y[1] - y[3];
        let impulse = self.rig.exchange() * approach;
        y[1] -= impulse / self.rig.m1;
        y[3] += impulse / self.rig.m2;
        approach
    }

    /// The outcome of a method whose step limit is reached at the time `t` (s).
    pub fn stalled(&self, t: f64) -> OutcomeWithReason {
        let why = format!("{} steps are spent at {t:.6} s of {:.6} s", self.most, self.until);
        OutcomeWithReason::new(Outcome::Stalled, why)
    }
}
