//! All parts of a study, and their cells in the order of their numbers.

use super::head::PartHead;
use super::part::PartReader;
use super::{Progress, Shard};
use crate::error::{Error, Result};
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
    /// Its name.
    first: String,
    /// Parts that are whole, by their numbers.
    whole: BTreeMap<u64, Part>,
    /// Names of parts that lack cells, by their numbers, with the numbers of cells that they have.
    begun: BTreeMap<u64, (String, u64)>,
}

/// A part, and where its next cells are read.
#[derive(Debug)]
struct Part {
    name: String,
    content: Content,
    /// Position in bytes after the head.
    cells_from: u64,
}

#[derive(Debug, Clone)]
enum Content {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

/// Bytes of a part.
trait Bytes: Read + Seek {}
impl<T: Read + Seek> Bytes for T {}

impl Content {
    fn open(&self, name: &str) -> Result<Box<dyn Bytes>> {
        Ok(match self {
            Content::File(path) => Box::new(File::open(path).map_err(|e| Error::io("open", name, e))?),
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
        let mut found = Vec::new();
        for folder in folders {
            let entries = std::fs::read_dir(folder).map_err(|e| Error::io("list", folder, e))?;
            let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
            let is_part = |path: &PathBuf| path.to_string_lossy().ends_with(PartHead::ENDING);
            let mut paths: Vec<PathBuf> = paths.filter(is_part).collect();
            paths.sort();
            found.extend(paths.into_iter().map(|path| (shown(&path), Content::File(path))));
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
        let named = |(i, bytes): (usize, Vec<u8>)| (format!("part {}", i + 1), Content::Memory(bytes.into()));
        let parts = Parts::of(parts.into_iter().enumerate().map(named).collect(), &())?;
        parts.ok_or_else(|| Error::usage("no parts", "one at least"))
    }

    fn of(found: Vec<(String, Content)>, progress: &dyn Progress) -> Result<Option<Parts>> {
        let mut parts: Option<Parts> = None;
        let mut bytes = Vec::new();
        progress.start("parts", found.len());
        for (name, content) in found {
            let mut reader = PartReader::new(&name, BufReader::new(content.open(&name)?))?;
            let cells_from = reader.end;
            while reader.next(&mut bytes)? {}
            let (shard, head) = (reader.head.shard, &reader.head);
            let parts = parts.get_or_insert_with(|| Parts {
                head: head.clone(),
                first: name.clone(),
                whole: BTreeMap::new(),
                begun: BTreeMap::new(),
            });
            if let Some(difference) = head.difference(&parts.head) {
                let what = format!("a part of another study than {}: {difference}", parts.first);
                return Err(foreign(&name, &what));
            }
            if shard.of != parts.head.shard.of {
                let (n, m, first) = (shard.of, parts.head.shard.of, &parts.first);
                return Err(foreign(&name, &format!("one of {n} parts, and {first} is one of {m}")));
            }
            let earlier = parts.whole.get(&shard.number).map(|part| &part.name);
            if let Some(earlier) = earlier.or(parts.begun.get(&shard.number).map(|begun| &begun.0)) {
                return Err(foreign(&name, &format!("part {shard}, which {earlier} is, too")));
            }
            if reader.whole {
                parts.whole.insert(shard.number, Part { name, content, cells_from });
            } else {
                parts.begun.insert(shard.number, (name, reader.read));
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
        if !missing.is_empty() {
            let all = self.head.all;
            let begun = self.begun.iter().map(|(number, (name, n))| {
                let shard = Shard { number: *number, of };
                format!("; {name} has {n} of {} cells", shard.count(all))
            });
            let (n, which) = (missing.len(), Parts::listed(&missing));
            let are = if n == 1 { "is" } else { "are" };
            let found = format!("{n} of {of} parts {are} missing: {which}{}", begun.collect::<String>());
            return Err(Error::usage(found, "all parts").hint(format!("sbatch --array={which}")));
        }
        let mut streams: Vec<Stream<'_>> = self.whole.values().map(Stream::of).collect();
        Ok((0..self.head.all).map(move |cell| {
            let number = Shard::number_of(cell, of);
            streams[(number - 1) as usize].next()
        }))
    }
}

/// Error of a part that cannot be merged with the others.
fn foreign(name: &str, what: &str) -> Error {
    Error::input(crate::error::Place::file(Path::new(name)), format!("this is {what}"), "parts of one study")
        .hint("move that file to another folder")
}

/// Cells that are read from a part at once. With a thousand parts, cells of 40 bytes take 20 MB.
const AHEAD: usize = 500;

/// The cells of a part, one after another. The file is open only while cells are read, so that any number of
/// parts can be merged.
struct Stream<'a> {
    part: &'a Part,
    at: u64,
    ready: VecDeque<Vec<u8>>,
}

impl Stream<'_> {
    fn of(part: &Part) -> Stream<'_> {
        Stream { part, at: part.cells_from, ready: VecDeque::new() }
    }

    fn next(&mut self) -> Result<Vec<u8>> {
        let name = &self.part.name;
        if self.ready.is_empty() {
            self.read().map_err(|e| Error::io("read", name, e))?;
        }
        self.ready.pop_front().ok_or_else(|| foreign(name, "changed since it was checked"))
    }

    /// Reads cells, which were checked before.
    fn read(&mut self) -> std::io::Result<()> {
        let mut file =
            BufReader::new(self.part.content.open(&self.part.name).map_err(std::io::Error::other)?);
        file.seek(SeekFrom::Start(self.at))?;
        let mut length = [0; 4];
        while self.ready.len() < AHEAD {
            file.read_exact(&mut length)?;
            let n = u32::from_le_bytes(length);
            if n == u32::MAX {
                break;
            }
            let mut cell = vec![0; n as usize + 4];
            file.read_exact(&mut cell)?;
            cell.truncate(n as usize);
            self.at += u64::from(n) + 8;
            self.ready.push_back(cell);
        }
        Ok(())
    }
}
