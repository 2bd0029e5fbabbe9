//! Numerical kernels, each with its source and its error bound.

pub mod cis;
pub mod lanes;
mod least_squares;
mod noise;
pub mod oscillator;
mod polynomial;
pub mod root;
pub mod runge_kutta;

pub use least_squares::{Fit, Minimum, least_squares, minimise};
pub use noise::Noise;
pub use oscillator::Oscillator;
pub use polynomial::Polynomial;
