//! Segments of a TDMS file: objects with their properties, and where their raw data lie.

use super::layout::{Field, Kind, Layout, Part, time};
use std::collections::{BTreeMap, HashMap};
use std::io::{BufReader, Read, Seek};
use std::sync::Arc;
use vibro_record::{Error, Finding, Place, Result};

/// Bytes before the objects of a segment.
const LEAD_IN: u64 = 28;
/// Bits of a segment's table of contents.
const OBJECTS: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
/// Types of DAQmx scalers, in the order of their numbers.
const DAQMX: [Kind; 10] = [
    Kind::U8,
    Kind::I8,
    Kind::U16,
    Kind::I16,
    Kind::U32,
    Kind::I32,
    Kind::U64,
    Kind::I64,
    Kind::F32,
    Kind::F64,
];
/// The length of a segment that was not finished.
const OPEN: u64 = u64::MAX;

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    Other,
}

impl Value {
    /// As a person reads it.
    pub fn text(&self) -> Option<String> {
        match self {
            Value::Text(text) => Some(text.clone()),
            Value::Number(number) => Some(number.to_string()),
            Value::Other => None,
        }
    }
}

/// What a column of raw values is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    Real,
    Imaginary,
    /// Seconds since 1904.
    Instant,
    /// A DAQmx scaler with this number.
    Scaler(u32),
}

/// The file, a group or a channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Object {
    /// Nothing, the group, or the group and the channel.
    pub path: Vec<String>,
    pub properties: BTreeMap<String, Value>,
    /// What its properties were, and how many values stood before another segment changed them.
    pub changes: Vec<(String, Value, u64)>,
    /// Values that the file declares.
    pub declared: u64,
    /// What its raw data are where they are no numbers.
    pub unreadable: Option<&'static str>,
    /// One a column of its raw values.
    pub slots: Vec<Slot>,
}

impl Object {
    /// A property that is a number.
    pub fn number(&self, key: &str) -> Option<f64> {
        if let Some(Value::Number(number)) = self.properties.get(key) { Some(*number) } else { None }
    }

    /// A property that is text.
    pub fn text(&self, key: &str) -> Option<&str> {
        if let Some(Value::Text(text)) = self.properties.get(key) { Some(text) } else { None }
    }
}

/// How the raw data of an object lie in the chunks of a segment.
#[derive(Debug, Clone, PartialEq)]
enum Index {
    /// Rows of numbers; of other things, one row of all their bytes.
    Plain { rows: u64, width: u64, fields: Vec<(Slot, usize, Kind)> },
    /// Rows that all channels of a DAQmx buffer share, the widths of the buffers, and the scalers with their buffers.
    Shared { rows: u64, widths: Vec<u64>, fields: Vec<(usize, Slot, usize, Kind)> },
}

/// Objects in their order, and the raw data of each segment.
pub struct Segments {
    pub objects: Vec<Object>,
    pub layouts: Vec<Layout>,
    pub findings: Vec<Finding>,
}

/// Goes from segment to segment of a file of `len` bytes.
///
/// # Errors
/// If the file cannot be read, or a segment is not what the format says.
pub fn all(file: &mut BufReader<impl Read + Seek>, len: u64) -> Result<Segments> {
    let mut known = Known::default();
    let (mut layouts, mut findings, mut at) = (Vec::new(), Vec::new(), 0);
    while at < len {
        let io = |e| Error::io("read", "", e);
        let mut lead = [0; LEAD_IN as usize];
        let cut = Finding::caution("segment-cut").number("at", at as f64);
        if len - at < LEAD_IN {
            findings.push(cut);
            break;
        }
        go(file, at).and_then(|()| file.read_exact(&mut lead)).map_err(io)?;
        if !lead.starts_with(b"TDSm") {
            return Err(Error::input(in_byte(at), "bytes that begin no segment", "TDSm")
                .hint("the file is damaged; copy it again from the computer that wrote it"));
        }
        let contents = u32::from_le_bytes([lead[4], lead[5], lead[6], lead[7]]);
        let big_endian = contents & BIG_ENDIAN != 0;
        let mut words = Words { rest: &lead[12..], big_endian, at: at + 12 };
        let (length, raw_from) = (words.u64()?, words.u64()?);
        let begin = at + LEAD_IN;
        let declared = if length == OPEN { len } else { begin.saturating_add(length) };
        let (raw_at, end) = (begin.saturating_add(raw_from), declared.min(len));
        if raw_at > end {
            findings.push(cut);
            break;
        }
        if contents & OBJECTS != 0 {
            let mut bytes = vec![0; raw_from as usize];
            file.read_exact(&mut bytes).map_err(io)?;
            known.describe(&mut Words { rest: &bytes, big_endian, at: begin }, contents & NEW_LIST != 0)?;
        }
        if contents & RAW_DATA != 0 {
            let parts = known.shared_parts(contents & INTERLEAVED != 0, at)?;
            let chunk =
                parts.iter().fold(0u64, |sum, part| sum.saturating_add(part.rows.saturating_mul(part.width)));
            if chunk > 0 && declared.max(end) > raw_at {
                known.declare((declared.max(end) - raw_at).div_ceil(chunk));
                layouts.push(Layout { at: raw_at, len: end - raw_at, big_endian, parts });
            }
        }
        at = declared;
    }
    Ok(Segments { objects: known.objects, layouts, findings })
}

