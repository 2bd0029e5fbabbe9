//! One writer at a time in a folder.

use super::or_here;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};
use vibro_record::{Error, Place, Result};

/// The right to write into a folder, held until it is dropped. The system takes it back from a program that is killed.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    _file: File,
}

/// Time between two tries, and after which another writer is taken to be stuck: figures and tables of a large campaign are written in a second.
const PAUSE: Duration = Duration::from_millis(20);
const PATIENCE: Duration = Duration::from_secs(10);

impl Lock {
    /// Name of its file, which holds the number of the process.
    pub const FILE: &str = ".vibro.lock";

    /// The lock of a folder on disk; waits a moment for another writer.
    ///
    /// # Errors
    /// If another program is still writing there, or the file cannot be made.
    pub fn of(folder: &Path) -> Result<Lock> {
        let (path, began) = (or_here(folder).join(Lock::FILE), Instant::now());
        let refused = |e| Error::io("write", or_here(folder), e);
        loop {
            if std::fs::symlink_metadata(&path).is_ok_and(|meta| !meta.is_file()) {
                return Err(Error::input(Place::file(&path), "not a regular file", "none of this name")
                    .hint(format!("rm {}", path.display())));
            }
            let mut open = OpenOptions::new();
            let mut file =
                open.read(true).write(true).create(true).truncate(false).open(&path).map_err(refused)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) if began.elapsed() < PATIENCE => sleep(PAUSE),
                Err(TryLockError::WouldBlock) => {
                    let mut process = String::new();
                    // Some systems let nobody read what is locked.
                    let _ = file.read_to_string(&mut process);
                    let found = format!("process {} is writing into this folder", process.trim());
                    return Err(Error::input(Place::file(folder), found, "one writer at a time")
                        .hint("end that process or wait for it, then run the same command again"));
                }
                // Where there are no locks, as on some network drives, there is nobody to wait for.
                Ok(()) | Err(TryLockError::Error(_)) => {
                    // The writer before may have removed the file between opening and locking it.
                    if same_file::Handle::from_path(&path).ok()
                        != file.try_clone().and_then(same_file::Handle::from_file).ok()
                    {
                        continue;
                    }
                    file.set_len(0).and_then(|()| write!(file, "{}", std::process::id())).map_err(refused)?;
                    return Ok(Lock { path, _file: file });
                }
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that cannot be removed is taken over by the next writer.
        let _ = std::fs::remove_file(&self.path);
    }
}
