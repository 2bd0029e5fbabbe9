//! Embedded Runge–Kutta integrators with dense output and located events.
//!
//! - [`DormandPrince`]: order 5 with an error estimate of order 4 and a dense output of order 4 (Dormand &
//!   Prince 1980; dense output of Shampine 1986);
//! - [`Dop853`]: order 8 with error estimates of orders 5 and 3 and a dense output of order 7 (Hairer,
//!   Nørsett & Wanner 1993, *Solving Ordinary Differential Equations I*, II.5 and II.6; coefficients of their
//!   program DOP853).
//!
//! A step is repeated with a smaller size until its estimated error is below the tolerance. Its dense output
//! is a polynomial in time, in which [`super::Polynomial`] finds the first event without missing one.

mod dop853;
mod dormand_prince;

pub use dop853::Dop853;
pub use dormand_prince::DormandPrince;

use super::Polynomial;
use vibro_record::{Error, Result};

/// Coefficients of a dense output, a polynomial in the time since the start of the step over its duration.
pub(crate) const TERMS: usize = 8;

/// Most stages of a scheme, those of its dense output included.
const STAGES: usize = 16;

/// An embedded Runge–Kutta scheme.
pub trait Scheme {
    /// Times of the stages since the start of the step, over its duration.
    const NODES: &'static [f64];
    /// Weights of the earlier stages, for each stage but the first.
    const ROWS: &'static [&'static [f64]];
    /// Number of stages of the step itself; the stage after them is at its end, with the step's own weights.
    const STEP: usize;
    /// One over the order of the estimated error.
    const ROOT: f64;

    /// Estimated error over tolerance, from the derivatives at the stages, the duration of the step, and the
    /// tolerated error of each component.
    fn error<const N: usize>(rates: &[[f64; N]], step: f64, tolerated: &[f64; N]) -> f64;

    /// Coefficients of the dense output.
    fn dense<const N: usize>(
        rates: &[[f64; N]],
        step: f64,
        start: &[f64; N],
        end: &[f64; N],
    ) -> [[f64; N]; TERMS];
}

/// Tolerated error of a step: `relative` times the size of a component, or times its `floor` where that is
/// larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance<const N: usize> {
    /// Relative error of a step; not below 1e-14.
    pub relative: f64,
    /// Size of each component below which its tolerated error does not fall further.
    pub floor: [f64; N],
}

/// One accepted step, with the solution between its ends by dense output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<const N: usize> {
    /// Time at its start in s.
    pub start: f64,
    /// Its duration in s.
    pub duration: f64,
    /// Solution at its end; more accurate than the dense output.
    pub end: [f64; N],
    terms: [[f64; N]; TERMS],
}

impl<const N: usize> Step<N> {
    /// The solution at the time `t` after the start of the step.
    pub fn at(&self, t: f64) -> [f64; N] {
        if t == self.duration {
            return self.end;
        }
        let part = t / self.duration;
        let mut y = [0.0; N];
        for term in self.terms.iter().rev() {
            for (y, term) in y.iter_mut().zip(term) {
                *y = *y * part + term;
            }
        }
        y
    }

    /// First time after the start of the step at which weights·y + offset, not negative at the start, falls
    /// to zero.
    pub fn first_fall(&self, weights: &[f64; N], offset: f64) -> Option<f64> {
        let mut terms = self.terms.map(|term| term.iter().zip(weights).map(|(y, w)| w * y).sum::<f64>());
        terms[0] += offset;
        Polynomial::new(terms).first_fall().map(|part| part * self.duration)
    }
}

/// An integration of y′ = f(t, y), step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrator<S: Scheme, const N: usize> {
    time: f64,
    y: [f64; N],
    rate: [f64; N],
    step: f64,
    tolerance: Tolerance<N>,
    scheme: std::marker::PhantomData<S>,
}

impl<S: Scheme, const N: usize> Integrator<S, N> {
    /// Starts at `time` with `y`; `step` > 0 is the size to try first.
    pub fn new(
        f: impl Fn(f64, &[f64; N]) -> [f64; N],
        time: f64,
        y: [f64; N],
        step: f64,
        tolerance: Tolerance<N>,
    ) -> Self {
        Integrator { time, y, rate: f(time, &y), step, tolerance, scheme: std::marker::PhantomData }
    }

    /// Time now.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Solution now.
    pub fn y(&self) -> &[f64; N] {
        &self.y
    }

    /// Size of the step to be tried next.
    pub fn next_step(&self) -> f64 {
        self.step
    }

    /// Takes one step, at most to the time `until`.
    ///
    /// # Errors
    /// If the tolerance cannot be met with any step that time can resolve, or the solution is not finite.
    pub fn step(&mut self, f: impl Fn(f64, &[f64; N]) -> [f64; N], until: f64) -> Result<Step<N>> {
        let (mut grow, remaining) = (10.0, until - self.time);
        let mut step = self.step;
        loop {
            let whole = step >= remaining;
            let h = step.min(remaining);
            // A step that the time cannot resolve, unless it ends at `until`.
            if !whole && h <= 4.0 * f64::EPSILON * self.time.abs() || h.is_nan() || step < f64::MIN_POSITIVE {
                return Err(Error::refused(format!(
                    "no step is small enough to integrate on from {} s with a relative error of {}",
                    self.time, self.tolerance.relative
                ))
                .hint("allow a larger error, or check the parameters for extremes"));
            }
            let mut rates = [[0.0; N]; STAGES];
            rates[0] = self.rate;
            let mut end = self.y;
            for stage in 1..=S::STEP {
                end = self.stage(&rates, S::ROWS[stage - 1], h);
                rates[stage] = f(self.time + S::NODES[stage] * h, &end);
            }
            let tolerated = std::array::from_fn(|i| {
                let size = self.y[i].abs().max(end[i].abs()).max(self.tolerance.floor[i]);
                self.tolerance.relative * size
            });
            let error = S::error(&rates, h, &tolerated);
            // 0.9 of the size that just meets the tolerance; at most ten times as large and at least a fifth
            // at once.
            let factor = (0.9 * error.powf(-S::ROOT)).clamp(0.2, grow);
            if error <= 1.0 {
                for stage in S::STEP + 1..S::NODES.len() {
                    let y = self.stage(&rates, S::ROWS[stage - 1], h);
                    rates[stage] = f(self.time + S::NODES[stage] * h, &y);
                }
                let terms = S::dense(&rates, h, &self.y, &end);
                let taken = Step { start: self.time, duration: h, end, terms };
                self.time = if whole { until } else { self.time + h };
                self.y = end;
                self.rate = rates[S::STEP];
                // A step cut short by `until` is no reason to reduce the step size.
                self.step = if h < step { step.max(h * factor) } else { h * factor };
                return Ok(taken);
            }
            grow = 1.0;
            // The error may be NaN, too.
            step = h * if factor.is_nan() { 0.2 } else { factor };
        }
    }

    fn stage(&self, rates: &[[f64; N]; STAGES], weights: &[f64], h: f64) -> [f64; N] {
        let sum = combine(rates, weights);
        std::array::from_fn(|i| self.y[i] + h * sum[i])
    }
}

/// Σ weights·derivatives, for each component.
fn combine<const N: usize>(rates: &[[f64; N]], weights: &[f64]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (rate, w) in rates.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
        for (sum, rate) in sum.iter_mut().zip(rate) {
            *sum += w * rate;
        }
    }
    sum
}

#[cfg(test)]
mod tests;
