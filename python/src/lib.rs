//! The module `vibroimpact._native` of the Python package: records, answers, figures and refusals between
//! Rust and Python. The functions for users are Python's, in `vibroimpact/`.

// PyO3 hands arguments over.
#![allow(clippy::needless_pass_by_value)]

mod answer;
mod command;
mod drawing;
mod head;
mod refused;
mod study;
mod value;
mod watched;

/// The module.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::answer::{ask, questions, run};
    #[pymodule_export]
    use crate::command::{demo, limit, main, version};
    #[pymodule_export]
    use crate::drawing::Drawing;
    #[pymodule_export]
    use crate::head::{Head, read, write};
    #[pymodule_export]
    use crate::study::{merged, part, study};
}
