//! Cache of answers and figures for the next run. They are computed again only if their keys, their files or
//! the program changed.

use crate::error::Result;
use crate::read::{Digest, Folder};
use crate::report::Output;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_bytes::ByteBuf;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

/// Size and modification time of a file.
type Stamp = Option<(u64, SystemTime)>;

/// Answers and pictures by a digest of all their inputs.
#[derive(Debug, Default)]
pub struct AnswerCache {
    /// Folder through which the files are read.
    folder: Folder,
    /// Answers of the last run.
    old: BTreeMap<Digest, ByteBuf>,
    /// Answers of this run.
    now: Mutex<BTreeMap<Digest, ByteBuf>>,
    /// Digests of files, with the size and modification time of each before it was hashed. A different stamp
    /// later shows that the file changed.
    files: Mutex<BTreeMap<PathBuf, (Digest, Stamp)>>,
}

impl AnswerCache {
    /// Name of the cache file in a folder of results.
    pub const FILE: &str = Output::KEPT;

    /// A cache without an earlier run.
    pub fn none(folder: &Folder) -> AnswerCache {
        AnswerCache { folder: folder.clone(), ..AnswerCache::default() }
    }

    /// The cache that the last run wrote to a folder of results; empty if it cannot be read, or if another
    /// build of the program wrote it.
    pub fn of(folder: &Folder) -> AnswerCache {
        let cache = AnswerCache::none(folder);
        let old = folder.own_file(AnswerCache::FILE).and_then(|bytes| {
            let (sum, rest) = bytes.split_at_checked(size_of::<Digest>())?;
            let (program, old): (Digest, BTreeMap<Digest, ByteBuf>) =
                rmp_serde::from_slice(rest).ok().filter(|_| digest([rest]) == *sum)?;
            (Some(program) == cache.program()).then_some(old)
        });
        AnswerCache { old: old.unwrap_or_default(), ..cache }
    }

    /// Whether the last run cached an answer for these inputs.
    pub fn is_old(&self, inputs: &Digest) -> bool {
        self.old.contains_key(inputs)
    }

    /// The cached answer for the digest `inputs`, else the one that `make` computes, which is then cached.
    ///
    /// Call [`file`](Self::file) on each of `files` first. An answer is not cached if one of them changed
    /// since, or was not hashed.
    ///
    /// # Errors
    /// Those of `make`; they are not cached.
    pub fn or_make<T>(&self, inputs: Digest, files: &[PathBuf], make: impl FnOnce() -> Result<T>) -> Result<T>
    where
        T: Serialize + DeserializeOwned,
    {
        let cached = locked(&self.now).get(&inputs).or_else(|| self.old.get(&inputs)).cloned();
        let cached = cached.and_then(|bytes| Some((rmp_serde::from_slice(&bytes).ok()?, bytes)));
        if let Some((answer, bytes)) = cached {
            locked(&self.now).insert(inputs, bytes);
            return Ok(answer);
        }
        let made = make()?;
        let hashed_stamp = |path: &PathBuf| locked(&self.files).get(path).map(|(_, stamp)| *stamp);
        if files.iter().all(|path| hashed_stamp(path) == Some(self.folder.stamp(path))) {
            locked(&self.now).extend(packed(&made).map(|bytes| (inputs, ByteBuf::from(bytes))));
        }
        Ok(made)
    }

    /// Content of the cache file: a digest of the rest, then the digest of the program and the answers of
    /// this run.
    pub fn bytes(&self) -> Vec<u8> {
        let rest = packed(&(self.program(), &*locked(&self.now))).unwrap_or_default();
        [&digest([&rest])[..], &rest].concat()
    }

    /// The digest of a file. A file is read for it once in a run.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn file(&self, path: &Path) -> Result<Digest> {
        if let Some((digest, _)) = locked(&self.files).get(path) {
            return Ok(*digest);
        }
        let stamp = self.folder.stamp(path);
        let digest = self.folder.digest(path)?;
        locked(&self.files).insert(path.to_owned(), (digest, stamp));
        Ok(digest)
    }

    /// The digest of the running program; in a browser, where it has no file, of its version.
    pub fn program(&self) -> Option<Digest> {
        static PROGRAM: OnceLock<Option<Digest>> = OnceLock::new();
        let of_version = || digest([env!("CARGO_PKG_VERSION")]);
        let of_file = || Folder::default().digest(&std::env::current_exe().ok()?).ok();
        *PROGRAM.get_or_init(|| if cfg!(target_family = "wasm") { Some(of_version()) } else { of_file() })
    }
}

/// The digest of several parts with the length of each, so that the same bytes in other parts have another
/// digest.
pub fn digest<T: AsRef<[u8]>>(parts: impl IntoIterator<Item = T>) -> Digest {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.as_ref().len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().into()
}

/// A value as `MessagePack`, which can represent NaN.
pub fn packed(value: &impl Serialize) -> Option<Vec<u8>> {
    rmp_serde::to_vec(value).ok()
}

/// The content of a mutex; also of one that is poisoned by the panic of another thread.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
