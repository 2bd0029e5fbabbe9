//! The command `vibro`, which the package brings.

use crate::refused::exception;
use crate::watched::watched;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use vibro_io::Limit;
use vibroimpact::Error;

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

/// Writes an example with its recordings into a folder, and returns the folder.
#[pyfunction]
pub fn demo(py: Python<'_>, name: String, folder: Option<PathBuf>) -> PyResult<PathBuf> {
    watched(py, None, move |_| vibroimpact::cli::demo(&name, folder))
}

/// States the memory that a file and its analysis may take, such as `2GB`.
#[pyfunction]
pub fn limit(py: Python<'_>, size: &str) -> PyResult<()> {
    let unknown = || Error::usage(format!("the size {size:?}"), "a size such as 2GB or 500MB");
    Limit::parse(size).map(Limit::state).ok_or_else(|| exception(py, &unknown()))
}
