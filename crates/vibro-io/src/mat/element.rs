//! Data elements: a tag with kind and size, content, padding to eight bytes.
//!
//! Source: The `MathWorks`, "MAT-File Format", chapter 1, "Level 5 MAT-File Format".

use std::io::{ErrorKind, Read};
use vibro_record::{Error, Place, Result};

/// How many bytes are converted at once.
const CHUNK: usize = 64 * 1024;

/// Kind and size of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tag {
    pub kind: u32,
    pub size: u64,
    /// The content of a small element stands in its tag.
    small: Option<[u8; 4]>,
}

impl Tag {
    /// Bytes of the content behind the tag.
    pub fn behind(self) -> u64 {
        if self.small.is_some() { 0 } else { self.size }
    }
}

/// Numbers that are stored as the tag says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
    I64,
    U64,
}

impl Storage {
    pub fn of(kind: u32) -> Option<Storage> {
        Some(match kind {
            1 => Storage::I8,
            2 => Storage::U8,
            3 => Storage::I16,
            4 => Storage::U16,
            5 => Storage::I32,
            6 => Storage::U32,
            7 => Storage::F32,
            9 => Storage::F64,
            12 => Storage::I64,
            13 => Storage::U64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Storage::I8 | Storage::U8 => 1,
            Storage::I16 | Storage::U16 => 2,
            Storage::I32 | Storage::U32 | Storage::F32 => 4,
            Storage::F64 | Storage::I64 | Storage::U64 => 8,
        }
    }

    /// Value of little-endian bytes; integers beyond 2⁵³ are rounded.
    fn value(self, b: [u8; 8]) -> f64 {
        let [b0, b1, b2, b3, ..] = b;
        match self {
            Storage::I8 => f64::from(i8::from_le_bytes([b0])),
            Storage::U8 => f64::from(b0),
            Storage::I16 => f64::from(i16::from_le_bytes([b0, b1])),
            Storage::U16 => f64::from(u16::from_le_bytes([b0, b1])),
            Storage::I32 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
            Storage::U32 => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
            Storage::F32 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
            Storage::F64 => f64::from_le_bytes(b),
            Storage::I64 => i64::from_le_bytes(b) as f64,
            Storage::U64 => u64::from_le_bytes(b) as f64,
        }
    }
}

/// The elements of one variable, one after the other, from wherever its bytes come.
pub struct Elements<'a> {
    input: &'a mut dyn Read,
    big_endian: bool,
    /// Where the variable stands in the file.
    place: Place,
    padding: usize,
}

impl<'a> Elements<'a> {
    pub fn new(input: &'a mut dyn Read, big_endian: bool, place: Place) -> Elements<'a> {
        Elements { input, big_endian, place, padding: 0 }
    }

    /// A complaint about the variable.
    pub fn fault(&self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::input(self.place.clone(), found, expected)
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.input.read_exact(bytes).map_err(|e| match e.kind() {
            ErrorKind::UnexpectedEof => {
                self.fault("a variable that ends early", "as many bytes as it declares").hint("save it again")
            }
            _ => self
                .fault(format!("a variable that cannot be read: {e}"), "intact data")
                .hint("the file is damaged; copy or save it again"),
        })
    }

    /// The next tag.
    pub fn tag(&mut self) -> Result<Tag> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes[..self.padding])?;
        self.fill(&mut bytes)?;
        let [a, b, c, d, small @ ..] = bytes;
        let word = self.word([a, b, c, d]);
        if word >> 16 != 0 {
            let (kind, size) = (word & 0xffff, u64::from(word >> 16));
            if size > 4 {
                return Err(self.fault(format!("a small element of {size} bytes"), "at most 4"));
            }
            self.padding = 0;
            return Ok(Tag { kind, size, small: Some(small) });
        }
        let size = u64::from(self.word(small));
        self.padding = ((8 - size % 8) % 8) as usize;
        Ok(Tag { kind: word, size, small: None })
    }

    /// The content of an element that must be of `kind` and of at most `most` bytes.
    pub fn content(&mut self, what: &str, kinds: &[u32], most: u64) -> Result<(Tag, Vec<u8>)> {
        let tag = self.tag()?;
        if !kinds.contains(&tag.kind) || tag.size > most {
            let found = format!("an element of kind {} and {} bytes for its {what}", tag.kind, tag.size);
            return Err(self.fault(found, format!("kind {kinds:?} and at most {most} bytes")));
        }
        let mut bytes = vec![0; tag.size as usize];
        match tag.small {
            Some(small) => bytes.copy_from_slice(&small[..tag.size as usize]),
            None => self.fill(&mut bytes)?,
        }
        Ok((tag, bytes))
    }

    /// The next element as `count` numbers, and how they are stored. Memory grows only as numbers arrive.
    pub fn numbers(&mut self, count: u64) -> Result<(Storage, Vec<f64>)> {
        let tag = self.tag()?;
        let Some(storage) = Storage::of(tag.kind) else {
            return Err(self.fault(format!("values of kind {}", tag.kind), "integers or floats"));
        };
        let width = storage.bytes();
        if count.checked_mul(width as u64) != Some(tag.size) {
            let found =
                format!("a variable that declares {count} values and holds {}", tag.size / width as u64);
            return Err(self.fault(found, "as many values as its dimensions say").hint("save it again"));
        }
        let mut values = Vec::new();
        if let Some(small) = tag.small {
            let bytes = small.get(..tag.size as usize).unwrap_or_default();
            values.extend(bytes.chunks_exact(width).map(|b| self.value(storage, b)));
            return Ok((storage, values));
        }
        let (mut left, mut chunk) = (tag.size as usize, vec![0; CHUNK.min(tag.size as usize)]);
        while left > 0 {
            let part = left.min(chunk.len());
            self.fill(&mut chunk[..part])?;
            values.extend(chunk[..part].chunks_exact(width).map(|b| self.value(storage, b)));
            left -= part;
        }
        Ok((storage, values))
    }

    fn value(&self, storage: Storage, bytes: &[u8]) -> f64 {
        let mut eight = [0; 8];
        for (to, from) in eight.iter_mut().zip(bytes) {
            *to = *from;
        }
        if self.big_endian {
            eight[..bytes.len().min(8)].reverse();
        }
        storage.value(eight)
    }

    /// An unsigned word in the file's order.
    pub fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }
}