/// Goes to a byte without losing what was read ahead.
pub fn go(file: &mut BufReader<impl Read + Seek>, to: u64) -> std::io::Result<()> {
    let at = file.stream_position()?;
    file.seek_relative(to.wrapping_sub(at) as i64)
}

/// What the segments so far say.
#[derive(Default)]
struct Known {
    objects: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// The last layout of each object.
    last: Vec<Option<Index>>,
    /// The objects of the present segment that have raw data or none, in their order.
    active: Vec<(usize, Option<Index>)>,
    /// The place of an object among the active ones.
    place: HashMap<usize, usize>,
    /// The parts of the present objects, interleaved or not.
    parts: Option<(bool, Arc<[Part]>)>,
}

impl Known {
    /// Takes the description of a segment.
    fn describe(&mut self, words: &mut Words, new_list: bool) -> Result<()> {
        self.parts = None;
        if new_list {
            self.active.clear();
            self.place.clear();
        }
        for _ in 0..words.u32()? {
            let path = words.text()?;
            let object = *self.by_path.entry(path.clone()).or_insert_with(|| {
                self.objects.push(Object { path: names(&path), ..Object::default() });
                self.last.push(None);
                self.objects.len() - 1
            });
            let index = match words.u32()? {
                u32::MAX => None,
                0 => self.last[object].clone(),
                kind => Some(words.index(kind)?),
            };
            if let Some(index) = &index {
                let (slots, unreadable): (Vec<Slot>, _) = match index {
                    Index::Plain { fields, .. } => {
                        (fields.iter().map(|f| f.0).collect(), fields.is_empty().then_some("text"))
                    }
                    Index::Shared { fields, .. } => (fields.iter().map(|f| f.1).collect(), None),
                };
                let found = &mut self.objects[object];
                if !found.slots.is_empty() && found.slots != slots {
                    return Err(words
                        .fault(format!("another type of values in {path}"), "one type in the whole file"));
                }
                (found.slots, found.unreadable) = (slots, unreadable);
                self.last[object] = Some(index.clone());
            }
            let place = *self.place.entry(object).or_insert(self.active.len());
            match self.active.get_mut(place) {
                Some((_, known)) => *known = index,
                None => self.active.push((object, index)),
            }
            let Object { properties, changes, declared, .. } = &mut self.objects[object];
            for _ in 0..words.u32()? {
                let (key, code) = (words.text()?, words.u32()?);
                let value = words.value(code)?;
                let before = properties.insert(key.clone(), value);
                let before = before.filter(|before| *declared > 0 && properties.get(&key) != Some(before));
                changes.extend(before.map(|before| (key, before, *declared)));
            }
        }
        Ok(())
    }

    /// The parts of a chunk, which segments without a description share.
    fn shared_parts(&mut self, interleaved: bool, at: u64) -> Result<Arc<[Part]>> {
        let known = self.parts.take().filter(|(was, _)| *was == interleaved);
        let parts =
            known.map_or_else(|| self.parts(interleaved, at).map(Arc::from), |(_, parts)| Ok(parts))?;
        self.parts = Some((interleaved, Arc::clone(&parts)));
        Ok(parts)
    }

