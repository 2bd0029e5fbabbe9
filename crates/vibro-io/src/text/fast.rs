//! The fast path: rectangular rows of real numbers and nothing else, read in pieces by several threads.
//!
//! Anything unexpected (a comment, a missing value, a ragged row, a word) makes this path give up, and
//! [`super::rows`] reads the file again, line by line, to say exactly what stands where.

use super::dialect::{Cell, Dialect, Head, Separator};
use super::fixed::{self, Fixed};
use crate::Source;
use crate::number::{self, Exponential};
use rayon::prelude::*;
use std::io::{Read, SeekFrom};
use vibro_record::{Error, Result, Values};

/// Bytes read at a time: small enough to stay in the second-level cache.
pub const BLOCK: usize = 256 * 1024;

/// Pieces smaller than this are not worth a thread.
pub(crate) const SMALLEST_PIECE: u64 = 1024 * 1024;

/// Rows that tell the shape.
const ENOUGH: usize = 24;

/// How clean rows look, as bytes.
pub struct Shape {
    /// Byte offset of the first row.
    pub first_byte: u64,
    pub columns: usize,
    separator: Separator,
    decimal: u8,
    /// Parser of unsigned numbers and their width, where the first rows print them all like `1.234e+05`.
    exponential: Option<(Exponential, usize)>,
    /// Shape of the rows, where the first ones are all alike.
    fixed: Option<Fixed>,
}

impl Shape {
    /// The shape of rows of real numbers; `None` for others.
    pub fn of(dialect: &Dialect, head: &Head) -> Option<Shape> {
        if dialect.cell == Cell::Complex {
            return None;
        }
        let Dialect { columns, separator, decimal, .. } = *dialect;
        let first_byte = dialect.first_byte(&head.bytes);
        let rows = head.bytes[first_byte..].split_inclusive(|b| *b == b'\n').take(ENOUGH);
        let rows: Vec<&[u8]> = rows.filter_map(|row| row.strip_suffix(b"\n")).collect();
        let exponential = exponential(&rows, separator).filter(|_| decimal == b'.');
        let fixed = Fixed::of(&rows).filter(|_| columns == 1 && decimal == b'.');
        Some(Shape { first_byte: first_byte as u64, columns, separator, decimal, exponential, fixed })
    }
}

/// The parser for numbers of one width, if all rows hold such numbers.
fn exponential(rows: &[&[u8]], separator: Separator) -> Option<(Exponential, usize)> {
    let mark = if let Separator::Char(mark) = separator { mark } else { b' ' };
    let cells = rows.iter().flat_map(|row| row.split(|b| *b == mark || b.is_ascii_whitespace()));
    let mut width = None;
    for cell in cells.filter(|c| !c.is_empty()) {
        let unsigned = cell.strip_prefix(b"-").or(cell.strip_prefix(b"+")).unwrap_or(cell);
        if *width.get_or_insert(unsigned.len()) != unsigned.len() || number::exponential(unsigned).is_none() {
            return None;
        }
    }
    number::exponential_of(width?).map(|parse| (parse, width.unwrap_or_default()))
}

/// All columns; `None` where the file is not clean.
pub fn read(source: &Source, shape: &Shape) -> Result<Option<Vec<Values>>> {
    let values = match shape.fixed {
        Some(fixed) => fixed::read(source, shape.first_byte, fixed)?,
        None => None,
    };
    let values = if values.is_some() { values } else { clean(source, shape)? };
    let columns = shape.columns;
    Ok(values.map(|values| match columns {
        1 => vec![Values::Real(values)],
        _ => (0..columns)
            .map(|c| Values::Real(values.iter().skip(c).step_by(columns).copied().collect()))
            .collect(),
    }))
}

