//! The fast path: rectangular rows of real numbers and nothing else, read in pieces by several threads.
//!
//! On anything unexpected (a comment, a missing value, a row of another length, a word) this path gives up.
//! [`super::rows`] then reads the file again, line by line, so that an error names line and column.

use super::cautions::may_be_marked;
use super::dialect::Dialect;
use super::lines::Separator;
use crate::held::{Held, rises};
use crate::number::{self, Exponential};
use crate::source::ReadSeek;
use crate::source::Source;
use rayon::prelude::*;
use std::io::{self, Read, SeekFrom, Take};
use std::slice::IterMut;
use vibro_record::lanes::Extremes;
use vibro_record::{Error, Result, Values};

/// Bytes read at a time; a block fits into the level-2 cache.
const BLOCK: usize = 256 * 1024;

/// Smallest piece of a file in bytes that is given to a thread of its own.
const SMALLEST_PIECE: u64 = 1024 * 1024;

/// Number of first rows from which the shape is detected.
const ENOUGH: usize = 24;

/// Layout of rows for the fast path: how they are cut, and whether all have the same widths.
#[derive(Debug, Clone, Copy)]
pub struct RowShape {
    separator: Separator,
    /// Decimal mark.
    decimal: u8,
    /// Columns of a row.
    pub columns: usize,
    /// Byte offset of the first row.
    first_byte: u64,
    /// Parser and width in bytes of unsigned numbers, if all numbers in the first rows are printed as
    /// `1.234e+05`.
    exponential: Option<(Exponential, usize)>,
    /// Length of a row in bytes and offset of the end of its only number, if the first rows are all alike.
    fixed: Option<(usize, usize)>,
}

impl RowShape {
    /// The shape of rows of real numbers that begin in `head`; `None` for other rows.
    pub fn of(dialect: &Dialect, head: &[u8]) -> Option<RowShape> {
        if dialect.complex || dialect.skipped > 0 || dialect.separator == Separator::Char(dialect.decimal) {
            return None;
        }
        let first_byte = dialect.first_byte(head);
        let rows = head[first_byte..].split_inclusive(|b| *b == b'\n').take(ENOUGH);
        let rows: Vec<&[u8]> = rows.filter(|row| row.ends_with(b"\n")).collect();
        let exponential = exponential(&rows, dialect.separator).filter(|_| dialect.decimal == b'.');
        let size = |row: &&[u8]| (row.len(), row.trim_ascii_end().len());
        let common = rows.first().map(size).filter(|first| rows.iter().all(|row| size(row) == *first));
        let fixed = common.filter(|_| dialect.columns == 1 && exponential.is_some());
        let Dialect { separator, decimal, columns, .. } = *dialect;
        Some(RowShape { separator, decimal, columns, first_byte: first_byte as u64, exponential, fixed })
    }
}

/// Parser and width of exponential numbers, if all numbers in `rows` have the same width.
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

/// Reads all columns up to the byte `end`, after which only blanks follow; `None` if a row is not clean.
/// For a column that is not `kept` and falls anywhere, only extremes and first values are held, unless its
/// largest magnitude may mark missing values: whether it does, all values tell.
pub fn read(source: &Source, shape: &RowShape, end: u64, kept: &[bool]) -> Result<Option<Vec<Held>>> {
    let found = match columns(source, shape, end, kept)? {
        None if shape.fixed.is_some() => columns(source, &RowShape { fixed: None, ..*shape }, end, kept)?,
        columns => columns,
    };
    if !found.iter().flatten().any(may_be_marked) {
        return Ok(found);
    }
    let kept: Vec<bool> =
        found.iter().flatten().zip(kept).map(|(held, kept)| *kept || may_be_marked(held)).collect();
    columns(source, &RowShape { fixed: None, ..*shape }, end, &kept)
}

