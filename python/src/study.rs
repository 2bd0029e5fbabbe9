//! Parts of a study, computed in several processes.

use crate::answer::python;
use crate::refused::exception;
use crate::watched::watched;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use vibroimpact::cli::{self, Shared};

/// The study that the words of a command line ask for, as text for [`part`].
#[pyfunction]
pub fn study(py: Python<'_>, words: Vec<String>) -> PyResult<String> {
    let study = cli::study(&words).map_err(|error| exception(py, &error))?;
    serde_json::to_string(&study).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// A part of a study, such as `3/16`, as bytes for [`merged`].
#[pyfunction]
pub fn part<'py>(
    py: Python<'py>,
    study: &str,
    shard: String,
    show: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let study: Shared =
        serde_json::from_str(study).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let bytes = watched(py, show, move |progress| study.part(&shard, progress))?;
    Ok(PyBytes::new(py, &bytes))
}

/// The answer of all parts of a study.
#[pyfunction]
pub fn merged(py: Python<'_>, parts: Vec<Vec<u8>>) -> PyResult<Bound<'_, PyAny>> {
    let answer = watched(py, None, move |_| Shared::merged(parts))?;
    python(py, answer)
}
