//! Missed and doubled impacts: which place in a series each impact has.

use super::background::median;
use super::multiples::multiples;
use super::pattern::{Step, pattern};
use vibro_record::Finding;

/// Which impacts count, and their indices in a series without missed ones.
pub struct Counted {
    /// Impacts that count, by their place among all.
    pub kept: Vec<usize>,
    /// Their indices; those of missed impacts are left out.
    pub index: Vec<usize>,
    /// Their places in the pattern; 0 without one.
    pub place: Vec<usize>,
    /// Impacts of the pattern that repeats; 1 where intervals are alike, or repeat nothing.
    pub length: usize,
    /// Impacts that should stand in intervals that are several of the others.
    pub missed: usize,
    /// Impacts that follow another too soon.
    pub doubled: usize,
    /// Why it is not known how many there are.
    pub unsure: Option<Finding>,
}

/// Robust standard deviations of the intervals beyond which one is no chance.
const OUTSIDE: f64 = 5.0;

/// Numbers the impacts at `times`, which are `steps` apart. With `complete` none is missed and none is too many.
pub fn count(times: &[f64], steps: &[f64], complete: bool) -> Counted {
    match pattern(steps) {
        repeated if complete => {
            let (length, first) = repeated.map_or((1, 0), |p| (p.intervals.len(), p.first));
            numbered(times, length, first, |_, _, _| Step::Several(1))
        }
        Some(pattern) => {
            let step = |place, d, later| pattern.step(place, d, later);
            numbered(times, pattern.intervals.len(), pattern.first, step)
        }
        None => even(times, steps),
    }
}

/// Numbers impacts by what each interval is to the train, from the place of the first; an interval after it is given, too.
fn numbered(
    times: &[f64],
    length: usize,
    first: usize,
    step: impl Fn(usize, f64, Option<f64>) -> Step,
) -> Counted {
    let mut counted = Counted {
        kept: vec![0],
        index: vec![0],
        place: vec![first],
        length,
        missed: 0,
        doubled: 0,
        unsure: None,
    };
    let (mut last, mut at, mut place) = (0, 0, first);
    for i in 1..times.len() {
        let later = times.get(i + 1).map(|t| t - times[i]);
        let steps = match step(place, times[i] - times[last], later) {
            Step::Part => {
                counted.doubled += 1;
                continue;
            }
            Step::Several(n) => n,
            Step::At(other) => {
                place = other;
                1
            }
        };
        counted.missed += steps - 1;
        (last, at, place) = (i, at + steps, (place + steps) % length);
        counted.kept.push(i);
        counted.index.push(at);
        counted.place.push(place);
    }
    counted
}

/// Numbers impacts of equal intervals, or of intervals that repeat nothing.
fn even(times: &[f64], steps: &[f64]) -> Counted {
    let typical = median(steps);
    let spread = median(&steps.iter().map(|d| (d - typical).abs()).collect::<Vec<f64>>()) / 0.674_5;
    let short = |d: f64| d < 0.5 * typical && typical - d > OUTSIDE * spread;
    // As many short intervals as a fifth of all are no accident.
    let many = steps.iter().filter(|d| short(**d)).count() * 5 > steps.len();
    let mut counted = numbered(times, 1, 0, |_, d, _| {
        if !many && short(d) {
            return Step::Part;
        }
        let long = d > 1.5 * typical && d - typical > OUTSIDE * spread;
        Step::Several(if long { (d / typical).round().clamp(1.0, 1e9) as usize } else { 1 })
    });
    counted.unsure = unsure(steps, &counted, OUTSIDE * spread > 0.5 * typical);
    counted
}

/// Why the count of even intervals may be another: all of them are multiples of a common one and were counted otherwise, or impacts
/// count as missed or doubled though the intervals `scatter` as far as one more or less would change them.
fn unsure(steps: &[f64], counted: &Counted, scatter: bool) -> Option<Finding> {
    let span = counted.index.last().copied().unwrap_or(0);
    let other = multiples(steps).map(|m| (m.interval, m.counts.iter().sum::<usize>()));
    if let Some((interval, all)) = other.filter(|(_, all)| *all != span) {
        let missed = all - steps.len().min(all);
        return Some(
            Finding::doubt("missed-or-skipped").number("interval", interval).count("missed", missed),
        );
    }
    (scatter && counted.missed + counted.doubled > 0).then(|| Finding::doubt("count-within-scatter"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn a_missed_and_a_doubled_impact_of_a_pattern() {
        let mut times: Vec<f64> =
            (0..100).map(|i| 0.12 * f64::from(i / 2) + if i % 2 == 1 { 0.045 } else { 0.0 }).collect();
        times.remove(21);
        times.insert(30, times[29] + 0.02);
        let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        let found = count(&times, &steps, false);
        assert_eq!((found.length, found.missed, found.doubled), (2, 1, 1));
        assert_eq!(found.index.last(), Some(&99));
        assert!(found.index.iter().zip(&found.place).all(|(i, p)| i % 2 == *p));
        let all = count(&times, &steps, true);
        assert_eq!((all.kept.len(), all.missed, all.doubled), (100, 0, 0));
    }

    /// A gap of any length counts all that it lacks, to the last impact.
    #[test]
    fn a_gap_in_a_pattern_counts_every_impact() {
        let at = |i: usize| 0.1 * (i / 2) as f64 + if i % 2 == 1 { 0.04 } else { 0.0 };
        for seed in 0..200 {
            let mut noise = Noise::new(seed);
            let jitter = if seed % 2 == 0 { 0.0 } else { 2e-4 };
            for missed in [1, 2, 3, 8, 14, 15, 40] {
                let kept = (0..60 + missed).filter(|i| !(21..21 + missed).contains(i));
                let times: Vec<f64> = kept.map(|i| at(i) + jitter * noise.normal()).collect();
                let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
                let found = count(&times, &steps, false);
                assert_eq!((found.length, found.missed, found.doubled), (2, missed, 0), "seed {seed}");
                assert_eq!(found.index.last(), Some(&(59 + missed)), "seed {seed}");
            }
        }
    }
}
