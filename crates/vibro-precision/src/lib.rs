//! Speed against accuracy, and where methods break.
//!
//! A [`Scene`] has a known truth; every method answers it with each of its settings, and error and time are measured
//! together. A [`FailureMap`] tells what the methods do at the borders of what they can: right, refused with a reason, wrong
//! without a word, stalled, crashed. Two families: models of the motion, and estimators of what is measured of it.

pub mod added;
pub mod busy;
pub mod earlier;
pub mod estimators;
pub mod failure;
pub mod measured;
pub mod models;
pub mod scene;
pub mod watched;

pub use earlier::Earlier;
pub use failure::{Cell, FailureMap, Outcome};
pub use scene::{Family, Measured, Scene};
