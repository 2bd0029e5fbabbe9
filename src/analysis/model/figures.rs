//! Figures of the model.

mod backbone;
mod branches;
mod drill;
mod energy;
mod ladder;
mod motion;
mod regimes;
mod sweep;

pub use backbone::backbone;
pub use branches::{branches, continued};
pub use drill::{drill_map, drill_speeds, drill_start, drill_turn};
pub use energy::energy;
pub use ladder::ladder;
pub use motion::{orbit, pattern, phase_plane, poincare, reaction, traces};
pub(super) use regimes::counted;
pub use regimes::regimes;
pub use sweep::{forces, sweep};
