//! Intervals that are whole multiples of one: a train of which most impacts are missed, or one that skips cycles.

/// Intervals that are whole multiples of a common one.
#[derive(Debug, Clone, PartialEq)]
pub struct Multiples {
    /// The common interval in s.
    pub interval: f64,
    /// How many of it each interval is.
    pub counts: Vec<usize>,
}

/// Root mean square distance from whole numbers, in common intervals, up to which intervals are multiples. Intervals of any length have 0.29.
const NEAR: f64 = 0.1;
/// Fewest intervals: of twelve of any length fewer than one set in a thousand comes as near, the common interval being fitted (random sets between 1 and
/// 3, 9 or 30: 1.5e-4 to 7e-4).
const FEWEST: usize = 12;
/// The shortest intervals, up to this many times the least, are one of the common interval each.
const SHORTEST: f64 = 1.25;

/// The interval of which all `steps` are multiples, the shortest ones being one of it; `None` where there is none.
pub fn multiples(steps: &[f64]) -> Option<Multiples> {
    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
    if steps.len() < FEWEST || !(least.is_finite() && least > 0.0) {
        return None;
    }
    let mut rising = steps.to_vec();
    rising.sort_by(f64::total_cmp);
    // From the shortest on, each tells the common interval better, by which the next is counted.
    let (mut products, mut squares, mut interval) = (0.0, 0.0, least);
    for d in rising {
        let n = if d <= SHORTEST * least { 1.0 } else { (d / interval).round().max(1.0) };
        products += d * n;
        squares += n * n;
        interval = products / squares;
    }
    let counts: Vec<f64> = steps.iter().map(|d| (d / interval).round().max(1.0)).collect();
    let off: f64 = steps.iter().zip(&counts).map(|(d, n)| (d / interval - n).powi(2)).sum();
    let counts = counts.into_iter().map(|n| n.min(1e9) as usize).collect();
    ((off / steps.len() as f64).sqrt() < NEAR).then_some(Multiples { interval, counts })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn a_train_of_which_most_are_missed_is_found_and_intervals_of_any_length_are_not() {
        let mut found_by_chance = 0;
        for seed in 0..2000 {
            let mut noise = Noise::new(seed);
            // Each impact comes in one of two cycles; intervals are off by 1 % of a cycle.
            let whole: Vec<usize> =
                (0..20).map(|_| 1 + ((1.0 - noise.uniform()).ln() / 0.5_f64.ln()) as usize).collect();
            let steps: Vec<f64> = whole.iter().map(|n| 0.13 * (*n as f64 + 0.01 * noise.normal())).collect();
            if whole.contains(&1) {
                let found = multiples(&steps).unwrap_or_else(|| panic!("seed {seed}: {steps:?}"));
                assert_eq!(found.counts, whole, "seed {seed}");
                // 1 % of one of twenty intervals at least, five standard deviations.
                assert!((found.interval / 0.13 - 1.0).abs() < 5.0 * 0.01 / 20f64.sqrt(), "seed {seed}");
            }
            let any: Vec<f64> = (0..FEWEST).map(|_| noise.between(1.0, 9.0)).collect();
            found_by_chance += usize::from(multiples(&any).is_some());
        }
        // 1.5e-4 of them, 0.3 of 2000: more than 4 are met in one run of 60 000.
        assert!(found_by_chance <= 4, "{found_by_chance}");
        assert!(multiples(&[0.1; 11]).is_none());
    }
}
