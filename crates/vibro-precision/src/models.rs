//! Models of the motion, on scenes with a known truth.

mod borders;
mod check;
mod ours;
mod rivals;
mod scenes;
mod task;
mod truth;

pub use borders::failures;
pub(crate) use scenes::scenes;
