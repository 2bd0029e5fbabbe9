//! Fourier transforms of real records.
//!
//! Xₖ = Σ xₙ e^(−2πikn/N), without a factor, for k = 0 … N/2. The inverse divides by N, so that it restores
//! the record.

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Tables of each length are computed once, for all threads.
static PLANNER: LazyLock<Mutex<RealFftPlanner<f64>>> = LazyLock::new(|| Mutex::new(RealFftPlanner::new()));

/// The transform of one length.
///
/// ```
/// use vibro_signal::fft::Transform;
/// let transform = Transform::new(4);
/// let lines = transform.forward(&[1.0, 0.0, -1.0, 0.0]); // one period of a cosine
/// assert_eq!(lines.iter().map(|x| x.re).collect::<Vec<f64>>(), [0.0, 2.0, 0.0]);
/// assert_eq!(transform.inverse(&lines), [1.0, 0.0, -1.0, 0.0]);
/// ```
#[derive(Clone)]
pub struct Transform {
    n: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Memory of a transform; each thread needs its own.
pub struct Workspace {
    /// The record; destroyed by the transform.
    pub input: Vec<f64>,
    /// The spectral lines.
    pub output: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Workspace {
    /// Takes a record, subtracts `level` and applies the weights.
    pub(crate) fn load(&mut self, values: &[f64], level: f64, weights: &[f64]) {
        for ((to, v), w) in self.input.iter_mut().zip(values).zip(weights) {
            *to = (v - level) * w;
        }
    }
}

impl Transform {
    /// The transform of records of `n` samples; fast where `n` has small factors only.
    pub fn new(n: usize) -> Transform {
        // Even after a panic in another thread the planner holds only finished tables.
        let mut planner = PLANNER.lock().unwrap_or_else(PoisonError::into_inner);
        Transform { n, forward: planner.plan_fft_forward(n), inverse: planner.plan_fft_inverse(n) }
    }

    /// Number of spectral lines, N/2 + 1.
    pub fn lines(&self) -> usize {
        self.n / 2 + 1
    }

    /// Memory for [`Transform::run`].
    pub fn workspace(&self) -> Workspace {
        Workspace {
            input: self.forward.make_input_vec(),
            output: self.forward.make_output_vec(),
            scratch: self.forward.make_scratch_vec(),
        }
    }

    /// Transforms the record in the workspace, without allocating memory.
    ///
    /// # Panics
    /// If the workspace is of another length.
    pub fn run(&self, work: &mut Workspace) {
        let done = self.forward.process_with_scratch(&mut work.input, &mut work.output, &mut work.scratch);
        assert!(done.is_ok(), "a workspace of another length");
    }

    /// Spectral lines of a record. Short records are filled with zeros, long ones are truncated.
    pub fn forward(&self, values: &[f64]) -> Vec<Complex64> {
        let mut work = self.workspace();
        work.input.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
        self.run(&mut work);
        work.output
    }

    /// Record with these spectral lines. Missing lines are zero. Imaginary parts at zero and at half the
    /// sampling rate, which no real record has, are ignored.
    pub fn inverse(&self, lines: &[Complex64]) -> Vec<f64> {
        let mut input = self.inverse.make_input_vec();
        input.iter_mut().zip(lines).for_each(|(to, from)| *to = *from);
        input[0].im = 0.0;
        if self.n.is_multiple_of(2) {
            input[self.n / 2].im = 0.0;
        }
        let mut output = self.inverse.make_output_vec();
        let done = self.inverse.process(&mut input, &mut output);
        debug_assert!(done.is_ok(), "lengths and imaginary parts are those the transform asks for");
        for v in &mut output {
            *v /= self.n as f64;
        }
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn lines_are_those_of_the_definition() {
        for n in [1usize, 2, 3, 8, 15, 97, 100] {
            // A sequence without symmetry.
            let values: Vec<f64> = (0..n).map(|i| ((i * i * 7 + 3 * i) % 23) as f64 - 9.0).collect();
            let transform = Transform::new(n);
            let found = transform.forward(&values);
            assert_eq!(found.len(), transform.lines());
            for (k, line) in found.iter().enumerate() {
                let slow: Complex64 = values
                    .iter()
                    .enumerate()
                    .map(|(i, v)| Complex64::from_polar(*v, -TAU * ((i * k) % n) as f64 / n as f64))
                    .sum();
                // n terms of up to 13, each with the rounding of a sine.
                assert!(
                    (line - slow).norm() < 13.0 * n as f64 * 4.0 * f64::EPSILON,
                    "{n} {k}: {line} {slow}"
                );
            }
            for (back, v) in transform.inverse(&found).iter().zip(&values) {
                assert!((back - v).abs() < 13.0 * n as f64 * 4.0 * f64::EPSILON);
            }
        }
    }
}
