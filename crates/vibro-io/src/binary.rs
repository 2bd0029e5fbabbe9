//! Decodes the binary number types of measurement files, from rows of any width in either byte order.

use NumberType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};

/// Type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    I8,
    I16,
    I24,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    /// Seconds since 1904 with a fraction of 2⁻⁶⁴ s.
    Time,
    /// One bit of a byte.
    Bit(u8),
}

/// Types in the order of `codes` of [`NumberType::coded`].
const NUMBERS: [NumberType; 10] = [I8, I16, I32, I64, U8, U16, U32, U64, F32, F64];

impl NumberType {
    /// The type with this code. `codes` lists a format's codes of signed integers of 1, 2, 4 and 8 bytes, of
    /// unsigned ones, and of floats of 4 and 8 bytes.
    pub fn coded(code: u32, codes: [u32; 10]) -> Option<NumberType> {
        codes.iter().position(|known| *known == code).map(|at| NUMBERS[at])
    }

    /// Size in bytes.
    pub fn size(self) -> u64 {
        match self {
            I8 | U8 | NumberType::Bit(_) => 1,
            I16 | U16 => 2,
            NumberType::I24 => 3,
            I32 | U32 | F32 => 4,
            I64 | U64 | F64 => 8,
            NumberType::Time => 16,
        }
    }

    /// Appends to `out` the number at byte `offset` of each row of `width` bytes. Integers above 2⁵³ are
    /// rounded to a double.
    pub fn take(self, rows: &[u8], offset: usize, width: usize, big_endian: bool, out: &mut Vec<f64>) {
        let at = (rows, offset, width, big_endian);
        match self {
            I8 => column(at, out, |b| f64::from(i8::from_le_bytes(b))),
            U8 => column(at, out, |b| f64::from(u8::from_le_bytes(b))),
            I16 => column(at, out, |b| f64::from(i16::from_le_bytes(b))),
            U16 => column(at, out, |b| f64::from(u16::from_le_bytes(b))),
            NumberType::I24 => column(at, out, |[a, b, c]| f64::from(i32::from_le_bytes([0, a, b, c]) >> 8)),
            I32 => column(at, out, |b| f64::from(i32::from_le_bytes(b))),
            U32 => column(at, out, |b| f64::from(u32::from_le_bytes(b))),
            I64 => column(at, out, |b| i64::from_le_bytes(b) as f64),
            U64 => column(at, out, |b| u64::from_le_bytes(b) as f64),
            F32 => column(at, out, |b| f64::from(f32::from_le_bytes(b))),
            F64 => column(at, out, f64::from_le_bytes),
            NumberType::Time => column(at, out, time),
            NumberType::Bit(bit) => column(at, out, |[byte]| f64::from(byte >> bit & 1)),
        }
    }
}

/// Seconds since 1904.
fn time(bytes: [u8; 16]) -> f64 {
    let both = i128::from_le_bytes(bytes);
    (both >> 64) as f64 + (both as u64) as f64 / 2f64.powi(64)
}

/// Appends the numbers of `N` bytes in a column. Big-endian bytes are reversed before `value` decodes them.
fn column<const N: usize>(
    (rows, offset, width, big_endian): (&[u8], usize, usize, bool),
    out: &mut Vec<f64>,
    value: impl Fn([u8; N]) -> f64,
) {
    let decoded = |mut bytes: [u8; N]| {
        if big_endian {
            bytes.reverse();
        }
        value(bytes)
    };
    if width == N {
        out.extend(rows.as_chunks::<N>().0.iter().map(|bytes| decoded(*bytes)));
        return;
    }
    let cell = |row: &[u8]| row.get(offset..).and_then(<[u8]>::first_chunk).copied();
    out.extend(rows.chunks_exact(width).filter_map(cell).map(decoded));
}
