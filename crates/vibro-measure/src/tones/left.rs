//! Contribution of each sample, clipped ones included, to a fit of sines.

use crate::chance::normal_beyond;

/// Contribution of a sample to a fit. A clipped sample is only known to lie beyond an end of the range (J.
/// Tobin, Econometrica 26 (1958) 24): its weight is the curvature of its likelihood.
pub(super) struct Left {
    /// Weight in the normal matrix, 1 for a sample that is not clipped.
    pub weight: f64,
    /// Expected residual from the sines.
    pub mean: f64,
    /// Contribution to the sum of squares of the noise; that to its degrees of freedom is `known`.
    pub square: f64,
    pub known: f64,
}

impl Left {
    /// From the residual `left` of the sample, the side on which it is clipped (1 or −1, 0 for none), and
    /// the standard deviation of the noise.
    pub fn of(left: f64, side: f64, noise: f64) -> Left {
        if side == 0.0 {
            return Left { weight: 1.0, mean: left, square: left * left, known: 1.0 };
        }
        let a = (side * left / noise.max(f64::MIN_POSITIVE)).clamp(-40.0, 1e6);
        let beyond = normal_beyond(a);
        let (square, known) =
            if a < 0.0 { (0.0, -a * beyond) } else { (noise * noise * (1.0 + a * beyond), 1.0) };
        Left { weight: (beyond * (beyond - a)).min(1.0), mean: side * noise * beyond, square, known }
    }
}
