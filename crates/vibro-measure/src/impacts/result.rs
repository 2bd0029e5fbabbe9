//! Impacts of a trace: their interval, what they repeat, and when they stand.

use super::{Hum, PerCycle, Phase};
use crate::Estimate;
use serde::Serialize;
use vibro_record::Finding;

/// Impacts of a trace.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Impacts {
    /// Impacts that were found.
    pub n: usize,
    /// Mean time between impacts in s, missed ones counted.
    pub interval: Estimate,
    /// Impacts a second.
    pub frequency: Estimate,
    /// Median of the intervals between neighbours, in s.
    pub median_interval: f64,
    /// Standard deviation of the intervals between neighbours that miss none, in s; null for fewer than two.
    pub spread: Option<f64>,
    /// Serial correlation of neighbouring intervals, less what a pattern repeats: −0.5 where onsets are noisy, 0 where intervals jitter.
    pub serial_correlation: Option<f64>,
    /// Impacts after which the intervals repeat, where they are unlike within that pattern; null where there is none.
    pub pattern: Option<usize>,
    /// Impacts that should stand in intervals that are several of the others.
    pub missed: usize,
    /// Impacts that follow another within less than half an interval, or cut one of a pattern in two.
    pub doubled: usize,
    /// Frequency of the excitation in Hz, as given or from the reference channel.
    pub excitation: Option<f64>,
    /// Impacts per excitation cycle; null where no fraction fits or no excitation is known.
    pub per_cycle: Option<PerCycle>,
    /// Frequency in Hz by which the impacts miss the fraction that they come near to; null where they keep it, come near none, or no
    /// excitation is known.
    pub beat: Option<Estimate>,
    /// Whether impacts repeat: a fraction fits, or without an excitation, intervals spread by less than 5 %, or about those of a pattern. Two impacts
    /// do not show it.
    pub regular: bool,
    /// Phases of the impacts of the pattern, in excitation cycles; empty where there is no pattern.
    pub phases: Vec<Phase>,
    /// Times of the impacts in s.
    pub times: Vec<f64>,
    /// Standard uncertainty of one time from the noise of the trace, in s (the median).
    pub onset_std: Option<f64>,
    /// Heights over the background, in the unit of the trace.
    pub heights: Vec<f64>,
    /// Phase of each impact in its excitation cycle, 0 to 1; empty where no excitation is known.
    pub phase: Vec<f64>,
    /// Mains hum that was removed.
    pub hum: Option<Hum>,
    /// What was done to the trace, and what is doubtful.
    pub findings: Vec<Finding>,
}
