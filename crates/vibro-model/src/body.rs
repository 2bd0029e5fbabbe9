//! One body: a mass on its spring and its damper, or both masses joined.

use num_complex::Complex64;
use vibro_math::Oscillator;

/// A mass on its spring and its damper. A wall has an infinite mass, no spring and no damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Body {
    /// Mass in kg.
    pub mass: f64,
    /// Damping in N s/m.
    pub damping: f64,
    /// Stiffness in N/m.
    pub stiffness: f64,
}

impl Body {
    /// Receptance L(iω) = 1/(k − mω² + icω) in m/N, for motion Re(X e^{iωt}); 0 for a wall.
    pub fn receptance(&self, omega: f64) -> Complex64 {
        if self.mass == f64::INFINITY {
            return Complex64::ZERO;
        }
        Complex64::new(self.stiffness - self.mass * omega * omega, self.damping * omega).inv()
    }

    /// Free motion of the body; a wall stays at rest.
    pub fn oscillator(&self) -> Oscillator {
        if self.mass == f64::INFINITY {
            return Oscillator::new(1.0, 0.0, 0.0);
        }
        Oscillator::new(self.mass, self.damping, self.stiffness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_receptance() {
        // Far below resonance 1/k, at it 1/(icω), far above −1/(mω²).
        let (m, c, k) = (0.125, 0.1, 135.0);
        let at = |omega| Body { mass: m, damping: c, stiffness: k }.receptance(omega);
        assert!((at(1e-9) * k - 1.0).norm() < 1e-12);
        let resonance = f64::sqrt(k / m);
        let expected = Complex64::new(0.0, -1.0 / (c * resonance));
        // k − mω² keeps the rounding of k where only icω should remain.
        assert!((at(resonance) / expected - 1.0).norm() < 4.0 * f64::EPSILON * k / (c * resonance));
        let high: f64 = 1e6;
        // The neglected terms are k/(mω²) and c/(mω).
        assert!((at(high) * (-m * high * high) - 1.0).norm() < 2.0 * (c / (m * high)));
    }
}
