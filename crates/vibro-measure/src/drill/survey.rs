//! First look over a channel: extremes, levels, noise. Memory does not grow with its length.

use crate::median::upper_median;

/// Groups whose extremes are kept: memory is bounded.
const GROUPS: usize = 1 << 14;
/// Places at which differences are kept: their median is known to 1.3 % or better.
const PLACES: usize = 1 << 14;
/// Fewer values than these do not make a level: a pulse shorter than a thousandth of a turn.
const FEW: usize = 50;
/// Median of |x| of a normal distribution of unit variance.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// What a channel looks like, found in one pass.
#[derive(Debug, Clone)]
pub(crate) struct Survey {
    samples: u64,
    missing: u64,
    envelope: Envelope,
    differences: Differences,
    before: [f64; 2],
}

/// Lowest and highest value of groups of samples; the groups double when they become too many.
#[derive(Debug, Clone)]
struct Envelope {
    extremes: Vec<(f64, f64)>,
    length: u64,
    filled: u64,
    open: (f64, f64),
}

/// Values with their first and second differences at places of which one lies at random in each stretch of equal length; the stretches
/// double when they become too many.
#[derive(Debug, Clone)]
struct Differences {
    kept: Vec<Place>,
    stretch: u64,
    next: u64,
    state: u64,
}

#[derive(Debug, Clone, Copy)]
struct Place {
    value: f64,
    first: f64,
    second: f64,
}

