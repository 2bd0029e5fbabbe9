//! All sounds of a trace, before a threshold and a pause choose among them: what a threshold is set by.

use super::background::bursts;
use super::detect::{ImpactsOptions, check, cleared, heights, turned_upright};
use super::rises::{largest, rises};
use serde::Serialize;
use std::ops::Range;
use vibro_record::{Result, Trace, median};

/// The sounds of a trace, and the level that they are compared with.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeardSounds {
    /// Level of the trace at rest, in its unit.
    pub rest: f64,
    /// Noise limit over that level: a quieter sound never counts.
    pub reach: f64,
    /// Median height of all sounds: a threshold is a fraction of it.
    pub median: f64,
    /// Whether heights count upwards, and whether downwards.
    pub sides: [bool; 2],
    /// All sounds in the order of time.
    pub sounds: Vec<HeardSound>,
}

/// A sound of a trace.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeardSound {
    /// When it begins, in s.
    pub from: f64,
    /// When it ends, in s.
    pub to: f64,
    /// Its largest distance from the level at rest, in the unit of the trace.
    pub height: f64,
}

/// The sounds of a trace. Of a falling body (`falls`) every sudden rise is one, as
/// [`Train::of`](crate::restitution::Train::of) compares them; else every burst with its ringing, as
/// [`detect`](super::detect) does.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values; on impossible options.
pub fn heard(trace: &Trace, options: &ImpactsOptions, falls: bool) -> Result<HeardSounds> {
    let rate = check(trace, options)?;
    let (mut values, quiet, _) = cleared(trace, options, rate, &mut Vec::new())?;
    let all = if falls { rises(&values, quiet.reach, rate) } else { bursts(&values, quiet.reach, None).0 };
    let inverted = turned_upright(&mut values, &all).is_some();
    let heights: Vec<f64> = if falls {
        all.iter().map(|b| largest(&values[b.clone()])).collect()
    } else {
        heights(&values, &all, 1.0)
    };
    let time = |i: usize| trace.axis.start() + i as f64 / rate;
    let sound = |(b, height): (&Range<usize>, &f64)| HeardSound {
        from: time(b.start),
        to: time(b.end),
        height: *height,
    };
    let sounds = all.iter().zip(&heights).map(sound).collect();
    Ok(HeardSounds {
        rest: quiet.level,
        reach: quiet.reach,
        median: median(&heights),
        sides: [falls || !inverted, falls || inverted],
        sounds,
    })
}
