//! What lies in a folder and below it.

use super::{Folder, Manifest, Side, locked, or_here, plain, real};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use vibro_record::{Error, Result, shown, steers};
use walkdir::{DirEntry, WalkDir};

/// Regular files that may be recordings, each once, and what was passed over.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Walk {
    /// Files, in the order of their names.
    pub files: Vec<PathBuf>,
    /// What could not be looked at or must not be, and why.
    pub left: Vec<(PathBuf, Left)>,
}

/// Why something in a folder is left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Left {
    /// A folder that cannot be listed.
    Unlisted(String),
    /// A link that leads outside, to this place.
    Outside(PathBuf),
    /// A link to nothing.
    Dangling,
    /// A pipe, a socket or a device, or a link to one.
    Special,
    /// A name that no campaign can hold, and what is wrong with it.
    Name(&'static str),
}

impl fmt::Display for Left {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Left::Unlisted(why) => write!(f, "cannot be listed: {why}"),
            Left::Outside(place) => write!(f, "a link that leads outside the folder, to {}", shown(place)),
            Left::Dangling => f.write_str("a link to nothing"),
            Left::Special => f.write_str("a pipe, a socket or a device"),
            Left::Name(what) => write!(f, "its name {what}: rename it"),
        }
    }
}

impl Folder {
    /// Looks through a folder and up to `levels` below it. Each folder is visited once, whatever links there are; links lead no further than
    /// [`Folder::path`] does. Hidden files and what vibro wrote as results are passed over without a word.
    ///
    /// # Errors
    /// If the folder itself cannot be listed. One below it that cannot is left out.
    pub fn walk(&self, top: &Path, levels: usize) -> Result<Walk> {
        let mut walk = Walk::default();
        match &self.side {
            Side::Disk => self.visit(or_here(top), levels, &mut BTreeSet::new(), &mut walk)?,
            Side::Memory(files) => {
                let top = plain(top);
                let shown = |path: &&PathBuf| {
                    let parts: Vec<_> = path.strip_prefix(&top).into_iter().flatten().collect();
                    let hidden = parts.iter().any(|part| part.to_string_lossy().starts_with('.'));
                    (1..=levels + 1).contains(&parts.len()) && !hidden
                };
                walk.files = locked(files).keys().filter(shown).cloned().collect();
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

    fn visit(&self, top: &Path, levels: usize, seen: &mut BTreeSet<PathBuf>, walk: &mut Walk) -> Result<()> {
        seen.extend(real(top));
        let mut links = Vec::new();
        let entries = WalkDir::new(top).max_depth(levels + 1).sort_by_file_name().into_iter();
        let new = |entry: &DirEntry| {
            let below = entry.depth() > 0;
            let hidden = below && entry.file_name().as_encoded_bytes().starts_with(b".");
            let folder = below && entry.file_type().is_dir();
            !hidden && (!folder || real(entry.path()).is_none_or(|path| seen.insert(path)))
        };
        for entry in entries.filter_entry(new) {
            let entry = match entry {
                Ok(entry) => entry,
                Err(error) => {
                    let (depth, path) = (error.depth(), plain(error.path().unwrap_or(top)));
                    let why = error.into_io_error().unwrap_or_else(|| std::io::ErrorKind::Other.into());
                    if depth == 0 {
                        return Err(Error::io("list", path, why));
                    }
                    walk.left.push((path, Left::Unlisted(why.kind().to_string())));
                    continue;
                }
            };
            let (path, kind) = (plain(entry.path()), entry.file_type());
            if kind.is_symlink() {
                links.push((path, entry.depth()));
            } else if kind.is_file() {
                walk.take(path);
            } else if !kind.is_dir() {
                walk.left.push((path, Left::Special));
            }
        }
        for (path, depth) in links {
            let Some(target) = real(&path) else {
                walk.left.push((path, Left::Dangling));
                continue;
            };
            // A file whose folder was looked through is known by its own name.
            let shown = |folder: &Path| seen.contains(folder) && !is_hidden(&target);
            if self.leads_outside(&path).is_some() {
                walk.left.push((path, Left::Outside(target)));
            } else if target.is_file() && !target.parent().is_some_and(shown) {
                walk.take(path);
            } else if target.is_dir() && depth <= levels && !seen.contains(&target) {
                // What cannot be listed is left out as below.
                if let Err(error) = self.visit(&path, levels - depth, seen, walk) {
                    walk.left.push((path, Left::Unlisted(error.why())));
                }
            } else if !target.is_file() && !target.is_dir() {
                walk.left.push((path, Left::Special));
            }
        }
        Ok(())
    }
}

impl Walk {
    /// Takes a file whose name can be written into a campaign.
    fn take(&mut self, path: PathBuf) {
        let why = match path.to_str() {
            None => "is not UTF-8",
            Some(name) if name.contains(steers) => "has a line break or a control character",
            // Lists of DOS machines have it between folders.
            Some(_) if path.file_name().is_some_and(|name| name.as_encoded_bytes().contains(&b'\\')) => {
                "has a backslash"
            }
            Some(_) => return self.files.push(path),
        };
        self.left.push((path, Left::Name(why)));
    }
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}
