//! Stretches of samples with an even clock, between lost samples, pauses and restarts.

use super::{Clock, DIGITS_SPANNED, FEWEST, JITTER, over_long, steps_within, with_binary_rounding};
use crate::median;
use std::ops::Range;

/// Largest deviation of an instant from the fitted grid by jitter and rounding together, over the sampling
/// interval, inside a stretch. An unnoticed lost sample would give 1/2.
const JITTER_AND_ROUNDING: f64 = 0.4;
/// Deviation of an interval between two instants from the usual interval, over that interval, that ends a
/// stretch; a coarse printed digit is added to it. A lost sample gives 1.
const STRETCH_END: f64 = 0.5;
/// Size of a printed digit, over the sampling interval, from which on rounding can hide a lost sample. With
/// finer digits every lost sample shows as an interval of double length.
const HIDING_DIGIT: f64 = 0.25;

/// Samples with an even clock, between lost samples, pauses and restarts of the clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Indices of the samples.
    pub samples: Range<usize>,
    /// Clock of these samples.
    pub clock: Clock,
}

impl Stretch {
    /// The stretch of longest duration, with its number from 1.
    pub fn longest(all: &[Stretch]) -> Option<(usize, &Stretch)> {
        (1..).zip(all).max_by(|a, b| a.1.duration().total_cmp(&b.1.duration()))
    }

    /// Duration in s.
    pub fn duration(&self) -> f64 {
        self.clock.step * self.samples.len() as f64
    }
}

/// Stretches of `instants` (s) that have an even clock, in order; empty if they contain less than half of the
/// instants. `resolution` in s is half a unit in the last printed digit. An interval far from the usual one,
/// as at a lost sample, ends a stretch; inside it instants may deviate by jitter and rounding together. If
/// the printed digits can hide a lost sample, a stretch ends before every place where one may be, and the
/// next begins after it.
pub fn stretches(instants: &[f64], resolution: f64) -> Vec<Stretch> {
    let resolution = with_binary_rounding(instants, resolution);
    let Some(usual) = usual_step(instants, resolution) else { return Vec::new() };
    let shows_lost = 2.0 * resolution < HIDING_DIGIT * usual;
    let margin = if shows_lost { 0.0 } else { 2.0 * resolution };
    let breaks = |(_, w): &(usize, &[f64])| {
        let off = w[1] - w[0] - usual;
        off.is_nan() || off.abs() > STRETCH_END * usual + margin
    };
    let long: Vec<usize> = instants.windows(2).enumerate().filter(breaks).map(|(i, _)| i).collect();
    // Runs between over-long intervals; a run is cut again until none is left in it.
    let mut unchecked = cut_behind(0..instants.len(), &long);
    unchecked.reverse();
    let mut runs = Vec::new();
    while let Some(run) = unchecked.pop() {
        let over_long = over_long(&instants[run.clone()]);
        if over_long.is_empty() {
            runs.push(run);
        } else {
            unchecked.extend(cut_behind(run, &over_long).into_iter().rev());
        }
    }
    let stretch_of = |samples: Range<usize>| {
        let part = &instants[samples.clone()];
        let clock = if part.len() < FEWEST { None } else { Clock::of(part, resolution) };
        let fitted =
            || Clock::within(part, resolution, |step| JITTER_AND_ROUNDING * step).filter(|_| shows_lost);
        Some(Stretch { clock: clock.or_else(fitted)?, samples })
    };
    // At least half of the instants must be even: irregular steps contain some even stretches by chance.
    let is_enough =
        |all: &Vec<Stretch>| 2 * all.iter().map(|s| s.samples.len()).sum::<usize>() >= instants.len();
    if shows_lost {
        let all: Vec<Stretch> = runs.into_iter().filter_map(stretch_of).collect();
        return Some(all).filter(is_enough).unwrap_or_default();
    }
    // Runs that have no even clock as a whole are cut at possible hidden lost samples.
    let cut = |tolerance: f64| -> Vec<Stretch> {
        let pieces_of = |run: &Range<usize>| {
            let pieces = certain_pieces(&instants[run.clone()], tolerance).into_iter();
            pieces.map(|piece| run.start + piece.start..run.start + piece.end).collect::<Vec<_>>()
        };
        let samples = |run: &Range<usize>| match stretch_of(run.clone()) {
            Some(stretch) => vec![stretch.samples],
            None => pieces_of(run),
        };
        runs.iter().flat_map(samples).filter_map(stretch_of).collect()
    };
    let tolerances = [resolution, resolution + JITTER * usual];
    tolerances.into_iter().map(cut).find(is_enough).unwrap_or_default()
}

/// Cuts a range after each of the indices `last`, which count from the start of the range.
fn cut_behind(range: Range<usize>, last: &[usize]) -> Vec<Range<usize>> {
    let mut first = range.start;
    let ends = last.iter().map(|i| range.start + i + 1).chain([range.end]);
    ends.map(|end| std::mem::replace(&mut first, end)..end).collect()
}

/// Pieces of `instants` that certainly contain no lost sample. The instants are cut greedily into the longest
/// pieces within `tolerance` of an even grid: once forward from the first, once backward from the last.
/// Forward and backward cuts bracket every possible break; only what lies inside both is kept.
fn certain_pieces(instants: &[f64], tolerance: f64) -> Vec<Range<usize>> {
    let n = instants.len();
    let back: Vec<f64> = instants.iter().rev().map(|t| -t).collect();
    let greedy_cuts = |instants: &[f64]| {
        let mut cuts = vec![0];
        while cuts[cuts.len() - 1] < n {
            let start = cuts[cuts.len() - 1];
            cuts.push(start + longest_even(&instants[start..], tolerance));
        }
        cuts
    };
    let (forward, backward) = (greedy_cuts(instants), greedy_cuts(&back));
    let starts = forward.iter();
    starts.zip(backward.iter().rev().skip(1)).map(|(start, end)| *start..(n - end).max(*start)).collect()
}

/// Largest number of instants from the first on that lie within `tolerance` of one even grid: found by
/// doubling, then by bisection.
fn longest_even(instants: &[f64], tolerance: f64) -> usize {
    let is_even = |n: usize| n < 3 || steps_within(&instants[..n], tolerance).is_some();
    let n = instants.len();
    let mut even = n.min(2);
    let mut uneven = even;
    while even < n && uneven == even {
        uneven = (2 * even).min(n);
        if is_even(uneven) {
            even = uneven;
        }
    }
    while uneven > even + 1 {
        let middle = usize::midpoint(even, uneven);
        if is_even(middle) { even = middle } else { uneven = middle }
    }
    even
}

/// Usual sampling interval in s: the median time of `lag` intervals, divided by `lag`. `lag` is doubled until
/// that time spans eight printed digits. `None` if the result is not above 0.
fn usual_step(instants: &[f64], resolution: f64) -> Option<f64> {
    let mut lag = 1;
    loop {
        let usual = median(instants.windows(lag + 1).map(|w| w[lag] - w[0]));
        if usual >= DIGITS_SPANNED * 2.0 * resolution || 8 * lag >= instants.len() {
            return Some(usual / lag as f64).filter(|step| *step > 0.0 && step.is_finite());
        }
        lag *= 2;
    }
}
