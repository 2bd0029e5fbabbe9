//! Faults of a laser vibrometer: drop-outs and speckle spikes are found and bridged, over-range is found.

use super::survey::{ChannelStatistics, noise};
use super::turns::Turn;
use std::ops::Range;
use vibro_record::Finding;

/// State of a sample after faults were bridged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// Measured.
    Good,
    /// Measured, but at the end of the range: over-range.
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
    /// Number of drop-outs: stretches of missing or of equal values.
    pub dropouts: usize,
    /// Number of spikes: one to three outliers, or a burst of 8 to 48.
    pub spikes: usize,
    /// Samples bridged by a straight line.
    pub bridged: usize,
    /// Samples in drop-outs that were too long to be bridged.
    pub lost: usize,
    /// Samples at the largest or smallest value of the channel: over-range.
    pub clipped: usize,
}

/// Samples examined on each side of equal values: around a drop-out most differ, in a signal at rest most
/// are equal.
const AROUND: usize = 16;
/// Longest speckle spike in samples.
const SPIKE: usize = 3;
/// Shortest burst of outliers in samples: fewer random values cannot be distinguished from a motion.
const SHORT_BURST: usize = 8;
/// Longest burst of outliers in samples: a dark speckle that passes within half a millisecond at 100 kHz.
const BURST: usize = 48;
/// Mean square of the second differences over that of the first, above which samples are a burst. Independent
/// values have 3; a sine has 1.6 at 0.22 of the sampling rate, and structures ring below that.
const ROUGH: f64 = 1.6;
/// Least mean square of each third of a burst over that of the whole. Ringing that decays below the height of
/// a spike has less in its last third.
const LAST_PART: f64 = 0.2;
/// Least distance of a spike from the line between its neighbours, over the change of the signal there.
const APART: f64 = 4.0;
/// Least step onto the first sample of a spike, over the height of a spike. A short spike has 7/8 at least,
/// since the line between its neighbours covers half of 1/[`APART`]; a burst may begin lower.
const ABRUPT: f64 = 0.7;
/// Samples on each side of a spike that must be calm: after an impact they ring.
const CALM: usize = 4;
/// Least height of a spike in standard deviations of the noise, which normal noise never reaches.
const SPIKE_NOISE: f64 = 10.0;
/// Least height of a spike over the range of the channel; smaller ones move neither impacts nor averages.
const SPIKE_RANGE: f64 = 0.02;
/// An extreme nearer to the median than this fraction of the larger excursion is the signal at rest, not the
/// end of the range.
const RAIL: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq)]
enum FaultKind {
    Dropout,
    Spike,
    OverRange,
}

