//! Search for recordings in a folder and below it.

use super::{Folder, Manifest, Side, locked, or_here, plain, real};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use vibro_record::{Error, Result, is_unprintable, shown};
use walkdir::{DirEntry, WalkDir};

/// Regular files that may be recordings, each once, and what was skipped.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Walk {
    /// Files, in the order of their names.
    pub files: Vec<PathBuf>,
    /// Paths that could not or must not be searched, and why.
    pub skipped: Vec<(PathBuf, String)>,
}

impl Folder {
    /// Searches a folder and up to `levels` levels of folders below it. Each folder is visited once,
    /// however many links lead to it. Links are followed only where [`Folder::path`] allows. Hidden files
    /// and vibro's own results are skipped without a report.
    ///
    /// # Errors
    /// If the folder itself cannot be listed. A folder below it that cannot be listed is skipped.
    pub fn walk(&self, top: &Path, levels: usize) -> Result<Walk> {
        let mut walk = Walk::default();
        match &self.side {
            Side::Disk => {
                fs::read_dir(or_here(top)).map_err(|e| Error::io("list", top, e))?;
                self.visit(or_here(top), levels, &mut BTreeSet::new(), &mut walk);
            }
            Side::Memory(files) => {
                let top = plain(top);
                let near = |path: &&PathBuf| {
                    let parts: Vec<_> = path.strip_prefix(&top).into_iter().flatten().collect();
                    let hidden = parts.iter().any(|part| is_hidden(Path::new(part)));
                    (1..=levels + 1).contains(&parts.len()) && !hidden
                };
                walk.files = locked(files).keys().filter(near).cloned().collect();
            }
        }
        let mut manifests: BTreeMap<PathBuf, Manifest> = BTreeMap::new();
        walk.files.retain(|path| {
            let folder = path.parent().unwrap_or(Path::new(""));
            let known = manifests.entry(folder.to_owned());
            let known = known.or_insert_with(|| Manifest::of(&self.at(folder)));
            !path.file_name().is_some_and(|name| known.is_result(&name.to_string_lossy()))
        });
        walk.files.sort();
        Ok(walk)
    }

    /// Visits a folder and those below it whose canonical paths have not been `seen`, then the targets of
    /// links.
    fn visit(&self, top: &Path, levels: usize, seen: &mut BTreeSet<PathBuf>, walk: &mut Walk) {
        seen.extend(real(top));
        let mut links = Vec::new();
        let entries = WalkDir::new(top).max_depth(levels + 1).sort_by_file_name().into_iter();
        let new = |entry: &DirEntry| {
            let folder = entry.file_type().is_dir();
            entry.depth() == 0
                || !is_hidden(entry.path())
                    && (!folder || real(entry.path()).is_none_or(|path| seen.insert(path)))
        };
        for entry in entries.filter_entry(new) {
            match entry {
                Ok(entry) if entry.file_type().is_symlink() => {
                    links.push((plain(entry.path()), entry.depth()));
                }
                Ok(entry) if entry.file_type().is_file() => walk.take(plain(entry.path())),
                Ok(entry) if entry.file_type().is_dir() => {}
                Ok(entry) => walk.skip(entry.path(), SPECIAL),
                Err(error) => {
                    let why = error.io_error().map_or(String::new(), |error| error.kind().to_string());
                    walk.skip(error.path().unwrap_or(top), format!("cannot be listed: {why}"));
                }
            }
        }
        for (link, depth) in links {
            match real(&link) {
                None => walk.skip(&link, "a link to nothing"),
                Some(target) if self.leads_outside(&link).is_some() => {
                    walk.skip(&link, format!("a link that leads outside the folder, to {}", shown(target)));
                }
                Some(target) if target.is_dir() => {
                    if depth <= levels && !seen.contains(&target) {
                        self.visit(&link, levels - depth, seen, walk);
                    }
                }
                Some(target) if target.is_file() => {
                    // A file in a folder already searched is listed under its own name.
                    let known =
                        target.parent().is_some_and(|folder| seen.contains(folder)) && !is_hidden(&target);
                    if !known && seen.insert(target) {
                        walk.take(link);
                    }
                }
                Some(_) => walk.skip(&link, SPECIAL),
            }
        }
    }
}

const SPECIAL: &str = "a pipe, a socket or a device";

impl Walk {
    fn skip(&mut self, path: &Path, why: impl Into<String>) {
        self.skipped.push((plain(path), why.into()));
    }

    /// Lists a file if its name can be written into a campaign, else skips it.
    fn take(&mut self, path: PathBuf) {
        let name = path.file_name().map_or(&[][..], |name| name.as_encoded_bytes());
        let why = match path.to_str() {
            None => "its name is not UTF-8: rename it",
            Some(path) if path.contains(is_unprintable) => {
                "its name has a line break or a control character: rename it"
            }
            // In lists written on DOS, a backslash separates folders.
            Some(_) if name.contains(&b'\\') => "its name has a backslash: rename it",
            Some(_) => return self.files.push(path),
        };
        self.skip(&path, why);
    }
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}
