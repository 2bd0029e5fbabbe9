//! What the noise of the lines may be.

use super::{LineNoise, Measured, Scaled};
use crate::modal::noise::of_both;

/// Equal noise of all lines over the noise in proportion to the response at its peak, standard deviations.
/// Mostly one of both does not matter: five of six times each end counts. Where both mattered beside the
/// peak, few lines would take their own scatter for such noise.
const EQUAL: [f64; 12] = [1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 0.01, 0.03, 1e4, 1e4, 1e4, 1e4, 1e4];

/// Noise with its name.
pub(super) type Named = (LineNoise, &'static str);

/// Alternatives for the noise of the lines, each with a name; `at` are parameters near the best fit.
pub(super) fn rivals(
    measured: &Measured,
    part: std::ops::Range<usize>,
    scaled: &Scaled<'_>,
    at: &[f64],
) -> Vec<Named> {
    let lines = part.len();
    let height = |i: usize| scaled.at(at, i).norm();
    match (&measured.std, &measured.coherence) {
        (Some(std), _) => {
            let weight = std[part].iter().map(|s| s / scaled.height).collect();
            vec![(LineNoise::independent(weight), "noise as stated")]
        }
        (None, None) => {
            let both = |equal: f64| {
                LineNoise::independent((0..lines).map(|i| height(i).max(1e-2).hypot(equal)).collect())
            };
            EQUAL.iter().map(|equal| (both(*equal), "equal and proportional noise")).collect()
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
