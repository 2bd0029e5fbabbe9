//! What is asked of a method: a rig, its excitation, a start and an end; and what comes back.

use std::f64::consts::TAU;

use vibro_model::{Rig, State};
use vibro_record::Error;

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
    /// State at time 0.
    pub start: State,
    /// Stiffness in N/m of the contact, for methods that have one.
    pub stiffness: f64,
    /// Time of the end in s.
    pub until: f64,
    /// The most steps that a method may take before it counts as stalled.
    pub most: u64,
}

/// Stiffness of a contact in N/m where it is not what is varied.
const STIFFNESS: f64 = 1e6;

/// What a method tells of a motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// Time in s and approach speed in m/s of each impact.
    pub impacts: Vec<(f64, f64)>,
    /// Times in s at which the masses come to rest against each other and part again; the last may be infinite.
    pub sticks: Vec<[f64; 2]>,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The method says that it cannot, and why.
    Refused(String),
    /// It needs more steps than it may take.
    Stalled(String),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Fault {
        Fault::Refused(error.to_string().replace("\n  try: ", "; try: "))
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Fault::Refused(why) => write!(f, "refused: {why}"),
            Fault::Stalled(why) => write!(f, "stalled: {why}"),
        }
    }
}

impl Task {
    /// A motion under F₀ sin ωt from rest, as [`Task::most`] steps of twenty million allow.
    pub fn sine(rig: Rig, force: f64, frequency: f64, until: f64) -> Task {
        let phase = -std::f64::consts::FRAC_PI_2;
        let (start, most) = (State::REST, 20_000_000);
        Task { rig, force, frequency, rate: 0.0, phase, start, stiffness: STIFFNESS, until, most }
    }

    /// Duration of a cycle at time 0 in s.
    pub fn cycle(&self) -> f64 {
        1.0 / self.frequency
    }

    /// Exciting force in N at `t`.
    #[inline]
    pub fn drive(&self, t: f64) -> f64 {
        self.force * (TAU * t * (self.frequency + self.rate / 2.0 * t) + self.phase).cos()
    }

    /// Rate of the state (x₁, v₁, x₂, v₂) where the masses push each other with `contact` (N).
    #[inline]
    pub fn pushed(&self, t: f64, y: &[f64; 4], contact: f64) -> [f64; 4] {
        let rig = &self.rig;
        [
            y[1],
            (self.drive(t) - rig.c1 * y[1] - rig.k1 * y[0] - contact) / rig.m1,
            y[3],
            (contact - rig.c2 * y[3] - rig.k2 * y[2]) / rig.m2,
        ]
    }

    /// The same where they do not touch.
    #[inline]
    pub fn apart(&self, t: f64, y: &[f64; 4]) -> [f64; 4] {
        self.pushed(t, y, 0.0)
    }

    /// Contact force in N that keeps the masses together.
    pub fn hold(&self, t: f64, y: &[f64; 4]) -> f64 {
        let rig = &self.rig;
        let [_, first, _, second] = self.apart(t, y);
        rig.reduced_mass() * (first - second)
    }

    /// Rate of the state where they move together.
    pub fn together(&self, t: f64, y: &[f64; 4]) -> [f64; 4] {
        self.pushed(t, y, self.hold(t, y))
    }

    /// Gap in m.
    #[inline]
    pub fn gap(&self, y: &[f64; 4]) -> f64 {
        self.rig.gap + y[2] - y[0]
    }

    /// The start as a list.
    pub fn first(&self) -> [f64; 4] {
        [self.start.x1, self.start.v1, self.start.x2, self.start.v2]
    }

    /// Exchanges momentum by the impact law: gives the approach speed in m/s.
    #[inline]
    pub fn collide(&self, y: &mut [f64; 4]) -> f64 {
        let approach = y[1] - y[3];
        let impulse = self.rig.exchange() * approach;
        y[1] -= impulse / self.rig.m1;
        y[3] += impulse / self.rig.m2;
        approach
    }

    /// That the budget is spent at `t`.
    pub fn stalled(&self, t: f64) -> Fault {
        Fault::Stalled(format!("{} steps are spent at {t:.6} s of {:.6} s", self.most, self.until))
    }
}
