//! Faults of a laser vibrometer: drop-outs and speckle spikes, found and bridged; over-range, found.

use super::survey::{Survey, noise};
use std::ops::Range;

/// What is known of a repaired sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// As it was measured.
    Good,
    /// As it was measured, but at the end of the range: over-range.
    Clipped,
    /// A straight line over a fault.
    Bridged,
    /// In a fault too long to be bridged.
    Lost,
}

impl State {
    /// Whether the value is the instrument's and not a bridge.
    pub fn measured(self) -> bool {
        matches!(self, State::Good | State::Clipped)
    }
}

/// Number of faults found, and of the samples they cover.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct FaultCount {
    /// Drop-outs: stretches of missing or of equal values.
    pub dropouts: usize,
    /// Spikes of one to three samples.
    pub spikes: usize,
    /// Samples bridged by a straight line.
    pub bridged: usize,
    /// Samples in drop-outs that were too long to be bridged.
    pub lost: usize,
    /// Samples that stand at the largest or smallest value: over-range.
    pub clipped: usize,
}

/// Neighbours that tell a drop-out in a motion from a signal at rest.
const AROUND: usize = 16;
/// Longest speckle spike in samples.
const SPIKE: usize = 3;
/// Samples on both sides of a spike that must be calm: an impact is followed by ringing.
const CALM: usize = 4;
/// A spike stands this many standard deviations of the noise off its neighbours, which normal noise never does.
const SPIKE_NOISE: f64 = 10.0;
/// … and this part of the range of the channel; smaller ones move neither impacts nor averages.
const SPIKE_RANGE: f64 = 0.02;
/// An extreme nearer to the median than this part of the reach is where the signal rests, not the end of the range.
const RAIL: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Dropout,
    Spike,
    OverRange,
}

/// Bridges the drop-outs and spikes of a velocity by straight lines, except those longer than `longest` samples, and says what is
/// known of each sample.
///
/// A *drop-out* is a stretch of missing values, or of equal values longer than chance gives, entered or left by a step amid
/// neighbours that move; a *spike* is one to three samples that stand off both neighbours while these agree; *over-range* are two or
/// more samples at the largest or smallest value, entered or left by a step. Neither a turning point of a coarsely digitised signal nor
/// an impact is a fault.
pub(super) fn repair(values: &mut [f64], survey: &Survey, longest: usize) -> (Vec<State>, FaultCount) {
    let height =
        (SPIKE_NOISE * noise(values).max(survey.quantum)).max(SPIKE_RANGE * (survey.high - survey.low));
    let faults = Velocity { raw: values, survey, height }.faults();
    let mut states = vec![State::Good; values.len()];
    let mut count = FaultCount::default();
    for (kind, range) in faults {
        let n = range.len();
        if kind == Kind::OverRange {
            states[range].fill(State::Clipped);
            count.clipped += n;
            continue;
        }
        count.dropouts += usize::from(kind == Kind::Dropout);
        count.spikes += usize::from(kind == Kind::Spike);
        let before = range.start.checked_sub(1).map(|i| values[i]).filter(|v| v.is_finite());
        let after = values.get(range.end).copied().filter(|v| v.is_finite());
        let known = before.or(after).is_some() && n <= longest;
        states[range.clone()].fill(if known { State::Bridged } else { State::Lost });
        *(if known { &mut count.bridged } else { &mut count.lost }) += n;
        let (a, b) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
        for (k, v) in values[range].iter_mut().enumerate() {
            *v = a + (b - a) * (k + 1) as f64 / (n + 1) as f64;
        }
    }
    (states, count)
}

/// A velocity as it was measured.
struct Velocity<'a> {
    raw: &'a [f64],
    survey: &'a Survey,
    /// Least height of a spike.
    height: f64,
}

