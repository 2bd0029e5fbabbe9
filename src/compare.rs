//! Measured results on model predictions, through the same measurement.

pub mod forcing;
pub mod observable;
pub mod overlay;
pub mod precision;
pub mod prediction;
pub mod score;

pub use forcing::{Forcing, levels};
pub use overlay::{Level, Overlay, Pair, PeakPair, overlay};
pub use prediction::{Kind, Prediction, Verdict};
pub use score::Score;