/// All values, row by row; `None` where the file is not clean.
///
/// The rows are counted first, so that every thread writes its values where they belong: looking at the bytes twice costs less
/// than joining vectors.
fn clean(source: &Source, shape: &Shape) -> Result<Option<Vec<f64>>> {
    let (from, to) = (shape.first_byte, source.len());
    let threads = rayon::current_num_threads().max(1) as u64;
    let pieces = ((to - from) / SMALLEST_PIECE).clamp(1, threads);
    let bounds: Vec<(u64, u64)> = (0..pieces)
        .map(|i| (from + (to - from) * i / pieces, from + (to - from) * (i + 1) / pieces))
        .collect();
    let counts: Vec<usize> = bounds.par_iter().map(|b| rows_in(source, shape, *b)).collect::<Result<_>>()?;
    let total = counts.iter().sum::<usize>().saturating_mul(shape.columns);
    // A value takes two bytes with what ends it: blank lines must not claim room for rows of many columns.
    if total as u64 > (to - from) / 2 + 1 {
        return Ok(None);
    }
    let mut values = vec![0.0; total];
    let mut rest = values.as_mut_slice();
    let parts: Vec<(&mut [f64], (u64, u64))> = counts
        .iter()
        .zip(bounds)
        .map(|(rows, bounds)| {
            let (part, behind) = std::mem::take(&mut rest).split_at_mut(rows * shape.columns);
            rest = behind;
            (part, bounds)
        })
        .collect();
    let filled: Vec<Option<(usize, usize)>> = parts
        .into_par_iter()
        .map(|(part, (from, to))| {
            let (room, mut used) = (part.len(), 0);
            let clean = scan(source, shape, (from, to), |v| {
                if let Some(place) = part.get_mut(used) {
                    *place = v;
                }
                used += 1;
            })?;
            Ok(clean.filter(|_| used <= room).map(|_| (used, room)))
        })
        .collect::<Result<_>>()?;
    let (mut total, mut ended) = (0, false);
    for part in filled {
        let Some((used, room)) = part else { return Ok(None) };
        if ended && used > 0 {
            return Ok(None); // rows behind blank lines
        }
        total += used;
        ended |= used < room;
    }
    values.truncate(total);
    Ok((!values.is_empty()).then_some(values))
}

/// Number of lines that start in these bounds.
fn rows_in(source: &Source, shape: &Shape, (from, to): (u64, u64)) -> Result<usize> {
    let first = from == shape.first_byte;
    let failed = |e| Error::io("read", source.path(), e);
    let mut file = source.open()?;
    // A line starts behind every line end before it.
    let from = if first { from } else { from - 1 };
    file.seek(SeekFrom::Start(from)).map_err(failed)?;
    let mut left = (to - 1).saturating_sub(from) as usize;
    let mut buffer = vec![0; BLOCK.min(left.max(1))];
    let mut count = usize::from(first);
    while left > 0 {
        let wanted = buffer.len().min(left);
        let read = file.read(&mut buffer[..wanted]).map_err(failed)?;
        if read == 0 {
            break;
        }
        count += count_lf(&buffer[..read]);
        left -= read;
    }
    Ok(count)
}

/// Counted in bytes that cannot overflow, so that the compiler looks at many at once.
fn count_lf(bytes: &[u8]) -> usize {
    bytes.chunks(255).map(|c| usize::from(c.iter().map(|b| u8::from(*b == b'\n')).sum::<u8>())).sum()
}

