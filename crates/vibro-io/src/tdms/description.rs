//! Reads the description of a segment word by word: properties, and the layout of each object's raw data.

use crate::binary::NumberType;
use vibro_record::{Error, Place, Result};

/// Type codes of numbers in raw data and properties, in the order of [`NumberType::coded`].
const NUMBERS: [u32; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
/// Type codes of DAQmx scalers, in the same order.
const DAQMX: [u32; 10] = [1, 3, 5, 7, 0, 2, 4, 6, 8, 9];

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    Other,
}

impl Value {
    /// The value as readable text.
    pub fn text(&self) -> Option<String> {
        match self {
            Value::Text(text) => Some(text.clone()),
            Value::Number(number) => Some(number.to_string()),
            Value::Other => None,
        }
    }
}

/// Meaning of a column of raw values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    Real,
    Imaginary,
    /// Seconds since 1904.
    Instant,
    /// A DAQmx scaler with this number.
    Scaler(u32),
}

/// Layout of an object's raw data in each chunk of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct Index {
    /// Number of rows; text counts as one row of all its bytes.
    pub rows: u64,
    /// Bytes of a row; for DAQmx, of a row of each buffer.
    pub widths: Vec<u64>,
    /// Whether all channels share the rows, as those of DAQmx do.
    pub shared: bool,
    /// For each number of a row: its meaning, the index of its buffer, its byte in the row and its type.
    /// Empty for text.
    pub fields: Vec<(Slot, usize, usize, NumberType)>,
}

/// Unread bytes of a description.
pub struct Words<'a> {
    pub rest: &'a [u8],
    pub big_endian: bool,
    /// Byte of the file at which the unread bytes begin.
    pub at: u64,
}

impl<'a> Words<'a> {
    pub fn fault(&self, found: impl Into<String>, expected: &str) -> Error {
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

    /// Bytes of a number, converted to little endian.
    fn word<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut word = [0; N];
        word.copy_from_slice(self.bytes(N)?);
        if self.big_endian {
            word.reverse();
        }
        Ok(word)
    }

    pub fn u32(&mut self) -> Result<u32> {
        self.word().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64> {
        self.word().map(u64::from_le_bytes)
    }

    pub fn text(&mut self) -> Result<String> {
        let n = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.bytes(n)?).into_owned())
    }

    /// The value of a property of the type `code`.
    pub fn value(&mut self, code: u32) -> Result<Value> {
        let kind = match code {
            0x20 => return self.text().map(Value::Text),
            0x21 => return Ok(Value::Text((self.word::<1>()? != [0]).to_string())),
            0 => return Ok(Value::Other),
            0x44 => NumberType::Time,
            0x0008_000c => return self.bytes(8).map(|_| Value::Other),
            // Extended precision, and complex numbers.
            0x0b | 0x1b | 0x0010_000d => return self.bytes(16).map(|_| Value::Other),
            other => number(other)
                .ok_or_else(|| self.fault(format!("a property of type {other:#x}"), "a type of TDMS 2.0"))?,
        };
        let (size, mut one) = (kind.size() as usize, Vec::new());
        kind.take(self.bytes(size)?, 0, size, self.big_endian, &mut one);
        Ok(Value::Number(one[0]))
    }

    /// The layout of raw data whose description begins with the word `kind`.
    pub fn index(&mut self, kind: u32) -> Result<Index> {
        let digital = kind == 0x126a;
        if digital || kind == 0x1269 {
            return self.shared(digital);
        }
        let code = self.u32()?;
        self.one_dimension()?;
        let rows = self.u64()?;
        if code == 0x20 {
            return Ok(Index { rows: 1, widths: vec![self.u64()?], shared: false, fields: Vec::new() });
        }
        let complex = |kind: NumberType| {
            vec![(Slot::Real, 0, 0, kind), (Slot::Imaginary, 0, kind.size() as usize, kind)]
        };
        let fields = match code {
            0x0008_000c => complex(NumberType::F32),
            0x0010_000d => complex(NumberType::F64),
            0x44 => vec![(Slot::Instant, 0, 0, NumberType::Time)],
            _ => vec![(Slot::Real, 0, 0, number(code).ok_or_else(|| self.type_unknown(code))?)],
        };
        let widths = vec![fields.iter().map(|(.., kind)| kind.size()).sum()];
        Ok(Index { rows, widths, shared: false, fields })
    }

    /// The layout of DAQmx data: scalers, then the widths of the buffers.
    fn shared(&mut self, digital: bool) -> Result<Index> {
        // This word states only that these are DAQmx raw data.
        self.u32()?;
        self.one_dimension()?;
        let rows = self.u64()?;
        let mut fields = Vec::new();
        for _ in 0..self.u32()? {
            let (code, buffer, offset) = (self.u32()?, self.u32()? as usize, self.u32()? as usize);
            let (offset, kind) = if digital {
                self.bytes(1)?;
                (offset / 8, NumberType::Bit((offset % 8) as u8))
            } else {
                self.bytes(4)?;
                (offset, NumberType::coded(code, DAQMX).ok_or_else(|| self.type_unknown(code))?)
            };
            fields.push((Slot::Scaler(self.u32()?), buffer, offset, kind));
        }
        let n = self.u32()?;
        let widths = (0..n).map(|_| self.u32().map(u64::from)).collect::<Result<_>>()?;
        Ok(Index { rows, widths, shared: true, fields })
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

/// Number type of a type code: a truth value (0x21) is one byte, and floats with a unit (0x19, 0x1a) are
/// floats.
fn number(code: u32) -> Option<NumberType> {
    let code = match code {
        0x21 => 5,
        0x19 | 0x1a => code - 0x10,
        code => code,
    };
    NumberType::coded(code, NUMBERS)
}

/// Place of an error in the file; the reader adds the file's name.
pub fn in_byte(at: u64) -> Place {
    Place { byte: Some(at), ..Place::default() }
}
