//! Polynomials on the interval 0..1, with bounds on their derivatives: no downward zero crossing is missed.

use super::root::{Bounded, RootAhead, walk};

/// A polynomial of K terms on the interval 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<const K: usize> {
    /// Coefficient of each power, from 0 on.
    terms: [f64; K],
    /// Bound on the magnitude of the second derivative.
    curvature: f64,
    /// Bound on the magnitude of the third derivative.
    third: f64,
    /// Bound on the magnitude of the difference from the value at 0.
    reach: f64,
}

impl<const K: usize> Polynomial<K> {
    /// The polynomial Σ termsₖ pᵏ.
    #[inline]
    pub fn new(terms: [f64; K]) -> Polynomial<K> {
        let (mut curvature, mut third, mut reach) = (0.0, 0.0, 0.0);
        for (k, term) in terms.iter().enumerate().skip(1) {
            let twice = (k * (k - 1)) as f64 * term.abs();
            curvature += twice;
            third += (k as f64 - 2.0) * twice;
            reach += term.abs();
        }
        Polynomial { terms, curvature, third, reach }
    }

    /// Value and slope at `part`, with the bound on the curvature.
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

    /// Second derivative at `part`.
    fn bend(&self, part: f64) -> f64 {
        let terms = self.terms.iter().enumerate().skip(2).rev();
        terms.fold(0.0, |sum, (k, term)| sum * part + (k * (k - 1)) as f64 * term)
    }

    /// First argument at which the polynomial falls to zero; its value at 0 must not be negative. `None` if
    /// it does not fall to zero up to 1.
    ///
    /// The search takes the steps of [`super::root`], which use the bound M on the curvature. If value f,
    /// slope ḟ and second derivative f̈ are all not negative, the bound M₃ on the third derivative allows
    /// longer steps: the largest of ∛(6f/M₃), √(6ḟ/M₃) and 3f̈/M₃. These grow geometrically from a triple
    /// root at 0, which occurs where masses part from rest.
    #[inline]
    pub fn first_fall(&self) -> Option<f64> {
        if self.terms[0] > self.reach {
            return None;
        }
        let look = |part| {
            let here = self.at(part);
            let falls = here.slope < 0.0;
            if falls && here.value <= 0.0 {
                return RootAhead::Root(0.0);
            }
            let mut step = here.step();
            let bend = if falls { 0.0 } else { self.bend(part) };
            if !falls && bend >= 0.0 && self.third > 0.0 {
                let value = (6.0 * here.value.max(0.0) / self.third).cbrt();
                let slope = (6.0 * here.slope / self.third).sqrt();
                step = step.max(value.max(slope).max(3.0 * bend / self.third));
            }
            RootAhead::Step { step, falls }
        };
        walk(0.0, 1.0, look).map(|(part, _)| part)
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

    #[test]
    fn a_multiple_root_at_the_start_is_left_behind() {
        // p³(0.7 − p), exactly and with rounding errors in its lower terms.
        let found = Polynomial::new([0.0, 0.0, 0.0, 0.7, -1.0]).first_fall().unwrap();
        assert!((found - 0.7).abs() < 4.0 * f64::EPSILON, "{found}");
        let found = Polynomial::new([-1e-19, 0.0, 1e-20, 0.7, -1.0]).first_fall().unwrap();
        assert!((found - 0.7).abs() < 4.0 * f64::EPSILON, "{found}");
        assert_eq!(Polynomial::new([0.0, 0.0, 0.0, 1.0]).first_fall(), None);
        assert_eq!(Polynomial::new([f64::NAN, 1.0]).first_fall(), None);
    }
}