/// Streams the values of all rows that start in `from..to` into `sink`. Gives whether blank lines stand behind the
/// rows, or `None` where the bytes are not clean (the sink may have taken values by then).
pub fn scan(
    source: &Source,
    shape: &Shape,
    (from, to): (u64, u64),
    mut sink: impl FnMut(f64),
) -> Result<Option<bool>> {
    let mut file = source.open()?;
    let first = from == shape.first_byte;
    // A piece owns the rows that start in it: look one byte back for the end of the row before.
    let mut position = if first { from } else { from - 1 };
    file.seek(SeekFrom::Start(position)).map_err(|e| Error::io("read", source.path(), e))?;
    let mut skipping = !first;
    let mut buffer = vec![0u8; BLOCK.min((to - from) as usize + 2)];
    let mut filled = 0;
    let mut ended = false;
    loop {
        let read = file.read(&mut buffer[filled..]).map_err(|e| Error::io("read", source.path(), e))?;
        let last = read == 0;
        filled += read;
        let mut at = 0;
        if skipping {
            match buffer[..filled].iter().position(|b| *b == b'\n') {
                Some(newline) => {
                    at = newline + 1;
                    skipping = false;
                }
                None if last => return Ok(Some(ended)),
                None => {
                    position += filled as u64;
                    filled = 0;
                    continue;
                }
            }
        }
        let complete = if last {
            filled
        } else {
            match buffer[..filled].iter().rposition(|b| *b == b'\n') {
                Some(newline) => newline + 1,
                None if filled == buffer.len() => return Ok(None), // a row as long as the buffer is no row
                None => continue,
            }
        };
        while at < complete {
            if position + at as u64 >= to {
                return Ok(Some(ended));
            }
            match row(&buffer[at..complete], shape, &mut sink) {
                Row::Values(used) if !ended => at += used,
                Row::Blank(used) => {
                    ended = true;
                    at += used;
                }
                _ => return Ok(None),
            }
        }
        if last {
            return Ok(Some(ended));
        }
        buffer.copy_within(at..filled, 0);
        position += at as u64;
        filled -= at;
    }
}

/// The number at the start of `bytes` and the bytes it takes.
#[inline]
fn value(bytes: &[u8], shape: &Shape) -> Option<(f64, usize)> {
    if let Some((parse, width)) = shape.exponential {
        let first = *bytes.first()?;
        let sign = usize::from(matches!(first, b'-' | b'+'));
        // What follows must end the number, or it is longer than the others.
        let ended = bytes.get(sign + width).is_none_or(|b| !b.is_ascii_digit());
        if let Some(magnitude) = bytes.get(sign..sign + width).filter(|_| ended).and_then(parse) {
            return Some((if first == b'-' { -magnitude } else { magnitude }, sign + width));
        }
    }
    number::prefix(bytes, shape.decimal)
}

enum Row {
    /// A full row, and the bytes it took with its line end.
    Values(usize),
    /// Nothing but blanks.
    Blank(usize),
    /// Something for the slow path.
    Odd,
}

#[inline]
fn row(bytes: &[u8], shape: &Shape, sink: &mut impl FnMut(f64)) -> Row {
    let blank = |at: &mut usize| {
        while bytes.get(*at).is_some_and(|b| matches!(b, b' ' | b'\t')) {
            *at += 1;
        }
    };
    // CR ends a line only before LF; elsewhere it is a line end of its own, which the slow path sees to.
    let line_end = |at: usize| match bytes.get(at) {
        None | Some(b'\n') => Some(at + 1),
        Some(b'\r') if bytes.get(at + 1) == Some(&b'\n') => Some(at + 2),
        Some(b'\r') => {
            let crs = bytes[at..].iter().take_while(|b| **b == b'\r').count();
            matches!(bytes.get(at + crs), None | Some(b'\n')).then_some(at + crs + 1)
        }
        Some(_) => None,
    };
    // Signs make the number of leading blanks random: take two without a branch.
    let mut at = usize::from(bytes.first() == Some(&b' '));
    at += usize::from(bytes.get(at) == Some(&b' '));
    blank(&mut at);
    if let Some(used) = line_end(at) {
        return Row::Blank(used);
    }
    for column in 0..shape.columns {
        if column > 0
            && let Separator::Char(mark) = shape.separator
            && mark != b'\t'
        {
            if bytes.get(at) != Some(&mark) {
                return Row::Odd;
            }
            at += 1;
            blank(&mut at);
        }
        let Some((value, used)) = value(&bytes[at..], shape) else { return Row::Odd };
        sink(value);
        at += used;
        // Two numbers must not touch.
        let before = at;
        blank(&mut at);
        let touching = before == at
            && column + 1 < shape.columns
            && !matches!(shape.separator, Separator::Char(mark) if bytes.get(at) == Some(&mark));
        if touching {
            return Row::Odd;
        }
    }
    line_end(at).map_or(Row::Odd, Row::Values)
}
