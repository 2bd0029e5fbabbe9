//! Errors that both masses of a step share.

/// What the errors of a step's frequency and force make of the amplitudes of both masses.
///
/// With w the change of each amplitude, in its standard deviations, by one standard uncertainty of an error, their covariance is
/// C = I + Σ wwᵀ. Its root is (C + √det C · I)/√(tr C + 2 √det C), by Cayley and Hamilton, so that its inverse has a closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shared {
    /// C^(−1/2): both on the diagonal, and what is beside it.
    root: [f64; 3],
}

impl Default for Shared {
    fn default() -> Self {
        Shared { root: [1.0, 1.0, 0.0] }
    }
}

impl Shared {
    /// From the w of each error.
    pub fn new(errors: [[f64; 2]; 2]) -> Shared {
        let sum = |i: usize, j: usize| errors.iter().map(|w| w[i] * w[j]).sum::<f64>();
        let (a, b, c) = (1.0 + sum(0, 0), 1.0 + sum(1, 1), sum(0, 1));
        // det C = 1 + Σ|w|² + (w₁ × w₂)², a sum without differences.
        let across = errors[0][0] * errors[1][1] - errors[0][1] * errors[1][0];
        let root = (a + b - 1.0 + across * across).sqrt();
        let scale = root * (a + b + 2.0 * root).sqrt();
        Shared { root: [(b + root) / scale, (a + root) / scale, -c / scale] }
    }

    /// Residuals in standard deviations with these errors allowed for.
    pub fn allow(&self, residuals: [f64; 2]) -> [f64; 2] {
        let ([a, b, c], [r, s]) = (self.root, residuals);
        [a * r + c * s, c * r + b * s]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition, C^(−1/2) C C^(−1/2) = I, for errors small and large, along each other and not.
    #[test]
    fn the_covariance_of_what_is_allowed_for_is_one() {
        for errors in [
            [[0.0, 0.0], [0.0, 0.0]],
            [[3.0, 0.0], [0.1, 0.0]],
            [[0.3, -0.2], [1.0, 2.0]],
            [[1e3, 2e3], [5e2, 1e3]],
            [[1e4, 1.0], [-1.0, 1e4]],
        ] {
            let shared = Shared::new(errors);
            let c = |i: usize, j: usize| {
                f64::from(u8::from(i == j)) + errors.iter().map(|w| w[i] * w[j]).sum::<f64>()
            };
            let columns = [shared.allow([1.0, 0.0]), shared.allow([0.0, 1.0])];
            for (i, a) in columns.iter().enumerate() {
                for (j, b) in columns.iter().enumerate() {
                    let sum: f64 = (0..2)
                        .flat_map(|k| (0..2).map(move |l| (k, l)))
                        .map(|(k, l)| a[k] * c(k, l) * b[l])
                        .sum();
                    // Rounding of entries of C, whose sums cancel down to 1.
                    let tolerance = 1e-15 * (c(0, 0) + c(1, 1));
                    assert!(
                        (sum - f64::from(u8::from(i == j))).abs() < tolerance,
                        "{errors:?}: {i} {j} {sum}"
                    );
                }
            }
        }
    }
}
