//! A part of a study: its head in one line, then its cells in the order of their numbers, then a SHA-256.
//!
//! A cell is its length (4 bytes, little-endian), its bytes, and the CRC-32 of its number (8 bytes,
//! little-endian) and its bytes. The end is a length of 2³² − 1 and the SHA-256 of all that precedes. A part
//! is written from front to back: a program that is killed leaves a part without its end, and perhaps with
//! half a cell, which is cut off when the part is continued. There is no fsync: after a power failure cells
//! may be damaged or missing, which the CRC-32 shows.

use super::{Computed, PartHead, Progress, Study};
use crate::error::{Error, Place, Result};
use crate::record::shown;
use crc32fast::Hasher;
use sha2::{Digest as _, Sha256};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Length that marks the end of a part.
pub(super) const END: u32 = u32::MAX;
/// Largest cell in bytes that is believed: a damaged length must not ask for more memory.
const LARGEST_CELL: u32 = 1 << 30;
/// Longest head in bytes that is read.
const LONGEST_HEAD: u64 = 1 << 26;

/// A part in a folder, all its cells computed.
#[derive(Debug)]
pub struct WrittenPart {
    /// Its file.
    pub path: PathBuf,
    /// Number of cells that were there before.
    pub kept: u64,
    /// Number of bytes behind these cells that were cut off: half a cell, or what was damaged.
    pub cut: u64,
    /// What cells computed now say that have no answer.
    pub complaints: Vec<String>,
}

/// Computes a part into a folder, or what is missing of one that is there.
///
/// # Errors
/// If the folder or the file cannot be written, if another program is computing this part, if the file is no
/// part, or another one; those of the cells.
pub fn write_part(
    folder: &Path,
    study: &dyn Study,
    head: &PartHead,
    progress: &dyn Progress,
) -> Result<WrittenPart> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
    let path = folder.join(head.file());
    let failed = |e| Error::io("write", &path, e);
    if std::fs::symlink_metadata(&path).is_ok_and(|meta| !meta.is_file()) {
        return Err(no_part(&path, "is a link, a folder or a device"));
    }
    // A part that is whole may lie where nothing can be written.
    let is_whole = matches!(Present::of(&path, head)?, Present::Whole);
    let mut part = WrittenPart { path: path.clone(), kept: 0, cut: 0, complaints: Vec::new() };
    if is_whole && study.keeps() {
        return Ok(WrittenPart { kept: head.cells(), ..part });
    }
    let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
    let file = opened.map_err(failed)?;
    // Some network drives have no locks.
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        let found = "another vibro is computing this part";
        return Err(Error::input(Place::file(&path), found, "one program a part").hint("wait for it to end"));
    }
    let mut cells = CellWriter::new(&path, &file, Sha256::new());
    // Another program may have written before the file was locked.
    match Present::of(&path, head)? {
        Present::Cells { kept, end, hash } if study.keeps() => {
            part.kept = kept;
            part.cut = file.metadata().map_err(failed)?.len() - end;
            cut(&file, end).map_err(failed)?;
            cells.hash = *hash;
        }
        _ => {
            cut(&file, 0).map_err(failed)?;
            cells.put(&head_line(head)?)?;
        }
    }
    let missing = head.shard.cells(head.all).skip(part.kept as usize);
    part.complaints = cells.compute(study, missing, head.cells() - part.kept, progress)?;
    cells.end()?;
    Ok(part)
}

/// Cuts off what follows `end`, and goes there.
fn cut(mut file: &File, end: u64) -> io::Result<()> {
    file.set_len(end)?;
    file.seek(SeekFrom::Start(end)).map(drop)
}

/// What is there of a part.
#[derive(Debug, Clone)]
enum Present {
    /// No file, an empty one, zeros that a power failure left, or the beginning of the head.
    Nothing,
    /// A number of cells up to a position in bytes, with the SHA-256 of all before it.
    Cells { kept: u64, end: u64, hash: Box<Sha256> },
    /// All cells.
    Whole,
}

