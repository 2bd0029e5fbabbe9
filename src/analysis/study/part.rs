//! A part of a study: its head in one line, then its cells in the order of their numbers, then a SHA-256.
//!
//! A cell is its length (4 bytes, little-endian), its bytes, and the CRC-32 of its number (8 bytes,
//! little-endian) and its bytes. The end is a length of 2³² − 1 and the SHA-256 of all that precedes. A part
//! is written from front to back: a program that is killed leaves a part without its end, and perhaps with
//! half a cell, which is cut off when the part is continued. There is no fsync: what a power failure damages
//! is found by the CRC-32, and computed anew.

use super::{Computed, PartHead, Progress, Study};
use crate::error::{Error, Place, Result};
use crate::record::shown;
use crc32fast::Hasher;
use sha2::{Digest as _, Sha256};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Length that marks the end of a part.
const END: u32 = u32::MAX;
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
}

/// Computes a part into a folder, or what is missing of one that is there.
///
/// # Errors
/// If the folder or the file cannot be written, if another program is computing this part, if the file is no
/// part, or one of another study; those of the cells.
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
        return Err(no_part(&path.display().to_string(), "is a link, a folder or a device"));
    }
    let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
    let mut file = opened.map_err(failed)?;
    // Some network drives have no locks.
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        let found = "another vibro is computing this part";
        return Err(Error::input(Place::file(&path), found, "one program a part").hint("wait for it to end"));
    }
    let first_line = head_line(head)?;
    let mut known = Vec::new();
    (&file).take(first_line.len() as u64).read_to_end(&mut known).map_err(failed)?;
    let (mut cells, mut kept) = (CellWriter::new(&file, Sha256::new()), 0);
    if known.len() < first_line.len() && first_line.starts_with(&known) {
        // New, or killed within its first line.
        restart(&file, 0).map_err(failed)?;
        cells.put(&first_line).map_err(failed)?;
    } else {
        file.rewind().map_err(failed)?;
        let mut there = PartReader::new(&path.display().to_string(), BufReader::new(&file))?;
        if let Some(difference) = there.head.difference(head) {
            let found = format!("a part of another study: {difference}");
            return Err(Error::input(Place::file(&path), found, "a part of this study")
                .hint(format!("another folder for this study than {}", shown(folder))));
        }
        let mut bytes = Vec::new();
        while there.next(&mut bytes)? {
            kept += 1;
        }
        if there.whole {
            return Ok(WrittenPart { path, kept });
        }
        let (end, hash) = (there.end, there.hash);
        restart(&file, end).map_err(failed)?;
        cells = CellWriter::new(&file, hash);
    }
    let missing = head.shard.cells(head.all).skip(kept as usize);
    cells.compute(study, missing, progress).and_then(|()| cells.end().map_err(failed))?;
    Ok(WrittenPart { path, kept })
}

/// Cuts off what follows `end`, and goes there.
fn restart(mut file: &File, end: u64) -> io::Result<()> {
    file.set_len(end)?;
    file.seek(SeekFrom::Start(end)).map(drop)
}

/// Computes a part in memory: the bytes of its file.
///
/// # Errors
/// Those of the cells.
pub fn part_in_memory(study: &dyn Study, head: &PartHead, progress: &dyn Progress) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut cells = CellWriter::new(&mut bytes, Sha256::new());
    let failed = |e| Error::io("write", "memory", e);
    cells.put(&head_line(head)?).map_err(failed)?;
    cells.compute(study, head.shard.cells(head.all), progress)?;
    cells.end().map_err(failed)?;
    Ok(bytes)
}

/// The first line of a part.
fn head_line(head: &PartHead) -> Result<Vec<u8>> {
    let line = serde_json::to_string(head).map_err(crate::analysis::answer::unwritten)?;
    Ok((line + "\n").into_bytes())
}

/// Error of a file that is no part.
fn no_part(name: &str, what: &str) -> Error {
    Error::input(Place::file(Path::new(name)), what.to_owned(), "a part that vibro wrote with --shard")
        .hint("another folder for parts, or move this file away")
}

/// Writes the cells of a part.
struct CellWriter<W> {
    out: W,
    hash: Sha256,
    /// Bytes not written yet.
    waiting: Vec<u8>,
}

impl<W: Write> CellWriter<W> {
    fn new(out: W, hash: Sha256) -> CellWriter<W> {
        CellWriter { out, hash, waiting: Vec::new() }
    }

    fn compute(
        &mut self,
        study: &dyn Study,
        numbers: impl Iterator<Item = u64>,
        progress: &dyn Progress,
    ) -> Result<()> {
        let all: Vec<u64> = numbers.collect();
        let mut computed = Computed::new(study, all.iter().copied(), progress);
        for number in &all {
            let Some(bytes) = computed.next() else { break };
            let bytes = bytes.inspect_err(|_| drop(self.flush()))?;
            self.waiting.extend((bytes.len() as u32).to_le_bytes());
            self.waiting.extend(&bytes);
            self.waiting.extend(checked(*number, &bytes).to_le_bytes());
            if computed.at_end_of_batch() {
                self.flush().map_err(|e| Error::io("write", "a part", e))?;
            }
        }
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.waiting.extend(bytes);
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        self.hash.update(&self.waiting);
        self.out.write_all(&self.waiting)?;
        self.waiting.clear();
        self.out.flush()
    }

    fn end(&mut self) -> io::Result<()> {
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
    name: String,
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
    pub fn new(name: &str, mut from: R) -> Result<PartReader<R>> {
        let mut line = Vec::new();
        let read = from.by_ref().take(LONGEST_HEAD).read_until(b'\n', &mut line);
        read.map_err(|e| Error::io("read", name, e))?;
        let head: PartHead =
            serde_json::from_slice(&line).map_err(|_| no_part(name, "does not begin as a part does"))?;
        let numbers = Box::new(head.shard.cells(head.all));
        let (end, hash) = (line.len() as u64, Sha256::new_with_prefix(&line));
        Ok(PartReader { name: name.to_owned(), from, head, read: 0, end, whole: false, hash, numbers })
    }

    /// Reads the next cell into `bytes`; false if there is none, or none that is whole.
    ///
    /// # Errors
    /// If the part cannot be read.
    pub fn next(&mut self, bytes: &mut Vec<u8>) -> Result<bool> {
        self.next_of(bytes).map_err(|e| Error::io("read", &self.name, e))
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
