//! Answers and pictures that are kept for the next run: asked again is only what rests on other words, other
//! files or another program.

use crate::error::Result;
use crate::read::{Digest, Folder};
use crate::report::Output;
use rmp_serde::config::BytesMode;
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

/// Length and time of a file.
type Stamp = Option<(u64, SystemTime)>;

/// Answers and pictures by the digest of all that they rest on.
#[derive(Debug, Default)]
pub struct AnswerCache {
    /// Where files lie.
    folder: Folder,
    /// Those of the last run.
    old: BTreeMap<Digest, Vec<u8>>,
    /// Those of this run.
    now: Mutex<BTreeMap<Digest, Vec<u8>>>,
    /// Digests of files, and what they looked like before they were read for it.
    files: Mutex<BTreeMap<PathBuf, (Digest, Stamp)>>,
}

impl AnswerCache {
    /// The file of a folder of results in which they are kept.
    pub const FILE: &str = Output::KEPT;

    /// Nothing is known of an earlier run.
    pub fn none(folder: &Folder) -> AnswerCache {
        AnswerCache { folder: folder.clone(), ..AnswerCache::default() }
    }

    /// What the last run of this very program kept in a folder of results; nothing where that cannot be read.
    pub fn of(folder: &Folder) -> AnswerCache {
        let kept = AnswerCache::none(folder);
        let old = folder.own_file(AnswerCache::FILE).and_then(|bytes| {
            let (sum, rest) = bytes.split_at_checked(size_of::<Digest>())?;
            let (program, old): (Digest, BTreeMap<Digest, Vec<u8>>) =
                rmp_serde::from_slice(rest).ok().filter(|_| digest([rest]) == *sum)?;
            (Some(program) == kept.program()).then_some(old)
        });
        AnswerCache { old: old.unwrap_or_default(), ..kept }
    }

    /// Whether the last run left this.
    pub fn is_old(&self, on: &Digest) -> bool {
        self.old.contains_key(on)
    }

    /// What rests on this, as it was kept; else it is made, and kept unless one of the files changed
    /// meanwhile.
    ///
    /// # Errors
    /// Those of making it; they are not kept.
    pub fn or_make<T>(&self, on: Digest, files: &[PathBuf], make: impl FnOnce() -> Result<T>) -> Result<T>
    where
        T: Serialize + DeserializeOwned,
    {
        let known = locked(&self.now).get(&on).or_else(|| self.old.get(&on)).cloned();
        let known = known.and_then(|bytes| Some((rmp_serde::from_slice(&bytes).ok()?, bytes)));
        if let Some((found, bytes)) = known {
            locked(&self.now).insert(on, bytes);
            return Ok(found);
        }
        let made = make()?;
        let known = |path: &PathBuf| locked(&self.files).get(path).map(|(_, before)| *before);
        if files.iter().all(|path| known(path) == Some(self.folder.stamp(path))) {
            locked(&self.now).extend(packed(&made).map(|bytes| (on, bytes)));
        }
        Ok(made)
    }

    /// What this run keeps for the next.
    pub fn bytes(&self) -> Vec<u8> {
        let rest = packed(&(self.program(), &*locked(&self.now))).unwrap_or_default();
        [&digest([&rest])[..], &rest].concat()
    }

    /// The digest of a file, which is read once.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn file(&self, path: &Path) -> Result<Digest> {
        if let Some(known) = locked(&self.files).get(path) {
            return Ok(known.0);
        }
        let before = self.folder.stamp(path);
        let digest = self.folder.digest(path)?;
        locked(&self.files).insert(path.to_owned(), (digest, before));
        Ok(digest)
    }

    /// The digest of the program that runs.
    pub fn program(&self) -> Option<Digest> {
        static OWN: OnceLock<Option<Digest>> = OnceLock::new();
        *OWN.get_or_init(|| Folder::default().digest(&std::env::current_exe().ok()?).ok())
    }
}

/// The digest of several things, told apart by their lengths.
pub fn digest<T: AsRef<[u8]>>(parts: impl IntoIterator<Item = T>) -> Digest {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.as_ref().len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().into()
}

/// A value as `MessagePack`, which holds numbers that are missing.
pub fn packed(value: &impl Serialize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut packer = rmp_serde::Serializer::new(&mut bytes).with_bytes(BytesMode::ForceIterables);
    value.serialize(&mut packer).ok().map(|()| bytes)
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