const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// Extremes of two pairs of extremes.
fn around(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl Default for Survey {
    fn default() -> Survey {
        Survey {
            samples: 0,
            missing: 0,
            envelope: Envelope { extremes: Vec::new(), length: 1, filled: 0, open: NOTHING },
            differences: Differences { kept: Vec::new(), stretch: 1, next: 2, state: 0x9E37_79B9_7F4A_7C15 },
            before: [f64::NAN; 2],
        }
    }
}

impl Survey {
    /// Takes the next samples; missing ones are NaN.
    pub fn push(&mut self, block: &[f64]) {
        for &v in block {
            if v.is_finite() {
                self.envelope.push(v);
            } else {
                self.missing += 1;
            }
            if self.samples == self.differences.next {
                let [b, a] = self.before;
                let place = Place { value: v, first: v - b, second: v - 2.0 * b + a };
                self.differences.keep(place, self.samples);
            }
            self.before = [v, self.before[0]];
            self.samples += 1;
        }
    }

    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Number of missing samples.
    pub fn missing(&self) -> u64 {
        self.missing
    }

    /// Lowest and highest value; `None` where there is no value at all.
    pub fn range(&self) -> Option<(f64, f64)> {
        let (low, high) = self.envelope.all().fold(NOTHING, around);
        (low <= high).then_some((low, high))
    }

    /// Median of the values.
    pub fn median(&self) -> f64 {
        median(self.differences.kept.iter().map(|d| d.value))
    }

    /// Standard deviation of white noise on a smooth signal: second differences of noise scatter √6 as much, and their
    /// median is not moved by the few places where the signal is not smooth.
    pub fn noise(&self) -> f64 {
        median(self.differences.kept.iter().map(|d| d.second.abs())) / (NORMAL_MEDIAN * 6f64.sqrt())
    }

    /// Smallest step between neighbours that is not 0: the resolution, where the channel was digitised coarsely.
    pub(crate) fn quantum(&self) -> f64 {
        let steps = self.differences.kept.iter().map(|d| d.first.abs()).filter(|d| *d > 0.0);
        let smallest = steps.fold(f64::INFINITY, f64::min);
        if smallest.is_finite() { smallest } else { 0.0 }
    }

    /// Number of equal neighbours that chance does not give in the whole channel (once in a thousand such channels).
    pub(crate) fn longest_by_chance(&self) -> usize {
        let n = self.differences.kept.len().max(1) as f64;
        let equal = self.differences.kept.iter().filter(|d| d.first == 0.0).count() as f64;
        // One more than was seen: none among a few thousand does not mean never.
        let p = ((equal + 1.0) / (n + 1.0)).min(0.999);
        let needed = ((1e-3 / self.samples.max(1) as f64).ln() / p.ln()).ceil() + 1.0;
        (needed as usize).clamp(4, 64)
    }

    /// The two levels of a pulsed signal: medians of the values on both sides of the threshold that Otsu's method finds
    /// between its local extremes (N. Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979) 62). `None` where there is only one level.
    pub fn levels(&self) -> Option<(f64, f64)> {
        let mut all: Vec<f64> = self.envelope.all().flat_map(|(low, high)| [low, high]).collect();
        all.sort_by(f64::total_cmp);
        let total: f64 = all.iter().sum();
        let n = all.len() as f64;
        let (mut below, mut best) = (0.0, (0.0, None));
        for (i, pair) in all.windows(2).enumerate() {
            below += pair[0];
            let count = (i + 1) as f64;
            let (low, high) = (below / count, (total - below) / (n - count));
            let between = count * (n - count) * (high - low) * (high - low);
            if pair[1] > pair[0] && between > best.0 {
                best = (between, Some((i + 1, 0.5 * (low + high))));
            }
        }
        let (split, threshold) = best.1?;
        let (low, high) = all.split_at(split);
        Some((self.level(low, |v| v <= threshold), self.level(high, |v| v > threshold)))
    }

    /// Part of the values that lie within a tenth of the height of a pulse from one of its two levels; 0 where there is only one.
    pub(crate) fn two_levels(&self) -> f64 {
        let Some((low, high)) = self.levels() else { return 0.0 };
        let near = |v: f64| (v - low).abs().min((v - high).abs()) < 0.1 * (high - low);
        let kept = &self.differences.kept;
        kept.iter().filter(|d| near(d.value)).count() as f64 / kept.len().max(1) as f64
    }

    /// Median of the values kept on one side, or of the extremes there where too few values are.
    fn level(&self, extremes: &[f64], side: impl Fn(f64) -> bool) -> f64 {
        let kept: Vec<f64> = self.differences.kept.iter().map(|d| d.value).filter(|v| side(*v)).collect();
        median(if kept.len() < FEW { extremes } else { &kept }.iter().copied())
    }
}

impl Envelope {
    fn push(&mut self, v: f64) {
        self.open = around(self.open, (v, v));
        self.filled += 1;
        if self.filled < self.length {
            return;
        }
        self.extremes.push(self.open);
        (self.open, self.filled) = (NOTHING, 0);
        if self.extremes.len() == GROUPS {
            self.extremes =
                self.extremes.chunks(2).map(|c| c.iter().copied().fold(NOTHING, around)).collect();
            self.length *= 2;
        }
    }

    fn all(&self) -> impl Iterator<Item = (f64, f64)> {
        self.extremes.iter().copied().chain((self.filled > 0).then_some(self.open))
    }
}

impl Differences {
    fn keep(&mut self, place: Place, at: u64) {
        if place.second.is_finite() {
            self.kept.push(place);
        }
        if self.kept.len() == PLACES {
            let mut take = false;
            self.kept.retain(|_| {
                take = !take;
                take
            });
            self.stretch *= 2;
        }
        // A random place in the next stretch, so that no period of the signal is in step with the places.
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.next = (at / self.stretch + 1) * self.stretch + (self.state >> 33) % self.stretch;
    }
}

/// Median of some values; 0 where there are none.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    upper_median(values).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_pulses_have_two_levels_however_long_the_record() {
        for turns in [400, 4000] {
            let mut survey = Survey::default();
            for _ in 0..turns {
                // A pulse of 3 samples in 500: 0.6 % of the time; a glitch of ten times its height in the record.
                let mut turn = vec![0.25; 500];
                turn[100..103].fill(4.75);
                survey.push(&turn);
            }
            survey.push(&[0.25, 40.0, f64::NAN]);
            let (low, high) = survey.levels().unwrap();
            assert_eq!((low, high), (0.25, 4.75), "{turns}");
            assert!(survey.two_levels() > 0.99);
            assert_eq!((survey.samples(), survey.missing()), (turns * 500 + 3, 1));
            assert_eq!(survey.range(), Some((0.25, 40.0)));
        }
        let mut flat = Survey::default();
        flat.push(&[1.0; 100]);
        assert_eq!(flat.levels(), None);
    }

    #[test]
    fn noise_and_resolution_of_a_digitised_sine() {
        let (mut state, mut survey) = (1u64, Survey::default());
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let block: Vec<f64> = (0..300_000)
            .map(|i| {
                // Twelve uniform numbers have a sum of variance 1, close to normal.
                let noise: f64 = (0..12).map(|_| uniform()).sum();
                let v = (f64::from(i) * 0.003).sin() + 0.05 * noise;
                (v / 0.001).round() * 0.001
            })
            .collect();
        survey.push(&block);
        // Medians of the halves of a sine, ±1/√2, and a tenth of their distance: (asin 0.849 − asin 0.566)·2/π = 0.26, less with noise.
        assert!((survey.two_levels() - 0.26).abs() < 0.03, "{}", survey.two_levels());
        // A median of 8000 absolute values or more scatters by 1.17/√8000 = 1.3 %; four times that.
        assert!((survey.noise() / 0.05 - 1.0).abs() < 0.052, "{}", survey.noise());
        assert!((survey.quantum() - 0.001).abs() < 1e-9);
        assert!((4..12).contains(&survey.longest_by_chance()));
    }
}
