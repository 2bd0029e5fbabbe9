//! Record 12 of data set 58: values in fixed columns, between blanks, or in binary.

use super::layout::Layout;
use super::sink::Sink;
use crate::uff::delimiter::is_delimiter;
use crate::uff::stream::Stream;
use crate::{missing, number};
use vibro_record::{Error, Result};

/// Numbers gathered before they go to the sink: they stay in the first-level cache.
const CHUNK: usize = 1536;

/// What is known when the values are done.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Taken {
    /// Points that went to the sink.
    pub n: usize,
    /// Missing values (NaN) among them.
    pub missing: usize,
}

/// Points on their way to the sink.
struct Chunk<'a, S> {
    sink: &'a mut S,
    numbers: Vec<f64>,
    columns: usize,
    /// Numbers still expected behind those that are here.
    due: usize,
    taken: usize,
    missing: usize,
}

impl<'a, S: Sink> Chunk<'a, S> {
    fn new(sink: &'a mut S, columns: usize, n: usize) -> Self {
        let numbers = Vec::with_capacity(CHUNK + 16);
        Chunk { sink, numbers, columns, due: n.saturating_mul(columns), taken: 0, missing: 0 }
    }

    /// Index of the first number that is not finite.
    fn odd(&self) -> Option<usize> {
        // No early end: this loop is vectorised, and nearly always finds nothing.
        let any = self.numbers.iter().fold(false, |any, v| any | !v.is_finite());
        if any { self.numbers.iter().position(|v| !v.is_finite()) } else { None }
    }

    /// Hands whole points on; numbers that are not finite are missing ones.
    fn flush(&mut self) {
        if let Some(first) = self.odd() {
            for value in self.numbers[first..].iter_mut().filter(|v| !v.is_finite()) {
                *value = f64::NAN;
            }
        }
        let whole = self.numbers.len() / self.columns * self.columns;
        self.missing += self.numbers[..whole].iter().filter(|v| v.is_nan()).count();
        self.sink.take(&self.numbers[..whole]);
        self.taken += whole / self.columns;
        self.numbers.drain(..whole);
    }

    fn end(mut self) -> Taken {
        self.flush();
        Taken { n: self.taken, missing: self.missing }
    }
}

/// Reads at most `n` points of text; stops before the closing delimiter.
pub fn text<S: Sink>(
    stream: &mut Stream,
    layout: Layout,
    n: usize,
    allow_missing: bool,
    sink: &mut S,
) -> Result<Taken> {
    let widths = layout.widths();
    let mut chunk = Chunk::new(sink, layout.columns(), n);
    while chunk.due > 0 {
        let (bytes, lines) = full_lines(stream.buffer()?, widths, &mut chunk.numbers, &mut chunk.due);
        stream.consume_lines(bytes, lines);
        if chunk.numbers.len() >= CHUNK {
            chunk.flush();
        }
        if lines > 0 {
            continue;
        }
        if !stream.next_line()? {
            break;
        }
        if is_delimiter(stream.text()) {
            stream.hold();
            break;
        }
        if stream.too_long() {
            return Err(Error::input(
                stream.place(),
                "a line of more than a million characters among the values of data set 58",
                "lines of 80 characters",
            ));
        }
        let before = chunk.numbers.len();
        if !stream.terminated() {
            last_line(stream.text(), widths, &mut chunk.numbers);
            chunk.numbers.truncate(before + chunk.due);
            break;
        }
        odd_line(stream, widths, allow_missing, &mut chunk.numbers)?;
        chunk.numbers.truncate(before + chunk.due); // what fills the last line is not data
        chunk.due -= chunk.numbers.len() - before;
    }
    Ok(chunk.end())
}

/// Reads lines that hold a full row of fixed-width numbers, the usual case, straight from the buffer. Gives bytes and
/// lines used; stops at the first line that is anything else.
fn full_lines(buffer: &[u8], widths: &[usize], numbers: &mut Vec<f64>, due: &mut usize) -> (usize, u64) {
    let (mut at, mut lines) = (0, 0);
    while *due >= widths.len() && numbers.len() < CHUNK {
        let before = numbers.len();
        let Some(used) = full_line(&buffer[at..], widths, numbers) else {
            numbers.truncate(before);
            break;
        };
        at += used;
        lines += 1;
        *due -= widths.len();
    }
    (at, lines)
}

#[inline]
fn full_line(bytes: &[u8], widths: &[usize], numbers: &mut Vec<f64>) -> Option<usize> {
    let mut at = 0;
    for &width in widths {
        let field = bytes.get(at..at + width)?;
        let printed = match width {
            13 => field.try_into().ok().and_then(number::scientific::<13>),
            _ => field.try_into().ok().and_then(number::scientific::<20>),
        };
        let touches = || at > 0 && bytes[at - 1] != b' ';
        numbers.push(printed.or_else(|| fixed_field(field, width, touches()))?);
        at += width;
    }
    loop {
        match bytes.get(at)? {
            b'\n' => return Some(at + 1),
            b' ' | b'\r' => at += 1,
            _ => return None,
        }
    }
}

/// The one number of a fixed-width field, which the end of the line may have cut short.
///
/// A number that touches the field before it must begin with its sign or fill its field: else the line has other widths
/// than the standard's, and this is the rest of a longer number.
#[inline]
fn fixed_field(field: &[u8], width: usize, touches: bool) -> Option<f64> {
    let blanks = field.iter().take_while(|b| **b == b' ').count();
    let (value, used) = number::prefix(field.get(blanks..)?, b'.')?;
    let end = blanks + used;
    if field[end..].iter().any(|b| *b != b' ') {
        return None;
    }
    let separate = !touches || blanks > 0 || used == width || matches!(field[0], b'-' | b'+');
    separate.then_some(value)
}

