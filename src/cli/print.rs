//! Standard output as one JSON object or as text; a progress bar for a person at a terminal.

use super::{complain, stdout};
use crate::analysis::{Answer, Progress};
use crate::error::{Error, Result};
use crate::read::{Folder, Format, Owner};
use crate::record::{shown, typed};
use crate::report::Picture;
use crate::report::files::Names;
use crate::report::words::{Voice, graded, put};
use crate::report::{Medium, Output, Table, files};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

/// Writes figures and files into the folder for results, if there is one, and prints the answer as JSON or
/// as tables. Gives the exit code.
///
/// # Errors
/// If a file or standard output cannot be written.
pub fn answer(mut answer: Answer, output: Option<Output>, json: bool) -> Result<u8> {
    let code = answer.refused.as_ref().map_or(0, Error::exit_code);
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
        stdout::object(answer.result)?;
        return Ok(code);
    }
    complain::warn(&graded(&answer.findings, Voice::Command), "--json");
    let shown = answer.tables.iter().chain(&answer.details).filter(|t| !t.rows.is_empty());
    let mut all = shown.map(Table::text).collect::<Vec<_>>().join("\n");
    for file in written {
        let _ = writeln!(all, "wrote {file}");
    }
    stdout::text(&all)?;
    Ok(code)
}

/// File name endings, beside those of recordings, that a folder for results must not have: `--out book.xlsx`
/// is a mistake for a file.
const FILE_ENDINGS: &str = "npy zip xlsx xlsm xls ods svg png jpg pdf html json toml md";

/// A folder for results, with the chosen style of figures. `elsewhere` is the hint of the error if an
/// existing file would be replaced.
///
/// # Errors
/// As [`Output::new`]; if a new folder has the name of a file.
pub fn output(folder: Folder, owner: Owner, elsewhere: String) -> Result<Output> {
    let OutputSettings { medium, replace } = WRITTEN.get().copied().unwrap_or_default();
    let root = folder.root();
    let ending = root.extension().map_or_else(String::new, |ending| ending.to_string_lossy().to_lowercase());
    let mut endings = Format::endings().chain(FILE_ENDINGS.split(' '));
    // `2.58` is a number and no file of UFF.
    let is_number = ending.bytes().all(|b| b.is_ascii_digit());
    if !is_number && endings.any(|known| known == ending) && !folder.exists(root) {
        let plain = root.with_extension("");
        let plain = if folder.exists(&plain) && !folder.is_folder(&plain) { unused(&plain) } else { plain };
        let found = format!("a folder named like a file: {}", shown(root));
        return Err(Error::usage(found, "a folder for results").hint(format!("--out {}", typed(&plain))));
    }
    let mut output = Output::new(folder, owner)?.replace(replace);
    (output.medium, output.elsewhere) = (medium, elsewhere);
    Ok(output)
}

/// A similar path that does not exist yet: `results_2`.
pub fn unused(path: &Path) -> PathBuf {
    let stem = path.file_stem().map_or_else(|| "results".to_owned(), shown);
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", shown(ending)));
    let mut names = (2..).map(|n| path.with_file_name(format!("{stem}_{n}{ending}")));
    names.find(|path| !path.exists()).unwrap_or_default()
}

/// The folder for the results of a command, if one is named. Checks that no file of a person has one of the
/// names that the command writes.
///
/// # Errors
/// As [`Output::new`] and [`Output::expect`].
pub fn results(folder: &Folder, out: Option<&Path>, names: Names) -> Result<Option<Output>> {
    let Some(out) = out else { return Ok(None) };
    let output = output(folder.at(out), Owner::Results, format!("--out {}", typed(unused(out))))?;
    output.expect(|name| names.has(name))?;
    Ok(Some(output))
}

/// A single file that a command writes.
pub struct File {
    output: Output,
    name: String,
}

impl File {
    /// Checks, before anything is computed, that the file can be written.
    ///
    /// # Errors
    /// If its folder does not exist, its name cannot be one, or it must not be replaced.
    pub fn of(folder: &Folder, path: &Path, owner: Owner) -> Result<File> {
        let name = path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
        let name = name.ok_or_else(|| Error::usage(format!("{} is no file name", shown(path)), "a file"))?;
        let parent = folder_of(path);
        if !parent.is_dir() {
            let found = format!("the folder {} does not exist", shown(parent));
            return Err(Error::usage(found, "an existing folder").hint("make that folder first"));
        }
        let file = File { output: output(folder.at(parent), owner, typed(unused(path)))?, name };
        file.expect().map(|()| file)
    }

    /// Checks again, once all files that are read are known: none of them may be replaced.
    ///
    /// # Errors
    /// If it must not be replaced.
    pub fn expect(&self) -> Result<()> {
        self.output.path(&self.name)?;
        self.output.expect(|known| known == self.name)
    }

    /// Writes the file as a whole and returns its path.
    ///
    /// # Errors
    /// As [`Output::write`] and [`Output::commit`].
    pub fn write(mut self, bytes: impl AsRef<[u8]>) -> Result<String> {
        self.output.write(&self.name, bytes)?;
        let path = self.output.path(&self.name)?;
        self.output.commit()?;
        Ok(path.display().to_string())
    }
}

/// The folder of a file; `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Options for all files that the program writes.
#[derive(Debug, Clone, Copy, Default)]
pub struct OutputSettings {
    /// Style of all figures.
    pub medium: Medium,
    /// Whether files that vibro did not write are replaced.
    pub replace: bool,
}

/// The options for written files, set once from the command line.
pub static WRITTEN: OnceLock<OutputSettings> = OnceLock::new();

/// Runs the work with a progress bar on standard error; without one if that is no terminal or `json` is set.
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
    // Clear the bar before an error is printed, too.
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

    fn aside(&self, print: &mut dyn FnMut()) {
        self.suspend(print);
    }
}
