//! Layout of raw data in a segment, in whatever order they are stored: parts one after the other, each of
//! equal rows, each row of fields.

use crate::binary::NumberType;
use std::sync::Arc;

/// Raw data of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct RawData {
    /// Byte of the file at which they begin.
    pub at: u64,
    /// Number of bytes that the file holds of them.
    pub len: u64,
    pub big_endian: bool,
    /// The parts of one chunk; chunks follow each other to the end.
    pub parts: Arc<[RowBlock]>,
}

impl RawData {
    /// Numbers that the raw data hold.
    pub fn values(&self) -> f64 {
        let in_chunk =
            |of: fn(&RowBlock) -> u64| self.parts.iter().map(move |part| part.rows as f64 * of(part) as f64);
        let numbers: f64 = in_chunk(|part| part.fields.len() as u64).sum();
        let bytes: f64 = in_chunk(|part| part.width).sum();
        if bytes > 0.0 { self.len as f64 * numbers / bytes } else { 0.0 }
    }
}

/// Rows of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct RowBlock {
    pub rows: u64,
    /// Bytes of a row.
    pub width: u64,
    pub fields: Vec<Field>,
}

/// One number of each row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Index of the object that it belongs to.
    pub object: usize,
    /// Which of its columns: imaginary parts are the second, DAQmx scalers have one each.
    pub slot: usize,
    /// Byte of the row at which it begins.
    pub offset: usize,
    pub kind: NumberType,
}