/// Numbers of a line in fixed columns; the last field may lack its trailing blanks.
fn by_columns(line: &[u8], widths: &[usize], numbers: &mut Vec<f64>) -> bool {
    let line = line.trim_ascii_end();
    let before = numbers.len();
    let mut at = 0;
    for &width in widths {
        if at >= line.len() {
            break;
        }
        let end = (at + width).min(line.len());
        let touches = at > 0 && line[at - 1] != b' ';
        let Some(value) = fixed_field(&line[at..end], width, touches) else { break };
        numbers.push(value);
        at = end;
    }
    let all = at >= line.len();
    if !all {
        numbers.truncate(before);
    }
    all
}

/// Numbers of a line that is not a full row: by columns where that works, else by blanks.
fn odd_line(stream: &Stream, widths: &[usize], allow_missing: bool, numbers: &mut Vec<f64>) -> Result<()> {
    if by_columns(stream.text(), widths, numbers) {
        return Ok(());
    }
    for (column, token) in tokens(stream.text()) {
        match number::parse(token) {
            Some(value) => numbers.push(value),
            None if allow_missing && number::is_missing(token) => numbers.push(f64::NAN),
            None => return Err(odd_token(stream, column, token)),
        }
    }
    Ok(())
}

/// Numbers of a line that ends with the file and not with a line end. What stands last may be half a number that looks
/// like a whole one: it counts only where it fills its field.
fn last_line(line: &[u8], widths: &[usize], numbers: &mut Vec<f64>) {
    let mut whole = 0;
    for width in widths {
        if whole + width <= line.len() {
            whole += width;
        }
    }
    let before = line[..whole].last().copied().unwrap_or(b' ');
    let behind = line.get(whole).copied().unwrap_or(b' ');
    let between = before == b' ' || matches!(behind, b' ' | b'-' | b'+');
    if between && whole > 0 && by_columns(&line[..whole], widths, numbers) {
        return;
    }
    for (column, token) in tokens(line) {
        let ends = column - 1 + token.len();
        match number::parse(token) {
            Some(value) if ends < line.len() => numbers.push(value),
            _ => break,
        }
    }
}

/// Tokens between blanks, with their columns from 1.
fn tokens(line: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut at = 0;
    line.split(u8::is_ascii_whitespace)
        .map(move |token| {
            let column = at + 1;
            at += token.len() + 1;
            (column, token)
        })
        .filter(|(_, token)| !token.is_empty())
}

#[cold]
fn odd_token(stream: &Stream, column: usize, token: &[u8]) -> Error {
    let found = String::from_utf8_lossy(&token[..token.len().min(40)]).into_owned();
    let found = format!("{found:?} among the values of data set 58");
    let place = stream.place().column(column as u64);
    if number::is_missing(token) {
        return missing::refusal(place, found);
    }
    Error::input(place, found, "numbers in the columns of record 12 or between blanks, or the closing -1")
}

/// How binary numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binary {
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Whether the abscissa of double-precision values has double precision too, which the standard does not provide.
    pub wide_abscissa: bool,
}

/// Reads at most `n` binary points of the next `available` bytes.
pub fn binary<S: Sink>(
    stream: &mut Stream,
    layout: Layout,
    storage: Binary,
    (n, available): (usize, u64),
    allow_missing: bool,
    sink: &mut S,
) -> Result<Taken> {
    let size = layout.point_size(storage.wide_abscissa);
    let n = n.min(usize::try_from(available / size as u64).unwrap_or(usize::MAX));
    let mut chunk = Chunk::new(sink, layout.columns(), n);
    let at_once = CHUNK / layout.columns();
    let mut straddling = [0; 24];
    while chunk.taken < n {
        let left = n - chunk.taken;
        let position = stream.position();
        let buffer = stream.buffer()?;
        let whole = (buffer.len() / size).min(left).min(at_once);
        if whole > 0 {
            decode(&buffer[..whole * size], layout, storage, &mut chunk.numbers);
            stream.consume_binary(whole * size);
        } else {
            let point = &mut straddling[..size];
            if !stream.take_binary(point)? {
                break;
            }
            decode(point, layout, storage, &mut chunk.numbers);
        }
        if !allow_missing && let Some(index) = chunk.odd() {
            let byte = position + (index / layout.columns() * size) as u64;
            return Err(missing::refusal(stream.byte_place(byte), "a value that is not a finite number"));
        }
        chunk.flush();
    }
    Ok(chunk.end())
}

fn decode(bytes: &[u8], layout: Layout, storage: Binary, numbers: &mut Vec<f64>) {
    let single = |b: &[u8; 4]| {
        f64::from(if storage.big_endian { f32::from_be_bytes(*b) } else { f32::from_le_bytes(*b) })
    };
    let double =
        |b: &[u8; 8]| if storage.big_endian { f64::from_be_bytes(*b) } else { f64::from_le_bytes(*b) };
    if !layout.double {
        numbers.extend(bytes.as_chunks().0.iter().map(single));
    } else if layout.even || storage.wide_abscissa {
        numbers.extend(bytes.as_chunks().0.iter().map(double));
    } else {
        for point in bytes.chunks_exact(layout.point_size(false)) {
            let Some((abscissa, values)) = point.split_first_chunk() else { continue };
            numbers.push(single(abscissa));
            numbers.extend(values.as_chunks().0.iter().map(double));
        }
    }
}
