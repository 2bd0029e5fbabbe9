//! The steps of a converter, and the noise that rounding to them adds.

use crate::chance::normal_at;
use std::f64::consts::PI;
use vibro_record::lanes::{Survey, survey};

/// Least range of an analogue trace, in steps: a switch has two values and no noise.
const FINE: f64 = 32.0;

/// Smallest non-zero difference between neighbours, which is the step of rounded values; 0 if all are equal.
/// Sorted values need the fewest samples to show it.
pub(crate) fn step(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    steps.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// The converter step of a trace; 0 for a trace of few levels, such as a switch.
pub(crate) fn analogue_step(values: &[f64]) -> f64 {
    let (Survey { low, high, .. }, step) = (survey(values), step(values));
    if step < (high - low) / FINE { step } else { 0.0 }
}

/// Standard deviation of rounding to a step q, q/√12 (Widrow & Kollár, Quantization Noise, 2008): the least
/// noise of a trace. A stretch with noise well below a step shows no scatter.
pub(crate) fn rounding(step: f64) -> f64 {
    step / 12f64.sqrt()
}

/// Standard deviation of the error that rounding to a step q causes in the mean of a quiet stretch. The
/// standard deviation `scatter` of the stretch does not show this error. It is q/√12 in a flat stretch, and
/// e^(−2π²σ²/q²) times that with noise σ, for which `scatter` is √(σ² + q²/12) (Widrow & Kollár, 2008).
pub(crate) fn hidden(scatter: f64, step: f64) -> f64 {
    let noise = (scatter.powi(2) - rounding(step).powi(2)).max(0.0);
    if step > 0.0 { rounding(step) * (-2.0 * (PI / step).powi(2) * noise).exp() } else { 0.0 }
}

/// Largest noise, as a standard deviation, that rounding may conceal in a stretch of `n` values with this
/// `scatter`. It is 0 if `scatter` is q/√12 or more and so shows the noise. Noise σ about the middle of a
/// step q moves the fraction 2Φ(−q/2σ) of the values out of the step. This fraction is scatter²/q² and, at
/// 95 %, at most 3/n more (Hanley & Lippman-Hand, If nothing goes wrong, is everything all right?, 1983).
pub(crate) fn concealed(scatter: f64, n: f64, step: f64) -> f64 {
    if step <= 0.0 || scatter >= rounding(step) {
        return 0.0;
    }
    let leaves = ((scatter / step).powi(2) + 3.0 / n).min(1.0);
    0.5 * step / normal_at(1.0 - 0.5 * leaves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean::{average, scatter};
    use vibro_math::Noise;

    #[test]
    fn a_step_is_seen_in_a_sine_and_none_in_a_switch() {
        let sine: Vec<f64> =
            (0..500).map(|i| (100.0 * (f64::from(i) * 0.013).sin()).round() * 0.25).collect();
        assert_eq!((step(&sine), analogue_step(&sine)), (0.25, 0.25));
        let switch: Vec<f64> = (0..500).map(|i| f64::from(u8::from(i % 50 < 5))).collect();
        assert_eq!((step(&switch), analogue_step(&switch), step(&[2.0; 9])), (1.0, 0.0, 0.0));
    }

    /// Reference: the error of the mean of a rounded level, simulated for 200 levels within a step.
    #[test]
    fn a_mean_hides_less_of_its_rounding_in_more_noise() {
        for sigma in [0.0, 0.2, 0.3, 0.5] {
            let mut noise = Noise::new(5);
            let (mut squares, mut scatters) = (0.0, 0.0);
            for k in 0..200 {
                let level = f64::from(k) / 200.0;
                let values: Vec<f64> = (0..400).map(|_| (level + sigma * noise.normal()).round()).collect();
                squares += (average(&values) - level).powi(2) / 200.0;
                scatters += scatter(&values).powi(2) / 200.0;
            }
            // Besides the hidden error, the mean of 400 draws scatters by √(σ² + 1/12)/20, except at σ = 0.
            let chance = if sigma > 0.0 { scatters / 400.0 } else { 0.0 };
            let found = hidden(scatters.sqrt(), 1.0).powi(2);
            // The exponential holds for the first harmonic of the error, which has 6/π² of the variance. The
            // scatter lacks the variance of the hidden error. Margins for chance: 10 % and 30 %.
            let most = 1.1 * PI * PI / 6.0 * squares * (4.0 * PI * PI * squares).exp();
            assert!(found < most && squares < 1.3 * (found + chance), "{sigma}: {squares} {found}");
        }
    }

    /// Reference: with the noise that 100 flat values may conceal, 100 simulated values are flat in 1 of 20
    /// cases.
    #[test]
    fn a_flat_stretch_conceals_noise_of_a_fifth_of_a_step() {
        let sigma = concealed(0.0, 100.0, 2.0);
        let mut noise = Noise::new(7);
        let flat = (0..4000).filter(|_| (0..100).all(|_| (sigma * noise.normal()).abs() < 1.0)).count();
        // (1 − 3/100)^100 = 0.0476; of 4000 draws three standard deviations are 0.0101.
        assert!((flat as f64 / 4000.0 - 0.0476).abs() < 0.0101, "{flat}");
        assert_eq!((concealed(0.6, 100.0, 2.0), concealed(0.0, 100.0, 0.0)), (0.0, 0.0));
    }

    /// Reference: rounding errors of a sine, which are uniform within a step.
    #[test]
    fn rounding_scatters_by_a_step_over_the_root_of_twelve() {
        let errors: Vec<f64> =
            (0..40_000).map(|i| 300.0 * (f64::from(i) * 0.618_034).sin()).map(|v| v.round() - v).collect();
        // The variance of 40 000 uniform errors scatters by √0.8/√40000 = 0.45 %; four times that.
        let variance = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        assert!((variance / rounding(1.0).powi(2) - 1.0).abs() < 0.018, "{variance}");
    }
}
