//! Bursts that repeat each impact at a fixed delay, quieter: echoes of a room, or the second of two impacts.

use crate::mean::scatter;
use std::collections::BTreeSet;
use vibro_record::{median, sort_by_number};

/// Longest delay of an echo of a room in s: a path of 14 m.
const LONGEST: f64 = 0.04;
/// Largest height of an echo over that of its impact.
pub const QUIETER: f64 = 0.8;
/// Largest difference of two delays that count as one, in s.
const SAME: f64 = 3e-4;
/// Of the impacts that any quieter burst follows, the least fraction that must have one at the delay of an
/// echo.
const MOST: f64 = 0.6;
/// Largest fraction of the impacts that another burst precedes by the same delay: in a train of uneven
/// heights most are preceded so.
const FEW: f64 = 0.2;
/// Fewest impacts with an echo.
const ENOUGH: usize = 4;
/// Least scatter of the intervals between impacts, over that of the delays, for sure echoes: an echo keeps
/// its delay however a machine jitters.
const APART: f64 = 4.0;
/// Most quieter bursts that follow a burst within [`LONGEST`], on average. With more, chance alone puts a
/// burst at any delay before more than [`FEW`] of the impacts, so no delay can show an echo.
const CROWD: f64 = FEW * LONGEST / (2.0 * SAME);

/// Bursts that repeat impacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Echoes {
    /// Their indices in the list of bursts, in order.
    pub places: Vec<usize>,
    /// Longest of their delays in s.
    pub delay: f64,
    /// Whether they are echoes; otherwise they may be impacts as well.
    pub sure: bool,
}

/// Echoes among bursts with their times in s and heights; `None` where no delay repeats. Delays are tried
/// from the most frequent on: a quieter burst must follow most of the others at that delay, and hardly any of
/// these may have a burst before it at the same delay.
pub fn echoes(times: &[f64], heights: &[f64]) -> Option<Echoes> {
    let mut impact = vec![true; times.len()];
    let (mut longest, mut off) = (0.0, Vec::new());
    let mut pairs = pairs(times, heights)?;
    while let Some((delay, quieter)) = repeated(times, &impact, &pairs) {
        let members = pairs.iter().filter(|pair| quieter.contains(&pair.1));
        off.extend(members.map(|pair| pair.2 - delay).filter(|off| off.abs() <= SAME));
        for i in &quieter {
            impact[*i] = false;
        }
        pairs.retain(|(first, second, _)| impact[*first] && impact[*second]);
        longest = delay.max(longest);
    }
    let of = |is: bool| (0..times.len()).filter(|i| impact[*i] == is).collect::<Vec<usize>>();
    let kept = of(true);
    let intervals: Vec<f64> = kept.windows(2).map(|w| times[w[1]] - times[w[0]]).collect();
    let sure = scatter(&intervals) > APART * scatter(&off);
    (longest > 0.0).then(|| Echoes { places: of(false), delay: longest, sure })
}

/// Bursts, quieter ones that follow them within the longest delay, and the delays in s; `None` where there
/// are too many.
fn pairs(times: &[f64], heights: &[f64]) -> Option<Vec<(usize, usize, f64)>> {
    let mut all = Vec::new();
    for (second, time) in times.iter().enumerate() {
        let before = (0..second).rev().take_while(|first| time - times[*first] < LONGEST);
        let louder = before.filter(|first| heights[second] < QUIETER * heights[*first]);
        all.extend(louder.map(|first| (first, second, time - times[first])));
        if all.len() as f64 > CROWD * times.len() as f64 {
            return None;
        }
    }
    sort_by_number(&mut all, |a| a.2);
    Some(all)
}

/// A delay that many `pairs`, sorted by delay, share, and the quieter bursts of these pairs. Most bursts that
/// quieter ones follow must have one at this delay.
fn repeated(times: &[f64], impact: &[bool], pairs: &[(usize, usize, f64)]) -> Option<(f64, BTreeSet<usize>)> {
    let near =
        |at: f64| pairs.partition_point(|p| p.2 < at - SAME)..pairs.partition_point(|p| p.2 <= at + SAME);
    let mut counts: Vec<(usize, f64)> = pairs.iter().map(|pair| (near(pair.2).len(), pair.2)).collect();
    counts.retain(|(n, _)| *n >= ENOUGH);
    counts.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut delays: Vec<f64> = Vec::new();
    for (_, delay) in counts {
        if delays.iter().all(|known| (known - delay).abs() > SAME) {
            delays.push(delay);
        }
    }
    delays.into_iter().find_map(|delay| {
        let members = &pairs[near(delay)];
        let quieter: BTreeSet<usize> = members.iter().map(|pair| pair.1).collect();
        let of = |pairs: &[(usize, usize, f64)]| -> BTreeSet<usize> {
            pairs.iter().map(|pair| pair.0).filter(|i| !quieter.contains(i)).collect()
        };
        let (leaders, leading) = (of(members).len(), of(pairs).len());
        let others: Vec<usize> = (0..times.len()).filter(|i| impact[*i] && !quieter.contains(i)).collect();
        let at = |time: f64| {
            times.partition_point(|t| *t < time - SAME) < times.partition_point(|t| *t <= time + SAME)
        };
        let preceded = others.iter().filter(|i| at(times[**i] - delay)).count();
        let enough = leaders >= ENOUGH && leaders as f64 >= MOST * leading as f64;
        let own: Vec<f64> = members.iter().map(|pair| pair.2).collect();
        (enough && preceded as f64 <= FEW * others.len() as f64).then(|| (median(&own), quieter))
    })
}
