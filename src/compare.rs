//! Measured results against model predictions, through the same measurement.

mod course;
mod fit;
mod forcing;
mod named;
mod overlay;
mod pair;
mod prediction;
mod rungs;
mod simulated;

pub use fit::{Block, Fit, FitPoint, Fitted, LeftOut, Profile, Rung, Unidentified, fit};
pub use forcing::{Forcing, levels};
pub use named::{Named, named};
pub use overlay::{Level, Overlay, overlay};
pub use pair::{Pair, PeakPair, Score};
pub use prediction::{Kind, Motion, Prediction, Verdict};
pub use rungs::{Predicting, Rungs};
pub use simulated::Pace;

pub use vibro_precision as precision;
