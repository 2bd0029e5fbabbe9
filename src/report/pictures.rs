//! The figures of this toolkit: results in, [`super::Figure`] out.

mod frf;
mod impacts;
mod overlay;
mod response;
mod waterfall;

pub use frf::frf;
pub use impacts::{drop, impacts};
pub use overlay::overlay;
pub use response::response;
pub use waterfall::{map, waterfall};
