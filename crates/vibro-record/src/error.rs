//! Errors that say where, what was found, what was expected and what to try.
//!
//! Every fallible function of this crate returns [`Error`]. Its kind sets the exit code of the command: 1
//! where the data or the parameters do not allow an answer, 2 for wrong usage and for input that cannot be
//! read.

use crate::{nearest, pattern, shown, typed};
use std::ffi::OsStr;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// What went wrong and what to try, boxed so that results stay small.
#[derive(Debug)]
pub struct Error(Box<Inner>);

#[derive(Debug)]
struct Inner {
    kind: Failure,
    /// Place in the input.
    place: Place,
    /// What was found there, what the system refused, or why there is no answer.
    found: String,
    /// What was expected there; empty where `found` says it all.
    expected: String,
    /// The line at fault with a caret under it, ready to print.
    excerpt: String,
    /// What to try; empty where nothing would help.
    hint: Hint,
    /// Keys of the settings that help, each with a value to try where one is known.
    settings: Vec<(&'static str, String)>,
    /// Code of a refusal, by which programs tell it from others.
    code: Option<&'static str>,
    /// File or record that was refused; a refusal has no place in the input.
    record: Option<PathBuf>,
}

/// What to try.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hint {
    /// In words; empty where nothing would help.
    Words(String),
    /// A command on the file that was read.
    OfFile(&'static str),
    /// A name that exists, in place of one that does not.
    Name {
        /// The name that was given.
        wrong: PathBuf,
        /// The existing name that was probably meant.
        meant: PathBuf,
    },
}

impl<T: Into<String>> From<T> for Hint {
    fn from(words: T) -> Hint {
        Hint::Words(words.into())
    }
}

impl fmt::Display for Hint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Hint::Words(words) => f.write_str(words),
            Hint::OfFile(command) => write!(f, "{command} FILE"),
            Hint::Name { meant, .. } => f.write_str(&shown(meant)),
        }
    }
}

/// The three ways in which a request fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Failure {
    /// The operating system refused to open, read or write.
    Io,
    /// Input that cannot be read as what it should be, or wrong usage.
    Input,
    /// Readable input that does not support an answer.
    Refused,
}

/// A place in an input: as much of it as is known.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Place {
    /// File.
    pub path: Option<PathBuf>,
    /// Line, counted from 1.
    pub line: Option<u64>,
    /// Column, counted from 1.
    pub column: Option<u64>,
    /// Byte offset, counted from 0, for binary formats.
    pub byte: Option<u64>,
    /// Cell of a workbook, `B2`, in place of line and column.
    pub cell: Option<String>,
}

impl Place {
    /// A whole file.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Place { path: Some(path.into()), ..Place::default() }
    }

    /// A line of a file, counted from 1.
    pub fn line(path: impl Into<PathBuf>, line: u64) -> Self {
        Place { line: Some(line), ..Place::file(path) }
    }

    /// A byte of a file, counted from 0.
    pub fn byte(path: impl Into<PathBuf>, byte: u64) -> Self {
        Place { byte: Some(byte), ..Place::file(path) }
    }

    /// The same place with a column, counted from 1.
    pub fn column(mut self, column: u64) -> Self {
        self.column = Some(column);
        self
    }
}

impl Error {
    fn new(kind: Failure, place: Place, found: String, expected: String) -> Self {
        let (excerpt, hint, settings) = (String::new(), String::new().into(), Vec::new());
        let (code, record) = (None, None);
        Error(Box::new(Inner { kind, place, found, expected, excerpt, hint, settings, code, record }))
    }

    /// Input at `place` is not what it should be.
    pub fn input(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Error::new(Failure::Input, place, found.into(), expected.into())
    }

    /// Wrong usage: no file is at fault.
    pub fn usage(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Error::input(Place::default(), found, expected)
    }

    /// The data or the parameters do not allow an answer.
    pub fn refused(why: impl Into<String>) -> Self {
        Error::new(Failure::Refused, Place::default(), why.into(), String::new())
    }

    /// Gives a refusal a code, by which programs tell it from others.
    pub fn coded(mut self, code: &'static str) -> Self {
        self.0.code = Some(code);
        self
    }

