//! The fast path: rectangular rows of real numbers and nothing else, read in pieces by several threads.
//!
//! Anything unexpected (a comment, a missing value, a ragged row, a word) makes this path give up, and
//! [`super::rows`] reads the file again, line by line, to say exactly what stands where.

use super::layout::{Layout, Separator};
use crate::error::{Error, Result};
use crate::read::{Source, number};
use std::io::{Read, SeekFrom};

/// Bytes read at a time: small enough to stay in the second-level cache.
const BLOCK: usize = 256 * 1024;

/// Pieces smaller than this are not worth a thread.
const SMALLEST_PIECE: u64 = 1024 * 1024;

/// Values of a piece, and whether blank lines stand behind them.
type Piece = (Vec<f64>, bool);

/// All values, row by row; `None` where the file is not clean.
pub fn read(source: &Source, layout: &Layout) -> Result<Option<Vec<f64>>> {
    let (from, to) = (layout.first_byte as u64, source.len());
    let threads = rayon::current_num_threads().max(1) as u64;
    let count = ((to - from) / SMALLEST_PIECE).clamp(1, threads);
    let bounds: Vec<u64> = (0..=count).map(|i| from + (to - from) * i / count).collect();
    let guess = |bytes: u64| (bytes / 12) as usize; // a shorter line only means that the vector grows
    let parts: Vec<Result<Option<Piece>>> = if count == 1 {
        vec![collect(source, layout, from, to, guess(to - from))]
    } else {
        let mut parts: Vec<_> = (0..count).map(|_| Ok(None)).collect();
        rayon::scope(|scope| {
            for (i, part) in parts.iter_mut().enumerate() {
                let (a, b) = (bounds[i], bounds[i + 1]);
                // The first piece makes room for all, so that joining copies only the others.
                let room = if i == 0 { guess(to - from) } else { guess(b - a) };
                scope.spawn(move |_| *part = collect(source, layout, a, b, room));
            }
        });
        parts
    };
    let mut values = Vec::new();
    let mut ended = false;
    for part in parts {
        let Some((part, blank_behind)) = part? else { return Ok(None) };
        if ended && !part.is_empty() {
            return Ok(None); // rows behind blank lines
        }
        ended |= blank_behind;
        if values.is_empty() {
            values = part;
        } else {
            values.extend_from_slice(&part);
        }
    }
    Ok((!values.is_empty()).then_some(values))
}

fn collect(source: &Source, layout: &Layout, from: u64, to: u64, room: usize) -> Result<Option<Piece>> {
    let mut values = Vec::with_capacity(room);
    let end = scan(source, layout, from, to, |v| values.push(v))?;
    Ok(end.map(|blank_behind| (values, blank_behind)))
}

/// Streams the values of all rows that start in `from..to` into `sink`. Gives whether blank lines stand behind the
/// rows, or `None` where the bytes are not clean (the sink may have taken values by then).
pub fn scan(
    source: &Source,
    layout: &Layout,
    from: u64,
    to: u64,
    mut sink: impl FnMut(f64),
) -> Result<Option<bool>> {
    let mut file = source.open()?;
    let first = from == layout.first_byte as u64;
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
            match row(&buffer[at..complete], layout, &mut sink) {
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
fn value(bytes: &[u8], layout: &Layout) -> Option<(f64, usize)> {
    if let Some((parse, width)) = layout.exponential {
        let first = *bytes.first()?;
        let sign = usize::from(matches!(first, b'-' | b'+'));
        // What follows must end the number, or it is longer than the others.
        let ended = bytes.get(sign + width).is_none_or(|b| !b.is_ascii_digit());
        if let Some(magnitude) = bytes.get(sign..sign + width).filter(|_| ended).and_then(parse) {
            return Some((if first == b'-' { -magnitude } else { magnitude }, sign + width));
        }
    }
    number::prefix(bytes, layout.decimal)
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
fn row(bytes: &[u8], layout: &Layout, sink: &mut impl FnMut(f64)) -> Row {
    let blank = |at: &mut usize| {
        while bytes.get(*at).is_some_and(|b| matches!(b, b' ' | b'\r' | b'\t')) {
            *at += 1;
        }
    };
    // Signs make the number of leading blanks random: take two without a branch.
    let mut at = usize::from(bytes.first() == Some(&b' '));
    at += usize::from(bytes.get(at) == Some(&b' '));
    blank(&mut at);
    if matches!(bytes.get(at), None | Some(b'\n')) {
        return Row::Blank(at + 1);
    }
    for column in 0..layout.columns {
        if column > 0
            && let Separator::Char(mark) = layout.separator
            && mark != b'\t'
        {
            if bytes.get(at) != Some(&mark) {
                return Row::Odd;
            }
            at += 1;
            blank(&mut at);
        }
        let Some((value, used)) = value(&bytes[at..], layout) else { return Row::Odd };
        sink(value);
        at += used;
        // Two numbers must not touch.
        let before = at;
        blank(&mut at);
        let touching = before == at
            && column + 1 < layout.columns
            && !matches!(layout.separator, Separator::Char(mark) if bytes.get(at) == Some(&mark));
        if touching {
            return Row::Odd;
        }
    }
    match bytes.get(at) {
        None | Some(b'\n') => Row::Values(at + 1),
        _ => Row::Odd,
    }
}
