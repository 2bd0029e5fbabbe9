//! Faults of a laser vibrometer: drop-outs and speckle spikes, found and bridged; over-range, found.

use super::survey::Survey;

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
/// A laser that comes back for fewer samples than these has not come back.
const JOIN: usize = 3;
/// A spike stands this many standard deviations of the noise off its neighbours, which normal noise never does.
const SPIKE_NOISE: f64 = 10.0;
/// … and this part of the range of the channel; smaller ones move neither impacts nor averages.
const SPIKE_RANGE: f64 = 0.02;
/// An extreme nearer to the median than this part of the reach is where the signal rests, not the end of the range.
const RAIL: f64 = 0.1;
/// Most samples looked ahead, whatever is to be bridged: memory is bounded.
const FARTHEST: usize = 1 << 20;

/// Finds and bridges faults in blocks of samples.
///
/// A *drop-out* is a stretch of missing values, or of equal values longer than chance gives, entered or left by a step amid
/// neighbours that move; a *spike* is one to three samples that stand off both neighbours while these agree; *over-range* are two or
/// more samples at the largest or smallest value, entered or left by a step. Neither a turning point of a coarsely digitised signal nor
/// an impact is a fault.
#[derive(Debug, Clone)]
pub(super) struct Faults {
    equal: usize,
    longest: usize,
    /// Samples that are known behind each that is judged.
    ahead: usize,
    quantum: f64,
    height: f64,
    limits: [f64; 2],
    /// Those of the limits that may be the end of the range: far from where the signal is most of the time.
    rails: [f64; 2],
    raw: Vec<f64>,
    done: usize,
    /// Kind of the stretch that was longer than could be looked ahead and may go on.
    open: Option<Kind>,
    count: FaultCount,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Dropout,
    Spike,
    OverRange,
}

impl Faults {
    /// Faults in a channel that looks like `survey`; those longer than `longest` samples are not bridged.
    pub fn new(survey: &Survey, longest: usize) -> Faults {
        let (low, high) = survey.range().unwrap_or((0.0, 0.0));
        let middle = survey.median();
        let reach = (middle - low).max(high - middle);
        Faults {
            equal: survey.longest_by_chance(),
            longest,
            ahead: longest.min(FARTHEST) + 2 * AROUND,
            quantum: survey.quantum(),
            height: (SPIKE_NOISE * survey.noise().max(survey.quantum())).max(SPIKE_RANGE * (high - low)),
            limits: [low, high],
            rails: [low, high].map(|v| if (v - middle).abs() > RAIL * reach { v } else { f64::NAN }),
            raw: Vec::new(),
            done: 0,
            open: None,
            count: FaultCount::default(),
        }
    }

    /// Takes the next samples and gives out those that are certain, after those that are in `values` already.
    pub fn push(&mut self, block: &[f64], values: &mut Vec<f64>, states: &mut Vec<State>) {
        self.raw.extend(block);
        self.repair(self.raw.len().saturating_sub(self.ahead), values, states);
    }

    /// Gives out the rest.
    pub fn finish(&mut self, values: &mut Vec<f64>, states: &mut Vec<State>) -> FaultCount {
        self.repair(self.raw.len(), values, states);
        self.count
    }

    fn repair(&mut self, to: usize, values: &mut Vec<f64>, states: &mut Vec<State>) {
        let mut at = self.done;
        while at < to {
            let open = self.open.take();
            let Some((mut kind, mut end)) = self.stretch(at, open) else {
                values.push(self.raw[at]);
                states.push(State::Good);
                at += 1;
                continue;
            };
            if kind == Kind::OverRange {
                values.extend(&self.raw[at..end]);
                states.extend(std::iter::repeat_n(State::Clipped, end - at));
                self.count.clipped += end - at;
            } else {
                let near = |end: usize| (end..end + JOIN).find_map(|i| self.stretch(i, None));
                while let Some((joined, further)) = near(end).filter(|(k, _)| *k != Kind::OverRange) {
                    end = further;
                    if joined == Kind::Dropout {
                        kind = joined;
                    }
                }
                let lost = end - at > self.longest || open.is_some();
                self.bridge(at, end, lost, values, states);
                match kind {
                    _ if open.is_some() => {}
                    Kind::Spike => self.count.spikes += 1,
                    _ => self.count.dropouts += 1,
                }
            }
            self.open = (end - at >= self.ahead || end == self.raw.len()).then_some(kind);
            at = end;
        }
        let keep = at.saturating_sub(AROUND + SPIKE);
        self.raw.drain(..keep);
        self.done = at - keep;
    }

    fn bridge(&mut self, at: usize, end: usize, lost: bool, values: &mut Vec<f64>, states: &mut Vec<State>) {
        let n = end - at;
        let before = at.checked_sub(1).map(|i| self.raw[i]).filter(|v| v.is_finite());
        let after = self.raw.get(end).copied().filter(|v| v.is_finite());
        let lost = lost || before.or(after).is_none();
        let (a, b) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
        values.extend((1..=n).map(|k| a + (b - a) * k as f64 / (n + 1) as f64));
        states.extend(std::iter::repeat_n(if lost { State::Lost } else { State::Bridged }, n));
        if lost {
            self.count.lost += n;
        } else {
            self.count.bridged += n;
        }
    }

