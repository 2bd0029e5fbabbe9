//! Figures of sweeps, and of sweeps against the model.

mod fit;
mod force;
mod overlay;
mod receptance;
mod response;
mod waterfall;

pub use fit::fit;
pub use force::force;
pub use overlay::overlay;
pub use receptance::receptance;
pub use response::response;
pub use waterfall::{map, waterfall};