impl Present {
    /// Reads what is there of the part with this head.
    ///
    /// # Errors
    /// If it is no part, or another one, or cannot be read.
    fn of(path: &Path, head: &PartHead) -> Result<Present> {
        let file = match File::open(path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Present::Nothing),
            opened => opened.map_err(|e| Error::io("open", path, e))?,
        };
        let failed = |e| Error::io("read", path, e);
        let first_line = head_line(head)?;
        let mut known = Vec::new();
        (&file).take(first_line.len() as u64).read_to_end(&mut known).map_err(failed)?;
        let begun = known.len() < first_line.len() && first_line.starts_with(&known);
        if begun || known.iter().all(|byte| *byte == 0) && is_zero(&file).map_err(failed)? {
            return Ok(Present::Nothing);
        }
        (&file).rewind().map_err(failed)?;
        let mut there = PartReader::new(path, BufReader::new(&file))?;
        if let Some(difference) = there.head.difference(head) {
            let found = format!("another part or study: {difference}");
            let folder = path.parent().unwrap_or(path);
            return Err(Error::input(Place::file(path), found, "this part of this study")
                .hint(format!("another folder than {}", shown(folder))));
        }
        let mut bytes = Vec::new();
        while there.next(&mut bytes)? {}
        if there.whole {
            return Ok(Present::Whole);
        }
        Ok(Present::Cells { kept: there.read, end: there.end, hash: Box::new(there.hash) })
    }
}

/// Whether the rest of a file has only zeros.
fn is_zero(mut file: &File) -> io::Result<bool> {
    let mut part = vec![0; 1 << 16];
    loop {
        match file.read(&mut part)? {
            0 => return Ok(true),
            n if part[..n].iter().any(|byte| *byte != 0) => return Ok(false),
            _ => {}
        }
    }
}

/// Computes a part in memory: the bytes of its file.
///
/// # Errors
/// Those of the cells.
pub fn part_in_memory(study: &dyn Study, head: &PartHead, progress: &dyn Progress) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut cells = CellWriter::new(Path::new("memory"), &mut bytes, Sha256::new());
    cells.put(&head_line(head)?)?;
    cells.compute(study, head.shard.cells(head.all), head.cells(), progress)?;
    cells.end()?;
    Ok(bytes)
}

/// The first line of a part.
fn head_line(head: &PartHead) -> Result<Vec<u8>> {
    let line = serde_json::to_string(head).map_err(crate::analysis::answer::unwritten)?;
    Ok((line + "\n").into_bytes())
}

/// Error of a file that is no part.
pub(super) fn no_part(path: &Path, what: &str) -> Error {
    Error::input(Place::file(path), what.to_owned(), "a part that vibro wrote with --shard")
        .hint("another folder for parts, or move this file away")
}

/// Writes the cells of a part.
struct CellWriter<'a, W> {
    path: &'a Path,
    out: W,
    hash: Sha256,
    /// Bytes not written yet.
    waiting: Vec<u8>,
}

