//! Evidence in an answer on the kind of its record, for proposals of a campaign.

use crate::measure::decay::DecayResult;
use crate::measure::impacts::Impacts;
use crate::measure::pulse::PulseResult;
use crate::measure::response::{Response, ResponsePoint};
use crate::measure::restitution::Restitution;
use crate::record::code::READER_DOUBTS;
use serde::{Deserialize, Serialize};

/// Numbers of one record by which its kind is judged; times in s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // each kind says what its fields are
pub enum Evidence {
    /// A sweep: number of steps, number of those with an uncertainty, and whether it jumps.
    Sweep { steps: usize, sure: usize, jumps: bool },
    /// A decay: its beginning and end, and the end of its record, in s.
    Decay { start: f64, end: f64, last: f64 },
    /// Impacts: number found, number missed, and spread of the intervals over their median.
    Impacts { n: usize, missed: usize, spread: f64 },
    /// Drops: number of files, coefficient of restitution, and whether each has one interval between
    /// impacts.
    Drops { files: usize, restitution: f64, one_interval_each: bool },
    /// A contact pulse: its duration in s.
    Pulse { duration: f64 },
}

impl From<&Response> for Evidence {
    fn from(response: &Response) -> Evidence {
        // A doubt of the reader takes the uncertainty of every step.
        let read_in_doubt = response.findings.iter().any(|found| READER_DOUBTS.contains(&&*found.code));
        let is_sure = |point: &&ResponsePoint| read_in_doubt || point.amplitude.std.is_some();
        let sure = response.points.iter().filter(is_sure).count();
        Evidence::Sweep { steps: response.points.len(), sure, jumps: !response.jumps.is_empty() }
    }
}

impl From<&DecayResult> for Evidence {
    fn from(found: &DecayResult) -> Evidence {
        Evidence::Decay { start: found.start, end: found.end, last: found.last }
    }
}

impl From<&Impacts> for Evidence {
    fn from(found: &Impacts) -> Evidence {
        let spread = found.spread.unwrap_or(f64::INFINITY) / found.median_interval;
        Evidence::Impacts { n: found.n, missed: found.missed, spread }
    }
}

impl From<&PulseResult> for Evidence {
    fn from(found: &PulseResult) -> Evidence {
        // Where no model has a duration, the pulse still lasts longer than this.
        let duration = found.duration.value;
        Evidence::Pulse { duration: if duration.is_finite() { duration } else { found.width } }
    }
}

impl Evidence {
    /// Evidence of drops in this number of files.
    pub fn of_drops(found: &Restitution, files: usize) -> Evidence {
        let one_interval_each = found.intervals.iter().all(|intervals| intervals.len() == 1);
        Evidence::Drops { files, restitution: found.restitution.value, one_interval_each }
    }
}
