//! Errors of the library as exceptions of the package.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use vibroimpact::Error;
use vibroimpact::error::Hint;
use vibroimpact::report::words::Voice;

/// The exception for an error: `Refused` where the data allow no answer, else `BadInput`.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    static REFUSED: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static INPUT: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let (cell, name) = if error.exit_code() == 1 { (&REFUSED, "Refused") } else { (&INPUT, "BadInput") };
    let text = error.text_with(keyword, Hint::to_string);
    let made = cell
        .import(py, "vibroimpact._errors", name)
        .and_then(|class| class.call1((text, error.code(), error.advice())));
    made.map_or_else(|failed| failed, PyErr::from_value)
}

/// A setting as a keyword argument: `low_pass=30000`.
fn keyword(key: &str, value: &str) -> String {
    match Voice::Campaign.set(key, value) {
        option if option.starts_with("--") => option,
        named if value.is_empty() => named.replace('`', "") + "=",
        set => set.replace('`', "").replacen(" = ", "=", 1),
    }
}
