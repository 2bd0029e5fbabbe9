//! The figures of this toolkit: results in, [`super::Figure`] out.

mod drill;
mod frf;
mod impacts;
mod overlay;
mod response;
mod spectrum;
mod waterfall;

pub use drill::drill;
pub use frf::frf;
pub use impacts::{drop, impacts};
pub use overlay::overlay;
pub use response::response;
pub use spectrum::{spectrum, transfer};
pub use waterfall::{map, waterfall};
