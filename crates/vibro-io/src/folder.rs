//! File access of a run: a folder on disk, or one in memory.

mod lock;
mod manifest;
mod staged;
mod walk;

pub use lock::Lock;
pub use manifest::{Manifest, Owner, hexadecimal, listed};
pub use staged::Staged;
pub use walk::Walk;

use crate::recording::Recording;
use crate::source::{Shared, Source};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;
use vibro_record::{Error, Place, Result};

/// A SHA-256.
pub type Digest = [u8; 32];

/// A folder on disk or in memory, through which a run accesses all its files. Paths are as the user sees
/// them: the folder's own path joined with a name in it.
///
/// ```
/// use std::path::Path;
/// use vibro_io::Folder;
/// let folder = Folder::memory("bench", [("drop.csv", b"0,1\n".to_vec())]);
/// let path = folder.path(Path::new("drop.csv"))?;
/// assert_eq!(folder.read(&path)?, b"0,1\n");
/// assert!(folder.path(Path::new("../drop.csv")).is_err());
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Folder {
    root: PathBuf,
    outside: bool,
    side: Side,
    /// Files opened as measurements, by an identity that is the same under all their names.
    opened: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// Records made in memory, by the paths under which they are read.
    recordings: Arc<BTreeMap<PathBuf, Arc<Recording>>>,
}

/// Files in memory by their paths.
type Files = BTreeMap<PathBuf, Arc<Vec<u8>>>;

#[derive(Debug, Clone, Default)]
enum Side {
    #[default]
    Disk,
    Memory(Arc<Mutex<Files>>),
}

/// What exists at a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occupant {
    /// Nothing.
    Nothing,
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A link, a pipe, a socket or a device.
    Special,
}

impl From<PathBuf> for Folder {
    fn from(root: PathBuf) -> Folder {
        Folder { root, ..Folder::default() }
    }
}

impl From<&Path> for Folder {
    fn from(root: &Path) -> Folder {
        Folder::from(root.to_owned())
    }
}

impl Folder {
    /// A folder in memory that holds these files.
    pub fn memory<N: AsRef<Path>>(
        root: impl Into<PathBuf>,
        files: impl IntoIterator<Item = (N, Vec<u8>)>,
    ) -> Folder {
        let root = root.into();
        let one = |(name, bytes): (N, Vec<u8>)| (plain(&root.join(name)), Arc::new(bytes));
        let files: Files = files.into_iter().map(one).collect();
        Folder { side: Side::Memory(Arc::new(Mutex::new(files))), ..Folder::from(root) }
    }

    /// Another folder of the same disk or memory. Both share the record of opened files.
    pub fn at(&self, root: impl Into<PathBuf>) -> Folder {
        Folder { root: root.into(), ..self.clone() }
    }

    /// Adds records made in memory: they are read, each recording under its path, in place of files.
    ///
    /// ```
    /// use vibro_io::{Folder, Format, Reader, Recording};
    /// use vibro_record::{Axis, Meta, Record, Trace, units::Unit};
    /// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
    /// let trace = Trace { meta, axis: Axis::time(0.0, 1e-3, 2), values: vec![0.1, 0.2] };
    /// let (path, findings) = ("array".into(), Vec::new());
    /// let made = Recording { path, format: Format::Memory, records: vec![Record::Trace(trace)], findings };
    /// let folder = Folder::default().with_recordings([made.clone()]);
    /// assert_eq!(Reader::new().within(&folder).from_path("array")?, made);
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    pub fn with_recordings(self, made: impl IntoIterator<Item = Recording>) -> Folder {
        let made = made.into_iter().map(|recording| (plain(&recording.path), Arc::new(recording)));
        Folder { recordings: Arc::new(made.collect()), ..self }
    }

    /// States whether names may lead outside the folder. Default: they are refused.
    pub fn allow_outside(self, outside: bool) -> Folder {
        Folder { outside, ..self }
    }

    /// Path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The path of a file by its name in this folder. A name that leads outside (by `..`, as an absolute
    /// name or through a link) is refused, unless [`Folder::allow_outside`] permits it.
    ///
    /// # Errors
    /// If the name leads outside and that is not allowed.
    pub fn path(&self, name: &Path) -> Result<PathBuf> {
        // Lists written on DOS separate folders by backslashes.
        let name = PathBuf::from(name.to_string_lossy().replace('\\', "/"));
        let path = self.root.join(&name);
        if self.outside {
            return Ok(path);
        }
        let drive = name.to_string_lossy().as_bytes().get(1) == Some(&b':');
        let deeper = |depth: usize, part: Component| match part {
            Component::Normal(_) => Some(depth + 1),
            Component::ParentDir => depth.checked_sub(1),
            Component::CurDir => Some(depth),
            _ => None,
        };
        let found = if drive || name.components().try_fold(0, deeper).is_none() {
            format!("the name {:?} leads outside its folder", name.display().to_string())
        } else if let Some(target) = self.leads_outside(&path) {
            format!("the link {} leads outside its folder, to {}", path.display(), target.display())
        } else {
            return Ok(path);
        };
        Err(Error::usage(found, "names of files in the folder or below it")
            .hint("move the files into the folder, or allow files outside it if you trust it")
            .setting("allow_outside"))
    }

