//! Benchmarks: speed against accuracy of methods, and where they fail.
//!
//! A [`BenchmarkScene`] has a known truth. Every method answers it with each of its settings; error and time
//! are measured together. A [`FailureMap`] shows how methods behave at the borders of what they can do:
//! right, refused with a reason, wrong without a warning, stalled, crashed. There are two families: models of
//! the motion, and estimators of measured quantities.
//!
//! ```no_run
//! use vibro_precision::{Family, Results};
//! let mut results = Results::default();
//! for measure in Results::scenes_of(Family::Estimators, true) {
//!     results.push(measure()?);
//! }
//! for scene in &results.scenes {
//!     let front = scene.methods.iter().filter(|m| m.front);
//!     println!("{}: {:?}", scene.name, front.map(|m| &m.method).collect::<Vec<_>>());
//! }
//! # Ok::<(), vibro_record::Error>(())
//! ```

pub mod estimators;
mod failure;
pub mod models;
mod results;
mod scene;

pub use failure::{BorderCell, FailureMap, Outcome};
pub use results::{Measurement, Results};
pub use scene::{BenchmarkScene, Family, MeasuredMethod};

// Used by several modules.
use failure::{BorderQuestion, OutcomeWithReason};
use scene::timed;
