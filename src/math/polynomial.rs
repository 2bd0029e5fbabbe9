//! A polynomial over 0..1, with bounds that let none of its falls through zero be missed.

use super::root::{Bounded, first_fall};

/// A polynomial of K terms over 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<const K: usize> {
    terms: [f64; K],
    /// Bound on its second derivative.
    curvature: f64,
    /// Bound on its way from its first value.
    reach: f64,
}

impl<const K: usize> Polynomial<K> {
    /// The polynomial Σ termsₖ pᵏ.
    #[inline]
    pub fn new(terms: [f64; K]) -> Polynomial<K> {
        let (mut curvature, mut reach) = (0.0, 0.0);
        for (k, term) in terms.iter().enumerate().skip(1) {
            curvature += (k * (k - 1)) as f64 * term.abs();
            reach += term.abs();
        }
        Polynomial { terms, curvature, reach }
    }

    /// Value, slope, and a bound on the curvature everywhere.
    #[inline]
    pub fn at(&self, part: f64) -> Bounded {
        let (mut value, mut slope) = (0.0, 0.0);
        for term in self.terms.iter().rev() {
            slope = slope * part + value;
            value = value * part + term;
        }
        Bounded { value, slope, curvature: self.curvature }
    }

    /// Integral from 0 to `part`.
    pub fn integral(&self, part: f64) -> f64 {
        let sum = self.terms.iter().enumerate().rev();
        part * sum.fold(0.0, |sum, (k, term)| sum * part + term / (k + 1) as f64)
    }

    /// Where the polynomial, not negative at 0, first falls to zero.
    #[inline]
    pub fn first_fall(&self) -> Option<f64> {
        if self.terms[0] > self.reach {
            return None;
        }
        first_fall(0.0, 1.0, 0.0, |part| self.at(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_slopes_and_integrals_of_known_polynomials() {
        // (p − 0.3)(p − 0.7) = 0.21 − p + p².
        let p = Polynomial::new([0.21, -1.0, 1.0]);
        assert!((p.first_fall().unwrap() - 0.3).abs() < 4.0 * f64::EPSILON);
        let there = p.at(0.5);
        assert!((there.value + 0.04).abs() < f64::EPSILON && there.slope == 0.0);
        // 0.21p − p²/2 + p³/3 at 1: 0.21 − 1/2 + 1/3.
        assert!((p.integral(1.0) - (0.21 - 0.5 + 1.0 / 3.0)).abs() < f64::EPSILON);
        // Two roots a millionth apart are not missed; none is found where there is none.
        let close = |middle: f64| Polynomial::new([0.25 + middle, -1.0, 1.0]);
        let found = close(-1e-12).first_fall().unwrap();
        assert!((found - (0.5 - 1e-6)).abs() < 1e-9, "{found}");
        assert_eq!(close(1e-12).first_fall(), None);
        assert_eq!(Polynomial::new([3.0, -1.0, -1.0]).first_fall(), None);
    }
}
