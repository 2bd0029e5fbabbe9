//! Impacts that come in a pattern: intervals that repeat after a few impacts, and are unlike within them.

use super::background::median;

/// Intervals that repeat.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Intervals of the pattern in s, in their order; two at least.
    pub intervals: Vec<f64>,
    /// Place in `intervals` of the first interval of the record.
    pub first: usize,
}

/// Intervals are alike where they differ by less than this part of the shorter.
const ALIKE: f64 = 0.1;
/// This part of all intervals must be like those a pattern before.
const REPEATED: f64 = 0.9;
/// Most impacts of a pattern.
const LONGEST: usize = 8;
/// A pattern must be seen this often.
const SEEN: usize = 3;

/// Whether two intervals are alike.
pub fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= ALIKE * a.min(b)
}

/// The shortest pattern that `steps` repeat; `None` where they are even, or repeat nothing.
///
/// Where every interval of p is unlike its neighbours in each round, it is a pattern of the impacts: an impact that is missed by chance is missed in
/// few rounds.
pub fn pattern(steps: &[f64]) -> Option<Pattern> {
    let repeated = |p: usize| {
        let pairs = steps.len().saturating_sub(p);
        let n = steps.iter().zip(&steps[steps.len() - pairs..]).filter(|(a, b)| alike(**a, **b)).count();
        n as f64 / pairs.max(1) as f64
    };
    let uneven = 1.0 - repeated(1);
    let length = (2..=LONGEST).take_while(|p| steps.len() >= SEEN * p).find(|p| {
        // One unlike interval in each round differs from both its neighbours.
        repeated(*p) >= REPEATED && uneven >= 2.0 * REPEATED / *p as f64 * REPEATED
    })?;
    let from = (0..steps.len() + 1 - 2 * length)
        .find(|i| (0..length).all(|k| alike(steps[i + k], steps[i + k + length])))?;
    let first = (length - from % length) % length;
    let intervals = (0..length)
        .map(|place| {
            let model = steps[from + (place + length - first - from % length) % length];
            let same: Vec<f64> = (0..steps.len())
                .filter(|i| (first + i) % length == place && alike(steps[*i], model))
                .map(|i| steps[i])
                .collect();
            if same.is_empty() { model } else { median(&same) }
        })
        .collect();
    Some(Pattern { intervals, first })
}

/// What an interval is to a train.
pub enum Step {
    /// So many intervals of the train: all but one of their impacts are missed.
    Several(usize),
    /// The first part of one: the impact at its end is one too many.
    Part,
    /// The interval at another place of the pattern.
    At(usize),
}

impl Pattern {
    /// What the interval `d` is, where the next is `place` and another, `later`, follows it.
    pub fn step(&self, place: usize, d: f64, later: Option<f64>) -> Step {
        let p = self.intervals.len();
        let at = |k: usize| self.intervals[k % p];
        if alike(d, at(place)) {
            return Step::Several(1);
        }
        if later.is_some_and(|l| alike(d + l, at(place))) {
            return Step::Part;
        }
        let period: f64 = self.intervals.iter().sum();
        let rounds = (d / period).floor().min(1e6);
        let mut sum = rounds * period;
        let whole = rounds as usize * p;
        let mut nearest = (0, f64::INFINITY);
        for k in 0..=p {
            let off = (d - sum).abs();
            if whole + k > 1 && off < nearest.1 {
                nearest = (whole + k, off);
            }
            sum += at(place + k);
        }
        // Intervals that may each be off by a tenth are together off by √k of it; by half of one, it would be another k.
        let shortest = self.intervals.iter().copied().fold(f64::INFINITY, f64::min);
        if nearest.1 <= (ALIKE * (nearest.0 as f64).sqrt()).min(0.5) * shortest {
            return Step::Several(nearest.0);
        }
        (0..p).find(|k| alike(d, at(*k))).map_or(Step::Several(1), Step::At)
    }
}

/// Times without what their places in the pattern shift them by: an even train. One slope fits all places.
pub fn evened(times: &[f64], index: &[usize], place: &[usize], length: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0, 0.0); length];
    for ((t, i), p) in times.iter().zip(index).zip(place) {
        let s = &mut sums[p % length];
        *s = (s.0 + 1.0, s.1 + *i as f64, s.2 + t);
    }
    let centred = |t: f64, i: usize, p: usize| {
        let s = sums[p % length];
        (i as f64 - s.1 / s.0, t - s.2 / s.0)
    };
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for ((t, i), p) in times.iter().zip(index).zip(place) {
        let (x, y) = centred(*t, *i, *p);
        sxx += x * x;
        sxy += x * y;
    }
    let slope = sxy / sxx;
    let used: Vec<&(f64, f64, f64)> = sums.iter().filter(|s| s.0 > 0.0).collect();
    let offset = |s: &(f64, f64, f64)| (s.2 - slope * s.1) / s.0;
    let mean = used.iter().map(|s| offset(s)).sum::<f64>() / used.len() as f64;
    times.iter().zip(place).map(|(t, p)| t - (offset(&sums[p % length]) - mean)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn intervals_that_repeat_are_a_pattern_and_chance_is_none() {
        let twin: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 0.03 } else { 0.09 }).collect();
        assert_eq!(pattern(&twin), Some(Pattern { intervals: vec![0.03, 0.09], first: 0 }));
        assert_eq!(pattern(&twin[1..]).unwrap().intervals.len(), 2);
        let three: Vec<f64> = (0..30).map(|i| [0.1, 0.1, 0.2][i % 3]).collect();
        assert_eq!(pattern(&three).unwrap().intervals, [0.1, 0.1, 0.2]);
        assert_eq!(pattern(&[0.1; 30]), None);
        for seed in 0..500 {
            let mut noise = Noise::new(seed);
            // One impact in five is missed by chance; then intervals of any length.
            let missing: Vec<f64> = (0..40).map(|_| if noise.uniform() < 0.2 { 0.2 } else { 0.1 }).collect();
            assert_eq!(pattern(&missing), None, "seed {seed}");
            let any: Vec<f64> = (0..40).map(|_| -noise.uniform().max(1e-9).ln()).collect();
            assert_eq!(pattern(&any), None, "seed {seed}");
        }
    }

    #[test]
    fn evened_times_are_even() {
        let index: Vec<usize> = (0..20).filter(|i| *i != 7).collect();
        let place: Vec<usize> = index.iter().map(|i| i % 2).collect();
        let times: Vec<f64> = index.iter().map(|i| 0.06 * *i as f64 + [0.0, -0.03][i % 2]).collect();
        let even = evened(&times, &index, &place, 2);
        for (t, i) in even.iter().zip(&index) {
            // The mean shift is left; numbers near 1, a few roundings.
            assert!((t - (0.06 * *i as f64 - 0.015)).abs() < 1e-14, "{even:?}");
        }
    }
}
