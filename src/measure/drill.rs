//! Hammer-drill records.
mod beam;
mod crossing;
mod edges;
mod faults;
mod survey;
pub use beam::{Beam, From};
pub use edges::{Edge, Edges, Found};
pub use faults::{FaultCount, Faults, State};
pub use survey::Survey;
