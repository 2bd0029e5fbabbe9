//! Samples that an instrument's range cut off.

use std::f64::consts::PI;

/// Samples at either end of the range of the values, where some stay there longer than any crest of this period in samples stays within a
/// step of the converter.
pub fn clipped(values: &[f64], period: f64) -> Vec<usize> {
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    let step = steps.fold(f64::INFINITY, f64::min);
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let crest = |run: usize| 0.5 * (high - low) * (1.0 - (PI * (run as f64 / period).min(0.5)).cos());
    let rests = |end: &f64| {
        let runs = values.chunk_by(|a, b| a == b).filter(|run| run[0] == *end && run.len() > 1);
        runs.into_iter().any(|run| crest(run.len() - 1) > 3.0 * step)
    };
    let ends: Vec<f64> = [low, high].into_iter().filter(rests).collect();
    (0..values.len()).filter(|i| ends.contains(&values[*i])).collect()
}

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
}
