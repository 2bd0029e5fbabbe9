//! Standard output: one JSON object, or text.

use super::complain;
use crate::analysis::Answer;
use crate::error::{Error, Result};
use crate::report::words::{Voice, add_warnings, put, told};
use crate::report::{Output, Table, files};
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Writes the figures and files of an answer where a folder is named, and prints it: as JSON, or its tables and a note.
///
/// # Errors
/// If a file or standard output cannot be written.
pub fn answer(
    mut answer: Answer,
    out: Option<&Path>,
    beside: &[String],
    note: &str,
    json: bool,
) -> Result<()> {
    let mut written = Vec::new();
    if let Some(folder) = out {
        let mut output = Output::set(folder)?;
        files::figures(&mut output, &answer.figures, &|| ())?;
        for (name, bytes) in &answer.files {
            output.write(name, bytes)?;
        }
        output.commit()?;
        written = output.written().to_vec();
    }
    written.extend(beside.iter().cloned());
    if json {
        put(&mut answer.result, &answer.findings, Voice::Command);
        answer.result.insert("files".to_owned(), written.into());
        return object(&Value::Object(answer.result));
    }
    complain::warn(&told(&answer.findings, Voice::Command, true));
    let shown = answer.tables.iter().chain(&answer.details).filter(|t| !t.rows.is_empty());
    let mut all = shown.map(Table::text).collect::<Vec<_>>().join("\n");
    if !note.is_empty() {
        let _ = writeln!(all, "\n{note}");
    }
    for file in written {
        let _ = writeln!(all, "wrote {file}");
    }
    text(&all)
}

/// Prints one JSON object. NaN becomes null.
///
/// # Errors
/// If standard output cannot be written; a closed pipe is no error.
pub fn json(value: &impl Serialize) -> Result<()> {
    let unwritten = |e| Error::refused(format!("the result cannot be written as JSON: {e}"));
    let mut value = serde_json::to_value(value).map_err(unwritten)?;
    add_warnings(&mut value, Voice::Command);
    object(&value)
}

/// Prints one JSON object whose findings have their words already.
///
/// # Errors
/// As [`json`].
pub fn object(value: &Value) -> Result<()> {
    let unwritten = |e| Error::refused(format!("the result cannot be written as JSON: {e}"));
    text(&(serde_json::to_string_pretty(value).map_err(unwritten)? + "\n"))
}

/// Prints text.
///
/// # Errors
/// As [`json`].
pub fn text(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", "standard output", e)),
        _ => Ok(()),
    }
}

/// Text without control characters but line breaks and tabs: a name from a file must not steer a terminal.
pub(crate) fn printable(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().map(|c| if steers(c) { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn escapes_of_a_terminal_are_shown_as_what_they_are() {
        assert_eq!(printable("a\x1b[31mb\tµ\n\u{9b}"), "a\u{fffd}[31mb\tµ\n\u{fffd}");
    }
}
