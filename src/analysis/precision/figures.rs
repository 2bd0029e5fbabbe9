//! Figures of scenes and of borders.

mod failures;
mod precision;

pub use failures::failures;
pub use precision::precision;
