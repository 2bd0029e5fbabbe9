//! Impacts of a simulated motion, and counts of its events.

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

/// Counts of a simulated motion so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Flights computed in closed form.
    pub flights: u64,
    /// Grazing impacts: slower than the grazing speed, and the masses then part by themselves. With slightly
    /// more gap they would not happen, so the later motion is very sensitive to them.
    pub grazing: u64,
    /// Times the masses came to rest against each other.
    pub sticks: u64,
}