/// As [`read`], with this shape only.
///
/// The rows are counted first, so that every thread writes its values to their final place: reading the
/// bytes twice takes less time than joining vectors. Zeroed memory is not allocated before it is written
/// to.
fn columns(source: &Source, shape: &RowShape, end: u64, kept: &[bool]) -> Result<Option<Vec<Held>>> {
    let from = shape.first_byte;
    let to = end.max(from);
    let pieces = ((to - from) / SMALLEST_PIECE).clamp(1, rayon::current_num_threads().max(1) as u64);
    let start =
        |i: u64| if i == 0 { Ok(from) } else { row_start(source, from + (to - from) * i / pieces, to) };
    let bounds: Vec<u64> = (0..pieces).map(start).chain([Ok(to)]).collect::<Result<_>>()?;
    let pieces: Vec<(u64, u64)> = bounds.windows(2).map(|w| (w[0], w[1])).collect();
    let counts: Vec<usize> = pieces.par_iter().map(|p| rows_in(source, shape, *p)).collect::<Result<_>>()?;
    let total = counts.iter().sum::<usize>();
    // A value and its separator take at least two bytes. Without this check, blank lines would reserve
    // memory for rows of many columns.
    if total == 0 || total.saturating_mul(shape.columns) as u64 > (to - from) / 2 + 1 {
        return Ok(None);
    }
    let mut columns: Vec<Vec<f64>> = (0..shape.columns).map(|_| vec![0.0; total]).collect();
    let mut rest: Vec<&mut [f64]> = columns.iter_mut().map(Vec::as_mut_slice).collect();
    let mut parts = Vec::new();
    for (rows, piece) in counts.iter().zip(pieces) {
        let part = rest.iter_mut().map(|column| {
            let (part, behind) = std::mem::take(column).split_at_mut(*rows);
            *column = behind;
            part
        });
        parts.push((part.collect::<Vec<_>>(), piece));
    }
    let all = kept.iter().all(|kept| *kept);
    let read = |(part, piece): (Vec<&mut [f64]>, (u64, u64))| {
        if all { whole(source, shape, piece, part) } else { surveyed(source, shape, piece, part, kept) }
    };
    let read: Option<Vec<Vec<Lane>>> =
        parts.into_par_iter().map(read).collect::<Result<Vec<_>>>()?.into_iter().collect();
    let Some(seen) = read else { return Ok(None) };
    let seen: Vec<Lane> = seen.into_iter().reduce(Lane::joined).unwrap_or_default();
    let mut seen = seen.into_iter();
    let held = columns.into_iter().map(|values| match seen.next() {
        Some(lane) if lane.falls && !lane.kept => Held::Summary(lane.ends),
        _ => Held::Values(Values::Real(values)),
    });
    Ok(Some(held.collect()))
}

/// Reads all values of a piece; `None` if it is not clean.
fn whole(
    source: &Source,
    shape: &RowShape,
    piece: (u64, u64),
    part: Vec<&mut [f64]>,
) -> Result<Option<Vec<Lane>>> {
    let mut part: Vec<IterMut<f64>> = part.into_iter().map(<[f64]>::iter_mut).collect();
    let clean = blocks(source, piece, |block| rows(block, shape, &mut part))?;
    Ok(clean.filter(|()| part.iter().all(|column| column.len() == 0)).map(|()| Vec::new()))
}

/// As [`whole`], but writes the values of a column only while it rises, or if it is `kept`.
fn surveyed(
    source: &Source,
    shape: &RowShape,
    piece: (u64, u64),
    part: Vec<&mut [f64]>,
    kept: &[bool],
) -> Result<Option<Vec<Lane>>> {
    let mut lanes: Vec<(&mut [f64], Lane)> =
        part.into_iter().zip(kept).map(|(values, kept)| (values, Lane::new(*kept))).collect();
    let mut block_of = vec![Vec::new(); shape.columns];
    let clean = blocks(source, piece, |bytes| {
        let n = parsed(bytes, shape, &mut block_of)?;
        lanes.iter_mut().zip(&block_of).try_for_each(|((values, lane), block)| lane.take(&block[..n], values))
    })?;
    let all = lanes.iter().all(|(values, lane)| lane.ends.len() == values.len());
    Ok(clean.filter(|()| all).map(|()| lanes.into_iter().map(|(_, lane)| lane).collect()))
}

/// Summary of the values of one column in one piece of the file.
#[derive(Debug, Clone)]
struct Lane {
    /// Whether all its values are kept in memory.
    kept: bool,
    /// Whether any value is not above the value before it.
    falls: bool,
    first: f64,
    last: f64,
    ends: Extremes,
}

impl Lane {
    fn new(kept: bool) -> Lane {
        Lane { kept, falls: false, first: f64::NAN, last: f64::NEG_INFINITY, ends: Extremes::NONE }
    }

    /// Takes the next values and writes them to their place in `values`; `None` if there are more than the
    /// rows counted.
    fn take(&mut self, next: &[f64], values: &mut [f64]) -> Option<()> {
        let (Some(first), Some(last)) = (next.first(), next.last()) else { return Some(()) };
        if self.kept || !self.falls {
            let n = self.ends.len();
            values.get_mut(n..n + next.len())?.copy_from_slice(next);
        }
        self.falls = self.falls || *first <= self.last || !rises(next);
        if self.ends.len() == 0 {
            self.first = *first;
        }
        self.last = *last;
        self.ends.take(next);
        Some(())
    }

