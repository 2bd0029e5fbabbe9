//! Figures of the model.

mod branches;
mod ladder;
mod motion;
mod regimes;
mod sweep;

pub use branches::branches;
pub use ladder::ladder;
pub use motion::{orbit, phase_plane, poincare, traces};
pub(super) use regimes::counted;
pub use regimes::regimes;
pub use sweep::sweep;
