//! Own numerical kernels, each with its source and its error bound.

pub mod oscillator;
pub mod root;

pub use oscillator::Oscillator;
