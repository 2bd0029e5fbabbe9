//! Embedded Runge–Kutta integrators with dense output and located events.
//!
//! - [`DormandPrince`]: order 5 with an error estimate of order 4 and a dense output of order 4 (Dormand &
//!   Prince 1980; dense output of Shampine 1986);
//! - [`Dop853`]: order 8 with error estimates of orders 5 and 3 and a dense output of order 7 (Hairer,
//!   Nørsett & Wanner 1993, *Solving Ordinary Differential Equations I*, II.5 and II.6; coefficients of their
//!   program DOP853).
//!
//! A step is repeated with a smaller size until its estimated error is below the tolerance. The dense output
//! of a step is a polynomial in time; [`super::Polynomial`] finds the first event in it without missing one.

mod dop853;
mod dormand_prince;

pub use dop853::Dop853;
pub use dormand_prince::DormandPrince;

use super::Polynomial;
use vibro_record::{Error, Result};

/// Number of coefficients of a dense output: a polynomial in the time since the start of the step, divided by
/// the duration of the step.
pub(crate) const TERMS: usize = 8;

/// Largest number of stages of a scheme, including those of its dense output.
const STAGES: usize = 16;

/// An embedded Runge–Kutta scheme.
pub trait Scheme {
    /// Times of the stages since the start of the step, divided by its duration (Butcher tableau, column c).
    const NODES: &'static [f64];
    /// Weights of the earlier stages, for each stage but the first (rows of the Butcher tableau).
    const ROWS: &'static [&'static [f64]];
    /// Index of the stage at the end of the step: its row has the weights of the step itself, and its
    /// derivative is the first stage of the next step. Later stages serve the dense output only.
    const END_STAGE: usize;
    /// Exponent of the step-size control: 1/q where the estimated error of a step grows with step^q.
    const STEP_SIZE_EXPONENT: f64;

    /// Estimated error divided by the tolerated error, as a root mean square over the components. `rates` are
    /// the derivatives at the stages, `step` is the duration of the step.
    fn error<const N: usize>(rates: &[[f64; N]], step: f64, tolerated: &[f64; N]) -> f64;

    /// Coefficients of the dense output of a step from `start` to `end`, by rising powers.
    fn dense<const N: usize>(
        rates: &[[f64; N]],
        step: f64,
        start: &[f64; N],
        end: &[f64; N],
    ) -> [[f64; N]; TERMS];
}

/// Tolerated error of a step: `relative` times the magnitude of a component, or times its `floor` if that is
/// larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance<const N: usize> {
    /// Relative error of a step, at least 1e-14.
    pub relative: f64,
    /// Magnitude of each component below which its tolerated error does not decrease further.
    pub floor: [f64; N],
}

