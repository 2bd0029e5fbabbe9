//! Measured results on model predictions, through the same measurement.

mod course;
pub mod fit;
pub mod forcing;
pub mod named;
pub mod overlay;
pub mod pair;
pub mod peak_pair;
pub mod prediction;
pub mod rungs;
pub mod score;
pub mod simulated;

pub use fit::{Fit, fit};
pub use forcing::{Forcing, levels};
pub use overlay::{Level, Overlay, overlay};
pub use pair::Pair;
pub use peak_pair::PeakPair;
pub use prediction::{Kind, Prediction, Verdict};
pub use rungs::{Predicting, Rungs, rungs};
pub use score::Score;
pub use simulated::{Pace, Simulated, simulated};

pub use crate::model::observable;
pub use vibro_precision as precision;