    /// The target of a path that leads outside the folder through links; `None` if it stays inside. A file
    /// not yet written counts as inside if its folder is.
    fn leads_outside(&self, path: &Path) -> Option<PathBuf> {
        let (Side::Disk, false) = (&self.side, self.outside) else { return None };
        let root = real(&self.root)?;
        let target = path.ancestors().find_map(real)?;
        (!target.starts_with(root)).then_some(target)
    }

    /// What exists at this path; links are not followed.
    pub fn occupant(&self, path: &Path) -> Occupant {
        self.occupant_by(path, |path| fs::symlink_metadata(path))
    }

    fn occupant_by(&self, path: &Path, look: fn(&Path) -> io::Result<fs::Metadata>) -> Occupant {
        if self.recordings.contains_key(&plain(path)) {
            return Occupant::File;
        }
        match &self.side {
            Side::Disk => match look(path) {
                Ok(meta) if meta.is_file() => Occupant::File,
                Ok(meta) if meta.is_dir() => Occupant::Folder,
                Ok(_) => Occupant::Special,
                Err(_) => Occupant::Nothing,
            },
            Side::Memory(files) => {
                let (files, path) = (locked(files), plain(path));
                match files.keys().find(|file| file.starts_with(&path)) {
                    Some(file) if *file == path => Occupant::File,
                    Some(_) => Occupant::Folder,
                    None => Occupant::Nothing,
                }
            }
        }
    }

    /// Whether anything exists at this path, links followed, or the path may name a part of an existing file.
    pub fn exists(&self, path: &Path) -> bool {
        self.occupant_by(path, |path| fs::metadata(path)) != Occupant::Nothing || self.part(path).is_some()
    }