    /// The parts of a chunk of the segment that begins at byte `at`.
    fn parts(&self, interleaved: bool, at: u64) -> Result<Vec<Part>> {
        let mut parts: Vec<Part> = Vec::new();
        let mut buffers: Vec<Part> = Vec::new();
        for (object, index) in &self.active {
            match index {
                None => {}
                Some(Index::Plain { rows, width, fields }) => {
                    let part = match parts.last_mut().filter(|_| interleaved) {
                        Some(part) if part.rows != *rows => {
                            let found = format!("{rows} and {} interleaved values", part.rows);
                            return Err(Error::input(in_byte(at), found, "as many of each channel"));
                        }
                        Some(part) => part,
                        None => {
                            parts.push(Part { rows: *rows, width: 0, fields: Vec::new() });
                            let last = parts.len() - 1;
                            &mut parts[last]
                        }
                    };
                    let base = part.width as usize;
                    part.width += width;
                    part.fields.extend(fields.iter().enumerate().map(|(slot, (_, offset, kind))| Field {
                        object: *object,
                        slot,
                        offset: base + offset,
                        kind: *kind,
                    }));
                }
                Some(Index::Shared { rows, widths, fields }) => {
                    for width in widths.iter().skip(buffers.len()) {
                        buffers.push(Part { rows: 0, width: *width, fields: Vec::new() });
                    }
                    for (slot, (buffer, _, offset, kind)) in fields.iter().enumerate() {
                        let fits = |part: &&mut Part| *offset as u64 + kind.size() <= part.width;
                        let Some(part) = buffers.get_mut(*buffer).filter(fits) else {
                            let found = format!("a DAQmx scaler at byte {offset} of buffer {buffer}");
                            return Err(Error::input(in_byte(at), found, "one inside its buffer"));
                        };
                        part.rows = part.rows.max(*rows);
                        part.fields.push(Field { object: *object, slot, offset: *offset, kind: *kind });
                    }
                }
            }
        }
        Ok(if buffers.is_empty() { parts } else { buffers })
    }

    /// Counts the values of so many chunks.
    fn declare(&mut self, chunks: u64) {
        for (object, index) in &self.active {
            if let Some(Index::Plain { rows, .. } | Index::Shared { rows, .. }) = index {
                let declared = &mut self.objects[*object].declared;
                *declared = declared.saturating_add(rows.saturating_mul(chunks));
            }
        }
    }
}

/// The place of a complaint; the reader adds the file.
fn in_byte(at: u64) -> Place {
    Place { byte: Some(at), ..Place::default() }
}

/// Names of a path: `/'group'/'channel'`, quotes doubled.
fn names(path: &str) -> Vec<String> {
    let (mut names, mut rest) = (Vec::new(), path);
    while let Some(body) = rest.strip_prefix("/'") {
        let mut from = 0;
        let end = loop {
            let Some(at) = body[from..].find('\'').map(|at| from + at) else { break body.len() };
            if !body[at + 1..].starts_with('\'') {
                break at;
            }
            from = at + 2;
        };
        names.push(body[..end].replace("''", "'"));
        rest = body.get(end + 1..).unwrap_or_default();
    }
    names
}

/// Words of a description.
struct Words<'a> {
    rest: &'a [u8],
    big_endian: bool,
    /// Byte of the file at which they begin.
    at: u64,
}

impl<'a> Words<'a> {
    fn fault(&self, found: impl Into<String>, expected: &str) -> Error {
        Error::input(in_byte(self.at), found, expected)
            .hint("the file is damaged or of a kind not known here; export it as text or UFF-58")
    }

