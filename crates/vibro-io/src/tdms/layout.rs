//! How raw data lie in a segment, whatever their order: parts, one after the other, of equal rows with fields in them.

use crate::binary::Kind;
use std::sync::Arc;

/// Raw data of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Byte of the file at which they begin.
    pub at: u64,
    /// Bytes that are there.
    pub len: u64,
    pub big_endian: bool,
    /// One chunk; chunks follow each other to the end.
    pub parts: Arc<[Part]>,
}

/// Rows of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
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
    pub kind: Kind,
}
