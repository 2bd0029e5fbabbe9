//! Tables of sweeps, and of sweeps against the model.

mod fit;
mod overlay;
mod response;

pub use fit::{fit_points, fit_rungs, fitted};
pub use overlay::{pairs, peaks, scores};
pub use response::{curve, jumps, resonances, response};
