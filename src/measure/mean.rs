//! How far the mean of values in a row can be trusted, where neighbours may depend on each other.

use std::f64::consts::PI;

/// Fewest values of which the scatter says anything about their mean.
const FEWEST: usize = 4;

/// Standard uncertainty of the mean of equally spaced values that may depend on their neighbours; `None` for fewer than four.
///
/// The lowest coefficients `c_j` = √(2/n) Σ `x_t` cos(πj(t − ½)/n), j = 1 to K, of the cosine transform see what varies as
/// slowly as the mean does: the variance of the mean is Σ `c_j`²/(K n) (U. K. Müller, J. Econometrics 141 (2007) 1331,
/// section 4), with K degrees of freedom. K = 1.2 n^0.4, at least 3 and at most 30: few where the record is short. What is given is that times √(K/(K − 2)), the
/// standard deviation of Student's distribution, so that ± 2 of it hold the truth about as often as they should.
pub fn serial_mean_std(values: &[f64]) -> Option<f64> {
    let n = values.len();
    if n < FEWEST {
        return None;
    }
    let count = n as f64;
    let freedom = (1.2 * count.powf(0.4)).round().clamp(3.0, 30.0);
    // A constant has no coefficients; taken away, rounding does not make any.
    let centre = values.iter().sum::<f64>() / count;
    let coefficient = |j: usize| {
        let at = |t: usize| (PI * j as f64 * (t as f64 + 0.5) / count).cos();
        values.iter().enumerate().map(|(t, x)| (x - centre) * at(t)).sum::<f64>() * (2.0 / count).sqrt()
    };
    let squares: f64 = (1..=freedom as usize).map(|j| coefficient(j).powi(2)).sum();
    Some((squares / (freedom * count) * freedom / (freedom - 2.0)).sqrt()).filter(|s| s.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal enough: a sum of twelve uniform numbers.
    fn normal(state: &mut u64) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum += (*state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    }

    #[test]
    fn intervals_hold_the_mean_with_and_without_correlation() {
        let mut state = 17u64;
        for (n, rho) in [(10, 0.0), (100, 0.0), (100, 0.5), (1000, 0.8)] {
            let cases = 1000;
            let inside = (0..cases)
                .filter(|_| {
                    let mut x = normal(&mut state) / (1.0f64 - rho * rho).sqrt();
                    let values: Vec<f64> = (0..n)
                        .map(|_| {
                            x = rho * x + normal(&mut state);
                            7.0 + x
                        })
                        .collect();
                    let mean = values.iter().sum::<f64>() / f64::from(n);
                    (mean - 7.0).abs() < 1.96 * serial_mean_std(&values).unwrap()
                })
                .count();
            println!("n {n}, correlation {rho}: {inside} of {cases}, seed 17");
            // 95 % of 1000 scatter by 7.
            assert!((920..=980).contains(&inside), "n {n}, correlation {rho}: {inside} of {cases}");
        }
    }

    #[test]
    fn few_values_and_constants() {
        assert_eq!(serial_mean_std(&[1.0, 2.0, 3.0]), None);
        // The mean of fifty times 0.1 has a rounding of 1e-17.
        assert!(serial_mean_std(&[0.1; 50]).unwrap() < 1e-17);
        assert_eq!(serial_mean_std(&[1.0, f64::NAN, 1.0, 2.0]), None);
    }
}
