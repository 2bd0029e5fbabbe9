//! Layout of a segment's raw data, in one form for all orders of storage: parts one after the other, each
//! part of rows of equal width, each row of fields.

use crate::binary::NumberType;
use std::sync::Arc;

/// Raw data of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct RawData {
    /// Byte of the file at which the raw data begin.
    pub at: u64,
    /// Number of bytes of the raw data that the file holds.
    pub len: u64,
    pub big_endian: bool,
    /// The parts of one chunk; the raw data consist of such chunks.
    pub parts: Arc<[RowBlock]>,
}

impl RawData {
    /// Number of values in the raw data.
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

/// A number in each row of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Index of the object that the number belongs to.
    pub object: usize,
    /// Index of its column in that object: 1 for imaginary parts; each DAQmx scaler has its own column.
    pub slot: usize,
    /// Byte of the row at which the number begins.
    pub offset: usize,
    pub kind: NumberType,
}
