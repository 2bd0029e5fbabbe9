//! Measured results on model predictions, through the same measurement.

pub mod observable;
pub mod overlay;
pub mod prediction;

pub use overlay::{Overlay, Pair, PeakPair, Score, overlay};
pub use prediction::{Kind, Prediction};
