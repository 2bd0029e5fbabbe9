//! One linear mode of the rig, solved in pieces by Taylor series: exact to rounding at any damping, for any
//! matrix.
//!
//! In a mode both accelerations are linear in the state: a = A(x₁, v₁, x₂, v₂) + constant + gain·F(t). The
//! series of the motion follows from it term by term (xₖ₊₁ = vₖ/(k + 1), vₖ₊₁ = aₖ/(k + 1)), also for a
//! matrix without a full set of eigenvectors (critical damping). Let K and C be the largest row sums of
//! stiffness and damping over mass, and s² = Cs + K. Then ‖A‖ ≤ s in the norm max(s|xᵢ|, |vᵢ|). A piece lasts
//! at most 1/s and 1/ω, so truncating the series after the power [`ORDER`] changes the motion by less than
//! e/(ORDER + 1)! = 2.2e-17 of the norm: less than rounding.

use super::flow::State;
use super::motion::Path;
use vibro_math::Polynomial;

/// Highest power of time in a series.
pub const ORDER: usize = 18;

/// Terms of a series in powers of time over the duration of a piece.
pub type Terms = [f64; ORDER + 1];

/// A linear mode of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Accelerations of both masses per unit of x₁, v₁, x₂, v₂.
    matrix: [[f64; 4]; 2],
    /// Constant acceleration of each mass in m/s².
    constant: [f64; 2],
    /// Acceleration of each mass per newton of the exciting force, in 1/kg.
    gain: [f64; 2],
    /// Rate s in 1/s, a bound on how fast the free motion changes.
    pub rate: f64,
}

impl Linear {
    /// Mode with the accelerations `matrix` per unit of x₁, v₁, x₂, v₂, `constant` (m/s²), and `gain` per
    /// newton of the exciting force.
    pub fn new(matrix: [[f64; 4]; 2], constant: [f64; 2], gain: [f64; 2]) -> Linear {
        let row_sum = |i: usize| matrix.iter().map(|row| row[i].abs() + row[i + 2].abs()).fold(0.0, f64::max);
        let (stiffness, damping) = (row_sum(0), row_sum(1));
        let rate = f64::midpoint(damping, (damping * damping + 4.0 * stiffness).sqrt());
        Linear { matrix, constant, gain, rate }
    }

    /// a₁ − a₂: the acceleration of the masses towards each other.
    pub fn closing(&self) -> Quantity {
        let [first, second] = &self.matrix;
        let weights = std::array::from_fn(|i| first[i] - second[i]);
        Quantity { weights, force: self.gain[0] - self.gain[1], offset: self.constant[0] - self.constant[1] }
    }

    /// Accelerations of both masses in m/s² at a state and an exciting force in N.
    #[inline]
    pub fn accelerations(&self, state: &State, force: f64) -> [f64; 2] {
        let state = state.array();
        std::array::from_fn(|i| dot(&self.matrix[i], &state) + self.gain[i] * force + self.constant[i])
    }

    /// The motion from `state` for `duration` seconds, at most 1/s, under a force with the terms `force`.
    #[inline]
    pub fn fly(&self, state: &State, force: &Terms, duration: f64) -> Taylor {
        let mut terms = [[0.0; 4]; ORDER + 1];
        terms[0] = state.array();
        for k in 0..ORDER {
            let here = terms[k];
            let step = duration / (k + 1) as f64;
            let [a1, a2] = std::array::from_fn(|i| {
                let constant = if k == 0 { self.constant[i] } else { 0.0 };
                dot(&self.matrix[i], &here) + self.gain[i] * force[k] + constant
            });
            terms[k + 1] = [step * here[1], step * a1, step * here[3], step * a2];
        }
        Taylor { terms, duration }
    }
}

/// The motion within one piece, as a Taylor series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Taylor {
    /// Terms of x₁, v₁, x₂, v₂ in powers of t over the duration.
    terms: [[f64; 4]; ORDER + 1],
    duration: f64,
}

impl Taylor {
    /// The course of a quantity that is linear in the state.
    #[inline]
    pub fn read(&self, quantity: &Quantity, force: &Terms) -> QuantityCourse {
        let mut terms = [0.0; ORDER + 1];
        for ((term, y), force) in terms.iter_mut().zip(&self.terms).zip(force) {
            *term = dot(&quantity.weights, y) + quantity.force * force;
        }
        terms[0] += quantity.offset;
        QuantityCourse { polynomial: Polynomial::new(terms), duration: self.duration }
    }
}

impl Path for Taylor {
    #[inline]
    fn state(&self, t: f64) -> State {
        let part = if self.duration > 0.0 { t / self.duration } else { 0.0 };
        let mut y = self.terms[ORDER];
        for term in self.terms[..ORDER].iter().rev() {
            for (y, term) in y.iter_mut().zip(term) {
                *y = *y * part + term;
            }
        }
        State::of(y)
    }
}

/// A quantity that is linear in the state and the exciting force: w·(x₁, v₁, x₂, v₂) + w₅F + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Weights of x₁, v₁, x₂, v₂.
    pub weights: [f64; 4],
    /// Weight of the exciting force.
    pub force: f64,
    /// Constant part.
    pub offset: f64,
}

impl Quantity {
    /// Value of the quantity at a state and an exciting force (N).
    pub fn value(&self, state: &State, force: f64) -> f64 {
        dot(&self.weights, &state.array()) + self.force * force + self.offset
    }

    /// The same quantity times a factor.
    pub fn times(&self, factor: f64) -> Quantity {
        let scaled = self.weights.map(|w| factor * w);
        Quantity { weights: scaled, force: factor * self.force, offset: factor * self.offset }
    }
}

/// A quantity as a polynomial of time within one piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantityCourse {
    polynomial: Polynomial<{ ORDER + 1 }>,
    duration: f64,
}

impl QuantityCourse {
    /// Integral over the first `t` seconds.
    pub fn integral(&self, t: f64) -> f64 {
        if self.duration > 0.0 { self.polynomial.integral(t / self.duration) * self.duration } else { 0.0 }
    }

    /// First time in s at which a quantity that is not negative at the beginning falls to zero. No root is
    /// missed.
    #[inline]
    pub fn first_fall(&self) -> Option<f64> {
        self.polynomial.first_fall().map(|part| part * self.duration)
    }
}

#[inline]
fn dot(w: &[f64; 4], y: &[f64; 4]) -> f64 {
    w[0] * y[0] + w[1] * y[1] + w[2] * y[2] + w[3] * y[3]
}

#[cfg(test)]
mod tests;