    /// The code of a refusal that has one.
    pub fn code(&self) -> Option<&'static str> {
        self.0.code
    }

    /// The operating system refused `action` on `path`.
    // By value, since `map_err` passes an owned error.
    #[allow(clippy::needless_pass_by_value)]
    pub fn io(action: &str, path: impl AsRef<Path>, source: std::io::Error) -> Self {
        let path = path.as_ref();
        let absent = source.kind() == ErrorKind::NotFound && action != "write";
        let found = format!("cannot {action} {}: {}", shown(path), refusal(&source));
        let error = Error::new(Failure::Io, Place::default(), found, String::new());
        if absent { error.hint(instead(Path::new(""), path)) } else { error }
    }

    /// A name that is not in a folder; the hint is the name there that was probably meant.
    pub fn absent(found: impl Into<String>, folder: &Path, name: &Path) -> Self {
        Error::usage(found, "").hint(instead(folder, name))
    }

    /// A name that is not among `all` of a folder that is on no disk; the hint is the one that was probably
    /// meant.
    pub fn absent_among(found: impl Into<String>, all: &[String], name: &Path) -> Self {
        let near = nearest(&name.to_string_lossy(), all.iter().map(String::as_str));
        let meant = near.map(|near| Hint::Name { wrong: name.to_owned(), meant: PathBuf::from(near) });
        Error::usage(found, "").hint(meant.unwrap_or_else(|| "a name of the list of recordings".into()))
    }

    /// Names the setting that helps by its key in a campaign: `low_pass`. The command line shows it as its
    /// option.
    pub fn setting(self, key: &'static str) -> Self {
        self.set(key, "")
    }

    /// Names the missing setting, as [`Error::setting`], with a value to try as a campaign would state it.
    pub fn set(mut self, key: &'static str, value: impl Into<String>) -> Self {
        self.0.settings.retain(|known| known.0 != key);
        self.0.settings.push((key, value.into()));
        self
    }

    /// Keys of the settings that the error names.
    pub fn settings(&self) -> impl DoubleEndedIterator<Item = &'static str> {
        self.0.settings.iter().map(|known| known.0)
    }

    /// The settings that the error names, each written by `typed` from its key and its value.
    pub fn settings_with(&self, typed: impl Fn(&str, &str) -> String) -> Vec<String> {
        self.0.settings.iter().map(|(key, value)| typed(key, value)).collect()
    }

    /// The text of the error. `typed` writes a setting from its key and its value, such as `low_pass` as
    /// `--low-pass`; `spelt` writes the hint.
    pub fn text_with(&self, typed: impl Fn(&str, &str) -> String, spelt: impl Fn(&Hint) -> String) -> String {
        let Inner { place, excerpt, hint, settings, .. } = &*self.0;
        let what = self.what(place);
        let values = settings.iter().any(|(_, value)| !value.is_empty());
        let all = self.settings_with(typed);
        let hint_text = spelt(hint);
        let advice = match (hint, settings.first()) {
            // The wrong name is in a file: the advice is what to write there, not what to type.
            (Hint::Name { .. }, Some((key, _))) if place.line.is_some() => {
                format!("\n  try: write {key} = {:?}", hint.to_string())
            }
            _ if hint_text.is_empty() && values => format!("\n  try: {}", all.join(" ")),
            _ => part("\n  try: ", &hint_text, "") + &part(" (", &all.join(", "), ")"),
        };
        what + &part("\n", excerpt, "") + &advice
    }

    /// What was found and what was expected, after `place`.
    fn what(&self, place: &Place) -> String {
        part("", &place.to_string(), ": ") + &self.0.found + &part("; expected ", &self.0.expected, "")
    }

    /// The error in one line, without the name of its file and without advice.
    pub fn reason(&self) -> String {
        self.what(&Place { path: None, ..self.0.place.clone() })
    }

    /// Sets what to try; an earlier hint is replaced, and its settings are dropped.
    pub fn hint(mut self, hint: impl Into<Hint>) -> Self {
        let first = self.advice().is_empty();
        self.0.settings.retain(|_| first);
        self.0.hint = hint.into();
        self
    }

    /// Line in the file at which the error was found.
    pub fn line(&self) -> Option<u64> {
        self.0.place.line
    }

    /// What to try; empty where nothing would help.
    pub fn advice(&self) -> String {
        self.0.hint.to_string()
    }

    /// The parts of an input error, to be completed; `None` for other errors.
    fn fault(&mut self) -> Option<&mut Inner> {
        Some(&mut *self.0).filter(|inner| inner.kind == Failure::Input)
    }

    /// Adds a text in brackets to the description of what was found.
    pub fn aside(mut self, text: impl fmt::Display) -> Self {
        if let Some(fault) = self.fault() {
            fault.found = format!("{} ({text})", fault.found);
        }
        self
    }

    /// Shows the offending line of `source` (the whole text) with a caret under the bytes `span`.
    ///
    /// Sets line and column of the place from the span. Tabs count as one column.
    pub fn excerpt(mut self, source: &str, span: std::ops::Range<usize>) -> Self {
        if let Some(fault) = self.fault() {
            let start = floor_char(source, span.start);
            let line_start = source[..start].rfind('\n').map_or(0, |i| i + 1);
            let line_end = source[start..].find('\n').map_or(source.len(), |i| start + i);
            let number = source[..start].matches('\n').count() as u64 + 1;
            let text = source[line_start..line_end].trim_end_matches('\r').replace('\t', " ");
            let before = source[line_start..start].chars().count();
            let end = floor_char(source, span.end.clamp(start, line_end));
            let width = source[start..end].trim_end().chars().count().max(1);
            fault.place.line = Some(number);
            fault.place.column = Some(before as u64 + 1);
            let gutter = " ".repeat(number.to_string().len());
            let caret = " ".repeat(before) + &"^".repeat(width);
            fault.excerpt = format!("{gutter} |\n{number} | {text}\n{gutter} | {caret}");
        }
        self
    }

    /// Names the file where none is named yet.
    pub fn in_file(mut self, path: impl AsRef<Path>) -> Self {
        if let Some(fault) = self.fault() {
            fault.place.path.get_or_insert_with(|| path.as_ref().to_owned());
        }
        self
    }

    /// Names the cell of a workbook in place of line and column; `cell` makes the name of the cell from
    /// them.
    pub fn in_cell(mut self, cell: impl FnOnce(u64, u64) -> Option<String>) -> Self {
        if let Some(Place { line: Some(line), column: Some(column), cell: named, .. }) =
            self.fault().map(|fault| &mut fault.place)
        {
            *named = cell(*line, *column);
        }
        self
    }

    /// Sets the file to `path`; the file that was at fault before is added in brackets.
    pub fn named_in(mut self, path: &Path) -> Self {
        if let Some(other) =
            self.fault().and_then(|fault| fault.place.path.take()).filter(|other| other != path)
        {
            self = self.aside(other.display());
        }
        self.in_file(path)
    }

    /// Sets the place where none is known yet.
    pub fn at(mut self, place: &Place) -> Self {
        if let Some(fault) = self.fault()
            && fault.place == Place::default()
        {
            fault.place = place.clone();
        }
        self
    }

    /// Names the record for which an answer was refused.
    pub fn of_record(mut self, name: &str) -> Self {
        if self.0.kind == Failure::Refused {
            self.0.found = format!("{name}: {}", self.0.found);
            self.0.record = Some(name.into());
        }
        self
    }

    /// The file or the record that the error names, if any.
    pub fn subject(&self) -> Option<&Path> {
        self.0.place.path.as_deref().or(self.0.record.as_deref())
    }

    /// Whether it is wrong usage that names no place in a file, no hint and no setting.
    pub fn is_bare_usage(&self) -> bool {
        let Inner { kind, place, settings, .. } = &*self.0;
        let is_bare = self.advice().is_empty() && settings.is_empty();
        *kind == Failure::Input && *place == Place::default() && is_bare
    }

    /// Why the data or the parameters do not allow an answer; `None` for another error.
    pub fn refusal(&self) -> Option<&str> {
        (self.0.kind == Failure::Refused).then_some(self.0.found.as_str())
    }

    /// Where and what is wrong, on one line, without what to try.
    pub fn why(&self) -> String {
        self.what(&self.0.place).replace('\n', " ")
    }

    /// Exit code of the command: 1 no answer possible, 2 unreadable input or wrong usage.
    pub fn exit_code(&self) -> u8 {
        if self.0.kind == Failure::Refused { 1 } else { 2 }
    }
}