/// One accepted step, with the dense output that interpolates the solution inside it.
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

    /// Bound on how far each component of the dense output goes from its start.
    pub fn reach(&self) -> [f64; N] {
        let mut reach = [0.0; N];
        for term in &self.terms[1..] {
            reach.iter_mut().zip(term).for_each(|(sum, term)| *sum += term.abs());
        }
        reach
    }

    /// First time after the start of the step at which weights·y + offset falls to zero; it must not be
    /// negative at the start. `None` if it stays above zero.
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
    /// Size with which the last accepted step would just have met the tolerance; infinite before the first.
    just: f64,
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
        let rate = f(time, &y);
        Integrator { time, y, rate, step, just: f64::INFINITY, tolerance, scheme: std::marker::PhantomData }
    }

    /// Time at the end of the last accepted step.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Solution at the end of the last accepted step.
    pub fn y(&self) -> &[f64; N] {
        &self.y
    }

    /// Derivative at the end of the last accepted step.
    pub fn rate(&self) -> &[f64; N] {
        &self.rate
    }

    /// Size of the step to be tried next.
    pub fn next_step(&self) -> f64 {
        self.step
    }

    /// Makes the step to be tried next no larger than `size`, above 0.
    pub fn limit_step(&mut self, size: f64) {
        self.step = self.step.min(size);
    }

    /// Takes one step that ends at the time `until` at the latest.
    ///
    /// # Errors
    /// If the tolerance cannot be met with any step that time can resolve, or the solution is not finite.
    pub fn step(&mut self, f: impl Fn(f64, &[f64; N]) -> [f64; N], until: f64) -> Result<Step<N>> {
        self.forced_step(|t| t, f, until)
    }

    /// As [`Integrator::step`] for y′ = f(u(t), y): the forcing u does not wait for the stages before it, so
    /// that a processor computes those of several stages at a time.
    ///
    /// # Errors
    /// As [`Integrator::step`].
    pub fn forced_step<U: Copy>(
        &mut self,
        forcing: impl Fn(f64) -> U,
        f: impl Fn(U, &[f64; N]) -> [f64; N],
        until: f64,
    ) -> Result<Step<N>> {
        let (mut grow, remaining) = (10.0, until - self.time);
        let mut step = self.step;
        loop {
            let whole = step >= remaining;
            let h = step.min(remaining);
            // A step is too small if rounding of the time hides it. One that ends at `until` may be.
            if !whole && h <= 4.0 * f64::EPSILON * self.time.abs() || h.is_nan() || step < f64::MIN_POSITIVE {
                return Err(Error::refused(format!(
                    "no step is small enough to integrate on from {} s with a relative error of {}",
                    self.time, self.tolerance.relative
                ))
                .hint("allow a larger error, or check the parameters for extremes"));
            }
            let mut rates = [[0.0; N]; STAGES];
            rates[0] = self.rate;
            let time = self.time;
            let forced: [U; STAGES] =
                std::array::from_fn(|stage| forcing(time + S::NODES.get(stage).unwrap_or(&1.0) * h));
            let mut end = self.y;
            for stage in 1..=S::END_STAGE {
                end = self.stage(&rates, S::ROWS[stage - 1], h);
                rates[stage] = f(forced[stage], &end);
            }
            let tolerated = std::array::from_fn(|i| {
                let size = self.y[i].abs().max(end[i].abs()).max(self.tolerance.floor[i]);
                self.tolerance.relative * size
            });
            let error = S::error(&rates, h, &tolerated);
            // The next size is 0.9 of the one that just meets the tolerance. It is limited to 0.2 to 10 times
            // the present size; after a rejected step it does not grow.
            let just = h * error.powf(-S::STEP_SIZE_EXPONENT);
            let bounded = |size: f64, grow: f64| h * (size / h).clamp(0.2, grow);
            if error <= 1.0 {
                for stage in S::END_STAGE + 1..S::NODES.len() {
                    let y = self.stage(&rates, S::ROWS[stage - 1], h);
                    rates[stage] = f(forced[stage], &y);
                }
                let terms = S::dense(&rates, h, &self.y, &end);
                let taken = Step { start: self.time, duration: h, end, terms };
                self.time = if whole { until } else { self.time + h };
                self.y = end;
                self.rate = rates[S::END_STAGE];
                // Where the size that just meets the tolerance falls, it falls on (Gustafsson 1994).
                let trend = if self.just.is_finite() { (just / self.just).min(1.0) } else { 1.0 };
                let next = bounded(0.9 * trend * just, grow);
                self.just = just;
                // A step cut short by `until` is no reason to reduce the step size.
                self.step = if h < step { step.max(next) } else { next };
                return Ok(taken);
            }
            grow = 1.0;
            // The estimated error is NaN if the derivatives are not finite.
            step = if just.is_nan() { 0.2 * h } else { bounded(0.9 * just, grow) };
        }
    }

    /// Solution at a stage: the start of the step plus `h` times the weighted derivatives of earlier stages.
    fn stage(&self, rates: &[[f64; N]; STAGES], weights: &[f64], h: f64) -> [f64; N] {
        let sum = combine(rates, weights);
        std::array::from_fn(|i| self.y[i] + h * sum[i])
    }
}

/// Sum of the derivatives `rates`, each times its weight, for each component.
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
