//! The least standard deviation that an estimator can have.

use nalgebra::DMatrix;

/// Cramér–Rao bounds: standard deviations of unbiased estimates of the parameters `p` from the values of `model` with independent
/// normal noise of standard deviation `noise`: roots of the diagonal of the inverse of Fisher's information (Kay 1993, eq. 3.33), whose slopes
/// are central differences of `steps`. NaN where the information is singular.
pub fn bounds(p: &[f64], steps: &[f64], noise: f64, model: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let slopes: Vec<Vec<f64>> = (0..p.len())
        .map(|i| {
            let at = |by: f64| {
                let mut moved = p.to_vec();
                moved[i] += by;
                model(&moved)
            };
            at(steps[i]).iter().zip(at(-steps[i])).map(|(a, b)| (a - b) / (2.0 * steps[i] * noise)).collect()
        })
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Columns of length 1, so that units do not spoil the inversion.
    let size: Vec<f64> = slopes.iter().map(|s| dot(s, s).sqrt()).collect();
    let information =
        DMatrix::from_fn(p.len(), p.len(), |i, j| dot(&slopes[i], &slopes[j]) / (size[i] * size[j]));
    let inverse = information.cholesky().map(|c| c.inverse());
    (0..p.len()).map(|i| inverse.as_ref().map_or(f64::NAN, |m| m[(i, i)].sqrt() / size[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A real sine of unknown amplitude, frequency and phase: Kay 1993, eq. 3.41.
    #[test]
    fn the_bound_of_a_sine_is_that_of_the_textbook() {
        let (n, sigma) = (1000, 0.1);
        let model = |p: &[f64]| (0..n).map(|i| p[0] * (TAU * p[1] * f64::from(i) + p[2]).cos()).collect();
        let found = bounds(&[1.0, 0.1234, 0.5], &[1e-4, 1e-8, 1e-4], sigma, model);
        let (eta, n) = (0.5 / (sigma * sigma), f64::from(n));
        // The textbook leaves out the sums at twice the frequency: of the order 1/n.
        let expected = (12.0 / (eta * n * (n * n - 1.0))).sqrt() / TAU;
        assert!((found[1] / expected - 1.0).abs() < 5.0 / n, "{found:?} {expected}");
        assert!((found[0] / (1.0 / (n * eta).sqrt()) - 1.0).abs() < 5.0 / n);
    }
}
