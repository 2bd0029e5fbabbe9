//! Where bytes come from: a file on disk or a buffer in memory.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use vibro_record::{Error, Place, Result};

/// How many bytes [`Source::head`] returns at most: enough to tell every format apart.
pub(crate) const HEAD: usize = 64 * 1024;

/// Bytes that can be opened several times, by several threads.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    path: PathBuf,
    len: u64,
    bytes: Option<std::sync::Arc<[u8]>>,
}

/// Something to read from and to seek in.
pub(crate) trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}

impl Source {
    /// A file on disk.
    ///
    /// # Errors
    /// If it cannot be opened, is a folder, or is empty.
    pub fn file(path: impl AsRef<Path>) -> Result<Source> {
        let path = path.as_ref();
        let info = std::fs::metadata(path).map_err(|e| Error::io("open", path, e))?;
        if info.is_dir() {
            return Err(Error::input(Place::file(path), "this is a folder", "a measurement file")
                .hint("name a file in it"));
        }
        Source { path: path.to_owned(), len: info.len(), bytes: None }.not_empty()
    }

    /// Bytes in memory; `name` stands for the path in messages.
    ///
    /// # Errors
    /// If there are none.
    pub fn memory(name: impl Into<PathBuf>, bytes: impl Into<std::sync::Arc<[u8]>>) -> Result<Source> {
        let bytes = bytes.into();
        Source { path: name.into(), len: bytes.len() as u64, bytes: Some(bytes) }.not_empty()
    }

    fn not_empty(self) -> Result<Source> {
        if self.len == 0 {
            return Err(Error::input(Place::file(&self.path), "the file is empty", "measurement data")
                .hint("export the record again; the instrument may have been stopped before it wrote"));
        }
        Ok(self)
    }

    /// Path, for messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// File name without its folder.
    pub fn name(&self) -> String {
        self.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }

    /// Lower-case ending without the dot; empty where there is none.
    pub fn extension(&self) -> String {
        self.path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase())
    }

    /// Number of bytes.
    #[allow(clippy::len_without_is_empty)] // an empty source cannot be made
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Opens it at its first byte. Wrap in a `BufReader` for small reads.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn open(&self) -> Result<Box<dyn ReadSeek>> {
        Ok(match &self.bytes {
            Some(bytes) => Box::new(Cursor::new(bytes.clone())),
            None => Box::new(File::open(&self.path).map_err(|e| Error::io("open", &self.path, e))?),
        })
    }

    /// The first 64 KiB, or all if there are fewer.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn head(&self) -> Result<Vec<u8>> {
        let mut head = Vec::with_capacity(HEAD.min(self.len as usize));
        self.open()?
            .take(HEAD as u64)
            .read_to_end(&mut head)
            .map_err(|e| Error::io("read", &self.path, e))?;
        Ok(head)
    }

    /// All bytes.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn all(&self) -> Result<Vec<u8>> {
        if let Some(bytes) = &self.bytes {
            return Ok(bytes.to_vec());
        }
        std::fs::read(&self.path).map_err(|e| Error::io("read", &self.path, e))
    }
}
