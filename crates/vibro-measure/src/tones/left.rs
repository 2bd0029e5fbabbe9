//! What samples tell of a fit of sines, those too that are cut off.

use std::f64::consts::TAU;

/// What a sample tells of a fit. What lies beyond an end of the range is only known to be beyond it (J.
/// Tobin, Econometrica 26 (1958) 24): it counts by the curvature of its likelihood.
pub(super) struct Left {
    /// Weight in the normal matrix, 1 for a whole sample.
    pub weight: f64,
    /// Expected value without the sines.
    pub mean: f64,
    /// Part in the sum of squares of the noise, and in its degrees of freedom.
    pub square: f64,
    pub known: f64,
}

impl Left {
    /// From what is left of the value, the side on which it is cut off (0 for none), and the standard
    /// deviation of the noise.
    pub fn of(left: f64, side: f64, noise: f64) -> Left {
        if side == 0.0 {
            return Left { weight: 1.0, mean: left, square: left * left, known: 1.0 };
        }
        let a = (side * left / noise.max(f64::MIN_POSITIVE)).clamp(-40.0, 1e6);
        let beyond = mills(a);
        let (square, known) =
            if a < 0.0 { (0.0, -a * beyond) } else { (noise * noise * (1.0 + a * beyond), 1.0) };
        Left { weight: (beyond * (beyond - a)).min(1.0), mean: side * noise * beyond, square, known }
    }
}

/// Mean of a normal variable that is known to lie beyond `a`: its density over the probability (Abramowitz &
/// Stegun 26.2.17; from 3 on by the continued fraction 26.2.14).
fn mills(a: f64) -> f64 {
    if a > 3.0 {
        return (1..60).rev().fold(a, |tail, k| a + f64::from(k) / tail);
    }
    let density = (-0.5 * a * a).exp() / TAU.sqrt();
    let t = 1.0 / (1.0 + 0.231_641_9 * a.abs());
    let series = [1.330_274_429, -1.821_255_978, 1.781_477_937, -0.356_563_782, 0.319_381_53];
    let tail = density * series.iter().fold(0.0, |sum, c| (sum + c) * t);
    density / if a < 0.0 { 1.0 - tail } else { tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_beyond_a_limit_is_that_of_tables() {
        // φ(a)/Q(a), from tables of the normal distribution.
        for (a, mean) in
            [(-5.0, 1.486_720e-6), (-1.0, 0.287_600), (0.0, 0.797_885), (2.0, 2.373_216), (5.0, 5.186_504)]
        {
            // The tail is good to 7.5e-8, that of 2.0 is 0.0228.
            assert!((mills(a) / mean - 1.0).abs() < 1e-5, "{a}: {}", mills(a));
        }
    }
}
