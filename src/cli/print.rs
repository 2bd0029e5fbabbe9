//! Standard output: one JSON object, or text.

use crate::error::{Error, Result};
use crate::report::words::{Voice, add_warnings};
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints one JSON object. NaN becomes null.
///
/// # Errors
/// If standard output cannot be written; a closed pipe is no error.
pub fn json(value: &impl Serialize) -> Result<()> {
    let unwritten = |e| Error::refused(format!("the result cannot be written as JSON: {e}"));
    let mut value = serde_json::to_value(value).map_err(unwritten)?;
    add_warnings(&mut value, Voice::Command);
    text(&(serde_json::to_string_pretty(&value).map_err(unwritten)? + "\n"))
}

/// Prints text.
///
/// # Errors
/// As [`json`].
pub fn text(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", "standard output", e)),
        _ => Ok(()),
    }
}
