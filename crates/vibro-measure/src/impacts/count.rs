//! Missed and doubled impacts, and intervals that repeat a pattern.

use super::background::median;

/// Which impacts count, and their indices in a series without missed ones.
pub struct Counted {
    /// Impacts that count, by their place among all.
    pub kept: Vec<usize>,
    /// Their indices; those of missed impacts are left out.
    pub index: Vec<usize>,
    /// Impacts that should stand in intervals that are several of the others.
    pub missed: usize,
    /// Impacts that follow another too soon.
    pub doubled: usize,
}

/// Robust standard deviations of the intervals beyond which one is no chance.
const OUTSIDE: f64 = 5.0;
/// As many odd intervals as this part of all are no accident, but belong to the motion: so are those of every second impact of a cycle.
const ACCIDENTS: f64 = 0.4;

/// Numbers the impacts at `times`, which are `steps` apart; with `complete` none is missed and none is too many.
///
/// An interval below half of the median ends with an impact too many, one beyond one and a half lacks impacts. Intervals that scatter as far
/// as that say nothing of either: all count as they are.
pub fn count(times: &[f64], steps: &[f64], complete: bool) -> Counted {
    let typical = median(steps);
    let off: Vec<f64> = steps.iter().map(|d| (d - typical).abs()).collect();
    let scatter = OUTSIDE * median(&off) / 0.674_5;
    let odd = |d: f64| (d - typical).abs() > scatter.max(0.5 * typical);
    let accidents = steps.iter().filter(|d| odd(**d)).count() as f64 <= ACCIDENTS * steps.len() as f64;
    let judged = !complete && accidents && scatter <= 0.5 * typical;
    let mut counted = Counted { kept: vec![0], index: vec![0], missed: 0, doubled: 0 };
    let (mut last, mut at) = (0, 0);
    for i in 1..times.len() {
        let step = times[i] - times[last];
        let odd = judged && odd(step);
        if odd && step < typical {
            counted.doubled += 1;
            continue;
        }
        let intervals = if odd { (step / typical).round().clamp(1.0, 1e9) as usize } else { 1 };
        counted.missed += intervals - 1;
        (last, at) = (i, at + intervals);
        counted.kept.push(i);
        counted.index.push(at);
    }
    counted
}

/// Intervals are alike where they differ by less than this part of the shorter.
const ALIKE: f64 = 0.1;
/// Most impacts of a pattern, and how often it must be seen.
const LONGEST: usize = 8;
const SEEN: usize = 3;
/// One unlike interval in each round of p makes 2/p of all neighbours unlike; so much of that is enough at the ends of a record.
const UNLIKE: f64 = 0.8;

/// Impacts after which all intervals repeat though they are unlike in between, as those of two impacts a cycle are; `None` where there is no such
/// number.
pub fn pattern(steps: &[f64]) -> Option<usize> {
    let unlike = |lag: usize| {
        let pairs = steps.iter().zip(steps.iter().skip(lag));
        pairs.filter(|(a, b)| (*a - *b).abs() > ALIKE * a.min(**b)).count()
    };
    let part = unlike(1) as f64 / steps.len() as f64;
    let repeats = |p: &usize| unlike(*p) == 0 && part >= UNLIKE * 2.0 / *p as f64;
    (2..=LONGEST).take_while(|p| steps.len() >= SEEN * p).find(repeats)
}

/// Times without what their places in a pattern of `length` impacts shift them by: an even train.
pub fn evened(times: &[f64], length: usize) -> Vec<f64> {
    let rounds: f64 = times.windows(length + 1).map(|w| w[length] - w[0]).sum();
    let interval = rounds / (length * (times.len() - length)) as f64;
    let shifts: Vec<f64> = times.iter().enumerate().map(|(i, t)| t - interval * i as f64).collect();
    let mean = |place: usize| {
        let same = shifts.iter().skip(place).step_by(length);
        same.clone().sum::<f64>() / same.count() as f64
    };
    let means: Vec<f64> = (0..length).map(mean).collect();
    let common = means.iter().sum::<f64>() / length as f64;
    times.iter().enumerate().map(|(i, t)| t - means[i % length] + common).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn intervals_that_repeat_are_a_pattern_and_chance_is_none() {
        let twin: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 0.03 } else { 0.09 }).collect();
        assert_eq!((pattern(&twin), pattern(&twin[1..])), (Some(2), Some(2)));
        let three: Vec<f64> = (0..30).map(|i| [0.1, 0.1, 0.2][i % 3]).collect();
        assert_eq!(pattern(&three), Some(3));
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
        let times: Vec<f64> = (0..20).map(|i| 0.06 * i as f64 + [0.0, -0.03][i % 2]).collect();
        for (i, t) in evened(&times, 2).iter().enumerate() {
            // The mean shift is left; numbers near 1, a few roundings.
            assert!((t - (0.06 * i as f64 - 0.015)).abs() < 1e-14, "{t}");
        }
    }

    /// A pattern that an accident breaks is none, and nothing is counted as missed for it.
    #[test]
    fn a_broken_pattern_misses_nothing() {
        let mut times: Vec<f64> =
            (0..100).map(|i| 0.12 * f64::from(i / 2) + if i % 2 == 1 { 0.03 } else { 0.0 }).collect();
        times.remove(21);
        let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        let found = count(&times, &steps, false);
        assert_eq!((pattern(&steps), found.kept.len(), found.missed, found.doubled), (None, 99, 0, 0));
    }
}
