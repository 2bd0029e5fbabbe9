//! Noise of the fits beside impacts, by their residuals.

/// Lags over which the noise may depend on itself.
const LAGS: usize = 6;

/// Residuals of all fits on one side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FitNoise {
    squares: f64,
    freedom: f64,
    lagged: [f64; LAGS],
    pairs: [f64; LAGS],
    fits: f64,
}

impl FitNoise {
    /// Takes the residuals of one parabola.
    pub fn push(&mut self, residuals: &[f64]) {
        self.squares += residuals.iter().map(|r| r * r).sum::<f64>();
        self.freedom += residuals.len() as f64 - 3.0;
        self.fits += 1.0;
        for (k, (sum, pairs)) in self.lagged.iter_mut().zip(&mut self.pairs).enumerate() {
            let behind = residuals.get(k + 1..).unwrap_or(&[]);
            *sum += residuals.iter().zip(behind).map(|(a, b)| a * b).sum::<f64>();
            *pairs += behind.len() as f64;
        }
    }

    /// Variance of the noise.
    pub fn variance(&self) -> f64 {
        self.squares / self.freedom
    }

    /// How much larger the variance of a fitted value is than in white noise, 1 + 2Σρ, after fits over `length` samples.
    ///
    /// A laser's decoder limits the bandwidth of its noise, so neighbours depend on each other. What the fits themselves take out of
    /// every lagged sum is given back.
    pub fn inflation(&self, length: usize) -> f64 {
        let variance = self.variance();
        let taken = taken_by_fits(length);
        let lagged = self.lagged.iter().zip(&self.pairs).zip(taken);
        let rho = lagged
            .map(|((sum, pairs), taken)| (sum + taken * variance * self.fits) / (variance * pairs.max(1.0)));
        let sum = 1.0 + 2.0 * rho.filter(|r| r.is_finite()).sum::<f64>();
        sum.max(1.0)
    }
}

/// What a parabola fitted to `n` samples of white noise of unit variance takes out of the sum of products of residuals at
/// each lag: the trace of the hat matrix on its side diagonals.
fn taken_by_fits(n: usize) -> [f64; LAGS] {
    // Orthonormal polynomials on the samples, by Gram and Schmidt.
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(3);
    for power in 0..3 {
        let mut v: Vec<f64> = (0..n).map(|i| (i as f64 - 0.5 * (n as f64 - 1.0)).powi(power)).collect();
        for u in &basis {
            let along: f64 = u.iter().zip(&v).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(u).for_each(|(v, u)| *v -= along * u);
        }
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for x in &mut v {
            *x /= norm;
        }
        basis.push(v);
    }
    std::array::from_fn(|k| {
        basis.iter().map(|u| u.iter().zip(u.iter().skip(k + 1)).map(|(a, b)| a * b).sum::<f64>()).sum()
    })
}
