//! Numerical kernels, each with its source and its error bound.
//!
//! ```
//! use vibro_math::Oscillator;
//! // Displacement and velocity 0.1 s after a release at 1 mm: a little more than half a period.
//! let (x, v) = Oscillator::new(0.125, 0.1, 135.0).free(1e-3, 0.0, 0.1);
//! assert!(x < 0.0 && v > 0.0);
//! ```

mod bisection;
pub mod cis;
mod least_squares;
mod noise;
pub mod oscillator;
mod polynomial;
pub mod root;
pub mod runge_kutta;

pub use bisection::{bisected, border, try_bisected};
pub use least_squares::{Fit, Minimum, least_squares, minimise};
pub use noise::Noise;
pub use oscillator::Oscillator;
pub use polynomial::Polynomial;
