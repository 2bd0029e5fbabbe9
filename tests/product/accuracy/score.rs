//! What is counted over many cases.

use super::draws::{Draws, none_far};
use vibroimpact::measure::Estimate;

/// Errors of one estimate over many cases, each in units of its bound and of its stated uncertainty.
#[derive(Default)]
pub struct Score {
    squares: f64,
    sum: f64,
    covered: usize,
    n: usize,
    /// Estimates without an uncertainty.
    unstated: usize,
    /// The largest error in its own standard uncertainties.
    worst: f64,
}

impl Score {
    /// Adds a case of which nothing but its own uncertainty is asked.
    pub fn own(&mut self, estimate: &Estimate, truth: f64) {
        self.add(estimate, truth, estimate.std.unwrap_or(1.0));
    }

    /// Adds a case whose bound is this standard deviation.
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

    /// Prints what was reached; fails beyond `ratio` of the bound, a bias of 0.1 of it (three times what
    /// chance gives, where that is more), a coverage outside 92…98 %, or where more than two in a hundred
    /// state no uncertainty.
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

    /// As [`Score::covers`], with two cases in a hundred that may state no uncertainty.
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

    /// Of a few cases most state an uncertainty, and none is far outside of it.
    fn few(&self, what: &str) {
        assert!(
            self.unstated < self.n,
            "{what}: {} of {} state an uncertainty",
            self.n,
            self.n + self.unstated
        );
        none_far(what, self.worst);
    }

    /// Prints the coverage; fails where it lies outside 92…98 %, or an uncertainty is not stated.
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

/// Standard deviations of unbiased estimates of the parameters `p` from values with independent noise of this
/// standard deviation: the diagonal of the inverse of Fisher's information, whose slopes are central
/// differences.
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
    // Scaled to a unit diagonal, so that units do not spoil the elimination.
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
