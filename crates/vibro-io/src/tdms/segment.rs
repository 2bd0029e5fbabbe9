//! Segments of a TDMS file: objects with their properties, and the place of their raw data.

use super::description::{Index, Slot, Value, Words, in_byte};
use super::layout::{Field, RawData, RowBlock};
use std::collections::{BTreeMap, HashMap};
use std::io::{BufReader, Read, Seek};
use std::sync::Arc;
use vibro_record::{Error, Finding, Result};

/// Bytes of a segment before its objects.
const LEAD_IN: u64 = 28;
/// Bits of a segment's table of contents.
const OBJECTS: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
/// Stored length of a segment that was not finished: it extends to the end of the file.
const OPEN: u64 = u64::MAX;

/// The file, a group or a channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Object {
    /// Empty for the file, else the group, or the group and the channel.
    pub path: Vec<String>,
    pub properties: BTreeMap<String, Value>,
    /// Former properties: name, former value, and number of values before a later segment changed it.
    pub changes: Vec<(String, Value, u64)>,
    /// Number of values that the file declares.
    pub declared: u64,
    /// Kind of its raw data, if these are not numbers.
    pub unreadable: Option<&'static str>,
    /// Meaning of each column of its raw values.
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

/// Reads the segments of a file of `len` bytes: objects in their order, the raw data of each segment,
/// findings.
///
/// # Errors
/// If the file cannot be read, or a segment violates the format.
pub fn all(
    file: &mut BufReader<impl Read + Seek>,
    len: u64,
) -> Result<(Vec<Object>, Vec<RawData>, Vec<Finding>)> {
    let mut known = SegmentState::default();
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
                layouts.push(RawData { at: raw_at, len: end - raw_at, big_endian, parts });
            }
        }
        at = declared;
    }
    Ok((known.objects, layouts, findings))
}

/// Moves to a byte of the file without discarding the read-ahead buffer.
pub fn go(file: &mut BufReader<impl Read + Seek>, to: u64) -> std::io::Result<()> {
    let at = file.stream_position()?;
    file.seek_relative(to.wrapping_sub(at) as i64)
}

/// State after the segments read so far, to which later ones may refer.
#[derive(Default)]
struct SegmentState {
    objects: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// The last layout of each object.
    last: Vec<Option<Index>>,
    /// The objects of the current segment in their order, each with the layout of its raw data, if any.
    active: Vec<(usize, Option<Index>)>,
    /// Index of an object among the active ones.
    place: HashMap<usize, usize>,
    /// Whether the values of the current objects are interleaved, and the parts of one chunk.
    parts: Option<(bool, Arc<[RowBlock]>)>,
}

impl SegmentState {
    /// Reads the description of a segment.
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
                let slots: Vec<Slot> = index.fields.iter().map(|field| field.0).collect();
                let unreadable = (slots.is_empty() && !index.shared).then_some("text");
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

    /// The parts of a chunk; a segment without a description shares those of the segment before.
    fn shared_parts(&mut self, interleaved: bool, at: u64) -> Result<Arc<[RowBlock]>> {
        let known = self.parts.take().filter(|(was, _)| *was == interleaved);
        let parts =
            known.map_or_else(|| self.parts(interleaved, at).map(Arc::from), |(_, parts)| Ok(parts))?;
        self.parts = Some((interleaved, Arc::clone(&parts)));
        Ok(parts)
    }

    /// The parts of a chunk of the segment that begins at byte `at`.
    fn parts(&self, interleaved: bool, at: u64) -> Result<Vec<RowBlock>> {
        let (mut parts, mut buffers): (Vec<RowBlock>, Vec<RowBlock>) = (Vec::new(), Vec::new());
        for (object, index) in &self.active {
            let Some(Index { rows, widths, shared, fields }) = index else { continue };
            if !shared {
                if !interleaved || parts.is_empty() {
                    parts.push(RowBlock { rows: *rows, width: 0, fields: Vec::new() });
                }
                let last = parts.len() - 1;
                let part = &mut parts[last];
                if part.rows != *rows {
                    let found = format!("{rows} and {} interleaved values", part.rows);
                    return Err(Error::input(in_byte(at), found, "as many of each channel"));
                }
                let base = part.width as usize;
                part.width += widths[0];
                let fields = fields.iter().enumerate();
                part.fields.extend(fields.map(|(slot, (_, _, offset, kind))| Field {
                    object: *object,
                    slot,
                    offset: base + offset,
                    kind: *kind,
                }));
                continue;
            }
            for width in widths.iter().skip(buffers.len()) {
                buffers.push(RowBlock { rows: 0, width: *width, fields: Vec::new() });
            }
            for (slot, (_, buffer, offset, kind)) in fields.iter().enumerate() {
                let fits = |part: &&mut RowBlock| *offset as u64 + kind.size() <= part.width;
                let Some(part) = buffers.get_mut(*buffer).filter(fits) else {
                    let found = format!("a DAQmx scaler at byte {offset} of buffer {buffer}");
                    return Err(Error::input(in_byte(at), found, "one inside its buffer"));
                };
                part.rows = part.rows.max(*rows);
                part.fields.push(Field { object: *object, slot, offset: *offset, kind: *kind });
            }
        }
        Ok(if buffers.is_empty() { parts } else { buffers })
    }

    /// Adds the values of this many chunks to the declared number of each active object.
    fn declare(&mut self, chunks: u64) {
        for (object, index) in &self.active {
            if let Some(Index { rows, .. }) = index {
                let declared = &mut self.objects[*object].declared;
                *declared = declared.saturating_add(rows.saturating_mul(chunks));
            }
        }
    }
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
