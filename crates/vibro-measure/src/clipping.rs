//! Samples that an instrument's range cut off.

use std::f64::consts::PI;

/// Samples at either end of the range of the values, where some stay there longer than any crest of this period in samples stays within a
/// step of the converter, or where more lie at the end than a crest lets lie there beside those a step away.
pub fn clipped(values: &[f64], period: f64) -> Vec<usize> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let at = |end: f64| values.iter().filter(|v| **v == end).count();
    let repeated: Vec<f64> = [low, high].into_iter().filter(|end| at(*end) > 1).collect();
    if low == high || repeated.is_empty() {
        return Vec::new();
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0);
    let step = steps.clone().fold(f64::INFINITY, f64::min);
    // Values that do not repeat were not rounded.
    let rounded = (steps.count() as f64) < UNROUNDED * values.len() as f64;
    let crest = |run: usize| 0.5 * (high - low) * (1.0 - (PI * (run as f64 / period).min(0.5)).cos());
    let rests = |end: f64| {
        let runs = values.chunk_by(|a, b| a == b).filter(|run| run[0] == end && run.len() > 1);
        runs.into_iter().any(|run| crest(run.len() - 1) > 3.0 * step)
    };
    let crowds = |end: f64| {
        let near = |v: &&f64| (**v - end).abs() <= 1.5 * step;
        let (at, near) = (at(end) as f64, values.iter().filter(near).count() as f64);
        let beside = near - at;
        // Under the crest of a sine of rounded values 2.4 times as many lie in the last step as in the one before, and chance adds to that.
        if rounded { at > 3.0 * beside + 4.0 * (at + 9.0 * beside).sqrt() } else { at > 2.0 }
    };
    let ends: Vec<f64> = repeated.into_iter().filter(|end| rests(*end) || crowds(*end)).collect();
    (0..values.len()).filter(|i| ends.contains(&values[*i])).collect()
}

/// Of values that were not rounded more than this part differ.
const UNROUNDED: f64 = 0.8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crests_of_coarse_steps_are_not_clipped() {
        let tone = |i: i32, period: f64| (std::f64::consts::TAU * f64::from(i) / period).cos();
        for period in [23.7, 37.3, 200.0] {
            // Eight bits: a crest stays on its last step for some samples.
            let coarse: Vec<f64> = (0..2000).map(|i| (127.0 * tone(i, period)).round()).collect();
            assert!(clipped(&coarse, period).is_empty(), "{period}");
            let cut: Vec<f64> = coarse.iter().map(|v| v.min(110.0)).collect();
            let found = clipped(&cut, period);
            assert_eq!(found.len(), coarse.iter().filter(|v| **v >= 110.0).count(), "{period}");
        }
        assert!(clipped(&[1.0; 50], 10.0).is_empty());
    }

    /// Of two sines a crest is cut for a sample or two: too short to tell by its length.
    #[test]
    fn sums_of_fast_sines_are_clipped_where_many_samples_share_the_end() {
        let sum = |i: i32| {
            let [a, b] = [3.1, 4.7].map(|period| (std::f64::consts::TAU * f64::from(i) / period).cos());
            a + 0.6 * b
        };
        for step in [1e-9, 1.0 / 1024.0] {
            let whole: Vec<f64> = (0..4000).map(|i| (sum(i) / step).round() * step).collect();
            assert!(clipped(&whole, 3.1).is_empty(), "{step}");
            let cut: Vec<f64> = whole.iter().map(|v| v.min(1.25)).collect();
            assert_eq!(clipped(&cut, 3.1).len(), whole.iter().filter(|v| **v >= 1.25).count(), "{step}");
        }
    }
}
