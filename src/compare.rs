//! Measured results against model predictions, through the same measurement.

mod fit;
mod forcing;
mod named;
mod overlay;
mod pair;
mod predicting;
mod prediction;
mod simulated;

pub use fit::{Block, Fit, FitPoint, Fitted, LeftOut, Profile, Rung, Unidentified, fit};
pub use forcing::{Forcing, levels};
pub use named::{Named, named};
pub use overlay::{Level, Overlay, overlay};
pub use pair::{Pair, PeakPair, Score};
pub use predicting::{Predicting, Rungs};
pub use prediction::{Kind, Motion, Prediction, Verdict};
pub use simulated::Pace;

pub use vibro_precision as precision;
