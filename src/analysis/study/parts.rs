//! All parts of a study, and their cells in the order of their numbers.

use super::head::PartHead;
use super::part::{END, PartReader, no_part};
use super::{Progress, Shard};
use crate::error::{Error, Place, Result};
use crate::record::shown;
use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The parts of one study.
#[derive(Debug)]
pub struct Parts {
    /// Head of the first part that was read.
    pub head: PartHead,
    /// Its file.
    first: PathBuf,
    /// Parts that are whole, by their numbers.
    whole: BTreeMap<u64, Part>,
    /// Parts that lack cells, by their numbers, with the numbers of cells that they have.
    begun: BTreeMap<u64, (PathBuf, u64)>,
}

/// A part, and where its next cells are read.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    content: Content,
    /// Position in bytes after the head.
    cells_from: u64,
}

#[derive(Debug, Clone)]
enum Content {
    File,
    Memory(Arc<[u8]>),
}

/// Bytes of a part.
trait Bytes: Read + Seek {}
impl<T: Read + Seek> Bytes for T {}

impl Content {
    fn open(&self, path: &Path) -> std::io::Result<Box<dyn Bytes>> {
        Ok(match self {
            Content::File => Box::new(File::open(path)?),
            Content::Memory(bytes) => Box::new(Cursor::new(bytes.clone())),
        })
    }
}

impl Parts {
    /// The parts in these folders: all files whose names end in `.cells`.
    ///
    /// # Errors
    /// If there are none; if a file is no part, or a part of another study or another version; if a part is
    /// there twice; if a file cannot be read.
    pub fn of_folders(folders: &[PathBuf], progress: &dyn Progress) -> Result<Parts> {
        let (mut found, mut seen) = (Vec::new(), Vec::new());
        for folder in folders {
            let failed = |e| Error::io("list", folder, e);
            let real = folder.canonicalize().map_err(failed)?;
            if seen.contains(&real) {
                continue;
            }
            seen.push(real);
            let mut paths = Vec::new();
            for entry in std::fs::read_dir(folder).map_err(failed)? {
                let path = entry.map_err(failed)?.path();
                if path.to_string_lossy().ends_with(PartHead::ENDING) {
                    if !path.is_file() {
                        return Err(no_part(&path, "is no file"));
                    }
                    paths.push(path);
                }
            }
            paths.sort();
            found.extend(paths.into_iter().map(|path| (path, Content::File)));
        }
        Parts::of(found, progress)?.ok_or_else(|| {
            let all = folders.iter().map(shown).collect::<Vec<_>>().join(", ");
            Error::usage(format!("no parts in {all}"), format!("files named *{}", PartHead::ENDING))
                .hint("vibro model map … --shard 1/4 --out DIR")
        })
    }

    /// Parts in memory.
    ///
    /// # Errors
    /// As [`Parts::of_folders`].
    pub fn of_bytes(parts: Vec<Vec<u8>>) -> Result<Parts> {
        let named = |(i, bytes): (usize, Vec<u8>)| {
            (PathBuf::from(format!("part {}", i + 1)), Content::Memory(bytes.into()))
        };
        let parts = Parts::of(parts.into_iter().enumerate().map(named).collect(), &())?;
        parts.ok_or_else(|| Error::usage("no parts", "one at least"))
    }

    fn of(found: Vec<(PathBuf, Content)>, progress: &dyn Progress) -> Result<Option<Parts>> {
        let mut parts: Option<Parts> = None;
        let mut bytes = Vec::new();
        progress.start("parts", found.len());
        for (path, content) in found {
            let opened = content.open(&path).map_err(|e| Error::io("open", &path, e))?;
            let mut reader = PartReader::new(&path, BufReader::new(opened))?;
            let cells_from = reader.end;
            while reader.next(&mut bytes)? {}
            let (shard, head) = (reader.head.shard, &reader.head);
            let parts = parts.get_or_insert_with(|| Parts {
                head: head.clone(),
                first: path.clone(),
                whole: BTreeMap::new(),
                begun: BTreeMap::new(),
            });
            let first = shown(&parts.first);
            let study_of = PartHead { shard: parts.head.shard, ..head.clone() };
            if shard.of != parts.head.shard.of {
                let (n, m) = (shard.of, parts.head.shard.of);
                return Err(foreign(&path, &format!("one of {n} parts, and {first} is one of {m}")));
            }
            if let Some(difference) = study_of.difference(&parts.head) {
                return Err(foreign(&path, &format!("of another study than {first}: {difference}")));
            }
            let earlier = parts.whole.get(&shard.number).map(|part| &part.path);
            if let Some(earlier) = earlier.or(parts.begun.get(&shard.number).map(|begun| &begun.0)) {
                return Err(foreign(&path, &format!("part {shard}, as {} is", shown(earlier))));
            }
            if reader.whole {
                parts.whole.insert(shard.number, Part { path, content, cells_from });
            } else {
                parts.begun.insert(shard.number, (path, reader.read));
            }
            progress.step();
        }
        Ok(parts)
    }

