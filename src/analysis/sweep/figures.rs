//! Figures of sweeps, and of sweeps against the model.

mod fit;
mod overlay;
mod response;
mod waterfall;

pub use fit::fit;
pub use overlay::overlay;
pub use response::response;
pub use waterfall::{map, waterfall};
