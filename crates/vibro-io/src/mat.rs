//! MATLAB's level 5 MAT-file (`save -v6` and `-v7`), which scipy writes too.
//!
//! ```text
//! 124 bytes of text, version 0x0100, IM (little endian) or MI (big endian)
//! variable: kind 14, size, then elements: flags, dimensions, name, real part, imaginary part
//! variable: kind 15, size, then the same packed by zlib
//! ```
//! A numeric vector is a record, and so is each column of a matrix. Scalars and texts are notes on every record. The
//! abscissa comes from a vector `t` or `time` (`f`, `freq` or `frequency`) of the same length, or from a scalar `fs`,
//! `rate`, `SampleRate`, `dt` or `Ts`; the file knows no units. Everything is read at once, for a survey too.

mod element;
mod records;
mod variable;

use super::format::{Format, Survey};
use super::reader::{Options, Recording};
use super::{Header, Source};
use element::Elements;
use flate2::read::ZlibDecoder;
use std::io::{BufReader, Read, Seek, SeekFrom};
use variable::{Content, Variable};
use vibro_record::{Error, Finding, Place, Result};

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes before the first variable.
const HEADER: u64 = 128;
/// Most bytes that deflate makes of one: 258 of two bits.
const MOST_INFLATED: u64 = 1032;

/// How many values the packed variables of a file of this length may hold, as doubles: 64 times its size, but no less
/// than 64 MiB and no more than 4 GiB.
fn budget(length: u64) -> u64 {
    length.saturating_mul(64).clamp(64 << 20, 4 << 30) / 8
}

/// The levels of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    Four,
    Five { big_endian: bool },
    Hdf5,
}

fn level(head: &[u8], source: &Source) -> Option<Level> {
    match head.get(124..128) {
        Some(b"\0\x01IM") => return Some(Level::Five { big_endian: false }),
        Some(b"\x01\0MI") => return Some(Level::Five { big_endian: true }),
        Some(b"\0\x02IM" | b"\x02\0MI") => return Some(Level::Hdf5),
        _ => {}
    }
    if source.extension() != "mat" {
        return None;
    }
    if head.starts_with(HDF5) || head.get(512..520) == Some(HDF5) {
        return Some(Level::Hdf5);
    }
    // Level 4 has no signature: five words of type, rows, columns, complex or not, length of the name.
    let word = |at: usize| head.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b));
    let words = [word(0)?, word(4)?, word(8)?, word(12)?, word(16)?];
    let plausible = |w: [u32; 5]| w[0] < 5000 && w[0] % 10 <= 2 && w[3] <= 1 && (1..=64).contains(&w[4]);
    (plausible(words) || plausible(words.map(u32::swap_bytes))).then_some(Level::Four)
}

pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    level(head, source).is_some()
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let refuse = |found: &str| {
        Error::input(Place::file(source.path()), found, "a level 5 MAT-file")
            .hint("open it in MATLAB and save it again with -v7 or -v6, e.g. save('name.mat', '-v7')")
    };
    let big_endian = match level(&source.head()?, source) {
        Some(Level::Five { big_endian }) => big_endian,
        Some(Level::Hdf5) => return Err(refuse("a MAT-file of version 7.3, which is HDF5")),
        Some(Level::Four) => return Err(refuse("a MAT-file of version 4")),
        None => return Err(refuse("no MAT-file header")),
    };
    let mut findings = Vec::new();
    let (variables, cut) = variables(source, big_endian)?;
    if let Some(cut) = cut {
        let numbers = |v: &Variable| matches!(&v.content, Content::Array(a) if a.real.len() > 1);
        if !variables.iter().any(numbers) {
            return Err(cut.error(source));
        }
        let found = Finding::caution("variable-cut-off").number("byte", cut.byte as f64);
        let found = found.number("there", cut.there as f64);
        findings
            .push(cut.declared.into_iter().fold(found, |f, declared| f.number("declared", declared as f64)));
    }
    let records = records::build(source, variables, options, &mut findings)?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Mat, records, findings })
}

pub(super) fn survey(source: &Source, options: &Options) -> Result<Survey> {
    let recording = read(source, options)?;
    Ok((recording.records.iter().map(Header::of).collect(), recording.findings))
}

/// The variable at which a file ends early.
struct Cut {
    /// Where it begins.
    byte: u64,
    /// Bytes that its tag declares; `None` where the tag itself is cut.
    declared: Option<u64>,
    /// Bytes that are there, behind the tag or of it.
    there: u64,
}

impl Cut {
    fn error(&self, source: &Source) -> Error {
        let place = Place::byte(source.path(), self.byte);
        Error::input(place, format!("the file is cut off: {self}"), "a whole variable of numbers")
            .hint("copy or save the file again")
    }
}

impl std::fmt::Display for Cut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Cut { byte, there, .. } = self;
        match self.declared {
            Some(declared) => {
                write!(f, "its last variable, at byte {byte}, declares {declared} bytes, {there} are there")
            }
            None => write!(f, "of its last variable, at byte {byte}, only {there} bytes are there"),
        }
    }
}

/// All whole variables, and where the file ends within one.
fn variables(source: &Source, big_endian: bool) -> Result<(Vec<Variable>, Option<Cut>)> {
    let io = |e| Error::io("read", source.path(), e);
    let mut file = BufReader::new(source.open()?);
    let (mut variables, mut budget) = (Vec::new(), budget(source.len()));
    let mut at = HEADER;
    while at < source.len() {
        let (byte, there) = (at, source.len() - at);
        if there < 8 {
            return Ok((variables, Some(Cut { byte, declared: None, there })));
        }
        let place = Place::byte(source.path(), at);
        file.seek(SeekFrom::Start(at)).map_err(io)?;
        let tag = Elements::new(&mut file, big_endian, place.clone()).tag()?;
        at += 8 + tag.behind();
        if at > source.len() {
            return Ok((variables, Some(Cut { byte, declared: Some(tag.size), there: there - 8 })));
        }
        let mut body = (&mut file).take(tag.size);
        match tag.kind {
            14 => {
                let mut unlimited = u64::MAX;
                variables
                    .push(variable::read(&mut Elements::new(&mut body, big_endian, place), &mut unlimited)?);
            }
            15 => {
                let mut packed = ZlibDecoder::new(body);
                let mut outer = Elements::new(&mut packed, big_endian, place.clone());
                let inner = outer.tag()?;
                if inner.kind != 14 {
                    return Err(
                        outer.fault(format!("an element of kind {}", inner.kind), "a packed variable")
                    );
                }
                if inner.size > MOST_INFLATED.saturating_mul(tag.size) {
                    let found = format!("a variable of {} bytes packed in {}", inner.size, tag.size);
                    return Err(outer
                        .fault(found, "at most 1032 times the packed size, which is all that deflate can do")
                        .hint("the file is damaged; save it again without compression (save -v6)"));
                }
                let mut body = packed.take(inner.size);
                variables
                    .push(variable::read(&mut Elements::new(&mut body, big_endian, place), &mut budget)?);
            }
            0 => break,
            _ => {}
        }
    }
    Ok((variables, None))
}

#[cfg(test)]
mod tests;
