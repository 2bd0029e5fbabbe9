//! Bursts that repeat each impact at a fixed delay, quieter: echoes of a room, or the second of two impacts.

use super::background::median;
use crate::mean::scatter;

/// Longest delay of an echo of a room in s: a way of 14 m.
const LONGEST: f64 = 0.04;
/// An echo is quieter than its impact by this factor or more.
const QUIETER: f64 = 0.8;
/// Delays that differ by less, in s, are one delay.
const SAME: f64 = 3e-4;
/// Part of the impacts that have an echo, at least.
const MOST: f64 = 0.6;
/// Part of the impacts that something else precedes by the same delay, at most: in a train of uneven heights most do.
const FEW: f64 = 0.2;
/// Fewest impacts with an echo.
const ENOUGH: usize = 4;
/// Intervals between impacts that scatter more than delays by this factor are another thing than these: an echo keeps its delay however a machine jitters.
const APART: f64 = 4.0;

/// Bursts that repeat impacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Echoes {
    /// Their places, in order.
    pub places: Vec<usize>,
    /// Longest of their delays in s.
    pub delay: f64,
    /// Whether they are echoes; otherwise they may be impacts as well.
    pub sure: bool,
}

/// Echoes among bursts with their times in s and heights; `None` where none repeats. A burst that no louder one precedes within the longest delay is an
/// impact, and the others follow the last of these.
pub fn echoes(times: &[f64], heights: &[f64]) -> Option<Echoes> {
    let (mut impacts, mut followers): (Vec<usize>, Vec<(usize, f64)>) = (Vec::new(), Vec::new());
    for (i, (time, height)) in times.iter().zip(heights).enumerate() {
        match impacts.last() {
            Some(last) if time - times[*last] < LONGEST && *height < QUIETER * heights[*last] => {
                followers.push((i, time - times[*last]));
            }
            _ => impacts.push(i),
        }
    }
    let mut delays: Vec<f64> = followers.iter().map(|f| f.1).collect();
    delays.sort_by(f64::total_cmp);
    let near = |all: &[f64], at: f64| {
        all.partition_point(|d| *d < at - SAME)..all.partition_point(|d| *d <= at + SAME)
    };
    let enough = ENOUGH.max((MOST * impacts.len() as f64).ceil() as usize);
    followers.retain(|f| near(&delays, f.1).len() >= enough);
    let delay = followers.iter().map(|f| f.1).fold(0.0, f64::max);
    let repeated = |i: &&usize| followers.iter().any(|f| !near(times, times[**i] - f.1).is_empty());
    let preceded = impacts.iter().filter(repeated).count();
    if followers.is_empty() || preceded as f64 > FEW * impacts.len() as f64 {
        return None;
    }
    let intervals: Vec<f64> = impacts.windows(2).map(|w| times[w[1]] - times[w[0]]).collect();
    let off: Vec<f64> = followers.iter().map(|f| f.1 - median(&delays[near(&delays, f.1)])).collect();
    let sure = scatter(&intervals) > APART * scatter(&off);
    Some(Echoes { places: followers.into_iter().map(|f| f.0).collect(), delay, sure })
}
