//! Standard output: one JSON object, or text; progress for a person at a terminal.

use super::complain;
use crate::analysis::{Answer, Progress};
use crate::error::{Error, Result};
use crate::read::{Folder, Owner};
use crate::record::{shown, steers};
use crate::report::Picture;
use crate::report::files::Names;
use crate::report::words::{Voice, graded, put};
use crate::report::{Medium, Output, Table, files};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::Value;
use std::fmt::Write as _;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

/// Writes the figures and files of an answer where there is a folder for them, and prints it: as JSON, or its tables. Gives the exit code.
///
/// # Errors
/// If a file or standard output cannot be written.
pub fn answer(mut answer: Answer, output: Option<Output>, json: bool) -> Result<u8> {
    let mut written = Vec::new();
    if let Some(mut output) = output {
        let medium = output.medium;
        files::figures(&mut output, &answer.figures, |figure| Picture::of(figure, medium))?;
        for (name, bytes) in &answer.files {
            output.write(name, bytes)?;
        }
        written = output.commit()?;
    } else if !json && !answer.files.is_empty() {
        complain::line("all numbers: --json, or files with --out DIR");
    }
    if json {
        answer.result.entry("files").or_insert_with(|| written.into());
        put(&mut answer.result, &answer.findings, Voice::Command);
        object(answer.result)?;
        return Ok(0);
    }
    complain::warn(&graded(&answer.findings, Voice::Command));
    let shown = answer.tables.iter().chain(&answer.details).filter(|t| !t.rows.is_empty());
    let mut all = shown.map(Table::text).collect::<Vec<_>>().join("\n");
    for file in written {
        let _ = writeln!(all, "wrote {file}");
    }
    text(&all)?;
    Ok(0)
}

/// A folder to write into, with figures in the style that was asked for.
///
/// # Errors
/// As [`Output::new`].
pub fn output(folder: Folder, owner: Owner) -> Result<Output> {
    let Written { medium, replace } = WRITTEN.get().copied().unwrap_or_default();
    let mut output = Output::new(folder, owner)?.replace(replace);
    output.medium = medium;
    Ok(output)
}

/// The error, with another place to write to where something stands in the way.
pub fn elsewhere(error: Error, place: &str) -> Error {
    let concerns = |key: &str| error.settings().any(|setting| setting == key);
    match (concerns("out"), concerns("replace")) {
        (true, true) => error.hint(format!("{place}, or --replace to replace it on purpose")),
        (true, false) => error.hint(place),
        _ => error,
    }
}

/// A path like this one that is free.
pub fn free(path: &Path) -> PathBuf {
    let stem = path.file_stem().map_or_else(|| "results".to_owned(), shown);
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", shown(ending)));
    let mut names = (2..).map(|n| path.with_file_name(format!("{stem}_{n}{ending}")));
    names.find(|path| !path.exists()).unwrap_or_default()
}

/// The folder for the results of a command, if one is named: nothing of a person's may stand there under the names of its files.
///
/// # Errors
/// As [`Output::new`] and [`Output::expect`].
pub fn results(folder: &Folder, out: Option<&Path>, names: Names) -> Result<Option<Output>> {
    let Some(out) = out else { return Ok(None) };
    let output = output(folder.at(out), Owner::Results)?;
    let elsewhere = |error| elsewhere(error, &format!("--out {}", typed(&free(out))));
    output.expect(|name| names.has(name)).map_err(elsewhere)?;
    Ok(Some(output))
}

/// How this program writes files.
#[derive(Debug, Clone, Copy, Default)]
pub struct Written {
    /// The style of all figures.
    pub medium: Medium,
    /// Whether files that are not vibro's are replaced, too.
    pub replace: bool,
}

/// What was typed of it.
pub static WRITTEN: OnceLock<Written> = OnceLock::new();

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

/// Text without control characters but line breaks and tabs: a name from a file must not steer a terminal.
pub(crate) fn printable(text: &str) -> String {
    let breaks = |c: char| c == '\n' || c == '\t';
    text.chars().map(|c| if steers(c) && !breaks(c) { '\u{fffd}' } else { c }).collect()
}

/// A path as a shell takes it.
pub fn typed(path: &Path) -> String {
    let text = shown(path);
    if text.contains(char::is_whitespace) { format!("\"{text}\"") } else { text }
}

/// Works with a bar on standard error, where that is a terminal and no JSON was asked for.
///
/// # Errors
/// Those of the work.
pub fn busy<T>(json: bool, what: &'static str, work: impl FnOnce(&ProgressBar) -> Result<T>) -> Result<T> {
    let bar = ProgressBar::no_length();
    if json || !std::io::stderr().is_terminal() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    } else if let Ok(style) =
        ProgressStyle::with_template("{spinner} {msg:24} {wide_bar} {pos}/{len} {elapsed}")
    {
        bar.set_style(style);
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar.set_message(what);
    let done = work(&bar);
    // Before a complaint, too.
    bar.finish_and_clear();
    done
}

impl Progress for ProgressBar {
    fn start(&self, what: &str, steps: usize) {
        self.set_length(steps as u64);
        self.set_position(0);
        self.set_message(what.to_owned());
    }

    fn step(&self) {
        self.inc(1);
    }

    fn at(&self, done: usize, all: usize) {
        self.set_length(all as u64);
        self.set_position(done as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn escapes_of_a_terminal_are_shown_as_what_they_are() {
        assert_eq!(printable("a\x1b[31mb\tµ\n\u{9b}"), "a\u{fffd}[31mb\tµ\n\u{fffd}");
    }
}