/// Bridges the drop-outs and spikes of a velocity by straight lines, except those longer than `longest`
/// samples. Returns the state of each sample and the number of faults.
///
/// A *drop-out* is a stretch of missing values, or of more equal values than chance gives, entered or left by
/// a step amid neighbours that move. A *spike* is one to three samples far from both neighbours while these
/// agree, or a burst of 8 to 48 that jump from each to the next between calm ends; the two ends may lie
/// before and after an impact. *Over-range* is two or more samples at the largest or smallest value, entered
/// or left by a step. Neither a turning point of a coarsely digitised signal nor an impact is a fault.
pub(super) fn repair(
    values: &mut [f64],
    survey: &ChannelStatistics,
    longest: usize,
) -> (Vec<State>, FaultCount) {
    let height =
        (SPIKE_NOISE * noise(values).max(survey.quantum)).max(SPIKE_RANGE * (survey.high - survey.low));
    let faults = Velocity { raw: values, survey, height }.faults();
    let mut states = vec![State::Good; values.len()];
    let mut count = FaultCount::default();
    for (kind, range) in faults {
        let n = range.len();
        if kind == FaultKind::OverRange {
            states[range].fill(State::Clipped);
            count.clipped += n;
            continue;
        }
        count.dropouts += usize::from(kind == FaultKind::Dropout);
        count.spikes += usize::from(kind == FaultKind::Spike);
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

/// Parts of a turn; two neighbours are one phase.
const PARTS: usize = 100;
/// Turns with a fault at one phase over those that faults anywhere in the turn would give.
const RECURS: f64 = 3.0;

/// Finding on the phase at which at least half of four turns or more have a bridged fault, and more than
/// chance gives.
pub(super) fn recurring(states: &[State], turns: &[Turn]) -> Option<Finding> {
    let begins = |i: &usize| states[*i] == State::Bridged && states[i - 1] != State::Bridged;
    let (mut struck, mut faults) = ([0; PARTS], 0);
    for turn in turns {
        let mut own = [false; PARTS];
        for i in ((turn.start.ceil() as usize).max(1)..turn.end as usize).filter(begins) {
            let part = (PARTS as f64 * (i as f64 - turn.start) / (turn.end - turn.start)) as usize;
            (own[part % PARTS], own[(part + 1) % PARTS]) = (true, true);
            faults += 1;
        }
        struck.iter_mut().zip(own).for_each(|(struck, own)| *struck += usize::from(own));
    }
    let (part, &most) = struck.iter().enumerate().max_by_key(|(_, struck)| **struck)?;
    let all = turns.len();
    let by_chance = all as f64 * -(-2.0 * f64::from(faults) / (all * PARTS) as f64).exp_m1();
    let recurs = most >= 4 && 2 * most >= all && most as f64 > RECURS * by_chance;
    let phase = part as f64 / PARTS as f64;
    let finding =
        || Finding::caution("drill-faults-recur").number("phase", phase).count("n", most).count("all", all);
    recurs.then(finding)
}

/// A measured velocity that is searched for faults.
struct Velocity<'a> {
    raw: &'a [f64],
    survey: &'a ChannelStatistics,
    /// Least height of a spike, in the unit of the velocity.
    height: f64,
}

impl Velocity<'_> {
    fn faults(&self) -> Vec<(FaultKind, Range<usize>)> {
        let mut all: Vec<(FaultKind, Range<usize>)> = Vec::new();
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

    /// The fault that begins at sample `i`, and the first sample after it.
    fn fault(&self, i: usize) -> Option<(FaultKind, usize)> {
        let v = self.raw[i];
        let before = i.checked_sub(1).map(|k| self.raw[k]);
        if before == Some(v) {
            // Equal values are judged at the first of them.
            return None;
        }
        let same = |x: &&f64| **x == v || !(x.is_finite() || v.is_finite());
        let end = i + self.raw[i..].iter().take_while(same).count();
        if !v.is_finite() {
            Some((FaultKind::Dropout, end))
        } else if end - i > 1 {
            self.flat(i, end).map(|kind| (kind, end))
        } else if (v - before?).abs() < ABRUPT * self.height {
            None
        } else {
            self.spike(i).map(|end| (FaultKind::Spike, end))
        }
    }

    /// The kind of fault of the equal values from `i` up to `end`; `None` if they belong to the signal.
    fn flat(&self, i: usize, end: usize) -> Option<FaultKind> {
        let ChannelStatistics { low, high, median, quantum, longest_by_chance } = *self.survey;
        let v = self.raw[i];
        let before = &self.raw[i.saturating_sub(AROUND)..i];
        let after = &self.raw[end..(end + AROUND).min(self.raw.len())];
        // More than one step of the converter, with a margin for rounding.
        let step = |x: Option<&f64>| x.is_some_and(|x| (x - v).abs() > 1.5 * quantum);
        if !(step(before.last()) || step(after.first())) {
            return None;
        }
        if v == low || v == high {
            let reach = (median - low).max(high - median);
            return ((v - median).abs() > RAIL * reach).then_some(FaultKind::OverRange);
        }
        let pairs = before.windows(2).chain(after.windows(2));
        let (equal, all) = pairs.fold((0, 0), |(e, n), p| (e + usize::from(p[0] == p[1]), n + 1));
        (end - i >= longest_by_chance && 2 * equal <= all).then_some(FaultKind::Dropout)
    }

    /// The first sample after a spike that begins at `i`: one to three samples, or a burst, far from the line
    /// between their neighbours while the signal there is calm.
    fn spike(&self, i: usize) -> Option<usize> {
        let a = self.raw[i - 1];
        let spread = |x: f64, around: &[f64]| around.iter().map(|y| (x - y).abs()).fold(0.0, f64::max);
        let calm = spread(a, &self.raw[i.saturating_sub(1 + CALM)..i - 1]);
        (1..=BURST).find_map(|n| {
            let b = *self.raw.get(i + n)?;
            let from = i + n + 1;
            let behind = spread(b, self.raw.get(from..(from + CALM).min(self.raw.len())).unwrap_or(&[]));
            if n > SPIKE {
                let calm = calm.max(behind) < self.height;
                return (n >= SHORT_BURST && calm && self.is_burst(i..i + n)).then_some(i + n);
            }
            let enough = self.height.max(APART * (b - a).abs().max(calm).max(behind));
            let off = |k: usize| (self.raw[i + k] - (a + (b - a) * (k + 1) as f64 / (n + 1) as f64)).abs();
            (0..n).all(|k| off(k) > enough).then_some(i + n)
        })
    }

    /// Whether these samples jump from one to the next and lie far from the samples at both ends, between
    /// which an impact may lie. Ringing after an impact decays, a burst does not.
    fn is_burst(&self, burst: Range<usize>) -> bool {
        let (a, b) = (self.raw[burst.start - 1], self.raw[burst.end]);
        let off = |v: &f64| (v - a).abs().min((v - b).abs()).powi(2);
        let power = |part: &[f64]| part.iter().map(off).sum::<f64>() / part.len() as f64;
        let values = &self.raw[burst];
        let least = self.height.powi(2).max(LAST_PART * power(values));
        if !values.chunks(values.len().div_ceil(3)).all(|part| power(part) > least) {
            return false;
        }
        let steps = |values: &[f64]| values.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>();
        let square = |steps: &[f64]| steps.iter().map(|d| d * d).sum::<f64>() / steps.len() as f64;
        let first = steps(values);
        // Steps of 0 belong to a drop-out, which holds its value.
        let held = first.iter().filter(|step| **step == 0.0).count();
        2 * held < first.len() && square(&steps(&first)) > ROUGH * square(&first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use vibro_math::Noise;

    /// A sine digitised in steps of `quantum`, with a little noise.
    fn signal(n: usize, quantum: f64, noise: f64) -> Vec<f64> {
        let mut draw = Noise::new(7);
        (0..n)
            .map(|i| {
                let v = 5.0 * (i as f64 * 0.003).sin() + noise * (draw.uniform() - 0.5);
                if quantum > 0.0 { (v / quantum).round() * quantum } else { v }
            })
            .collect()
    }

    fn repaired(raw: &[f64]) -> (Vec<f64>, Vec<State>, FaultCount) {
        let mut values = raw.to_vec();
        let (states, count) = repair(&mut values, &ChannelStatistics::of(raw), 500);
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

    /// A fault at 0.3 of each turn recurs, one at any place does not.
    #[test]
    fn faults_at_one_phase_recur() {
        let turns: Vec<Turn> = (0..40)
            .map(|k| Turn { start: 0.5 + 500.0 * f64::from(k), end: 500.5 + 500.0 * f64::from(k) })
            .collect();
        let states = |place: &mut dyn FnMut() -> f64| {
            let mut states = vec![State::Good; 20_002];
            for turn in &turns {
                let at = (turn.start + 500.0 * place()) as usize;
                states[at..at + 5].fill(State::Bridged);
            }
            recurring(&states, &turns)
        };
        let mut noise = Noise::new(1);
        let found = states(&mut || 0.3 + 0.004 * (noise.uniform() - 0.5)).unwrap();
        assert!(
            found.get("n") == Some(40.0) && (found.get("phase").unwrap() - 0.3).abs() < 0.011,
            "{found:?}"
        );
        assert_eq!(states(&mut || 0.98 * noise.uniform()), None);
    }

    #[test]
    fn bursts_of_outliers_are_bridged_whole() {
        let clean = signal(60_000, 0.0, 0.1);
        let mut raw = clean.clone();
        let bursts: Vec<(usize, usize)> = (0..36).map(|k| (1000 + 1400 * k, 10 + k)).collect();
        for (k, (at, n)) in bursts.iter().enumerate() {
            // A dark speckle: ±6 m/s with equal chance.
            let mut random = Noise::new(k as u64);
            raw[*at..at + n].iter_mut().for_each(|v| *v = random.between(-6.0, 6.0));
        }
        let (values, states, count) = repaired(&raw);
        // Of values between −6 and 6 m/s, 6 % lie within the height of a spike, 0.36 m/s, of the motion. At
        // an end of a burst they stay, and do no harm.
        let all: usize = bursts.iter().map(|b| b.1).sum();
        assert!(count.bridged <= all && count.bridged > 9 * all / 10, "{count:?} of {all}");
        assert_eq!(states.iter().filter(|s| **s == State::Bridged).count(), count.bridged);
        let height = SPIKE_NOISE * noise(&raw).max(SPIKE_RANGE * 12.0);
        // A bridge between ends that are off by up to the height of a spike, and the sagitta of the motion.
        let off = values.iter().zip(&clean).map(|(v, c)| (v - c).abs()).fold(0.0, f64::max);
        assert!(off < 1.2 * height.max(0.36), "{off} {height}");
    }

    #[test]
    fn turning_points_impacts_and_rest_are_no_faults() {
        // Without noise a coarse sine stands still at its turning points.
        let (_, _, count) = repaired(&signal(60_000, 0.005, 0.0));
        assert_eq!(count, FaultCount::default());
        // A step down within two samples, ringing after it, and rest before.
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
            // Takes 8 ms without optimisation; searching the beginning of the rest from each sample took 100
            // times as long.
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