impl<'a, W: Write> CellWriter<'a, W> {
    fn new(path: &'a Path, out: W, hash: Sha256) -> CellWriter<'a, W> {
        CellWriter { path, out, hash, waiting: Vec::new() }
    }

    /// Computes and writes the cells with these numbers, `all` of them; returns what those say that have no
    /// answer.
    fn compute(
        &mut self,
        study: &dyn Study,
        numbers: impl Iterator<Item = u64>,
        all: u64,
        progress: &dyn Progress,
    ) -> Result<Vec<String>> {
        let mut computed = Computed::new(study, numbers, all, progress);
        let mut complaints = Vec::new();
        while let Some((number, bytes)) = computed.next() {
            let bytes = bytes.or_else(|error| self.flush().and(Err(error)))?;
            complaints.extend(study.complaint(&bytes));
            self.waiting.extend((bytes.len() as u32).to_le_bytes());
            self.waiting.extend(&bytes);
            self.waiting.extend(checked(number, &bytes).to_le_bytes());
            if computed.at_end_of_batch() {
                self.flush()?;
            }
        }
        Ok(complaints)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.waiting.extend(bytes);
        self.flush()
    }

    fn flush(&mut self) -> Result<()> {
        self.hash.update(&self.waiting);
        let written = self.out.write_all(&self.waiting).and_then(|()| self.out.flush());
        self.waiting.clear();
        written.map_err(|e| Error::io("write", self.path, e))
    }

    fn end(&mut self) -> Result<()> {
        let hash = self.hash.clone().finalize();
        self.put(&[&END.to_le_bytes()[..], &hash[..]].concat())
    }
}

/// The CRC-32 of a cell.
fn checked(number: u64, bytes: &[u8]) -> u32 {
    let mut check = Hasher::new();
    check.update(&number.to_le_bytes());
    check.update(bytes);
    check.finalize()
}

/// Reads the cells of a part from its start.
pub(super) struct PartReader<R> {
    path: PathBuf,
    from: R,
    pub head: PartHead,
    /// Number of cells read.
    pub read: u64,
    /// Position in bytes after the last whole cell.
    pub end: u64,
    /// Whether the end of the part was reached, with the SHA-256 that it states.
    pub whole: bool,
    hash: Sha256,
    numbers: Box<dyn Iterator<Item = u64>>,
}

impl<R: BufRead> PartReader<R> {
    /// Reads the head.
    ///
    /// # Errors
    /// If it is not that of a part, or cannot be read.
    pub fn new(path: &Path, mut from: R) -> Result<PartReader<R>> {
        let mut line = Vec::new();
        let read = from.by_ref().take(LONGEST_HEAD).read_until(b'\n', &mut line);
        read.map_err(|e| Error::io("read", path, e))?;
        let head: PartHead =
            serde_json::from_slice(&line).map_err(|_| no_part(path, "does not begin as a part does"))?;
        let numbers = Box::new(head.shard.cells(head.all));
        let (end, hash) = (line.len() as u64, Sha256::new_with_prefix(&line));
        Ok(PartReader { path: path.to_owned(), from, head, read: 0, end, whole: false, hash, numbers })
    }

    /// Reads the next cell into `bytes`; false if there is none, or none that is whole.
    ///
    /// # Errors
    /// If the part cannot be read, or something follows its end.
    pub fn next(&mut self, bytes: &mut Vec<u8>) -> Result<bool> {
        let found = self.next_of(bytes).map_err(|e| Error::io("read", &self.path, e))?;
        if self.whole && filled(&mut self.from, &mut [0]).map_err(|e| Error::io("read", &self.path, e))? {
            return Err(no_part(&self.path, "was changed: something follows its end"));
        }
        Ok(found)
    }

    fn next_of(&mut self, bytes: &mut Vec<u8>) -> io::Result<bool> {
        let (mut length, mut check) = ([0; 4], [0; 4]);
        if !filled(&mut self.from, &mut length)? {
            return Ok(false);
        }
        let n = u32::from_le_bytes(length);
        if n == END {
            let mut stated = [0; 32];
            self.whole = filled(&mut self.from, &mut stated)?
                && self.numbers.next().is_none()
                && self.hash.clone().finalize()[..] == stated;
            return Ok(false);
        }
        bytes.clear();
        if n > LARGEST_CELL
            || self.from.by_ref().take(u64::from(n)).read_to_end(bytes)? < n as usize
            || !filled(&mut self.from, &mut check)?
        {
            return Ok(false);
        }
        let Some(number) = self.numbers.next() else { return Ok(false) };
        if checked(number, bytes) != u32::from_le_bytes(check) {
            return Ok(false);
        }
        for part in [&length[..], bytes, &check[..]] {
            self.hash.update(part);
        }
        self.end += u64::from(n) + 8;
        self.read += 1;
        Ok(true)
    }
}

/// Fills `bytes`; false at the end of the file.
fn filled(from: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match from.read_exact(bytes) {
        Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        other => other.map(|()| true),
    }
}
