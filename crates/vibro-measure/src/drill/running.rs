//! Mean and scatter of values as they come.

/// Count, mean and sum of squared deviations (B. Welford, Technometrics 4 (1962) 419).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Running {
    n: usize,
    mean: f64,
    squares: f64,
}

impl Running {
    /// Takes a value.
    pub fn push(&mut self, value: f64) {
        self.n += 1;
        let step = value - self.mean;
        self.mean += step / self.n as f64;
        self.squares += step * (value - self.mean);
    }

    /// Number of values.
    #[cfg(test)]
    pub fn n(&self) -> usize {
        self.n
    }

    /// Mean; NaN where there is no value.
    pub fn mean(&self) -> f64 {
        if self.n == 0 { f64::NAN } else { self.mean }
    }

    /// Standard deviation of the values; NaN for fewer than two.
    pub fn std(&self) -> f64 {
        if self.n < 2 { f64::NAN } else { (self.squares / (self.n - 1) as f64).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_two_passes_have_it() {
        let values = [1e6 + 1.0, 1e6 + 2.0, 1e6 + 4.0];
        let mut running = Running::default();
        assert!(running.mean().is_nan());
        for v in values {
            running.push(v);
        }
        let mean = values.iter().sum::<f64>() / 3.0;
        let std = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
        // Roundings of 1e6 are 1e-10.
        assert!((running.mean() - mean).abs() < 1e-9 && (running.std() - std).abs() < 1e-9);
        assert_eq!(running.n(), 3);
    }
}
