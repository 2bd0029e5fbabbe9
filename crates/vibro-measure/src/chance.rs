//! Probabilities and quantiles of the normal, χ² and Student distributions, from statrs.

use statrs::distribution::{ChiSquared, Continuous, ContinuousCDF, Normal, StudentsT};

/// Mean of a standard normal variable that is known to exceed `a`: density φ(a) over tail probability Q(a).
/// Above 3 it is computed by the continued fraction of Abramowitz & Stegun 26.2.14, which does not
/// underflow.
pub(crate) fn normal_beyond(a: f64) -> f64 {
    if a > 3.0 {
        return (1..60).rev().fold(a, |tail, k| a + f64::from(k) / tail);
    }
    Normal::standard().pdf(a) / Normal::standard().sf(a)
}

/// Probability that a standard normal variable exceeds `a`.
pub(crate) fn normal_above(a: f64) -> f64 {
    Normal::standard().sf(a)
}

/// P(χ² > x) for `free` degrees of freedom; NaN for 0.
pub(crate) fn chi_squared_above(x: f64, free: usize) -> f64 {
    ChiSquared::new(free as f64).map_or(f64::NAN, |chance| chance.sf(x))
}

/// Quantile of χ² with `free` degrees of freedom at this probability; NaN for 0 degrees.
///
/// ```
/// // Abramowitz & Stegun, table 26.8.
/// let limit = vibro_measure::chance::chi_squared_at(0.999, 5);
/// assert!((limit / 20.515 - 1.0).abs() < 1e-4);
/// ```
pub fn chi_squared_at(probability: f64, free: usize) -> f64 {
    ChiSquared::new(free as f64).map_or(f64::NAN, |chance| chance.inverse_cdf(probability))
}

/// Quantile of Student's t with `free` degrees of freedom at this probability; NaN for 0 degrees.
pub(crate) fn student_at(probability: f64, free: usize) -> f64 {
    StudentsT::new(0.0, 1.0, free as f64).map_or(f64::NAN, |chance| chance.inverse_cdf(probability))
}

/// Quantile of the standard normal distribution at this probability.
pub(crate) fn normal_at(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun, tables 26.1, 26.8 and 26.10: as many digits as are printed.
    #[test]
    fn tables_are_met() {
        for (x, free, above) in [(18.3070, 10, 0.05), (13.2767, 4, 0.01), (3.841_46, 1, 0.05)] {
            assert!((chi_squared_above(x, free) / above - 1.0).abs() < 2e-5, "{x}");
            assert!((chi_squared_at(1.0 - above, free) / x - 1.0).abs() < 2e-5, "{x}");
        }
        for (probability, free, t) in
            [(0.975, 1, 12.706), (0.975, 2, 4.303), (0.9995, 5, 6.869), (0.9995, 10, 4.587)]
        {
            assert!((student_at(probability, free) / t - 1.0).abs() < 2e-4, "{free}");
        }
        assert!((normal_at(0.975) - 1.959_963_985).abs() < 1e-9);
    }

    /// φ(a)/Q(a), from tables of the normal distribution: seven digits are printed.
    #[test]
    fn the_mean_beyond_a_limit_is_that_of_tables() {
        for (a, mean) in
            [(-5.0, 1.486_720e-6), (-1.0, 0.287_600), (0.0, 0.797_885), (2.0, 2.373_216), (5.0, 5.186_504)]
        {
            assert!((normal_beyond(a) / mean - 1.0).abs() < 2e-6, "{a}: {}", normal_beyond(a));
        }
    }

    #[test]
    fn without_a_degree_of_freedom_there_is_no_chance() {
        assert!(
            chi_squared_above(1.0, 0).is_nan()
                && chi_squared_at(0.5, 0).is_nan()
                && student_at(0.5, 0).is_nan()
        );
    }
}
