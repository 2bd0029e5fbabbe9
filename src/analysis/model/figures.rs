//! Figures of the model.

mod backbone;
mod branches;
mod energy;
mod ladder;
mod motion;
mod regimes;
mod sweep;

pub use backbone::backbone;
pub use branches::{branches, continued};
pub use energy::energy;
pub use ladder::ladder;
pub use motion::{orbit, pattern, phase_plane, poincare, reaction, traces};
pub(super) use regimes::counted;
pub use regimes::regimes;
pub use sweep::{forces, sweep};
