//! Tables of sweeps, and of sweeps against the model.

mod fit;
mod overlay;
mod response;

pub(crate) use fit::{fit_points, fit_rungs, fitted};
pub(crate) use overlay::{pairs, peaks, scores};
pub(crate) use response::{curve, jumps, resonances, response};
