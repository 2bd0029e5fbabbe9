//! One writer at a time in a folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};
use vibro_record::{Error, Place, Result};

/// The right to write into a folder, held until dropped. The system releases it if the program is killed.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    _file: File,
}

/// Time between two attempts to lock: short compared with writing the results of a campaign.
const PAUSE: Duration = Duration::from_millis(20);
/// Time after which another writer counts as stuck; even a large campaign writes its figures and tables in
/// 1 s.
const PATIENCE: Duration = Duration::from_secs(10);

impl Lock {
    /// Name of the lock file. It holds the process number, only as information for the user.
    pub const FILE: &str = ".vibro.lock";

    /// Locks a folder on disk; waits up to 10 s for another writer.
    ///
    /// # Errors
    /// If another program is still writing there, or the file cannot be made or is not vibro's.
    pub(super) fn of(folder: &Path) -> Result<Lock> {
        let (path, began) = (folder.join(Lock::FILE), Instant::now());
        let strange = || {
            Error::input(Place::file(&path), "not the file of vibro that has this name", "none of this name")
                .hint("move it to another place")
        };
        let refused = |e| {
            if path.exists() { Error::io("open", &path, e) } else { Error::io("write", folder, e) }
        };
        loop {
            if std::fs::symlink_metadata(&path).is_ok_and(|meta| !meta.is_file()) {
                return Err(strange());
            }
            let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            // The lock file of another user may be read-only: it can be locked without the right to write.
            let file = open.or_else(|e| File::open(&path).map_err(|_| e));
            let mut file = file.map_err(refused)?;
            let mut process = String::new();
            // On some systems a locked file cannot be read.
            let read = file.read_to_string(&mut process);
            match file.try_lock() {
                Err(TryLockError::WouldBlock) if began.elapsed() < PATIENCE => sleep(PAUSE),
                Err(TryLockError::WouldBlock) => {
                    let who =
                        if process.is_empty() { "another vibro" } else { &*format!("process {process}") };
                    let found = format!("{who} is writing into this folder");
                    return Err(Error::input(Place::file(folder), found, "one writer at a time")
                        .hint("end that process or wait for it, then run the same command again"));
                }
                Ok(()) if read.is_err() || !process.bytes().all(|c| c.is_ascii_digit()) => {
                    return Err(strange());
                }
                // Some network drives have no locks: the folder is then written without one. If the
                // previous writer removed the file between opening and locking here, the loop opens it
                // again.
                Ok(()) | Err(TryLockError::Error(_)) if is_at(&path, &file) => {
                    let _ = file.set_len(0).and_then(|()| file.rewind());
                    let _ = write!(file, "{}", std::process::id());
                    return Ok(Lock { path, _file: file });
                }
                _ => {}
            }
        }
    }
}

/// Whether a path still leads to the file that was opened there.
fn is_at(path: &Path, file: &File) -> bool {
    let opened = file.try_clone().and_then(same_file::Handle::from_file);
    same_file::Handle::from_path(path).ok() == opened.ok()
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that cannot be removed is taken over by the next writer.
        let _ = std::fs::remove_file(&self.path);
    }
}
