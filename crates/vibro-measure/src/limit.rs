//! An upper limit for a sine that noise hides.

use super::bisection::border;

/// Chance that the true amplitude lies above the limit, at most.
const MISSED: f64 = 0.05;

/// The amplitude that a sine stays below with 95 % confidence, from the magnitude of its line and the noise of one component.
///
/// The magnitude is Rice distributed (S. O. Rice, Bell Syst. Tech. J. 24 (1945) 46). The limit ν solves
/// P(M ≤ m | ν) = 0.05 P(M ≤ m | 0) (A. L. Read, J. Phys. G 28 (2002) 2693): the division keeps it from falling to nothing where
/// noise happens to be small, so it is never below 2.45 `noise`, and the true amplitude lies above it in less than 5 % of
/// all cases.
///
/// All cases are faint and strong readings together. Where only faint readings are given a limit, no more than 5 % of all
/// readings lie above theirs; but a strong sine that noise made faint lies above its limit more often than that. `None` where one of
/// the two is not a number or there is no noise.
pub fn upper_limit(magnitude: f64, noise: f64) -> Option<f64> {
    let m = magnitude / noise;
    // Far above the noise there is nothing to limit, and the series below would be long.
    if !(noise > 0.0 && (0.0..=20.0).contains(&m)) {
        return None;
    }
    // Below this the limit does not change in its first five digits, and the sums would cancel.
    let m = m.max(1e-3);
    let wanted = MISSED * below(m, 0.0);
    // Ten standard deviations above the magnitude nothing is left.
    Some(noise * border(0.0, m + 10.0, |height| below(m, height) > wanted))
}

/// P(M ≤ m) of a Rice distributed magnitude of height ν in noise of one unit a component: a sum of gamma distributions
/// with Poisson weights, since M² is noncentral χ² of two degrees of freedom.
pub(super) fn below(m: f64, nu: f64) -> f64 {
    let (y, lambda) = (m * m / 2.0, nu * nu / 2.0);
    // Poisson probability of j at λ and of j at y, and what is left of the latter above j.
    let (mut weight, mut term, mut tail) = ((-lambda).exp(), (-y).exp(), -(-y).exp_m1());
    let (mut sum, mut j) = (weight * tail, 0.0);
    // From where terms fall, until they no longer count.
    while j < y || term > 1e-18 {
        j += 1.0;
        weight *= lambda / j;
        term *= y / j;
        tail = (tail - term).max(0.0);
        sum += weight * tail;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slow oracle: midpoint rule over the density x exp(−(x² + ν²)/2) I₀(xν), with I₀ as a mean over angles.
    fn by_integration(m: f64, nu: f64) -> f64 {
        let (n, angles) = (2000, 64);
        let step = m / f64::from(n);
        let density = |x: f64| {
            let mean: f64 = (0..angles)
                .map(|i| {
                    let c = (std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(angles)).cos();
                    (-(x * x + nu * nu) / 2.0 + x * nu * c).exp()
                })
                .sum();
            x * mean / f64::from(angles)
        };
        (0..n).map(|i| step * density((f64::from(i) + 0.5) * step)).sum()
    }

    #[test]
    fn the_distribution_is_that_of_rice() {
        for m in [0.05_f64, 0.7, 1.5, 3.0, 5.5] {
            for nu in [0.0, 0.4, 1.7, 3.0, 6.0] {
                // Midpoint rule: m³/24n² times a second derivative of order one.
                let tolerance = m.powi(3) / 24.0 / 4e6 * 4.0 + 1e-14;
                let (sum, slow) = (below(m, nu), by_integration(m, nu));
                assert!((sum - slow).abs() < tolerance, "{m} {nu}: {sum} {slow}");
            }
        }
    }

    #[test]
    fn limits_far_from_and_deep_in_the_noise() {
        // exp(−ν²/2) = 0.05 where nothing is seen; the m²/8 of the next order is 1e-7.
        assert!((upper_limit(0.0, 2.0).unwrap() / 2.0 - (2.0 * 20f64.ln()).sqrt()).abs() < 1e-5);
        // High above the noise the magnitude is normal about √(ν² + 1): 1.645 standard deviations, less 1/2ν.
        let m = 15.0;
        let expected = m + 1.644_85 - 1.0 / (2.0 * (m + 1.644_85));
        // Next order of the expansion of the Rice quantile: 1/ν².
        assert!((upper_limit(m, 1.0).unwrap() - expected).abs() < 1.0 / (m * m));
        assert_eq!(upper_limit(f64::NAN, 1.0), None);
        assert_eq!(upper_limit(1.0, 0.0), None);
    }
}