impl Velocity<'_> {
    fn faults(&self) -> Vec<(Kind, Range<usize>)> {
        let mut all: Vec<(Kind, Range<usize>)> = Vec::new();
        let mut at = 0;
        while at < self.raw.len() {
            if let Some((kind, end)) = self.fault(at) {
                all.push((kind, at..end));
                at = end;
            } else {
                at += 1;
            }
        }
        all
    }

    /// The fault that begins at sample `i`, and the sample behind it.
    fn fault(&self, i: usize) -> Option<(Kind, usize)> {
        let v = self.raw[i];
        let before = i.checked_sub(1).map(|k| self.raw[k]);
        if before == Some(v) {
            // Judged where it began.
            return None;
        }
        let same = |x: &&f64| **x == v || !(x.is_finite() || v.is_finite());
        let end = i + self.raw[i..].iter().take_while(same).count();
        if !v.is_finite() {
            Some((Kind::Dropout, end))
        } else if end - i > 1 {
            self.flat(i, end).map(|kind| (kind, end))
        } else if (v - before?).abs() < 0.7 * self.height {
            None
        } else {
            self.spike(i).map(|end| (Kind::Spike, end))
        }
    }

    /// What a stretch of equal values is.
    fn flat(&self, i: usize, end: usize) -> Option<Kind> {
        let Survey { low, high, median, quantum, longest_by_chance } = *self.survey;
        let v = self.raw[i];
        let before = &self.raw[i.saturating_sub(AROUND)..i];
        let after = &self.raw[end..(end + AROUND).min(self.raw.len())];
        let step = |x: Option<&f64>| x.is_some_and(|x| (x - v).abs() > 1.5 * quantum);
        if !(step(before.last()) || step(after.first())) {
            return None;
        }
        if v == low || v == high {
            let reach = (median - low).max(high - median);
            return ((v - median).abs() > RAIL * reach).then_some(Kind::OverRange);
        }
        let pairs = before.windows(2).chain(after.windows(2));
        let (equal, all) = pairs.fold((0, 0), |(e, n), p| (e + usize::from(p[0] == p[1]), n + 1));
        (end - i >= longest_by_chance && 2 * equal <= all).then_some(Kind::Dropout)
    }

    /// The sample behind one to three that stand off the line between their neighbours, while the signal there is calm.
    fn spike(&self, i: usize) -> Option<usize> {
        let a = self.raw[i - 1];
        let spread = |x: f64, around: &[f64]| around.iter().map(|y| (x - y).abs()).fold(0.0, f64::max);
        let calm = spread(a, &self.raw[i.saturating_sub(1 + CALM)..i - 1]);
        (1..=SPIKE).find_map(|n| {
            let b = *self.raw.get(i + n)?;
            let from = i + n + 1;
            let behind = spread(b, self.raw.get(from..(from + CALM).min(self.raw.len())).unwrap_or(&[]));
            let enough = self.height.max(4.0 * (b - a).abs()).max(4.0 * calm).max(4.0 * behind);
            let off = |k: usize| (self.raw[i + k] - (a + (b - a) * (k + 1) as f64 / (n + 1) as f64)).abs();
            (0..n).all(|k| off(k) > enough).then_some(i + n)
        })
    }
}
#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A sine digitised in steps of `quantum`, with a little noise.
    fn signal(n: usize, quantum: f64, noise: f64) -> Vec<f64> {
        let mut state = 7u64;
        (0..n)
            .map(|i| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let uniform = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                let v = 5.0 * (i as f64 * 0.003).sin() + noise * uniform;
                if quantum > 0.0 { (v / quantum).round() * quantum } else { v }
            })
            .collect()
    }

    fn repaired(raw: &[f64]) -> (Vec<f64>, Vec<State>, FaultCount) {
        let mut values = raw.to_vec();
        let (states, count) = repair(&mut values, &Survey::of(raw), 500);
        (values, states, count)
    }

    #[test]
    fn faults_are_counted_and_bridged() {
        let clean = signal(60_000, 0.001, 0.1);
        let mut raw = clean.clone();
        raw[1000..1040].fill(0.0);
        raw[5000..5100].fill(f64::NAN);
        let held = raw[9000];
        raw[9001..9030].fill(held);
        raw[20_000] += 3.0;
        raw[30_000] -= 2.0;
        raw[30_001] -= 2.0;
        raw[40_000..40_900].fill(0.0);
        let (values, states, count) = repaired(&raw);
        let expected =
            FaultCount { dropouts: 4, spikes: 2, bridged: 40 + 100 + 30 + 3, lost: 900, clipped: 0 };
        assert_eq!(count, expected);
        assert_eq!(states.iter().filter(|s| **s == State::Bridged).count(), 173);
        for (i, ((v, c), s)) in values.iter().zip(&clean).zip(&states).enumerate() {
            match s {
                State::Good | State::Clipped => assert_eq!(v, c),
                // The noise of both ends, and the sagitta 5·0.003²·100²/8 = 0.056 of the longest bridge.
                State::Bridged => assert!((v - c).abs() < 0.1 + 0.1 + 0.057, "{i}: {v} {c}"),
                State::Lost => assert!((40_000..40_900).contains(&i)),
            }
        }
    }

    #[test]
    fn turning_points_impacts_and_rest_are_no_faults() {
        // Without noise a coarse sine stands still at its turning points.
        let (_, _, count) = repaired(&signal(60_000, 0.005, 0.0));
        assert_eq!(count, FaultCount::default());
        // A step down within two samples, ringing behind it, and rest before.
        let mut raw = signal(20_000, 0.0, 0.02);
        for (k, v) in raw[10_000..10_400].iter_mut().enumerate() {
            *v -= 9.0;
            *v += 3.0 * (-(k as f64) / 40.0).exp() * (k as f64 * 1.2).sin();
        }
        let (_, _, count) = repaired(&raw);
        assert_eq!(count, FaultCount::default());
    }

    #[test]
    fn over_range_is_counted() {
        let raw: Vec<f64> = signal(60_000, 0.0, 0.2).iter().map(|v| v.clamp(-9.0, 4.0)).collect();
        let truth = raw.windows(3).filter(|w| w[1] == 4.0 && (w[0] == 4.0 || w[2] == 4.0)).count();
        let (_, _, count) = repaired(&raw);
        assert_eq!((count.dropouts, count.spikes), (0, 0));
        assert!(truth > 10_000 && count.clipped == truth, "{count:?} {truth}");
    }

    #[test]
    fn rest_at_an_extreme_is_no_end_of_the_range_and_takes_no_time() {
        // Half sines that end in coarse steps, or begin and end by a jump, and rest at 0 between them.
        for jump in [0.0, 1.0] {
            let one = |i: usize| {
                if i % 20_000 < 4000 { jump + 3.0 * ((i % 20_000) as f64 * PI / 4000.0).sin() } else { 0.0 }
            };
            let raw: Vec<f64> = (0..400_000).map(|i| (one(i) / 0.01).round() * 0.01).collect();
            let begun = std::time::Instant::now();
            let (_, _, count) = repaired(&raw);
            assert_eq!((count.dropouts, count.spikes, count.clipped), (0, 0, 0), "{jump}");
            // 8 ms in a program that is not optimised; a search for the beginning of the rest from each sample took 100 times that.
            assert!(begun.elapsed().as_secs_f64() < 2.0, "{:?}", begun.elapsed());
        }
    }

    #[test]
    fn nothing_but_missing_values_does_not_end_in_a_panic() {
        let (values, states, count) = repaired(&[f64::NAN; 300]);
        assert_eq!((values.len(), states.len(), count.dropouts, count.lost), (300, 300, 1, 300));
        let (values, _, _) = repaired(&[]);
        assert!(values.is_empty());
    }
}
