//! Analyses: one a kind of record.

mod drill_file;

pub use drill_file::DrillFile;
