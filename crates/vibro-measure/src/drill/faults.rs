//! Faults of a laser vibrometer: drop-outs and speckle spikes, found and bridged.

use super::survey::Survey;

/// What is known of a repaired sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
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

/// Neighbours that are looked at to tell a drop-out from a signal at rest.
const AROUND: usize = 16;
/// Longest spike in samples.
const SPIKE: usize = 3;
/// Samples on both sides of a spike that must be calm.
const CALM: usize = 4;
/// Samples between two faults that are one.
const JOIN: usize = 3;
/// A spike stands this many standard deviations of the noise off its neighbours.
const SPIKE_NOISE: f64 = 10.0;
/// … and this part of the range of the channel.
const SPIKE_RANGE: f64 = 0.02;
/// An extreme nearer to the median than this part of the reach is where the signal rests.
const RAIL: f64 = 0.1;
/// Samples gathered before they are looked at.
const CHUNK: usize = 1 << 14;
/// Samples after which a fault without an end is given out as lost.
const ENDLESS: usize = 1 << 20;

/// Finds and bridges faults in blocks of samples.
///
/// A *drop-out* is a stretch of missing values, or of equal values longer than chance gives, with moving neighbours; a *spike*
/// is one to three samples that stand off both neighbours while these agree. Neither a turning point of a coarsely digitised
/// signal nor an impact is one.
#[derive(Debug, Clone)]
pub struct Faults {
    equal: usize,
    longest: usize,
    quantum: f64,
    height: f64,
    limits: (f64, f64),
    /// Extremes that may be the end of the range: those far from where the signal is most of the time.
    rails: [f64; 2],
    raw: Vec<f64>,
    done: usize,
    endless: bool,
    /// Whether the equal samples that are gone over were entered by a step.
    entered: bool,
    /// Whether the sample before was over-range.
    over: bool,
    count: FaultCount,
}

enum Kind {
    Dropout,
    Spike,
}

impl Faults {
    /// Faults in a channel that looks like `survey`; those longer than `longest` samples are not bridged.
    pub fn new(survey: &Survey, longest: usize) -> Faults {
        let (low, high) = survey.range().unwrap_or((0.0, 0.0));
        Faults {
            equal: survey.longest_by_chance(),
            longest,
            quantum: survey.quantum(),
            height: (SPIKE_NOISE * survey.noise().max(survey.quantum())).max(SPIKE_RANGE * (high - low)),
            limits: (low, high),
            rails: rails(survey.middle(), low, high),
            raw: Vec::new(),
            done: 0,
            endless: false,
            entered: false,
            over: false,
            count: FaultCount::default(),
        }
    }

    /// Takes the next samples and gives out those that are certain, after those that are in `values` already.
    pub fn push(&mut self, block: &[f64], values: &mut Vec<f64>, states: &mut Vec<State>) {
        self.raw.extend(block);
        if self.raw.len() - self.done >= CHUNK {
            self.repair(false, values, states);
        }
    }

    /// Gives out the rest.
    pub fn finish(mut self, values: &mut Vec<f64>, states: &mut Vec<State>) -> FaultCount {
        self.repair(true, values, states);
        self.count
    }

    fn repair(&mut self, last: bool, values: &mut Vec<f64>, states: &mut Vec<State>) {
        let mut at = self.done;
        // A fault may begin at any sample whose neighbours are known.
        let certain = if last { self.raw.len() } else { self.raw.len().saturating_sub(2 * AROUND) };
        while at < certain {
            let Some((kind, mut end)) = self.fault(at) else {
                let clipped = self.clipped(at);
                self.over = clipped;
                self.count.clipped += usize::from(clipped);
                values.push(self.raw[at]);
                states.push(if clipped { State::Clipped } else { State::Good });
                at += 1;
                self.endless = false;
                continue;
            };
            let mut kind = kind;
            while let Some((joined, further)) = (end..end + JOIN).find_map(|i| self.fault(i)) {
                end = further;
                if matches!(joined, Kind::Dropout) {
                    kind = joined;
                }
            }
            let open = end + 2 * AROUND > self.raw.len() && !last;
            if open && end - at < ENDLESS {
                break;
            }
            self.bridge(at, end, &kind, values, states);
            self.endless = open;
            (self.entered, self.over) = (false, false);
            at = end;
        }
        let keep = at.saturating_sub(AROUND + SPIKE);
        self.raw.drain(..keep);
        self.done = at - keep;
    }