    /// Joins the summaries of two consecutive pieces.
    fn joined(mut before: Vec<Lane>, behind: Vec<Lane>) -> Vec<Lane> {
        for (lane, next) in before.iter_mut().zip(behind).filter(|(_, next)| next.ends.len() > 0) {
            lane.falls = lane.falls || next.falls || next.first <= lane.last;
            lane.last = next.last;
            lane.ends.join(&next.ends);
        }
        before
    }
}

/// Byte offset of the first row that starts at or after `at`; `to` if there is none.
fn row_start(source: &Source, at: u64, to: u64) -> Result<u64> {
    // The search begins one byte before `at`, since the row before may end there.
    let mut start = to;
    let mut passed = 0;
    blocks(source, (at - 1, to), |block| {
        let end = block.iter().position(|b| *b == b'\n');
        start = end.map_or(start, |end| at + passed + end as u64);
        passed += block.len() as u64;
        end.is_none().then_some(())
    })?;
    Ok(start)
}

/// Number of line ends. A `u8` counts those in 255 bytes without overflow, so the compiler can vectorise
/// the loop.
fn line_ends(bytes: &[u8]) -> usize {
    let ends = |c: &[u8]| usize::from(c.iter().map(|b| u8::from(*b == b'\n')).sum::<u8>());
    bytes.chunks(255).map(ends).sum()
}

/// Number of rows of a piece.
fn rows_in(source: &Source, shape: &RowShape, (from, to): (u64, u64)) -> Result<usize> {
    if let Some((length, _)) = shape.fixed {
        return Ok((to - from).div_ceil(length as u64) as usize);
    }
    let (mut count, mut whole) = (0, true);
    blocks(source, (from, to), |block| {
        count += line_ends(block);
        whole = block.last().map_or(whole, |last| *last == b'\n');
        Some(())
    })?;
    Ok(count + usize::from(!whole))
}

/// Passes a range of bytes, which begins with a row, to `each` in blocks of whole rows. `None` as soon as
/// `each` returns `None` or a row is longer than a block.
fn blocks(
    source: &Source,
    (from, to): (u64, u64),
    mut each: impl FnMut(&[u8]) -> Option<()>,
) -> Result<Option<()>> {
    if let Some(bytes) = source.in_memory() {
        return Ok(each(&bytes[from as usize..to as usize]));
    }
    let mut all = Blocks::open(source, (from, to))?;
    loop {
        match all.next().map_err(|e| Error::io("read", source.path(), e))? {
            Some([]) => return Ok(Some(())),
            Some(block) if each(block).is_some() => {}
            _ => return Ok(None),
        }
    }
}

/// Reads part of a file in blocks of whole rows.
pub struct Blocks {
    file: Take<Box<dyn ReadSeek>>,
    buffer: Vec<u8>,
    /// Number of bytes in the buffer; `out` of them were returned by the last call.
    filled: usize,
    out: usize,
}

impl Blocks {
    /// Opens the rows of `shape` up to the byte `end`.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn of(source: &Source, shape: &RowShape, end: u64) -> Result<Blocks> {
        Blocks::open(source, (shape.first_byte, end.max(shape.first_byte)))
    }

    fn open(source: &Source, (from, to): (u64, u64)) -> Result<Blocks> {
        let mut file = source.open()?;
        file.seek(SeekFrom::Start(from)).map_err(|e| Error::io("read", source.path(), e))?;
        let buffer = vec![0u8; BLOCK.min((to - from) as usize + 1)];
        Ok(Blocks { file: file.take(to - from), buffer, filled: 0, out: 0 })
    }

    /// The next block of rows, empty at the end; `None` if a row is longer than a block.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn next(&mut self) -> io::Result<Option<&[u8]>> {
        self.buffer.copy_within(self.out..self.filled, 0);
        self.filled -= std::mem::take(&mut self.out);
        while self.out == 0 && self.filled < self.buffer.len() {
            let read = self.file.read(&mut self.buffer[self.filled..])?;
            self.filled += read;
            let end = self.buffer[..self.filled].iter().rposition(|b| *b == b'\n').map(|end| end + 1);
            self.out = if read == 0 { self.filled } else { end.unwrap_or_default() };
            if read == 0 {
                return Ok(Some(&self.buffer[..self.out]));
            }
        }
        Ok((self.out > 0).then(|| &self.buffer[..self.out]))
    }
}

