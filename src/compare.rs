//! Measured results against model predictions, through the same measurement.

mod course;
mod fit;
mod forcing;
mod named;
mod overlay;
mod pair;
mod peak_pair;
mod prediction;
mod rungs;
mod score;
mod simulated;

pub use fit::{Block, Fit, FitModel, FitPoint, Fitted, LeftOut, Profile, Rung, Unidentified, fit};
pub use overlay::{Level, Overlay, overlay};
pub use pair::Pair;
pub use peak_pair::PeakPair;
pub use prediction::{Kind, Motion, Prediction, Verdict};
pub use score::Score;

pub(crate) use forcing::{Forcing, levels};
pub(crate) use named::{Named, named};
pub(crate) use rungs::Predicting;
