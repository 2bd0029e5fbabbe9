//! What a campaign is computed from, by content.

use super::kept::Kept;
use super::{RESULTS, file_name, files};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::record::Finding;
use rayon::prelude::*;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

/// A line for the program, the campaign and each of its recordings, as `sha256sum` writes them; names are relative to the folder of the campaign.
///
/// # Errors
/// As [`files`]; if a file cannot be read.
pub fn inputs(campaign: &Campaign, allow_outside: bool, kept: &Kept) -> Result<String> {
    let mut all = files(campaign, allow_outside)?;
    all.sort();
    all.dedup();
    // The reader says what is wrong with a folder or a pipe.
    all.retain(|path| path.is_file());
    let own = line(Sha256::digest(campaign.text()).as_slice(), &file_name(campaign.path()));
    // One that was proposed is no file that could be checked.
    let own = if campaign.path().is_file() { own } else { format!("# {own}") };
    let program = line(&kept.program().unwrap_or_default(), concat!("vibro ", env!("CARGO_PKG_VERSION")));
    let of_file = |path: &Path| {
        let name = path.strip_prefix(campaign.folder()).unwrap_or(path).display().to_string();
        kept.file(path).map(|digest| line(&digest, &name))
    };
    let lines: Result<Vec<String>> = all.par_iter().map(|path| of_file(path)).collect();
    Ok(format!("# {program}{own}{}", lines?.concat()))
}

fn line(digest: &[u8], name: &str) -> String {
    let mut line = String::new();
    for byte in digest {
        let _ = write!(line, "{byte:02x}");
    }
    line + "  " + name + "\n"
}

/// Levels below a folder that are looked into.
const LEVELS: usize = 2;

/// Files that nobody takes for recordings.
const NO_RECORDINGS: [&str; 23] = [
    "toml",
    "json",
    "md",
    "html",
    "pdf",
    "png",
    "jpg",
    "jpeg",
    "svg",
    "gif",
    "doc",
    "docx",
    "ppt",
    "pptx",
    "py",
    "m",
    "rs",
    "zip",
    "exe",
    "bak",
    "log",
    "ini",
    "tdms_index",
];

/// The files of a folder and up to two levels below it that may be recordings, numbers by value, and those that are none by their endings. Hidden
/// files and folders of results are passed over.
///
/// # Errors
/// If a folder cannot be listed.
pub fn recordings(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>)> {
    let (mut found, mut others) = (Vec::new(), Vec::new());
    list(folder, LEVELS, &mut found, &mut others)?;
    found.sort_by(|a, b| natord::compare(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok((found, others))
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
            let list = if NO_RECORDINGS.contains(&ending.as_str()) { &mut *others } else { &mut *found };
            list.push(path);
        }
    }
    below.iter().filter(|_| levels > 0).try_for_each(|folder| list(folder, levels - 1, found, others))
}

/// Those of the files that the campaign names in no table and in no comment.
///
/// # Errors
/// As [`files`].
pub fn unnamed(campaign: &Campaign, allow_outside: bool, all: &[PathBuf]) -> Result<Vec<PathBuf>> {
    // `./a` is `a`.
    let plain = |path: &Path| path.components().filter(|c| *c != Component::CurDir).collect::<PathBuf>();
    let named: Vec<PathBuf> = files(campaign, allow_outside)?.iter().map(|path| plain(path)).collect();
    let folder = plain(campaign.folder());
    let ends = |c: char| !c.is_alphanumeric() && !['_', '-', '.', '/', '\\'].contains(&c);
    let said = |path: &Path| {
        let name = path.strip_prefix(&folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        campaign.text().match_indices(&name).any(|(at, _)| {
            let (before, behind) = (&campaign.text()[..at], &campaign.text()[at + name.len()..]);
            // A full stop ends a sentence, too.
            let behind =
                behind.strip_prefix('.').filter(|b| !b.starts_with(char::is_alphanumeric)).unwrap_or(behind);
            before.chars().next_back().is_none_or(ends) && behind.chars().next().is_none_or(ends)
        })
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
