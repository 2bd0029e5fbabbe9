//! How often a method's errors are larger than it states.

/// An answer within so many of its standard uncertainties is right.
pub(crate) const WITHIN: f64 = 3.0;
/// Share of normal errors that lie further off.
pub const OUTSIDE: f64 = 2.699_796e-3;
/// Share of errors that lie further off where the standard uncertainty comes from 30 free residuals (Student's distribution).
const ALLOWED: f64 = 5.39e-3;
/// Chance that any method of such errors is said to be too often off.
const CHANCE: f64 = 0.01;
/// Methods of this library, for which that chance is made.
const METHODS: usize = 8;

/// How often the answers of one method lie beyond three of the standard uncertainties that they state, at all borders together.
#[derive(Debug, Clone, PartialEq)]
pub struct Rate {
    /// Name of the method.
    pub method: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// Answers that were held to the uncertainty that they state.
    pub judged: usize,
    /// Those of them that lie further off than three of it.
    pub beyond: usize,
}

impl Rate {
    /// How many may lie beyond: the least number that chance exceeds for any of eight methods in fewer than one map of a hundred, where 0.54 % of
    /// answers do. That is the share of a standard uncertainty from 30 free residuals; a perfectly known one has 0.27 %.
    pub fn limit(&self) -> usize {
        exceeded(self.judged, ALLOWED, CHANCE / METHODS as f64)
    }
}

/// The least number that more of `trials` independent events of probability `share` exceed with less than `chance` (binomial distribution).
pub fn exceeded(trials: usize, share: f64, chance: f64) -> usize {
    let odds = share / (1.0 - share);
    let mut term = (1.0 - share).powf(trials as f64);
    let mut beyond = 1.0 - term;
    let mut count = 0;
    while beyond > chance && count < trials {
        term *= odds * (trials - count) as f64 / (count + 1) as f64;
        beyond -= term;
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_that_chance_exceeds_is_that_of_the_binomial_distribution() {
        // P(k) by its factorials.
        let at = |share: f64, n: usize, k: usize| {
            let ways = (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
            ways * share.powf(k as f64) * (1.0 - share).powf((n - k) as f64)
        };
        for (share, chance) in [(OUTSIDE, 1e-5), (ALLOWED, CHANCE / METHODS as f64)] {
            for n in [1, 6, 40, 1000] {
                let beyond = |count: usize| (count + 1..=n).map(|k| at(share, n, k)).sum::<f64>();
                let count = exceeded(n, share, chance);
                assert!(beyond(count) < chance, "{n}: {count}");
                assert!(count == 0 || beyond(count - 1) > chance, "{n}: {count}");
            }
        }
    }

    /// Student's density for 30 degrees of freedom, whose constant is 14.5·13.5·…·0.5/14!/√30 (Γ(15.5)/(Γ(15)√(30π))), by the midpoint rule.
    #[test]
    fn the_share_that_is_allowed_is_that_of_thirty_free_residuals() {
        let gammas = (0..14).map(|i| (f64::from(i) + 1.5) / (f64::from(i) + 1.0)).product::<f64>() * 0.5;
        let density = |x: f64| gammas / 30f64.sqrt() * (1.0 + x * x / 30.0).powf(-15.5);
        let integral = |from: f64, steps: i32| -> f64 {
            (0..steps).map(|i| 1e-3 * density(from + 1e-3 * (f64::from(i) + 0.5))).sum()
        };
        assert!((2.0 * integral(0.0, 60_000) - 1.0).abs() < 1e-6);
        assert!((2.0 * integral(WITHIN, 57_000) / ALLOWED - 1.0).abs() < 0.005);
    }
}
