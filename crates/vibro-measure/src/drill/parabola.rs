//! A parabola beside a contact.

use super::faults::State;
use super::lack_of_fit::Shape;
use std::ops::RangeInclusive;

/// Fewest samples of a fit: twice its parameters.
pub(super) const FEWEST: usize = 6;

/// A parabola, continued to the middle of the contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parabola {
    /// Its value there.
    pub value: f64,
    /// Variance of the value for unit variance of the samples.
    pub leverage: f64,
    /// Variance of the value by the residuals of this fit alone.
    pub variance: f64,
    /// Residuals by their place.
    pub shape: Shape,
}

impl Parabola {
    /// Parabola through the measured samples of `range`, continued to the place `at`, and its residuals; `None` where fewer than two
    /// thirds of them are measured.
    pub fn through(
        values: &[f64],
        states: &[State],
        at: f64,
        range: RangeInclusive<isize>,
    ) -> Option<(Parabola, Vec<f64>)> {
        let (from, to) = (usize::try_from(*range.start()).ok()?, usize::try_from(*range.end()).ok()?);
        let (part, known) = (values.get(from..=to)?, states.get(from..=to)?);
        let scale = 1.0 / part.len().max(1) as f64;
        let all = part.iter().zip(known).enumerate();
        let good: Vec<(usize, f64, f64)> = all
            .filter(|(_, (v, s))| s.measured() && v.is_finite())
            .map(|(k, (v, _))| (k, ((from + k) as f64 - at) * scale, *v))
            .collect();
        if good.len() < FEWEST || 3 * good.len() < 2 * part.len() {
            return None;
        }
        let (mut s, mut t) = ([0.0; 5], [0.0; 3]);
        for (_, x, y) in &good {
            let mut power = 1.0;
            for (k, s) in s.iter_mut().enumerate() {
                *s += power;
                if let Some(t) = t.get_mut(k) {
                    *t += power * y;
                }
                power *= x;
            }
        }
        // Inverse of the normal matrix by cofactors; its first row gives the value.
        let c = [s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]];
        let det = s[0] * c[0] + s[1] * c[1] + s[2] * c[2];
        let c11 = s[0] * s[4] - s[2] * s[2];
        let c12 = s[1] * s[2] - s[0] * s[3];
        let c22 = s[0] * s[2] - s[1] * s[1];
        let value = (c[0] * t[0] + c[1] * t[1] + c[2] * t[2]) / det;
        let slope = (c[1] * t[0] + c11 * t[1] + c12 * t[2]) / det;
        let bend = (c[2] * t[0] + c12 * t[1] + c22 * t[2]) / det;
        let residuals: Vec<f64> = good.iter().map(|(_, x, y)| y - value - x * (slope + x * bend)).collect();
        let shape = Shape::new(good.iter().zip(&residuals).map(|((k, ..), r)| (*k, *r)), part.len());
        let leverage = c[0] / det;
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        let variance = leverage * squares / (residuals.len() - 3) as f64;
        value.is_finite().then_some((Parabola { value, leverage, variance, shape }, residuals))
    }
}
