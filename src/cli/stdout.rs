//! Standard output: one JSON object, or text that cannot control the terminal.

use crate::error::{Error, Result};
use crate::record::is_unprintable;
use serde_json::Value;
use std::io::{ErrorKind, Write};

/// Prints one JSON object.
///
/// # Errors
/// As [`text`].
pub fn object(object: impl Into<Value>) -> Result<()> {
    text(&format!("{:#}\n", object.into()))
}

/// Prints text.
///
/// # Errors
/// If standard output cannot be written; a closed pipe is no error.
pub fn text(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", "standard output", e)),
        _ => Ok(()),
    }
}

/// Replaces control characters other than line breaks and tabs: a name in a file must not control the
/// terminal.
pub(crate) fn printable(text: &str) -> String {
    let breaks = |c: char| c == '\n' || c == '\t';
    text.chars().map(|c| if is_unprintable(c) && !breaks(c) { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn escapes_of_a_terminal_are_shown_as_what_they_are() {
        assert_eq!(printable("a\x1b[31mb\tµ\n\u{9b}"), "a\u{fffd}[31mb\tµ\n\u{fffd}");
    }
}
