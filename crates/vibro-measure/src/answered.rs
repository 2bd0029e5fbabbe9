//! Keeps the steps of a sweep that can be evaluated: a bad record is left out, the others stay.

use std::path::PathBuf;
use vibro_record::{Error, Finding, Result};

/// The results of the steps that can be evaluated, in order, and a finding for each other step.
///
/// # Errors
/// The error of the first step, with its name, where no step can be evaluated.
pub(crate) fn answered<T>(
    steps: impl IntoIterator<Item = (PathBuf, Result<T>)>,
) -> Result<(Vec<T>, Vec<Finding>)> {
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    let mut first: Option<Error> = None;
    for (k, (path, step)) in steps.into_iter().enumerate() {
        let error = match step {
            Ok(step) => {
                kept.push(step);
                continue;
            }
            Err(error) => error,
        };
        let file = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let (why, hint) = (error.reason(), error.advice());
        let found =
            Finding::caution("step-left-out").count("step", k + 1).name("why", why.trim_end_matches('.'));
        let found = if hint.is_empty() { found } else { found.name("hint", hint) };
        left_out.push(found.about(file.as_str()));
        first.get_or_insert_with(|| error.of_record(&file));
    }
    match first {
        Some(error) if kept.is_empty() => Err(error),
        _ => Ok((kept, left_out)),
    }
}
