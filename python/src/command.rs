//! The command `vibro`, which the package brings.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs a command line, which begins with the name of the program, and gives the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| vibroimpact::cli::main(words))
}

/// Version of the library.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
