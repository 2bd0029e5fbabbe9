//! What the noise of the lines may be.

use super::{LineNoise, Measured, Scaled};
use crate::modal::noise::of_both;

/// Alternatives for the noise of the lines, each with a name; `at` are parameters near the best fit.
pub(super) fn rivals(
    measured: &Measured,
    part: std::ops::Range<usize>,
    scaled: &Scaled<'_>,
    at: &[f64],
) -> Vec<(LineNoise, &'static str)> {
    let lines = part.len();
    let height = |i: usize| scaled.at(at, i).norm();
    match (&measured.std, &measured.coherence) {
        (Some(std), _) => {
            let weight = std[part].iter().map(|s| s / scaled.height).collect();
            vec![(LineNoise::independent(weight), "noise as stated")]
        }
        (None, None) => {
            let relative = LineNoise::independent((0..lines).map(|i| height(i).max(1e-2)).collect());
            let equal = LineNoise::independent(vec![1.0; lines]);
            vec![(equal, "equal noise on all lines"), (relative, "noise proportional to the response")]
        }
        (None, Some(coherence)) => {
            // Variance of a line: |H|²(1 − γ²)/(2γ²) over the averages (Bendat & Piersol 2010, 9.90), whose
            // number is left to the fit. With few averages the variance of a single line is poorly known,
            // and one that is small by chance would attract the fit.
            let share: Vec<f64> = coherence[part].iter().map(|c| (1.0 - c).max(1e-5) / c).collect();
            let level: Vec<f64> =
                share.iter().zip(&scaled.values).map(|(s, v)| s * v.norm_sqr().max(1e-12)).collect();
            let segments = |(window, spacing)| scaled.of_segments(window, spacing, at, &level);
            if let Some(noise) = measured.window.map(|window| (window, measured.spacing())).and_then(segments)
            {
                vec![(noise, "noise by the coherence and the window")]
            } else {
                let power: Vec<f64> = (0..lines).map(|i| height(i).powi(2)).collect();
                let each = of_both(&level, &power, &scaled.x).into_iter().map(f64::sqrt).collect();
                vec![(LineNoise::independent(each), "noise by the coherence")]
            }
        }
    }
}
