//! Speed against accuracy, and where methods break.
//!
//! A [`BenchmarkScene`] has a known truth; every method answers it with each of its settings, and error and
//! time are measured together. A [`FailureMap`] tells what the methods do at the borders of what they can:
//! right, refused with a reason, wrong without a word, stalled, crashed. Two families: models of the motion,
//! and estimators of what is measured of it.
//!
//! ```no_run
//! use vibro_precision::{Family, Results};
//! let mut results = Results::default();
//! results.measure(Family::Estimators, true, false, &mut |scene| eprintln!("{scene}"))?;
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
pub use results::Results;
pub use scene::{BenchmarkScene, Family, MeasuredMethod};

// What several modules speak of.
use failure::{BorderQuestion, Found};
use scene::timed;
