//! Source of the bytes of a measurement: a file on disk or a buffer in memory.

use crate::recording::Recording;
use std::borrow::Cow;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use vibro_record::{Error, Place, Result};

/// Largest number of bytes that [`Source::head`] returns: enough to tell every format apart.
const HEAD: usize = 64 * 1024;

/// Path that means standard input.
const PIPE: &str = "-";

/// Bytes read from standard input so far: a second reader gets the same bytes.
static STDIN: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// Bytes that can be opened several times, by several threads.
#[derive(Debug)]
pub(crate) struct Source {
    path: PathBuf,
    len: u64,
    /// All bytes of a small file or a buffer, the first ones of a larger file.
    bytes: Arc<Vec<u8>>,
    /// For the text of a workbook's sheet: the sheet's first column, counted from 0.
    sheet: Option<u32>,
    /// Records that were made in memory; there are no bytes then.
    recording: Option<Arc<Recording>>,
}

/// An input that can be read and positioned (`Seek`).
pub(crate) trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}

impl Source {
    /// A file on disk; `-` is standard input, kept in memory.
    ///
    /// # Errors
    /// If it cannot be opened, is a folder, a pipe or a device, or is empty.
    pub fn file(path: impl AsRef<Path>) -> Result<Source> {
        let path = path.as_ref();
        if path == Path::new(PIPE) {
            let mut held = STDIN.lock().unwrap_or_else(PoisonError::into_inner);
            std::io::stdin()
                .lock()
                .read_to_end(&mut held)
                .map_err(|e| Error::io("read", "standard input", e))?;
            return Source::memory(PIPE, held.clone());
        }
        let info = std::fs::metadata(path).map_err(|e| {
            if path.to_string_lossy().contains(['*', '?']) {
                return Error::usage(format!("no file, or more than one, matches {}", path.display()), "")
                    .hint("name one file; vibro run FOLDER takes all files of a folder");
            }
            Error::io("open", path, e)
        })?;
        if info.is_dir() {
            return Err(Error::input(Place::file(path), "this is a folder", "a measurement file")
                .hint(format!("vibro run {}", path.display())));
        }
        if !info.is_file() {
            return Err(Error::input(Place::file(path), "not a regular file", "a measurement file")
                .hint("a pipe is read as -"));
        }
        let mut bytes = Vec::with_capacity(HEAD.min(info.len() as usize + 1));
        File::open(path)
            .and_then(|file| file.take(HEAD as u64).read_to_end(&mut bytes))
            .map_err(|e| Error::io("read", path, e))?;
        let len = if bytes.len() < HEAD { bytes.len() as u64 } else { info.len() };
        let bytes = Arc::new(bytes);
        Source { path: path.to_owned(), len, bytes, sheet: None, recording: None }.not_empty()
    }

    /// Bytes in memory; `name` stands for the path in messages.
    ///
    /// # Errors
    /// If there are none.
    pub fn memory(name: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Result<Source> {
        Source::shared(name, Arc::new(bytes.into()))
    }

    /// As [`Source::memory`], of bytes that others hold too: they are not copied.
    ///
    /// # Errors
    /// If there are none.
    pub fn shared(name: impl Into<PathBuf>, bytes: Arc<Vec<u8>>) -> Result<Source> {
        Source { path: name.into(), len: bytes.len() as u64, bytes, sheet: None, recording: None }.not_empty()
    }

    /// Records that were made in memory.
    pub fn recording(recording: Arc<Recording>) -> Source {
        let (path, bytes) = (recording.path.clone(), Arc::default());
        Source { path, len: 0, bytes, sheet: None, recording: Some(recording) }
    }

    /// The records, if they were made in memory.
    pub fn in_records(&self) -> Option<&Recording> {
        self.recording.as_deref()
    }

    /// Marks the text as the sheet of a workbook whose cells begin in column `first`, counted from 0.
    #[cfg(feature = "sheets")]
    pub fn of_sheet(self, first: u32) -> Source {
        Source { sheet: Some(first), ..self }
    }

    /// Whether it is the sheet of a workbook, which is read as a table, like CSV.
    pub fn is_sheet(&self) -> bool {
        self.sheet.is_some()
    }

    /// Name of a sheet's cell, such as `B2`, at a character of the sheet's text; line and column count from
    /// 1.
    pub fn cell(&self, line: u64, column: u64) -> Option<String> {
        let first = self.sheet?;
        let text = str::from_utf8(self.in_memory()?).ok()?.lines().nth(line.checked_sub(1)? as usize)?;
        let before = text.chars().take(column.saturating_sub(1) as usize);
        let mut at = first as usize + before.filter(|c| *c == '\t').count() + 1;
        let mut letters = Vec::new();
        while at > 0 {
            letters.push(char::from(b'A' + ((at - 1) % 26) as u8));
            at = (at - 1) / 26;
        }
        Some(letters.iter().rev().collect::<String>() + &line.to_string())
    }

    /// The same source with other bytes.
    ///
    /// # Errors
    /// As [`Source::memory`].
    pub fn with_bytes(&self, bytes: impl Into<Vec<u8>>) -> Result<Source> {
        Ok(Source { sheet: self.sheet, ..Source::memory(&self.path, bytes)? })
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

    /// Lower-case file ending without the dot; empty if there is none.
    pub fn extension(&self) -> String {
        self.path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase())
    }

    /// Number of bytes.
    #[allow(clippy::len_without_is_empty)] // an empty source cannot be made
    pub fn len(&self) -> u64 {
        self.len
    }

    /// The first 64 KiB, or all if there are fewer.
    pub fn head(&self) -> &[u8] {
        &self.bytes[..self.bytes.len().min(HEAD)]
    }

    /// All bytes, if they are in memory.
    pub fn in_memory(&self) -> Option<&[u8]> {
        self.is_whole().then_some(&self.bytes)
    }

    /// Whether all bytes are in memory.
    fn is_whole(&self) -> bool {
        self.bytes.len() as u64 == self.len
    }

    /// All bytes.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn all(&self) -> Result<Cow<'_, [u8]>> {
        match self.in_memory() {
            Some(bytes) => Ok(bytes.into()),
            None => Ok(std::fs::read(&self.path).map_err(|e| Error::io("read", &self.path, e))?.into()),
        }
    }

    /// Opens it at its first byte. Wrap in a `BufReader` for small reads.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn open(&self) -> Result<Box<dyn ReadSeek>> {
        if self.is_whole() {
            return Ok(Box::new(Cursor::new(Shared(self.bytes.clone()))));
        }
        Ok(Box::new(File::open(&self.path).map_err(|e| Error::io("open", &self.path, e))?))
    }
}

/// Bytes that several readers hold.
pub(crate) struct Shared(pub Arc<Vec<u8>>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
