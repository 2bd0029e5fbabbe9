//! The figures of this toolkit: results in, [`super::Figure`] out.

mod frf;
mod overlay;
mod pulse;
mod response;
mod waterfall;

pub use frf::{frf, nyquist};
pub use overlay::overlay;
pub use pulse::pulse;
pub use response::response;
pub use waterfall::{map, waterfall};
