//! Bursts of a trace, with the ringing that each impact leaves behind.

use std::ops::Range;

/// An impact rises above what is left of the ringing before it by this factor.
const RISE: f64 = 2.0;
/// Ratio of one candidate decay time to the one before.
const STEP: f64 = 1.25;
/// Numbers of bursts that differ by less than this part are the same.
const SAME: f64 = 0.02;

/// Bursts of samples further than `reach` from 0, one an impact, joined over pauses of up to `pause` samples; without `pause`, a burst goes on
/// until something rises above the envelope of its ringing. Then there is also the factor by which the decay that is assumed of the ringing may
/// change without another number of bursts.
pub fn bursts(values: &[f64], reach: f64, pause: Option<usize>) -> (Vec<Range<usize>>, Option<f64>) {
    let runs = runs(values, reach);
    let (firsts, stable) = match pause {
        Some(pause) => {
            let apart = |j: &usize| *j == 0 || runs[*j].start + 1 - runs[j - 1].end >= pause;
            ((0..runs.len()).filter(apart).collect(), None)
        }
        None => most_stable(values, &runs),
    };
    let ends = firsts.iter().skip(1).copied().chain([runs.len()]);
    let whole = |(first, next): (&usize, usize)| runs[*first].start..runs[next - 1].end;
    (firsts.iter().zip(ends).map(whole).collect(), stable)
}

/// Stretches of samples beyond the noise.
fn runs(values: &[f64], reach: f64) -> Vec<Range<usize>> {
    let beyond: Vec<usize> = (0..values.len()).filter(|i| values[*i].abs() > reach).collect();
    beyond.chunk_by(|a, b| a + 1 == *b).map(|run| run[0]..run[0] + run.len()).collect()
}

/// Runs that begin an impact if ringing decays by e in `decay` samples at least: those that rise above an envelope which follows every
/// peak and falls with that time. What follows within the same time is the impact's own rise.
fn firsts(values: &[f64], runs: &[Range<usize>], decay: f64) -> Vec<usize> {
    let keep = (-1.0 / decay).exp();
    let (mut envelope, mut at) = (0.0f64, 0);
    let mut found: Vec<usize> = Vec::new();
    for (j, run) in runs.iter().enumerate() {
        // The flank that leads up to a run is its own, and nothing that rings.
        let rises = |i: &usize| values[i - 1].abs() < values[*i].abs();
        let foot = (at + 1..=run.start).rev().take_while(rises).last().unwrap_or(run.start);
        for v in &values[at..foot] {
            envelope = (envelope * keep).max(v.abs());
        }
        envelope *= keep.powi((run.start - foot) as i32);
        at = run.start;
        let own = found.last().is_some_and(|f| (at - runs[*f].start) as f64 <= decay);
        let height = values[run.clone()].iter().fold(0.0, |h: f64, v| h.max(v.abs()));
        if !own && height > RISE * envelope {
            found.push(j);
        }
    }
    found
}

/// Impacts for the decay whose choice matters least, and the factor over which it does not matter.
///
/// The envelope follows each peak of the ringing, so that it need not fall as slowly as the ringing does: from a few half waves on, and up
/// to the pause between impacts, the number of bursts stays the same. A decay that first parts bursts as it should far beyond the half waves
/// belongs to a rest in the record.
fn most_stable(values: &[f64], runs: &[Range<usize>]) -> (Vec<usize>, Option<f64>) {
    // Length of a half wave, or of a pulse: half of all samples beyond the noise lie in runs no longer.
    let mut lengths: Vec<usize> = runs.iter().flat_map(|r| vec![r.len(); r.len()]).collect();
    lengths.sort_unstable();
    let Some(length) = lengths.get(lengths.len().saturating_sub(1) / 2) else { return (Vec::new(), None) };
    let length = *length as f64;
    let counts: Vec<(f64, usize)> =
        std::iter::successors(Some((0.5 * length).max(1.0)), |decay| Some(decay * STEP))
            .take_while(|decay| *decay < 0.5 * values.len() as f64)
            .map(|decay| (decay, firsts(values, runs, decay).len()))
            .take_while(|(_, n)| *n > 1)
            .collect();
    let mut best = (0.0, 0.5 * length.max(2.0));
    for (i, (from, n)) in counts.iter().enumerate().take_while(|(_, (from, _))| *from <= 8.0 * length + 4.0) {
        let same = |m: &usize| m.abs_diff(*n) as f64 <= SAME * *n as f64;
        let to = counts[i..].iter().take_while(|(_, m)| same(m)).last().map_or(*from, |t| t.0);
        if to / from > best.0 {
            best = (to / from, (from * to).sqrt());
        }
    }
    (firsts(values, runs, best.1), Some(best.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_rest_does_not_join_the_impacts_beside_it() {
        let mut values = vec![0.0; 20_000];
        for i in 0..50 {
            values[100 + i * 20] = 1.0;
            values[15_000 + i * 20] = 1.0;
        }
        assert_eq!(bursts(&values, 0.5, None).0.len(), 100);
    }

    #[test]
    fn a_given_pause_parts_bursts_and_nothing_else_does() {
        let mut values = vec![0.0; 100];
        for i in [10, 13, 20, 21, 60] {
            values[i] = 1.0;
        }
        assert_eq!(bursts(&values, 0.5, Some(5)).0, [10..14, 20..22, 60..61]);
        assert_eq!(bursts(&values, 0.5, Some(20)).0, [10..22, 60..61]);
        assert!(bursts(&values, 2.0, None).0.is_empty());
    }
}
