//! The recordings of a folder, and those of them that its campaign does not name.

use super::{RESULTS, file_name, files};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::record::Finding;
use glob::{MatchOptions, Pattern};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Levels below a folder that are looked into.
const LEVELS: usize = 2;

/// Files that nobody takes for recordings.
const NO_RECORDINGS: &str =
    "toml json md html pdf png jpg jpeg svg gif doc docx ppt pptx py m rs zip exe bak log ini tdms_index";

/// The files of a folder and up to two levels below it that may be recordings, numbers by value, and those that are none by their endings. Hidden
/// files and folders of results are passed over.
///
/// # Errors
/// If a folder cannot be listed.
pub fn recordings(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>)> {
    let (mut found, mut others) = (Vec::new(), Vec::new());
    list(folder, LEVELS, &mut found, &mut others)?;
    in_order(&mut found);
    Ok((found, others))
}

/// Puts files in the order of the numbers in their names: 2 before 10, and 11.15 before 11.2.
pub fn in_order(files: &mut [PathBuf]) {
    files.sort_by(|a, b| natord::compare(&with_decimals(a), &with_decimals(b)));
}

/// A path in which all numbers have decimals of one length, so that they are in order as whole numbers are; the ending is no decimal, nor are parts
/// of a date or a version.
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

/// Decimals that a number in a name has at most.
const DECIMALS: usize = 12;

/// A path without `.` in it.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

/// Whether a name is the pattern of files in a folder, not that of one.
pub fn is_pattern(folder: &Path, name: &Path) -> bool {
    name.to_string_lossy().contains(['*', '?']) && !folder.join(name).exists()
}

/// The names of files in a folder that a name or a pattern with `*`, `?` or `[…]` means, numbers in them by value.
///
/// # Errors
/// If it is no pattern, or no file has such a name.
pub fn matching(folder: &Path, name: &Path) -> Result<Vec<PathBuf>> {
    if folder.join(name).exists() {
        return Ok(vec![name.to_owned()]);
    }
    let base = plain(folder);
    let pattern = Path::new(&Pattern::escape(&base.to_string_lossy())).join(plain(name));
    let wrong = |e: glob::PatternError| {
        Error::usage(format!("the pattern {}: {e}", name.display()), "a pattern such as step*.csv")
    };
    let found = glob::glob(&pattern.to_string_lossy()).map_err(wrong)?.filter_map(std::result::Result::ok);
    let mut files: Vec<PathBuf> =
        found.map(|path| path.strip_prefix(&base).map_or_else(|_| path.clone(), Path::to_owned)).collect();
    if files.is_empty() {
        let found = format!("no file matches {}", folder.join(name).display());
        return Err(Error::absent(found, folder, name));
    }
    in_order(&mut files);
    Ok(files)
}

fn list(folder: &Path, levels: usize, found: &mut Vec<PathBuf>, others: &mut Vec<PathBuf>) -> Result<()> {
    if levels < LEVELS && folder.join(RESULTS).exists() {
        return Ok(());
    }
    let list_of = |e| Error::io("list", folder, e);
    let mut below = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(list_of)? {
        let entry = entry.map_err(list_of)?;
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if name.starts_with('.') {
            continue;
        }
        if path.is_dir() {
            below.push(path);
        } else if path.is_file() {
            let ending = path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase());
            let none = NO_RECORDINGS.split(' ').any(|known| known == ending);
            if none { &mut *others } else { &mut *found }.push(path);
        }
    }
    below.iter().filter(|_| levels > 0).try_for_each(|folder| list(folder, levels - 1, found, others))
}

/// Those of the files that the campaign names in no table and in no comment.
///
/// # Errors
/// As [`files`].
pub fn unnamed(campaign: &Campaign, allow_outside: bool, all: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let named: BTreeSet<PathBuf> = files(campaign, allow_outside)?.iter().map(|path| plain(path)).collect();
    let folder = plain(campaign.folder());
    let ends = |c: char| !c.is_alphanumeric() && !['_', '-', '.', '/', '\\'].contains(&c);
    // A table that is still a comment may name a pattern.
    let commented = campaign.text().lines().filter_map(|line| {
        let key = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("file")?;
        key.trim_start().strip_prefix('=')?.split('"').nth(1)
    });
    let patterns: Vec<Pattern> = commented.filter_map(|text| Pattern::new(text).ok()).collect();
    let how = MatchOptions { require_literal_separator: true, ..MatchOptions::default() };
    let said = |path: &Path| {
        let name = path.strip_prefix(&folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        let in_words = || {
            campaign.text().match_indices(&name).any(|(at, _)| {
                let (before, behind) = (&campaign.text()[..at], &campaign.text()[at + name.len()..]);
                // A full stop ends a sentence, too.
                let behind = behind
                    .strip_prefix('.')
                    .filter(|b| !b.starts_with(char::is_alphanumeric))
                    .unwrap_or(behind);
                before.chars().next_back().is_none_or(ends) && behind.chars().next().is_none_or(ends)
            })
        };
        patterns.iter().any(|pattern| pattern.matches_with(&name, how)) || in_words()
    };
    let new = |path: &&PathBuf| {
        let path = plain(path);
        !named.contains(&path) && !said(&path)
    };
    Ok(all.iter().filter(new).cloned().collect())
}

/// What is said of files in the folder of a campaign that it does not name, where it is the folder's own.
///
/// # Errors
/// As [`files`].
pub fn beside(campaign: &Campaign, allow_outside: bool) -> Result<Option<Finding>> {
    if !campaign.path().is_file() || !campaign.path().ends_with(OWN) {
        return Ok(None);
    }
    let new = unnamed(campaign, allow_outside, &recordings(campaign.folder())?.0)?;
    let names: Vec<String> = new.iter().take(SHOWN).map(|path| file_name(path)).collect();
    let more = new.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let found = Finding::note("files-not-named").count("n", new.len());
    Ok((!new.is_empty()).then(|| found.name("files", names.join(", ") + &more)))
}

/// Name of the file of a folder's own campaign.
pub const OWN: &str = "campaign.toml";

/// Files that are named one by one.
const SHOWN: usize = 5;
