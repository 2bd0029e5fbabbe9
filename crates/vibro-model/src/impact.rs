//! Impacts of a simulated motion, and how many of what it has met.

use serde::Serialize;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Impact {
    /// Time in s.
    pub time: f64,
    /// Phase in 0..2π of the excitation's cycle; a sine force is F₀ cos(phase).
    pub phase: f64,
    /// Approach speed v₁ − v₂ in m/s.
    pub approach_velocity: f64,
    /// Impulse in N s.
    pub impulse: f64,
}

/// What a motion has met so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Stretches of motion in closed form.
    pub flights: u64,
    /// Impacts below the grazing speed after which the masses part by themselves: a little more gap and
    /// there is none. What follows depends on them more than on anything else.
    pub grazing: u64,
    /// Times the masses came to rest against each other.
    pub sticks: u64,
}
