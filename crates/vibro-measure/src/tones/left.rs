//! What samples tell of a fit of sines, those too that are cut off.

use crate::chance::normal_beyond;

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
        let beyond = normal_beyond(a);
        let (square, known) =
            if a < 0.0 { (0.0, -a * beyond) } else { (noise * noise * (1.0 + a * beyond), 1.0) };
        Left { weight: (beyond * (beyond - a)).min(1.0), mean: side * noise * beyond, square, known }
    }
}