    fn bytes(&mut self, n: usize) -> Result<&'a [u8]> {
        let Some((bytes, rest)) = self.rest.split_at_checked(n) else {
            return Err(self.fault("a description that ends early", "whole objects and properties"));
        };
        self.rest = rest;
        self.at += n as u64;
        Ok(bytes)
    }

    /// Bytes of a number, little endian.
    fn word<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut word = [0; N];
        word.copy_from_slice(self.bytes(N)?);
        if self.big_endian {
            word.reverse();
        }
        Ok(word)
    }

    fn u32(&mut self) -> Result<u32> {
        self.word().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64> {
        self.word().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Result<String> {
        let n = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.bytes(n)?).into_owned())
    }

    /// The value of a property of a type.
    fn value(&mut self, code: u32) -> Result<Value> {
        Ok(Value::Number(match code {
            0x20 => return self.text().map(Value::Text),
            0x21 => return Ok(Value::Text((self.word::<1>()? != [0]).to_string())),
            0 => return Ok(Value::Other),
            0x44 => time(self.word()?),
            1 => f64::from(i8::from_le_bytes(self.word()?)),
            2 => f64::from(i16::from_le_bytes(self.word()?)),
            3 => f64::from(i32::from_le_bytes(self.word()?)),
            4 => i64::from_le_bytes(self.word()?) as f64,
            5 => f64::from(u8::from_le_bytes(self.word()?)),
            6 => f64::from(u16::from_le_bytes(self.word()?)),
            7 => f64::from(self.u32()?),
            8 => self.u64()? as f64,
            9 | 0x19 => f64::from(f32::from_le_bytes(self.word()?)),
            10 | 0x1a => f64::from_le_bytes(self.word()?),
            0x0008_000c => return self.bytes(8).map(|_| Value::Other),
            // Extended precision, and complex numbers.
            0x0b | 0x1b | 0x0010_000d => return self.bytes(16).map(|_| Value::Other),
            other => return Err(self.fault(format!("a property of type {other:#x}"), "a type of TDMS 2.0")),
        }))
    }

    /// The layout of raw data that begins with this word.
    fn index(&mut self, kind: u32) -> Result<Index> {
        let digital = kind == 0x126a;
        if digital || kind == 0x1269 {
            return self.shared(digital);
        }
        let code = self.u32()?;
        self.one_dimension()?;
        let rows = self.u64()?;
        if code == 0x20 {
            return Ok(Index::Plain { rows: 1, width: self.u64()?, fields: Vec::new() });
        }
        let complex = |kind: Kind| vec![(Slot::Real, 0, kind), (Slot::Imaginary, kind.size() as usize, kind)];
        let fields = match code {
            0x0008_000c => complex(Kind::F32),
            0x0010_000d => complex(Kind::F64),
            0x44 => vec![(Slot::Instant, 0, Kind::Time)],
            _ => vec![(Slot::Real, 0, number(code).ok_or_else(|| self.type_unknown(code))?)],
        };
        let width = fields.iter().map(|(_, _, kind)| kind.size()).sum();
        Ok(Index::Plain { rows, width, fields })
    }

    /// The layout of DAQmx data: scalers, then the widths of the buffers.
    fn shared(&mut self, digital: bool) -> Result<Index> {
        // The type says only that these are raw data of DAQmx.
        self.u32()?;
        self.one_dimension()?;
        let rows = self.u64()?;
        let mut fields = Vec::new();
        for _ in 0..self.u32()? {
            let (code, buffer, offset) = (self.u32()?, self.u32()? as usize, self.u32()? as usize);
            let (offset, kind) = if digital {
                self.bytes(1)?;
                (offset / 8, Kind::Bit((offset % 8) as u8))
            } else {
                self.bytes(4)?;
                (offset, *DAQMX.get(code as usize).ok_or_else(|| self.type_unknown(code))?)
            };
            fields.push((buffer, Slot::Scaler(self.u32()?), offset, kind));
        }
        let n = self.u32()?;
        let widths = (0..n).map(|_| self.u32().map(u64::from)).collect::<Result<_>>()?;
        Ok(Index::Shared { rows, widths, fields })
    }

    fn one_dimension(&mut self) -> Result<()> {
        match self.u32()? {
            1 => Ok(()),
            n => Err(self.fault(format!("raw data of {n} dimensions"), "one dimension")),
        }
    }

    fn type_unknown(&self, code: u32) -> Error {
        self.fault(format!("raw data of type {code:#x}"), "integers, floats, complex numbers, times or text")
    }
}

/// The number that a type of raw data is.
fn number(code: u32) -> Option<Kind> {
    Some(match code {
        1 => Kind::I8,
        2 => Kind::I16,
        3 => Kind::I32,
        4 => Kind::I64,
        5 | 0x21 => Kind::U8,
        6 => Kind::U16,
        7 => Kind::U32,
        8 => Kind::U64,
        9 | 0x19 => Kind::F32,
        10 | 0x1a => Kind::F64,
        _ => return None,
    })
}
