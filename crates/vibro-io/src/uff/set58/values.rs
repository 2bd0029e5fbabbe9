//! Record 12 of data set 58: values in fixed columns, between blanks, or in binary.

use super::heading::Heading;
use super::layout::Layout;
use crate::binary::NumberType;
use crate::uff::stream::{Stream, closes, is_delimiter};
use crate::{missing, number};
use vibro_record::{Error, Finding, Result};

/// Reads text values, at most as many as the header declares; stops before the closing delimiter.
pub fn text(stream: &mut Stream, heading: &Heading, allow_missing: bool) -> Result<Vec<f64>> {
    let widths = heading.layout.widths();
    let due = heading.n.saturating_mul(heading.layout.columns());
    // Memory for values of the usual 13 bytes; the vector grows if they are shorter.
    let mut numbers = Vec::with_capacity(due.min(stream.rest().len() / 13 + 1));
    while numbers.len() < due {
        let before = numbers.len();
        let used = by_columns(stream.rest(), widths, &mut numbers);
        let full = numbers.len() - before == widths.len();
        if let Some(used) = used.filter(|used| full || !is_delimiter(&stream.rest()[..*used])) {
            stream.take_line(used);
            continue;
        }
        numbers.truncate(before);
        let Some(line) = stream.line_within() else { break };
        if stream.terminated() {
            by_blanks(stream, line, allow_missing, &mut numbers)?;
        } else {
            last_line(line, widths, &mut numbers);
        }
    }
    numbers.truncate(due); // numbers that pad the last line
    Ok(numbers)
}

/// Reads the line at the start of `bytes` in fixed columns and returns its length including its end; `None`
/// if it does not fit the columns. The last field may lack its trailing blanks.
#[inline]
fn by_columns(bytes: &[u8], widths: &[usize], numbers: &mut Vec<f64>) -> Option<usize> {
    let line_end = |at: usize| Some(at + bytes[at..].iter().position(|b| *b == b'\n')?);
    let mut at = 0;
    for &width in widths {
        // A full row as Fortran prints it is the usual case.
        let printed = bytes.get(at..at + width).and_then(|field| match width {
            13 => number::scientific::<13>(field.try_into().ok()?),
            _ => number::scientific::<20>(field.try_into().ok()?),
        });
        if let Some(value) = printed {
            numbers.push(value);
            at += width;
            continue;
        }
        let rest = bytes[at..line_end(at)?].trim_ascii_end();
        if rest.is_empty() {
            break;
        }
        let field = &rest[..width.min(rest.len())];
        numbers.push(fixed_field(field, width, at > 0 && bytes[at - 1] != b' ')?);
        at += field.len();
    }
    let end = line_end(at)?;
    bytes[at..end].trim_ascii().is_empty().then_some(end + 1)
}

/// The one number of a fixed-width field, which the end of the line may have cut short.
///
/// A number that touches the field before it must begin with its sign or fill its field. Otherwise the line
/// has other widths than the standard's, and this is the rest of a longer number.
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

/// Reads the numbers of a line that are separated by blanks.
fn by_blanks(stream: &Stream, line: &[u8], allow_missing: bool, numbers: &mut Vec<f64>) -> Result<()> {
    for (column, token) in tokens(line) {
        match number::parse(token) {
            Some(value) => numbers.push(value),
            None if allow_missing && number::is_missing(token) => numbers.push(f64::NAN),
            None => {
                let shown = String::from_utf8_lossy(&token[..token.len().min(40)]).into_owned();
                let found = format!("{shown:?} among the values of data set 58");
                let place = stream.place().column(column as u64);
                if number::is_missing(token) {
                    return Err(missing::refusal(place, found));
                }
                let expected = "numbers in the columns of record 12 or between blanks, or the closing -1";
                return Err(Error::input(place, found, expected));
            }
        }
    }
    Ok(())
}

/// Reads the numbers of a last line without a line end. Its last number may be cut short and still look
/// complete, so it counts only if it fills its field.
fn last_line(line: &[u8], widths: &[usize], numbers: &mut Vec<f64>) {
    let whole =
        widths.iter().fold(0, |whole, width| if whole + width <= line.len() { whole + width } else { whole });
    let behind = line.get(whole).copied().unwrap_or(b' ');
    let between = whole > 0 && (line[whole - 1] == b' ' || matches!(behind, b' ' | b'-' | b'+'));
    let before = numbers.len();
    if !between || by_columns(&[&line[..whole], b"\n"].concat(), widths, numbers).is_none() {
        numbers.truncate(before);
        let ended = tokens(line).filter(|(column, token)| column - 1 + token.len() < line.len());
        numbers.extend(ended.map_while(|(_, token)| number::parse(token)));
    }
}

/// Tokens separated by blanks, with their columns from 1.
fn tokens(line: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let tokens = line.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
    tokens.map(|token| (token.as_ptr() as usize - line.as_ptr() as usize + 1, token))
}