/// `text` between `before` and `after`; empty if `text` is empty.
fn part(before: &str, text: &str, after: &str) -> String {
    if text.is_empty() { String::new() } else { [before, text, after].concat() }
}

/// The reason for an error of the operating system, in words.
fn refusal(source: &std::io::Error) -> String {
    let known = match source.kind() {
        ErrorKind::NotFound => "no such file or directory",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::AlreadyExists => "it exists already",
        ErrorKind::NotADirectory => "a file stands where a folder is named",
        ErrorKind::IsADirectory => "this is a folder",
        ErrorKind::ReadOnlyFilesystem => "nothing can be written to this disk",
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::InvalidFilename => "no name of a file",
        _ => return source.to_string(),
    };
    known.to_owned()
}

/// Hint for a name that is not in a folder: the nearest name there, else one with the same beginning, else
/// the command that lists the folder.
fn instead(folder: &Path, name: &Path) -> Hint {
    let path = folder.join(name);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| {
        let name = entry.ok()?.file_name().into_string().ok()?;
        Some(name).filter(|name| !name.starts_with('.') && path.file_name() != Some(name.as_ref()))
    });
    let text =
        |name: Option<&OsStr>| name.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let wrong = text(path.file_name());
    // A pattern is compared with the patterns of the names.
    let beside = beside.map(|name| if wrong.contains('*') { pattern(&name) } else { name });
    let mut beside: Vec<String> = beside.collect();
    beside.sort();
    let stem = text(path.file_stem()).to_lowercase();
    let begins = |name: &&String| stem.len() >= SHORTEST && name.to_lowercase().starts_with(&stem);
    let ending = |name: &&String| Path::new(name).extension() != path.extension();
    let near = nearest(&wrong, beside.iter().map(String::as_str));
    let near = near.or_else(|| beside.iter().filter(begins).min_by_key(ending).map(String::as_str));
    match near {
        Some(near) => Hint::Name { wrong: name.to_owned(), meant: name.with_file_name(near) },
        None if folder == Path::new(".") => "ls".into(),
        None if folder.is_dir() => format!("ls {}", typed(folder)).into(),
        None => format!("another folder: there is no {}", folder.display()).into(),
    }
}

