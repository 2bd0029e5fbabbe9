//! Measured results on model predictions, through the same measurement.

pub mod fit;
pub mod forcing;
pub mod observable;
pub mod overlay;
pub mod prediction;
pub mod score;
pub mod simulated;

pub use fit::{Fit, fit};
pub use forcing::{Forcing, levels};
pub use overlay::{Level, Overlay, Pair, PeakPair, overlay};
pub use prediction::{Kind, Prediction, Verdict};
pub use score::Score;
pub use simulated::{Contact, Pace, Simulated, simulated};
