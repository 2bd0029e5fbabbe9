//! Files that are written but have no name yet.

use super::{Folder, Side, locked, or_here, plain};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;
use tempfile::{NamedTempFile, TempPath};
use vibro_record::{Error, Result};

/// A file without its name. It is removed unless it gets one.
#[derive(Debug)]
pub struct Staged(Content);

#[derive(Debug)]
enum Content {
    Disk(TempPath),
    Memory(Vec<u8>),
}

/// End of the names of temporary files.
const PART: &str = ".vibro.part";

impl Folder {
    /// Writes bytes beside the place that they are to get. The folder must exist.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn stage(&self, path: &Path, bytes: &[u8]) -> Result<Staged> {
        if matches!(self.side, Side::Memory(_)) {
            return Ok(Staged(Content::Memory(bytes.to_vec())));
        }
        let folder = or_here(path.parent().unwrap_or(Path::new("")));
        let write = || {
            let mut file = temporary(folder)?;
            file.write_all(bytes)?;
            Ok(file.into_temp_path())
        };
        write().map(|file| Staged(Content::Disk(file))).map_err(|e| Error::io("write", path, e))
    }

    /// Gives a staged file its name, at once and whole; what had the name is gone.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn place(&self, staged: Staged, path: &Path) -> Result<()> {
        match (staged.0, &self.side) {
            (Content::Disk(file), _) => {
                // Who may read or write the file that it replaces may go on so.
                if let Ok(known) = fs::metadata(path) {
                    let _ = fs::set_permissions(&file, known.permissions());
                }
                file.persist(path).map_err(|e| Error::io("write", path, e.error))
            }
            (Content::Memory(bytes), Side::Memory(files)) => {
                locked(files).insert(plain(path), bytes.into());
                Ok(())
            }
            (Content::Memory(_), Side::Disk) => Ok(()),
        }
    }

    /// Makes a folder with those above it.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn make(&self, path: &Path) -> Result<()> {
        match self.side {
            Side::Disk => {
                fs::create_dir_all(or_here(path)).map_err(|e| Error::io("make the folder", path, e))
            }
            Side::Memory(_) => Ok(()),
        }
    }

    /// Removes a file, if it is there.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn remove(&self, path: &Path) -> Result<()> {
        match &self.side {
            Side::Disk => match fs::remove_file(path) {
                Err(e) if e.kind() != ErrorKind::NotFound => Err(Error::io("remove", path, e)),
                _ => Ok(()),
            },
            Side::Memory(files) => {
                locked(files).remove(&plain(path));
                Ok(())
            }
        }
    }

    /// Removes temporary files of programs that were killed in this folder. Only who holds its lock may ask for it.
    pub fn remove_leftovers(&self) {
        for name in self.names().iter().filter(|name| name.starts_with('.') && name.ends_with(PART)) {
            // It is in nobody's way: a leftover that cannot be removed is no failure.
            let _ = self.remove(&self.root().join(name));
        }
    }
}

/// A file of a hidden name, on the file system of its folder, which everybody may read who may read a new file there.
fn temporary(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut named = tempfile::Builder::new();
    named.prefix(".").suffix(PART);
    #[cfg(unix)]
    named.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    named.tempfile_in(folder)
}