    /// Splits a path that names a part of a file, an archive's `walk.zip/Gyroscope.csv` or a workbook's
    /// `walk.xlsx/Sheet 2`, into file and part. Whether the part exists shows only on reading.
    pub fn part<'a>(&self, path: &'a Path) -> Option<(&'a Path, &'a Path)> {
        let file = path
            .ancestors()
            .find(|above| self.occupant_by(above, |path| fs::metadata(path)) != Occupant::Nothing)?;
        let name = path.strip_prefix(file).ok().filter(|name| !name.as_os_str().is_empty())?;
        self.is_file(file).then_some((file, name))
    }

    /// The file at a path, or the file of which the path names a part.
    pub fn file<'a>(&self, path: &'a Path) -> &'a Path {
        self.part(path).map_or(path, |(file, _)| file)
    }

    /// Whether the path leads to a regular file, also through a link.
    pub fn is_file(&self, path: &Path) -> bool {
        self.occupant_by(path, |path| fs::metadata(path)) == Occupant::File
    }

    /// Whether the path leads to a folder, also through a link.
    pub fn is_folder(&self, path: &Path) -> bool {
        self.occupant_by(path, |path| fs::metadata(path)) == Occupant::Folder
    }

    /// Sorted names of the files directly in the folder, hidden ones included; on disk also of its
    /// subfolders. Names that are not UTF-8 are left out. Empty if the folder cannot be listed.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = match &self.side {
            Side::Disk => {
                let entries = fs::read_dir(or_here(&self.root)).into_iter().flatten().flatten();
                entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
            }
            Side::Memory(files) => {
                let root = plain(&self.root);
                let files = locked(files);
                let own = files.keys().filter_map(|path| path.strip_prefix(&root).ok()?.to_str());
                own.filter(|name| !name.contains('/')).map(str::to_owned).collect()
            }
        };
        names.sort();
        names
    }

    /// Creates the folder with its parents and locks it for writing until the lock is dropped. Temporary
    /// files of killed programs are removed. A folder in memory needs no lock: `None`.
    ///
    /// # Errors
    /// If the folder or the lock file cannot be made, or another program is writing there.
    pub fn lock(&self) -> Result<Option<Lock>> {
        if matches!(self.side, Side::Memory(_)) {
            return Ok(None);
        }
        let root = or_here(&self.root);
        fs::create_dir_all(root).map_err(|e| Error::io("make the folder", root, e))?;
        let lock = Lock::of(root)?;
        self.remove_leftovers();
        Ok(Some(lock))
    }

    /// Opens a file for reading from its start.
    fn open(&self, path: &Path) -> Result<Box<dyn Read>> {
        // Opening a pipe would block for ever.
        if self.exists(path) && !self.is_file(path) {
            return Err(Error::input(Place::file(path), "not a regular file", "a file"));
        }
        let opened: io::Result<Box<dyn Read>> = match &self.side {
            Side::Disk => fs::File::open(path).map(|file| Box::new(file) as _),
            Side::Memory(_) => match self.held(path) {
                Some(bytes) => Ok(Box::new(io::Cursor::new(Shared(bytes)))),
                None => Err(io::ErrorKind::NotFound.into()),
            },
        };
        opened.map_err(|e| Error::io("open", path, e))
    }

    /// All bytes of a file.
    ///
    /// # Errors
    /// If it is not a regular file, or cannot be read.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.open(path)?.read_to_end(&mut bytes).map_err(|e| Error::io("read", path, e))?;
        Ok(bytes)
    }

    /// The bytes of a file of this name in the folder itself; `None` if it is a link or cannot be read.
    pub fn own_file(&self, name: &str) -> Option<Vec<u8>> {
        let path = self.root.join(name);
        if self.occupant(&path) == Occupant::File { self.read(&path).ok() } else { None }
    }

    /// The SHA-256 of a regular file, read 64 KiB at a time; of the whole file if the path names a part.
    ///
    /// # Errors
    /// As [`Folder::read`].
    pub fn digest(&self, path: &Path) -> Result<Digest> {
        let (mut file, mut hash, mut part) = (self.open(self.file(path))?, Sha256::new(), vec![0; 1 << 16]);
        loop {
            match file.read(&mut part).map_err(|e| Error::io("read", path, e))? {
                0 => return Ok(hash.finalize().into()),
                n => hash.update(&part[..n]),
            }
        }
    }

    /// Opens a file as a measurement and records it as read. The path must name a whole file:
    /// [`Folder::part`] splits others. `-` is standard input.
    ///
    /// # Errors
    /// As [`Source::file`].
    pub(crate) fn source(&self, path: &Path) -> Result<Source> {
        if let Some(made) = self.recordings.get(&plain(path)) {
            return Ok(Source::recording(made.clone()));
        }
        self.reads(path);
        match &self.side {
            Side::Disk => Source::file(path),
            Side::Memory(_) => match self.held(path) {
                Some(bytes) => Source::shared(path, bytes),
                None => Source::memory(path, self.read(path)?),
            },
        }
    }

    /// The bytes of a file in memory.
    fn held(&self, path: &Path) -> Option<Arc<Vec<u8>>> {
        let Side::Memory(files) = &self.side else { return None };
        locked(files).get(&plain(path)).cloned()
    }

    /// Adds a file to a folder in memory, in place of one of this name.
    ///
    /// # Errors
    /// If the name leads outside the folder, or the folder is on a disk.
    pub fn hold(&self, name: &Path, bytes: Vec<u8>) -> Result<()> {
        let path = self.path(name)?;
        let Side::Memory(files) = &self.side else {
            return Err(Error::usage("a folder on a disk", "a folder in memory"));
        };
        locked(files).insert(plain(&path), Arc::new(bytes));
        Ok(())
    }

    /// Records that the run reads a file as a measurement, even if its content is known from an earlier
    /// run.
    pub fn reads(&self, path: &Path) {
        locked(&self.opened).extend(self.identity(path));
    }

    /// Whether the run reads this file as a measurement, under this name or another.
    pub fn opened(&self, path: &Path) -> bool {
        self.identity(path).is_some_and(|file| locked(&self.opened).contains(&file))
    }

    /// Identity of a file under all its names: device and inode on Unix, else the canonical path; `None` if
    /// there is no file. `-` is the file that standard input comes from.
    fn identity(&self, path: &Path) -> Option<PathBuf> {
        let path = self.file(path);
        if matches!(self.side, Side::Memory(_)) {
            return Some(plain(path));
        }
        let path = if path == Path::new("-") { Path::new("/dev/stdin") } else { path };
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt;
            fs::metadata(path).ok().map(|meta| format!("{} {}", meta.dev(), meta.ino()).into())
        }
        #[cfg(not(unix))]
        real(path)
    }

    /// Whether a file is protected against writing.
    pub fn is_protected(&self, path: &Path) -> bool {
        matches!(self.side, Side::Disk) && fs::metadata(path).is_ok_and(|meta| meta.permissions().readonly())
    }

    /// Length in bytes and time of the last change of a file (in memory: 1970); of the whole file if the
    /// path names a part.
    pub fn stamp(&self, path: &Path) -> Option<(u64, SystemTime)> {
        let path = self.file(path);
        match &self.side {
            Side::Disk => fs::metadata(path).ok().and_then(|meta| Some((meta.len(), meta.modified().ok()?))),
            Side::Memory(files) => {
                let bytes = locked(files).get(&plain(path)).map(|bytes| bytes.len() as u64);
                bytes.map(|n| (n, SystemTime::UNIX_EPOCH))
            }
        }
    }
}

/// A path without its `.` parts.
pub fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

/// The path itself, or `.` (the current folder) for the empty path.
fn or_here(path: &Path) -> &Path {
    if path.as_os_str().is_empty() { Path::new(".") } else { path }
}

/// The canonical path of a file or folder, links followed; `None` if it does not exist.
fn real(path: &Path) -> Option<PathBuf> {
    or_here(path).canonicalize().ok()
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
