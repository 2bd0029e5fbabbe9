//! The recordings of a folder, and patterns of their names.

use super::own_files::{REPORT, RESULTS};
use crate::error::{Error, Result};
use crate::read::{Folder, Manifest, Walk, plain};
use crate::record::shown;
use glob::{MatchOptions, Pattern};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Levels of subfolders that are searched.
const LEVELS: usize = 2;

/// Endings of files that are no recordings.
const NO_RECORDINGS: &str =
    "toml json md html pdf png jpg jpeg svg gif doc docx ppt pptx py m rs exe bak log ini tdms_index";

/// Contents of a folder and of two levels below it.
#[derive(Debug, Default)]
pub struct Recordings {
    /// Files that may be recordings, sorted by the numbers in their names.
    pub files: Vec<PathBuf>,
    /// Files that are no recordings, by their endings.
    pub others: Vec<PathBuf>,
    /// Paths that could not be read, with the reason.
    pub skipped: Vec<(PathBuf, String)>,
}

/// The recordings of a folder. Hidden files and results are skipped.
///
/// # Errors
/// If the folder cannot be listed.
pub fn recordings(folder: &Folder) -> Result<Recordings> {
    let Walk { mut files, skipped } = folder.walk(folder.root(), LEVELS)?;
    let top = plain(folder.root());
    // Versions without a manifest wrote results into a folder of their own: all files in it are results.
    let has = |path: &Path, name: &str| folder.is_file(&path.join(name));
    let is_results =
        |path: &Path| path != top && has(path, RESULTS) && has(path, REPORT) && !has(path, Manifest::FILE);
    let mut results: BTreeMap<PathBuf, bool> = BTreeMap::new();
    files.retain(|path| {
        let parent = path.parent().unwrap_or(Path::new("")).to_owned();
        !*results.entry(parent).or_insert_with_key(|parent| is_results(parent))
    });
    let ending =
        |path: &Path| path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase());
    let is_no_recording = |path: &PathBuf| NO_RECORDINGS.split(' ').any(|known| known == ending(path));
    let (others, mut files): (Vec<_>, Vec<_>) = files.into_iter().partition(is_no_recording);
    in_order(&mut files);
    Ok(Recordings { files, others, skipped })
}

/// Sorts files by the numbers in their names: 2 before 10, and 11.15 before 11.2.
pub fn in_order(files: &mut [PathBuf]) {
    files.sort_by(|a, b| natord::compare(&with_decimals(a), &with_decimals(b)));
}

/// A path with decimals padded to one length, so that its numbers sort like whole numbers. The ending is no
/// decimal, nor are parts of a date or a version.
fn with_decimals(path: &Path) -> String {
    let text = path.to_string_lossy();
    let dot = text.rfind('.').filter(|dot| !text[*dot..].contains(['/', '\\'])).unwrap_or(text.len());
    let (mut rest, ending) = text.split_at(dot);
    let mut out = String::new();
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    while let Some(begins) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, number) = rest.split_at(begins);
        let (whole, behind) = number.split_at(digits(number));
        let decimals = behind.strip_prefix('.').map_or("", |behind| &behind[..digits(behind)]);
        let further = behind.get(1 + decimals.len()..).is_some_and(|rest| rest.starts_with('.'));
        let decimals = if before == "." || further { "" } else { decimals };
        out.extend([before, whole, ".", &format!("{decimals:0<DECIMALS$}")]);
        rest = if decimals.is_empty() { behind } else { &behind[1 + decimals.len()..] };
    }
    [&out, rest, ending].concat()
}

/// Largest number of decimals in a name.
const DECIMALS: usize = 12;

/// Whether a name is a pattern of files in a folder, and not the name of a file there.
pub fn is_pattern(folder: &Folder, name: &Path) -> bool {
    name.to_string_lossy().contains(['*', '?']) && !folder.exists(&folder.root().join(name))
}

/// Names of files in a folder that match a name or a pattern with `*`, `?` or `[…]`, sorted by their
/// numbers.
///
/// # Errors
/// If the pattern is invalid, no file matches, or a matching file must not be read.
pub fn matching(folder: &Folder, name: &Path) -> Result<Vec<PathBuf>> {
    if folder.exists(&folder.root().join(name)) {
        return Ok(vec![name.to_owned()]);
    }
    let name = plain(name);
    let is_pattern_part = |part: &Component<'_>| part.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    let fixed: PathBuf = name.components().take_while(|part| !is_pattern_part(part)).collect();
    let levels = name.components().skip_while(|part| !is_pattern_part(part)).count();
    let levels = if name.to_string_lossy().contains("**") { DEEPEST } else { levels.saturating_sub(1) };
    let invalid = |e: glob::PatternError| {
        Error::usage(format!("the pattern {}: {e}", shown(&name)), "a pattern such as step*.csv")
    };
    let pattern = Pattern::new(&name.to_string_lossy()).map_err(invalid)?;
    let top = plain(&folder.root().join(fixed));
    let found = if folder.is_folder(&top) || top == Path::new("") {
        folder.walk(&top, levels)?
    } else {
        Walk::default()
    };
    let root = plain(folder.root());
    let within = |path: &Path| path.strip_prefix(&root).map_or_else(|_| path.to_owned(), Path::to_owned);
    let matches = |path: &Path| pattern.matches_path_with(path, WHOLE_NAMES);
    let mut skipped = found.skipped.iter().map(|(path, _)| within(path)).filter(|path| matches(path));
    skipped.try_for_each(|path| folder.path(&path).map(drop))?;
    let mut files: Vec<PathBuf> =
        found.files.iter().map(|path| within(path)).filter(|path| matches(path)).collect();
    if files.is_empty() {
        let found = format!("no file matches {}", shown(folder.root().join(&name)));
        return Err(Error::absent(found, folder.root(), &name));
    }
    in_order(&mut files);
    Ok(files)
}

/// Options of patterns: a star matches only within one part of a path.
pub(super) const WHOLE_NAMES: MatchOptions = MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: false,
};

/// Levels of subfolders that `**` reaches.
const DEEPEST: usize = 16;
