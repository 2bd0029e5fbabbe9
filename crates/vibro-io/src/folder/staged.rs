//! Files that are written completely before they get their names.

use super::{Files, Folder, Side, locked, or_here, plain};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use tempfile::{NamedTempFile, TempPath};
use vibro_record::{Error, Result};

/// A complete file without its final name: a temporary file in its folder, or bytes in memory. It is
/// removed unless [`Staged::place`] names it.
#[derive(Debug)]
pub enum Staged {
    /// On a disk.
    Disk(TempPath, PathBuf),
    /// In a folder in memory.
    Memory(Arc<Mutex<Files>>, PathBuf, Vec<u8>),
}

impl Staged {
    /// Gives the file its name in one step; an existing file of that name is replaced.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn place(self) -> Result<()> {
        match self {
            Staged::Disk(file, path) => {
                // The new file takes the permissions of the file that it replaces.
                if let Ok(known) = fs::metadata(&path) {
                    let _ = fs::set_permissions(&file, known.permissions());
                }
                file.persist(&path).map_err(|e| Error::io("write", &path, e.error))
            }
            Staged::Memory(files, path, bytes) => {
                locked(&files).insert(path, Arc::new(bytes));
                Ok(())
            }
        }
    }
}

/// End of the names of temporary files.
const PART: &str = ".vibro.part";

impl Folder {
    /// Writes bytes to a temporary file in the folder of `path`, which must exist.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn stage(&self, path: &Path, bytes: &[u8]) -> Result<Staged> {
        if let Side::Memory(files) = &self.side {
            return Ok(Staged::Memory(files.clone(), plain(path), bytes.to_vec()));
        }
        let write = || {
            let mut file = temporary(or_here(path.parent().unwrap_or(Path::new(""))))?;
            file.write_all(bytes)?;
            Ok(Staged::Disk(file.into_temp_path(), path.to_owned()))
        };
        write().map_err(|e| Error::io("write", path, e))
    }

    /// Removes a file, if it is there.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn remove(&self, path: &Path) -> Result<()> {
        let removed = match &self.side {
            Side::Disk => fs::remove_file(path),
            Side::Memory(files) => {
                locked(files).remove(&plain(path));
                Ok(())
            }
        };
        removed.or_else(|e| {
            if e.kind() == ErrorKind::NotFound { Ok(()) } else { Err(Error::io("remove", path, e)) }
        })
    }

    /// Removes temporary files that killed programs left in this folder. Only the holder of the folder's lock
    /// may call it.
    pub(super) fn remove_leftovers(&self) {
        for name in self.names().iter().filter(|name| name.starts_with('.') && name.ends_with(PART)) {
            // A temporary file does no harm: failing to remove it is no error.
            let _ = self.remove(&self.root().join(name));
        }
    }
}

/// A temporary file with a hidden name in `folder`, so that renaming stays within one file system. It has
/// the permissions of any new file.
fn temporary(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut named = tempfile::Builder::new();
    named.prefix(".").suffix(PART);
    #[cfg(unix)]
    named.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    named.tempfile_in(folder)
}