/// Byte order and size of the values of a 58b, from its number line (byte order, number format, header
/// lines, bytes): whether they are big-endian, and their bytes. The stated size is often wrong, so it is
/// only a hint.
pub fn storage(line: &[u8], stream: &Stream) -> Result<(bool, Option<usize>)> {
    let text = String::from_utf8_lossy(line);
    let mut fields = text.split_whitespace().skip(1);
    let (order, format) = (fields.next().unwrap_or(""), fields.next().unwrap_or(""));
    let found = match (order, format) {
        ("1" | "2", "2") => {
            let bytes = fields.nth(1).and_then(|f| f.parse().ok()).filter(|n| *n > 0);
            return Ok((order == "2", bytes));
        }
        (_, "1") => "binary numbers of DEC VMS".to_owned(),
        (_, "3") => "binary numbers of IBM 5/370".to_owned(),
        _ => format!("58b with byte order {order:?} and number format {format:?}"),
    };
    let expected = "byte order 1 or 2 and number format 2 (IEEE 754)";
    Err(Error::input(stream.place(), found, expected)
        .hint("export the record as ASCII (data set 58), which has one spelling of numbers"))
}

/// Reads binary numbers, at most as many as the header declares, with findings on a size that differs.
///
/// Record 7 determines the number of bytes. The closing `-1` decides only if they cannot all be present, if
/// the number line contradicts, or where writers differ (abscissa of double-precision values).
pub fn binary(
    stream: &mut Stream,
    heading: &Heading,
    (big_endian, noted): (bool, Option<usize>),
    allow_missing: bool,
) -> Result<(Vec<f64>, Vec<Finding>)> {
    let (layout, n, rest) = (heading.layout, heading.n, stream.rest());
    let size = |wide| layout.point_size(wide).saturating_mul(n);
    let closed = |bytes: usize| rest.get(bytes..).is_some_and(closes);
    let declared = size(false);
    let mixed = layout.double && !layout.even;
    let mut findings = Vec::new();
    let (mut wide, mut bytes) = (false, declared);
    if (noted == Some(declared) && declared <= rest.len() && !mixed) || closed(declared) {
    } else if mixed && closed(size(true)) {
        (wide, bytes) = (true, size(true));
        findings.push(Finding::note("abscissa-double"));
    } else if let Some(noted) = noted.filter(|bytes| closed(*bytes)) {
        bytes = noted;
        let other = Finding::caution("other-size").count("n", n).number("declared", declared as f64);
        findings.push(other.number("bytes", bytes as f64));
    } else {
        wide = mixed && noted == Some(size(true));
        bytes = size(wide);
        if bytes > rest.len() {
            // Cut short: the values end with the file, unless a delimiter follows them.
            let tail = rest.len().saturating_sub(100);
            let ends = |at: &usize| closes(&rest[*at..]) && rest[*at..].trim_ascii() == b"-1";
            bytes = (tail..rest.len()).find(ends).unwrap_or(rest.len());
        } else {
            let open = Finding::doubt("no-closing-line").number("bytes", bytes as f64);
            findings.push(open.without_estimate());
        }
    }
    let point = layout.point_size(wide);
    let used = n.min(bytes / point) * point;
    let mut numbers = decode(stream.take_block(used), layout, big_endian, wide);
    // Without an early exit, this loop is vectorised; it nearly always finds nothing.
    if numbers.iter().fold(false, |any, v| any | !v.is_finite()) {
        let odd = numbers.iter().position(|v| !v.is_finite()).unwrap_or(0);
        if !allow_missing {
            let place = stream.byte_place(used - odd / layout.columns() * point);
            return Err(missing::refusal(place, "a value that is not a finite number"));
        }
        numbers.iter_mut().filter(|v| !v.is_finite()).for_each(|v| *v = f64::NAN);
    }
    Ok((numbers, findings))
}

fn decode(bytes: &[u8], layout: Layout, big_endian: bool, wide: bool) -> Vec<f64> {
    let single =
        |b: &[u8; 4]| f64::from(if big_endian { f32::from_be_bytes(*b) } else { f32::from_le_bytes(*b) });
    let double = |b: &[u8; 8]| if big_endian { f64::from_be_bytes(*b) } else { f64::from_le_bytes(*b) };
    if !layout.double || layout.even || wide {
        let (kind, mut numbers) = (if layout.double { NumberType::F64 } else { NumberType::F32 }, Vec::new());
        kind.take(bytes, 0, kind.size() as usize, big_endian, &mut numbers);
        return numbers;
    }
    let points = bytes.chunks_exact(layout.point_size(false)).filter_map(|point| point.split_first_chunk());
    points.flat_map(|(x, y)| std::iter::once(single(x)).chain(y.as_chunks().0.iter().map(double))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eight_cases_are_numbered_as_in_the_standard() {
        let mut case = 0;
        for double in [false, true] {
            for complex in [false, true] {
                for even in [true, false] {
                    case += 1;
                    assert_eq!(Layout { complex, double, even }.case(), case);
                }
            }
        }
    }
}
