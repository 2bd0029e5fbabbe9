//! Measured results against model predictions, through the same measurement.

mod drill;
mod fit;
mod forcing;
mod named;
mod overlay;
mod pair;
mod predicting;
mod prediction;
pub(crate) mod simulated;

pub use drill::{Difference, DrillComparison, DrillFit, FittedKey, ShownBody};
pub use fit::{Block, Fit, FitPoint, FittedParameter, LeftOut, Profile, Rung, Unidentified, fit};
pub use overlay::{Level, Overlay, overlay, predicted};
pub use pair::{Pair, PeakPair, Score};
pub use prediction::{Motion, MotionKind, Prediction, Verdict};

pub(crate) use drill::drill_comparison;
pub(crate) use fit::design;
pub(crate) use forcing::{Forcing, levels};
pub(crate) use named::{Named, named};
pub(crate) use predicting::Predicting;
