//! What a drill's record gave.

use super::{Bandwidth, Beam, Corner, FaultCount, Group, Impact, NoiseFloor, Phases};
use crate::Estimate;
use crate::exposure::Exposure;
use serde::Serialize;
use vibro_record::Finding;

/// Everything found in a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Drill {
    /// Mean speed of the crank in turns a second.
    pub speed: Estimate,
    /// Standard deviation of the speed from turn to turn, in Hz.
    pub speed_variation: f64,
    /// Whole turns.
    pub cycles: usize,
    /// Turns in the average: whole, and with no part of the velocity lost.
    pub averaged: usize,
    /// The reference.
    pub reference: Pulses,
    /// Every impact.
    pub impacts: Vec<Impact>,
    /// Impacts by direction and phase, the strongest group first.
    pub groups: Vec<Group>,
    /// Mean velocity before the impacts of the strongest group; so are all means down to the restitution.
    pub before: Option<Estimate>,
    /// Mean velocity after the impacts.
    pub after: Option<Estimate>,
    /// Mean phase of the impacts in turns after the edge.
    pub phase: Option<Estimate>,
    /// Mean kinetic energy before the impacts.
    pub energy: Option<Estimate>,
    /// Mean energy that the impacts take out of the mass.
    pub energy_given: Option<Estimate>,
    /// Restitution from the balance of momentum; without a struck mass that of a struck mass that does not move.
    pub restitution: Option<Estimate>,
    /// Turns whose impact lies in a drop-out.
    pub hidden: usize,
    /// Impacts whose fits reach the end of the range; they are in no mean unless there are no others.
    pub clipped: usize,
    /// Velocity over the phase.
    pub average: Phases,
    /// Displacement over the phase.
    pub displacement: Displacement,
    /// Drop-outs of the velocity.
    pub dropouts: usize,
    /// Drop-outs and spikes, and the samples bridged, lost and clipped.
    pub faults: FaultCount,
    /// How fast the motion changes.
    pub bandwidth: Bandwidth,
    /// Motion against the noise of the instrument, where a record without motion was given.
    pub noise_floor: Option<NoiseFloor>,
    /// Hand-arm exposure, where a handle was measured.
    pub exposure: Option<Exposure>,
    /// The beam.
    pub beam: Beam,
    /// Smoothing of average and displacement; `None` where it was switched off.
    pub smoothing: Option<Corner>,
    /// Speed of each turn in Hz, for the picture of it.
    #[serde(skip)]
    pub speeds: Vec<f64>,
    /// Time of the beginning of each turn in s.
    #[serde(skip)]
    pub times: Vec<f64>,
    /// Velocity, as it was measured, of a few turns in the middle.
    #[serde(skip)]
    pub excerpt: Vec<f64>,
    /// The reference beside it.
    #[serde(skip)]
    pub excerpt_reference: Vec<f64>,
    /// Time of its first sample in s, and sampling interval.
    #[serde(skip)]
    pub excerpt_time: (f64, f64),
    /// What was found, assumed or left out.
    pub findings: Vec<Finding>,
}

/// Edges of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pulses {
    /// Edges found.
    pub edges: usize,
    /// Missing edges.
    pub missing: usize,
    /// False edges, which were ignored.
    pub extra: usize,
    /// Stretches without edges.
    pub pauses: usize,
    /// Standard uncertainty of an edge in s.
    pub std: f64,
}

/// Displacement by integration over whole turns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Displacement {
    /// Displacement in m at the phases of the average; its mean is 0.
    pub value: Vec<f64>,
    /// Mean peak-to-peak displacement of a turn.
    pub stroke: Estimate,
    /// Mean displacement left at the end of a turn, which was taken away.
    pub drift: Estimate,
}