    fn bridge(&mut self, at: usize, end: usize, kind: &Kind, values: &mut Vec<f64>, states: &mut Vec<State>) {
        let n = end - at;
        let before = at.checked_sub(1).map(|i| self.raw[i]).filter(|v| v.is_finite());
        let after = self.raw.get(end).copied().filter(|v| v.is_finite());
        let lost = n > self.longest || self.endless || before.or(after).is_none();
        let (a, b) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
        values.extend((1..=n).map(|k| a + (b - a) * k as f64 / (n + 1) as f64));
        states.extend(std::iter::repeat_n(if lost { State::Lost } else { State::Bridged }, n));
        if lost {
            self.count.lost += n;
        } else {
            self.count.bridged += n;
        }
        if self.endless {
            return;
        }
        match kind {
            Kind::Dropout => self.count.dropouts += 1,
            Kind::Spike => self.count.spikes += 1,
        }
    }

    /// The fault that begins at sample `i`, and the sample behind it.
    fn fault(&self, i: usize) -> Option<(Kind, usize)> {
        let v = *self.raw.get(i)?;
        if !v.is_finite() {
            let n = self.raw[i..].iter().take_while(|v| !v.is_finite()).count();
            return Some((Kind::Dropout, i + n));
        }
        let next = *self.raw.get(i + 1)?;
        if next == v {
            return self.flat(i).map(|end| (Kind::Dropout, end));
        }
        let before = *self.raw.get(i.checked_sub(1)?)?;
        if (v - before).abs() < 0.7 * self.height {
            None
        } else {
            self.spike(i).map(|end| (Kind::Spike, end))
        }
    }

    /// Equal values, more than chance gives, that the signal enters or leaves by a step, or amid neighbours that move.
    fn flat(&self, i: usize) -> Option<usize> {
        let v = self.raw[i];
        if !self.endless && i > 0 && self.raw[i - 1] == v {
            return None;
        }
        let end = i + self.raw[i..].iter().take_while(|x| **x == v).count();
        if end - i < self.equal {
            return None;
        }
        let before = &self.raw[i.saturating_sub(AROUND)..i];
        let after = &self.raw[end..(end + AROUND).min(self.raw.len())];
        let step = |x: Option<&f64>| x.is_some_and(|x| (x - v).abs() > 1.5 * self.quantum);
        let steps = step(before.last()) || step(after.first());
        let limit = v <= self.limits.0 || v >= self.limits.1;
        if !steps || limit {
            return None;
        }
        let pairs = before.windows(2).chain(after.windows(2));
        let (equal, all) = pairs.fold((0, 0), |(e, n), p| (e + usize::from(p[0] == p[1]), n + 1));
        (2 * equal <= all).then_some(end)
    }

    /// One to three samples off the line between their neighbours, while the signal there is calm.
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

    /// Whether a sample stands at the end of the range, equals a neighbour, and was not reached by resolution.
    fn clipped(&mut self, i: usize) -> bool {
        let v = self.raw[i];
        let before = i.checked_sub(1).and_then(|k| self.raw.get(k));
        let step = |x: &f64| (x - v).abs() > 1.5 * self.quantum;
        let goes_on = before == Some(&v);
        let entered = if goes_on { self.entered } else { before.is_some_and(step) };
        self.entered = entered;
        if !self.rails.contains(&v) || !(goes_on || self.raw.get(i + 1) == Some(&v)) {
            return false;
        }
        let near = (i + 1 + 2 * AROUND).min(self.raw.len());
        let left = || self.raw[i + 1..near].iter().find(|x| **x != v).is_some_and(step);
        entered || (goes_on && self.over) || left()
    }
}

/// Extremes farther from the `middle` of a signal than a part of the farther one; not a number where the signal rests.
fn rails(middle: f64, low: f64, high: f64) -> [f64; 2] {
    let reach = (middle - low).max(high - middle);
    [low, high].map(|v| if (v - middle).abs() > RAIL * reach { v } else { f64::NAN })
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
