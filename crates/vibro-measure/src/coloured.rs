//! The density of noise at one frequency, over that of white noise of the same variance.
//!
//! A sine sees the noise around its own line only: its uncertainties in white noise are to be multiplied by the square root of
//! this ratio (asymptotically exact for noise whose density changes little over 1/T: P. Whittle, Ark. Mat. 2 (1953) 423).

use std::f64::consts::TAU;

/// Highest order of the autoregressive process.
const HIGHEST: usize = 20;
/// Most samples that are looked at, from the middle of the record.
const MOST: usize = 1 << 18;

/// Noise as an autoregressive process by Burg's method (J. P. Burg, Maximum entropy spectral analysis, 1975), of the order that has
/// the smallest corrected criterion of Akaike (Hurvich & Tsai 1989). White noise is order 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Coloured {
    /// a₁, a₂, … of y(i) = −Σ aₖ y(i − k) + e(i).
    coefficients: Vec<f64>,
    /// Variance of e over that of y.
    innovation: f64,
}

impl Coloured {
    /// The process of noise that was sampled evenly.
    pub fn of(noise: &[f64]) -> Coloured {
        let spare = noise.len().saturating_sub(MOST) / 2;
        let noise = noise.get(spare..noise.len() - spare).unwrap_or(noise);
        let n = noise.len();
        let total = noise.iter().map(|v| v * v).sum::<f64>() / n as f64;
        let white = Coloured { coefficients: Vec::new(), innovation: 1.0 };
        if !(total.is_finite() && total > 0.0) {
            return white;
        }
        let highest = HIGHEST.min(n / 10);
        let criterion = |left: f64, order: usize| {
            let k = order as f64 + 1.0;
            n as f64 * left.ln() + 2.0 * k * n as f64 / (n as f64 - k - 1.0)
        };
        let (mut forward, mut backward) = (noise.to_vec(), noise.to_vec());
        let (mut a, mut left) = (Vec::<f64>::new(), 1.0);
        let mut best = (criterion(1.0, 0), white);
        for order in 1..=highest {
            let (mut products, mut squares) = (0.0, 0.0);
            for i in order..n {
                products += forward[i] * backward[i - 1];
                squares += forward[i].powi(2) + backward[i - 1].powi(2);
            }
            let reflection = -2.0 * products / squares;
            // A process that can be foretold without error is no noise.
            if !reflection.is_finite() || reflection.abs() >= 1.0 {
                break;
            }
            let before = a.clone();
            for (k, value) in a.iter_mut().enumerate() {
                *value += reflection * before[order - 2 - k];
            }
            a.push(reflection);
            left *= 1.0 - reflection * reflection;
            for i in (order..n).rev() {
                let (f, b) = (forward[i], backward[i - 1]);
                forward[i] = f + reflection * b;
                backward[i] = b + reflection * f;
            }
            let found = criterion(left, order);
            if found < best.0 {
                best = (found, Coloured { coefficients: a.clone(), innovation: left });
            }
        }
        best.1
    }

    /// Square root of the density at `turns` periods a sample over that of white noise of the same variance, but not below 1: what
    /// is no noise but a further sine leaves a process whose density elsewhere is too small.
    pub(crate) fn widening(&self, turns: f64) -> f64 {
        let (mut re, mut im) = (1.0, 0.0);
        for (k, a) in self.coefficients.iter().enumerate() {
            let (sin, cos) = (TAU * turns * (k as f64 + 1.0)).sin_cos();
            re += a * cos;
            im -= a * sin;
        }
        (self.innovation / (re * re + im * im)).sqrt().max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Normal;

    #[test]
    fn the_density_of_a_first_order_process_is_found() {
        let mut normal = Normal(0xc01);
        let phi = 0.9;
        let mut y = 0.0;
        let noise: Vec<f64> = (0..20_000)
            .map(|_| {
                y = phi * y + normal.next();
                y
            })
            .collect();
        let found = Coloured::of(&noise);
        for turns in [0.0f64, 0.01, 0.03] {
            let truth = ((1.0 - phi * phi) / (1.0 - 2.0 * phi * (TAU * turns).cos() + phi * phi)).sqrt();
            // φ is good to √((1 − φ²)/n) = 0.003, and the density at 0 has the slope 1/(1 − φ) in it: 3 %, three times that.
            assert!((found.widening(turns) / truth - 1.0).abs() < 0.1, "{turns} {truth} {found:?}");
        }
        assert!(found.widening(0.4) == 1.0);
    }

    #[test]
    fn white_noise_and_nothing_are_hardly_widened() {
        let mut normal = Normal(0x3117e);
        for _ in 0..50 {
            let noise: Vec<f64> = (0..400).map(|_| normal.next()).collect();
            // An order that chance chose has coefficients of about 2/√400: a density off by 2·2·0.1 at most with two of them.
            assert!(Coloured::of(&noise).widening(0.05) < 1.5);
        }
        for nothing in [vec![], vec![0.0; 50], vec![f64::NAN; 50], vec![1.0; 5]] {
            assert!(Coloured::of(&nothing).widening(0.1) == 1.0, "{nothing:?}");
        }
    }
}
