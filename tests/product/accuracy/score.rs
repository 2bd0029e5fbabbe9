//! Statistics of errors over many cases.

use super::draws::{Draws, none_far};
use vibroimpact::measure::Estimate;

/// Errors of one estimate over many cases, each in units of its bound and of its stated uncertainty.
#[derive(Default)]
pub struct Score {
    squares: f64,
    sum: f64,
    covered: usize,
    n: usize,
    /// Number of estimates without an uncertainty.
    unstated: usize,
    /// Largest error in its own standard uncertainties.
    worst: f64,
}

impl Score {
    /// Adds a case without a bound: its error counts in units of its own standard uncertainty.
    pub fn own(&mut self, estimate: &Estimate, truth: f64) {
        self.add(estimate, truth, estimate.std.unwrap_or(1.0));
    }

    /// Adds a case whose Cramér–Rao bound is this standard deviation.
    pub fn add(&mut self, estimate: &Estimate, truth: f64, bound: f64) {
        let Some(std) = estimate.std else {
            self.unstated += 1;
            return;
        };
        let error = estimate.value - truth;
        if (error / bound).abs() > 4.0 {
            println!("case {}: {} for {truth}, bound {bound}", self.n, estimate.value);
        }
        self.squares += (error / bound).powi(2);
        self.sum += error / bound;
        self.covered += usize::from(error.abs() <= 1.96 * std);
        self.worst = self.worst.max(error.abs() / std);
        self.n += 1;
    }

    /// Prints the statistics. Fails if the RMS error exceeds `ratio` bounds, the bias 0.1 bounds (or 3/√n,
    /// three standard deviations of a mean, if that is more), if the coverage lies outside 92 to 98 %, or if
    /// more than 2 % of the cases state no uncertainty.
    pub fn judge(&self, draws: Draws, what: &str, ratio: f64) {
        let n = self.n as f64;
        let (reached, bias, coverage) =
            ((self.squares / n).sqrt(), self.sum / n, 100.0 * self.covered as f64 / n);
        println!(
            "{what}: {} cases, error {reached:.3} of the bound, bias {bias:+.3}, coverage {coverage:.1} %, {} without an uncertainty",
            self.n, self.unstated
        );
        if draws == Draws::Few {
            return self.few(what);
        }
        assert!(50 * self.unstated <= self.n, "{what}: {} without an uncertainty", self.unstated);
        assert!(self.n >= 200, "{what}: {} cases", self.n);
        assert!(reached <= ratio, "{what}: {reached} times the bound");
        assert!(bias.abs() <= 0.1_f64.max(3.0 / n.sqrt()), "{what}: bias {bias} of the bound");
        assert!((92.0..=98.0).contains(&coverage), "{what}: coverage {coverage} %");
    }

    /// As [`Score::covers`], but 2 % of the cases may state no uncertainty.
    pub fn mostly(&self, draws: Draws, what: &str) {
        let coverage = 100.0 * self.covered as f64 / self.n as f64;
        println!(
            "{what}: {} cases, coverage {coverage:.1} %, {} without an uncertainty",
            self.n, self.unstated
        );
        if draws == Draws::Few {
            return self.few(what);
        }
        assert!(50 * self.unstated <= self.n, "{what}: {} without an uncertainty", self.unstated);
        assert!(self.n >= 196, "{what}: {} cases", self.n);
        assert!((92.0..=98.0).contains(&coverage), "{what}: coverage {coverage} %");
    }

    /// Of a few cases most state an uncertainty, and no error exceeds five of them.
    fn few(&self, what: &str) {
        assert!(
            self.unstated < self.n,
            "{what}: {} of {} state an uncertainty",
            self.n,
            self.n + self.unstated
        );
        none_far(what, self.worst);
    }

    /// Prints the coverage. Fails if it lies outside 92 to 98 %, or if a case states no uncertainty.
    pub fn covers(&self, draws: Draws, what: &str) {
        let coverage = 100.0 * self.covered as f64 / self.n as f64;
        println!("{what}: {} cases, coverage {coverage:.1} %", self.n);
        if draws == Draws::Few {
            return self.few(what);
        }
        assert!(self.unstated == 0 && self.n >= 200, "{what}: {} cases, {} without", self.n, self.unstated);
        assert!((92.0..=98.0).contains(&coverage), "{what}: coverage {coverage} %");
    }
}

/// Cramér–Rao bounds, as standard deviations, of the parameters `p` from values with independent noise of
/// these standard deviations: the diagonal of the inverse Fisher information. Slopes are central
/// differences of `steps`.
pub fn bounds(p: &[f64], steps: &[f64], noise: &[f64], model: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let k = p.len();
    let slopes: Vec<Vec<f64>> = (0..k)
        .map(|i| {
            let at = |by: f64| {
                let mut moved = p.to_vec();
                moved[i] += by;
                model(&moved)
            };
            let (above, below) = (at(steps[i]), at(-steps[i]));
            above.iter().zip(below).zip(noise).map(|((a, b), s)| (a - b) / (2.0 * steps[i] * s)).collect()
        })
        .collect();
    // Scaled to a unit diagonal, so that different units do not spoil the elimination.
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size: Vec<f64> = slopes.iter().map(|s| dot(s, s).sqrt()).collect();
    let mut m: Vec<Vec<f64>> = (0..k)
        .map(|i| {
            let mut row: Vec<f64> =
                (0..k).map(|j| dot(&slopes[i], &slopes[j]) / (size[i] * size[j])).collect();
            row.extend((0..k).map(|j| f64::from(u8::from(i == j))));
            row
        })
        .collect();
    for i in 0..k {
        let pivot = m[i][i];
        m[i].iter_mut().for_each(|v| *v /= pivot);
        for r in 0..k {
            if r != i {
                let factor = m[r][i];
                let row = m[i].clone();
                m[r].iter_mut().zip(row).for_each(|(v, p)| *v -= factor * p);
            }
        }
    }
    (0..k).map(|i| m[i][k + i].sqrt() / size[i]).collect()
}
