//! Results on their way out: a folder in which each file appears whole.

mod output;

pub use output::Output;