    /// The fault that begins at sample `i` or goes on there from an `open` one, and the sample behind it.
    fn stretch(&self, i: usize, open: Option<Kind>) -> Option<(Kind, usize)> {
        let v = *self.raw.get(i)?;
        let same = |x: &f64| *x == v || !(x.is_finite() || v.is_finite());
        let before = i.checked_sub(1).map(|k| self.raw[k]);
        let goes_on = before.is_some_and(|b| same(&b));
        if goes_on && v.is_finite() && open.is_none() {
            // Judged where it began.
            return None;
        }
        let end = i + self.raw[i..].iter().take(self.ahead).take_while(|x| same(x)).count();
        match open {
            Some(kind) if goes_on => Some((kind, end)),
            _ if !v.is_finite() => Some((Kind::Dropout, end)),
            _ if end - i > 1 => self.flat(i, end).map(|kind| (kind, end)),
            _ if (v - before?).abs() < 0.7 * self.height => None,
            _ => self.spike(i).map(|end| (Kind::Spike, end)),
        }
    }

    /// What a stretch of equal values is.
    fn flat(&self, i: usize, end: usize) -> Option<Kind> {
        let v = self.raw[i];
        let before = &self.raw[i.saturating_sub(AROUND)..i];
        let after = &self.raw[end..(end + AROUND).min(self.raw.len())];
        let step = |x: Option<&f64>| x.is_some_and(|x| (x - v).abs() > 1.5 * self.quantum);
        if !(step(before.last()) || step(after.first())) {
            return None;
        }
        if self.limits.contains(&v) {
            return self.rails.contains(&v).then_some(Kind::OverRange);
        }
        let pairs = before.windows(2).chain(after.windows(2));
        let (equal, all) = pairs.fold((0, 0), |(e, n), p| (e + usize::from(p[0] == p[1]), n + 1));
        (end - i >= self.equal && 2 * equal <= all).then_some(Kind::Dropout)
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
            let enough = [self.height, 4.0 * (b - a).abs(), 4.0 * calm, 4.0 * behind];
            let enough = enough.into_iter().fold(0.0, f64::max);
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

    fn repaired(raw: &[f64], block: usize) -> (Vec<f64>, Vec<State>, FaultCount) {
        let mut survey = Survey::default();
        survey.push(raw);
        let mut faults = Faults::new(&survey, 500);
        let (mut values, mut states) = (Vec::new(), Vec::new());
        raw.chunks(block).for_each(|b| faults.push(b, &mut values, &mut states));
        let count = faults.finish(&mut values, &mut states);
        (values, states, count)
    }

    #[test]
    fn faults_are_counted_and_bridged_in_blocks_of_any_size() {
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
        let (values, states, count) = repaired(&raw, raw.len());
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
        for block in [1, 17, 5000, 16_384] {
            assert!(repaired(&raw, block) == (values.clone(), states.clone(), count), "{block}");
        }
    }

    #[test]
    fn turning_points_impacts_and_rest_are_no_faults() {
        // Without noise a coarse sine stands still at its turning points.
        let (_, _, count) = repaired(&signal(60_000, 0.005, 0.0), 9999);
        assert_eq!(count, FaultCount::default());
        // A step down within two samples, ringing behind it, and rest before.
        let mut raw = signal(20_000, 0.0, 0.02);
        for (k, v) in raw[10_000..10_400].iter_mut().enumerate() {
            *v -= 9.0;
            *v += 3.0 * (-(k as f64) / 40.0).exp() * (k as f64 * 1.2).sin();
        }
        let (_, _, count) = repaired(&raw, 777);
        assert_eq!(count, FaultCount::default());
    }

    #[test]
    fn over_range_is_counted() {
        let raw: Vec<f64> = signal(60_000, 0.0, 0.2).iter().map(|v| v.clamp(-9.0, 4.0)).collect();
        let truth = raw.windows(3).filter(|w| w[1] == 4.0 && (w[0] == 4.0 || w[2] == 4.0)).count();
        let (_, _, count) = repaired(&raw, 5000);
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
            let (_, _, count) = repaired(&raw, 9999);
            assert_eq!((count.dropouts, count.spikes, count.clipped), (0, 0, 0), "{jump}");
            // 8 ms in a program that is not optimised; a search for the beginning of the rest from each sample took 100 times that.
            assert!(begun.elapsed().as_secs_f64() < 2.0, "{:?}", begun.elapsed());
        }
    }

    #[test]
    fn nothing_but_missing_values_does_not_end_in_a_panic() {
        let (values, states, count) = repaired(&[f64::NAN; 300], 7);
        assert_eq!((values.len(), states.len(), count.dropouts, count.lost), (300, 300, 1, 300));
        let (values, _, _) = repaired(&[], 1);
        assert!(values.is_empty());
    }
}