/// Least length in bytes of a wrong name (without its ending) from which on a name with the same beginning is
/// suggested. Shorter ones fit too many names.
const SHORTEST: usize = 3;

/// The last character boundary in `text` up to the byte `at`.
fn floor_char(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.iter().map(shown);
        let counts = match &self.cell {
            Some(cell) => [("cell", Some(cell.clone())), ("", None), ("", None)],
            None => [("line", self.line), ("column", self.column), ("byte", self.byte)]
                .map(|(what, n)| (what, n.map(|n| n.to_string()))),
        };
        let counts = counts.into_iter().filter_map(|(what, n)| Some(format!("{what} {}", n?)));
        f.write_str(&path.chain(counts).collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let typed = |key: &str, value: &str| {
            if value.is_empty() { key.to_owned() } else { format!("{key} = {value}") }
        };
        f.write_str(&self.text_with(typed, Hint::to_string))
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caret_stands_under_the_span_even_after_non_ascii_text() {
        let source = "a = 1\nµ² = 2\n";
        let start = source.find("= 2").unwrap();
        let error = Error::input(Place::file("x.toml"), "unknown key", "").excerpt(source, start..start + 1);
        assert_eq!(error.to_string(), "x.toml, line 2, column 4: unknown key\n  |\n2 | µ² = 2\n  |    ^");
    }

    #[test]
    fn a_span_outside_the_text_does_not_panic() {
        let error = Error::usage("x", "").excerpt("µ", 1..99);
        assert!(error.to_string().contains('^'));
    }

    #[test]
    fn a_setting_is_shown_as_it_is_typed() {
        let error = Error::refused("no rate").hint("state the sampling rate").setting("base_band");
        assert_eq!(error.to_string(), "no rate\n  try: state the sampling rate (base_band)");
        let option = |key: &str, _: &str| format!("--{}", key.replace('_', "-"));
        assert_eq!(
            error.text_with(option, Hint::to_string),
            "no rate\n  try: state the sampling rate (--base-band)"
        );
    }

    #[test]
    fn a_setting_stands_once_and_a_new_hint_drops_those_of_the_old_one() {
        let error = Error::usage("x", "").hint("lower it").setting("low_pass").setting("low_pass");
        assert_eq!(error.to_string(), "x\n  try: lower it (low_pass)");
        assert_eq!(error.hint("name the file").to_string(), "x\n  try: name the file");
    }

    #[test]
    fn a_reason_is_one_line_without_the_file() {
        let place = Place::line("a/b.csv", 7);
        let error = Error::input(place, "\"x\"", "a number").excerpt("x\n", 0..1).hint("write one");
        assert_eq!(error.reason(), "line 1, column 1: \"x\"; expected a number");
        assert_eq!(Error::refused("no").hint("yes").reason(), "no");
    }

    #[test]
    fn exit_codes_follow_the_kind() {
        assert_eq!(Error::refused("no").exit_code(), 1);
        assert_eq!(Error::usage("no", "yes").exit_code(), 2);
    }
}