    /// Numbers of the parts that are missing or lack cells.
    pub fn missing(&self) -> Vec<u64> {
        (1..=self.head.shard.of).filter(|number| !self.whole.contains_key(number)).collect()
    }

    /// Numbers as the job arrays of Slurm take them: `3,7-9`.
    pub fn listed(numbers: &[u64]) -> String {
        let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
            [one] => one.to_string(),
            [one, two] => format!("{one},{two}"),
            _ => format!("{}-{}", run[0], run[run.len() - 1]),
        });
        runs.collect::<Vec<_>>().join(",")
    }

    /// All cells in the order of their numbers.
    ///
    /// # Errors
    /// If parts are missing or lack cells.
    pub fn cells(&self) -> Result<impl Iterator<Item = Result<Vec<u8>>> + '_> {
        let missing = self.missing();
        let Shard { of, .. } = self.head.shard;
        if let Some(first) = missing.first() {
            let all = self.head.all;
            let begun = self.begun.iter().map(|(number, (path, n))| {
                let shard = Shard { number: *number, of };
                format!("; {} has {n} of {} cells", shown(path), shard.count(all))
            });
            let (n, which) = (missing.len(), Parts::listed(&missing));
            let are = if n == 1 { "is" } else { "are" };
            let found = format!("{n} of {of} parts {are} missing: {which}{}", begun.collect::<String>());
            let hint = format!("the command of the other parts with --shard {first}/{of}");
            return Err(Error::usage(found, "all parts").hint(hint));
        }
        let ahead = (AHEAD / of as usize).max(1 << 12);
        let mut streams: Vec<Stream<'_>> = self.whole.values().map(|part| Stream::of(part, ahead)).collect();
        Ok((0..self.head.all).map(move |cell| {
            let number = Shard::number_of(cell, of);
            streams[(number - 1) as usize].next()
        }))
    }
}

/// Error of a part that cannot be merged with the others.
fn foreign(path: &Path, what: &str) -> Error {
    Error::input(Place::file(path), format!("this is {what}"), "parts of one study, each once")
        .hint("move the one that does not belong to them to another folder")
}

/// Bytes of cells that are read ahead of all parts together.
const AHEAD: usize = 1 << 26;

/// The cells of a part, one after another. The file is open only while cells are read, so that any number of
/// parts can be merged.
struct Stream<'a> {
    part: &'a Part,
    at: u64,
    /// Bytes that are read at once, at least one cell.
    ahead: usize,
    ready: VecDeque<Vec<u8>>,
}

impl Stream<'_> {
    fn of(part: &Part, ahead: usize) -> Stream<'_> {
        Stream { part, at: part.cells_from, ahead, ready: VecDeque::new() }
    }

    fn next(&mut self) -> Result<Vec<u8>> {
        let path = &self.part.path;
        if self.ready.is_empty() {
            self.read().map_err(|e| Error::io("read", path, e))?;
        }
        self.ready.pop_front().ok_or_else(|| no_part(path, "changed since it was checked"))
    }

    /// Reads cells, which were checked before.
    fn read(&mut self) -> std::io::Result<()> {
        let mut file = BufReader::new(self.part.content.open(&self.part.path)?);
        file.seek(SeekFrom::Start(self.at))?;
        let (mut length, mut read) = ([0; 4], 0);
        while read < self.ahead {
            file.read_exact(&mut length)?;
            let n = u32::from_le_bytes(length);
            if n == END {
                break;
            }
            let mut cell = vec![0; n as usize + 4];
            file.read_exact(&mut cell)?;
            cell.truncate(n as usize);
            self.at += u64::from(n) + 8;
            // An empty cell takes memory, too.
            read += n as usize + 40;
            self.ready.push_back(cell);
        }
        Ok(())
    }
}