/// Parses whole rows into the columns of `block`, which grow as needed, and returns the number of rows;
/// `None` if a row is not clean.
pub fn parsed(bytes: &[u8], shape: &RowShape, block: &mut [Vec<f64>]) -> Option<usize> {
    let most = line_ends(bytes) + 1;
    for column in block.iter_mut().filter(|column| column.len() < most) {
        column.resize(most, 0.0);
    }
    let mut columns: Vec<IterMut<f64>> = block.iter_mut().map(|column| column.iter_mut()).collect();
    rows(bytes, shape, &mut columns)?;
    let left = columns.first().map_or(0, IterMut::len);
    Some(block.first()?.len() - left)
}

/// Parses whole rows; `None` if a row is not clean or there are more rows than counted.
fn rows(block: &[u8], shape: &RowShape, columns: &mut [IterMut<f64>]) -> Option<()> {
    let mut at = 0;
    while at < block.len() {
        if let (Some((length, end)), Some((parse, width))) = (shape.fixed, shape.exponential)
            && let Some(value) =
                block.get(at..at + length).and_then(|row| fixed(row, (end - width, end), parse))
        {
            *columns.first_mut()?.next()? = value;
            at += length;
            continue;
        }
        at += row(&block[at..], shape, columns)?;
    }
    Some(())
}

/// Value of a row of fixed layout: blanks, a sign or blank, the number at bytes `from..to`, blanks or CR,
/// LF.
#[inline]
fn fixed(row: &[u8], (from, to): (usize, usize), parse: Exponential) -> Option<f64> {
    let magnitude = parse(&row[from..to])?;
    let ends = match &row[to..] {
        [b'\n'] | [b'\r', b'\n'] => true,
        [blanks @ .., b'\n'] => blanks.iter().all(|b| matches!(b, b' ' | b'\r' | b'\t')),
        _ => false,
    };
    let (sign, blanks) = row[..from].split_last().unwrap_or((&b' ', &[]));
    if !ends || blanks.iter().any(|b| *b != b' ') {
        return None;
    }
    match sign {
        b' ' | b'+' => Some(magnitude),
        b'-' => Some(-magnitude),
        _ => None,
    }
}

/// The number at the start of `bytes`, and its length in bytes.
#[inline]
fn value(bytes: &[u8], shape: &RowShape) -> Option<(f64, usize)> {
    if let Some((parse, width)) = shape.exponential {
        let first = *bytes.first()?;
        let sign = usize::from(matches!(first, b'-' | b'+'));
        // A further digit shows a number longer than the others.
        let ended = bytes.get(sign + width).is_none_or(|b| !b.is_ascii_digit());
        if let Some(magnitude) = bytes.get(sign..sign + width).filter(|_| ended).and_then(parse) {
            return Some((if first == b'-' { -magnitude } else { magnitude }, sign + width));
        }
    }
    number::prefix(bytes, shape.decimal)
}

/// Parses one row and returns its length in bytes, including the line end; `None` if the row is not clean.
#[inline]
fn row(bytes: &[u8], shape: &RowShape, columns: &mut [IterMut<f64>]) -> Option<usize> {
    let blank = |at: &mut usize| {
        while bytes.get(*at).is_some_and(|b| matches!(b, b' ' | b'\t')) {
            *at += 1;
        }
    };
    // CR ends a line only before LF. Elsewhere CR is a line end of its own, which the careful path reads.
    let line_end = |at: usize| match bytes.get(at) {
        None | Some(b'\n') => Some(at + 1),
        Some(b'\r') if bytes.get(at + 1) == Some(&b'\n') => Some(at + 2),
        Some(_) => None,
    };
    // With signs, the number of leading blanks varies from row to row: up to two are skipped without a
    // branch.
    let mut at = usize::from(bytes.first() == Some(&b' '));
    at += usize::from(bytes.get(at) == Some(&b' '));
    blank(&mut at);
    let last = columns.len() - 1;
    for (column, values) in columns.iter_mut().enumerate() {
        if column > 0
            && let Separator::Char(mark) = shape.separator
            && mark != b'\t'
        {
            if bytes.get(at) != Some(&mark) {
                return None;
            }
            at += 1;
            blank(&mut at);
        }
        let (value, used) = value(&bytes[at..], shape)?;
        *values.next()? = value;
        at += used;
        // Two numbers must not touch each other.
        let before = at;
        blank(&mut at);
        let touching = before == at
            && column < last
            && !matches!(shape.separator, Separator::Char(mark) if bytes.get(at) == Some(&mark));
        if touching {
            return None;
        }
    }
    line_end(at)
}
