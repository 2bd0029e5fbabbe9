//! Finding out how a text file of numbers is laid out.

use super::fixed::Fixed;
use super::grouping::{GROUPED, grouped};
use super::rows::without_end_mark;
use crate::Options;
use crate::number::{self, Exponential};
use std::path::Path;
use vibro_record::{Error, Place, Result};

/// What stands between two values of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// Any run of spaces and tabs.
    Blank,
    /// One character: `,`, `;` or tab.
    Char(u8),
}

/// What one cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// One real number.
    Real,
    /// `(re+imj)`, `re+imj`, `re - im i`, …
    Complex,
}

/// How rows are to be cut and read.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Lines before the first row of numbers, without comment marks, with their line numbers.
    pub header: Vec<(u64, String)>,
    /// Line number of the first row, from 1.
    pub first_line: u64,
    /// Byte offset of the first row.
    pub first_byte: usize,
    /// Separator of values.
    pub separator: Separator,
    /// Decimal mark.
    pub decimal: u8,
    /// Values a row.
    pub columns: usize,
    /// Real or complex.
    pub cell: Cell,
    /// Parser of unsigned numbers and their width, where the first rows print them all like `1.234e+05`.
    pub exponential: Option<(Exponential, usize)>,
    /// Shape of the rows, where the first ones are all alike.
    pub fixed: Option<Fixed>,
}

/// Rows that tell the layout where no comma makes it doubtful.
const ENOUGH: usize = 24;

/// Lines of `bytes` with their numbers and offsets, ended by LF or CRLF. A lone CR is converted before.
pub fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, usize, &[u8])> {
    let mut offset = 0;
    bytes.split(|b| *b == b'\n').enumerate().map(move |(i, line)| {
        let start = offset;
        offset += line.len() + 1;
        (i as u64 + 1, start, line)
    })
}

/// The text of a comment line, without its mark; `None` where the line is no comment.
pub fn comment(line: &[u8]) -> Option<&[u8]> {
    let line = line.trim_ascii();
    let rest = line
        .strip_prefix(b"//")
        .or_else(|| line.first().filter(|b| b"#%!*'\"".contains(b)).map(|_| &line[1..]))?;
    // `*****` is how Fortran prints a number that does not fit: a value, not a comment.
    let stars = line.len() > 1 && line.iter().all(|b| *b == b'*');
    (!stars).then(|| rest.trim_ascii_start())
}

/// Whether every token of a line is a number, a piece of a complex number or a missing value, and at least one is a number.
fn is_row(line: &[u8]) -> bool {
    let mut numbers = 0;
    for token in line.split(|b| b" \t,;\r".contains(b)).filter(|t| !t.is_empty()) {
        if number::parse(token).is_some() || complex(token, b'.').is_some() {
            numbers += 1;
        } else if !number::is_missing(token) && !matches!(token, b"+" | b"-") {
            return false;
        }
    }
    numbers > 0
}

/// Finds the layout from the first bytes of a file.
///
/// # Errors
/// If there is no row of numbers, or if it cannot be told whether commas are decimal marks.
pub fn detect(path: &Path, head: &[u8], cut: bool, options: &Options) -> Result<Layout> {
    let mut header = Vec::new();
    let mut rows: Vec<(u64, usize, &[u8])> = Vec::new();
    let mut comma = false;
    // The last line of the head may be half a line.
    let whole = if cut {
        &head[..head.iter().rposition(|b| *b == b'\n').unwrap_or(head.len())]
    } else {
        without_end_mark(head)
    };
    let mark = if whole.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    for (number, start, line) in lines(&whole[mark..]).map(|(n, start, line)| (n, start + mark, line)) {
        if rows.len() >= ENOUGH && !comma {
            break;
        }
        if line.trim_ascii().is_empty() {
            continue;
        }
        if let Some(text) = comment(line) {
            if rows.is_empty() {
                header.push((number, decode_line(text)));
            }
        } else if is_row(line) {
            comma |= line.contains(&b',');
            rows.push((number, start, line));
        } else if rows.is_empty() {
            header.push((number, decode_line(line)));
        } else {
            break; // reading the rows will complain, with the place
        }
    }
    let Some(&(first_line, first_byte, first)) = rows.first() else {
        let found = match header.first() {
            Some((n, text)) => format!("no row of numbers (line {n} is {:?})", shorten(text)),
            None => "no row of numbers".to_owned(),
        };
        return Err(Error::input(Place::file(path), found, "one or more numbers a line").hint(
            "if this is another format, name it with --format; if it is a list of files, give it to `vibro response`",
        ));
    };
    let (separator, decimal) = marks(path, &rows, options)?;
    let mut cells = Vec::new();
    cut_row(first, separator, &mut cells);
    let whole = decode_line(first);
    let imaginary = |c: &[u8]| number::parse_with(c, decimal).is_none() && complex(c, decimal).is_some();
    let cell = if cells.iter().any(|c| imaginary(c.1)) || imaginary(whole.trim().as_bytes()) {
        Cell::Complex
    } else {
        Cell::Real
    };
    let spaced = cell == Cell::Complex && separator == Separator::Blank && imaginary(whole.trim().as_bytes());
    let columns = if spaced { 1 } else { cells.len() };
    let exponential = exponential(&rows, separator, decimal);
    let mut layout = Layout {
        header,
        first_line,
        first_byte,
        separator,
        decimal,
        columns,
        cell,
        exponential,
        fixed: None,
    };
    layout.fixed = Fixed::of(&rows, &layout);
    Ok(layout)
}

/// The parser for numbers of one width, if all rows hold such numbers.
fn exponential(
    rows: &[(u64, usize, &[u8])],
    separator: Separator,
    decimal: u8,
) -> Option<(Exponential, usize)> {
    let mut width = None;
    let mut cells = Vec::new();
    for (_, _, row) in rows {
        cut_row(row, separator, &mut cells);
        for (_, cell) in &cells {
            let unsigned = cell.strip_prefix(b"-").or(cell.strip_prefix(b"+")).unwrap_or(cell);
            if *width.get_or_insert(unsigned.len()) != unsigned.len()
                || number::exponential(unsigned).is_none()
            {
                return None;
            }
        }
    }
    let width = width.filter(|_| decimal == b'.')?;
    number::exponential_of(width).map(|parse| (parse, width))
}

fn decode_line(line: &[u8]) -> String {
    let line = line.trim_ascii();
    std::str::from_utf8(line)
        .map_or_else(|_| line.iter().map(|b| char::from(*b)).collect(), str::to_owned)
        .trim_start_matches('\u{feff}')
        .to_owned()
}

/// The first characters of a text, for messages.
pub fn shorten(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { format!("{short}…") } else { short }
}

/// Separator and decimal mark.
fn marks(path: &Path, rows: &[(u64, usize, &[u8])], options: &Options) -> Result<(Separator, u8)> {
    let any = |test: &dyn Fn(&[u8]) -> bool| rows.iter().any(|r| test(r.2));
    let has = |mark: u8| any(&|line| line.contains(&mark));
    let explicit = if has(b';') {
        Some(Separator::Char(b';'))
    } else if any(&|line| line.trim_ascii().contains(&b'\t')) {
        Some(Separator::Char(b'\t'))
    } else {
        None
    };
    if !has(b',') {
        return Ok((explicit.unwrap_or(Separator::Blank), b'.'));
    }
    match options.decimal_comma {
        Some(true) => return Ok((explicit.unwrap_or(Separator::Blank), b',')),
        Some(false) => return Ok((explicit.unwrap_or(Separator::Char(b',')), b'.')),
        None => {}
    }
    if has(b'.') {
        if explicit.is_none() && grouped(rows) {
            let (line, _, text) = rows[0];
            let found = format!(
                "{:?} may be one number with grouped digits or two numbers",
                shorten(&decode_line(text))
            );
            return Err(
                Error::input(Place::line(path, line), found, "a file where this can be told").hint(GROUPED)
            );
        }
        // Points are decimal marks, so commas separate.
        return Ok((explicit.unwrap_or(Separator::Char(b',')), b'.'));
    }
    if explicit.is_some() {
        return Ok((explicit.unwrap_or(Separator::Blank), b','));
    }
    // `1, 2` or a field with two commas: commas separate.
    if any(&|line| {
        let line = line.trim_ascii();
        line.ends_with(b",")
            || line.windows(2).any(|w| w[0] == b',' && w[1].is_ascii_whitespace())
            || line
                .split(u8::is_ascii_whitespace)
                .any(|f| f.iter().position(|b| *b == b',') != f.iter().rposition(|b| *b == b','))
    }) {
        return Ok((Separator::Char(b','), b'.'));
    }
    // Several fields between blanks, each with at most one comma: decimal commas.
    if any(&|line| line.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).count() > 1) {
        return Ok((Separator::Blank, b','));
    }
    // One comma a line. What no integer column would print decides for the decimal comma.
    let decisive = any(&|line| {
        let line = line.trim_ascii();
        let Some(at) = line.iter().position(|b| *b == b',') else { return false };
        let (left, right) = (&line[..at], &line[at + 1..]);
        let leading_zero = right.len() > 1 && right[0] == b'0' && right[1].is_ascii_digit();
        left == b"-0" || leading_zero || right.iter().any(|b| b"eEdD".contains(b))
    });
    if decisive {
        return Ok((Separator::Blank, b','));
    }
    let (line, _, text) = rows[0];
    let text = decode_line(text);
    Err(Error::input(
        Place::line(path, line),
        format!("{:?} may be one number with a decimal comma or two numbers", shorten(&text)),
        "a file where this can be told",
    )
    .hint("say which: --decimal comma, or --decimal point"))
}

/// Cuts a row into cells with their byte offset in the line.
pub fn cut_row<'a>(line: &'a [u8], separator: Separator, cells: &mut Vec<(usize, &'a [u8])>) {
    cells.clear();
    let from = line.as_ptr() as usize;
    let offset = |cell: &[u8]| cell.as_ptr() as usize - from;
    match separator {
        Separator::Blank => {
            for cell in line.split(|b| b" \t\r".contains(b)).filter(|c| !c.is_empty()) {
                cells.push((offset(cell), cell));
            }
        }
        Separator::Char(mark) => {
            let line = line.trim_ascii_end();
            for cell in line.split(|b| *b == mark) {
                let cell = cell.trim_ascii();
                cells.push((offset(cell), cell));
            }
            // A separator behind the last value makes no further cell.
            if cells.len() > 1 && cells.last().is_some_and(|c| c.1.is_empty()) {
                cells.pop();
            }
        }
    }
}

/// Reads `(re+imj)` and its relatives; a bare number has no imaginary part and is accepted.
pub fn complex(text: &[u8], decimal: u8) -> Option<(f64, f64)> {
    let text = text.trim_ascii();
    let text = match text.strip_prefix(b"(") {
        Some(inner) => inner.strip_suffix(b")")?.trim_ascii(),
        None => text,
    };
    let unit = |b: &u8| b"ijIJ".contains(b);
    let (first, used) = number::prefix(text, decimal)?;
    let rest = text[used..].trim_ascii_start();
    match rest {
        [] => return Some((first, 0.0)),
        [i] if unit(i) => return Some((0.0, first)),
        _ => {}
    }
    let sign = match rest[0] {
        b'+' => 1.0,
        b'-' => -1.0,
        _ => return None,
    };
    let mut rest = rest[1..].trim_ascii_start();
    let before = rest.first().is_some_and(unit);
    if before {
        rest = rest[1..].trim_ascii_start();
        rest = rest.strip_prefix(b"*").unwrap_or(rest).trim_ascii_start();
    }
    let (second, used) = number::prefix(rest, decimal)?;
    let rest = rest[used..].trim_ascii_start();
    let rest = rest.strip_prefix(b"*").unwrap_or(rest);
    let ends = if before { rest.is_empty() } else { rest.len() == 1 && unit(&rest[0]) };
    ends.then_some((first, sign * second))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Result<Layout> {
        detect(Path::new("x.txt"), text.as_bytes(), false, &Options::default())
    }

    fn shape(text: &str) -> (Separator, u8, usize, Cell) {
        let l = layout(text).unwrap();
        (l.separator, l.decimal, l.columns, l.cell)
    }

    #[test]
    fn separators_and_decimal_marks() {
        use Cell::Real;
        use Separator::{Blank, Char};
        assert_eq!(shape("1.5\n2.5\n"), (Blank, b'.', 1, Real));
        assert_eq!(shape("  1.5  2.5\n"), (Blank, b'.', 2, Real));
        assert_eq!(shape("1.5,2.5\n"), (Char(b','), b'.', 2, Real));
        assert_eq!(shape("1,5;2,5\n"), (Char(b';'), b',', 2, Real));
        assert_eq!(shape("1,5\t2,5\n"), (Char(b'\t'), b',', 2, Real));
        assert_eq!(shape("1,5 2,5\n"), (Blank, b',', 2, Real));
        assert_eq!(shape("1, 2\n3, 4\n"), (Char(b','), b'.', 2, Real));
        assert_eq!(shape("1,2,3\n"), (Char(b','), b'.', 3, Real));
        assert_eq!(shape("3,0517\n"), (Blank, b',', 1, Real));
        assert_eq!(shape("1,5E-3\n"), (Blank, b',', 1, Real));
        assert_eq!(shape("1;2;\n"), (Char(b';'), b'.', 2, Real));
    }

    #[test]
    fn an_ambiguous_comma_is_asked_about() {
        let error = layout("1,5\n2,5\n").unwrap_err().to_string();
        assert!(error.contains("--decimal comma"), "{error}");
        let comma = Options { decimal_comma: Some(true), ..Options::default() };
        assert_eq!(detect(Path::new("x"), b"1,5\n", false, &comma).unwrap().columns, 1);
        let point = Options { decimal_comma: Some(false), ..Options::default() };
        assert_eq!(detect(Path::new("x"), b"1,5\n", false, &point).unwrap().columns, 2);
    }

    #[test]
    fn grouped_digits_are_asked_about() {
        for text in ["1.234,50\n2.345,60\n", "-1,234.50\n", "999,50\n1.000,25\n"] {
            let error = layout(text).unwrap_err().to_string();
            assert!(error.contains("grouped") && error.contains("--decimal point"), "{text}: {error}");
            let point = Options { decimal_comma: Some(false), ..Options::default() };
            let columns = detect(Path::new("x"), text.as_bytes(), false, &point).unwrap().columns;
            assert_eq!(columns, text.lines().next().unwrap().split(',').count(), "{text}");
        }
        for text in ["0.123,50\n", "1.234,50\n1.2345,5\n", "1.234,5e1\n", "1.234,50\n12,5\n0.100,5\n"] {
            assert_eq!(shape(text), (Separator::Char(b','), b'.', 2, Cell::Real), "{text}");
        }
    }

    #[test]
    fn complex_spellings() {
        for text in ["(1.5-2e-3j)", "1.5-2e-3i", "1.5 - 2e-3i", "1.5 - i2e-3", "1.5-j*2e-3", "(1.5-2e-3*I)"] {
            assert_eq!(complex(text.as_bytes(), b'.'), Some((1.5, -2e-3)), "{text}");
        }
        assert_eq!(complex(b"2j", b'.'), Some((0.0, 2.0)));
        for text in ["(1+2j", "1+2", "1+2jj", "j", "1+j", "", "()"] {
            assert_eq!(complex(text.as_bytes(), b'.'), None, "{text}");
        }
        assert_eq!(shape("(1-2j)\n"), (Separator::Blank, b'.', 1, Cell::Complex));
        assert_eq!(shape("1.0 - 2.0i\n"), (Separator::Blank, b'.', 1, Cell::Complex));
        assert_eq!(shape("5.0;(1-2j)\n"), (Separator::Char(b';'), b'.', 2, Cell::Complex));
    }

    #[test]
    fn header_lines_end_where_numbers_begin() {
        let l = layout("SPS390 SPECTRUM\n20 Hz 400 lines\n# note\n\n 4.0e-02\n").unwrap();
        assert_eq!(l.header.len(), 3);
        assert_eq!(l.first_line, 5);
        assert_eq!(l.header[2].1, "note");
        assert!(layout("no numbers\nat all\n").is_err());
    }
}
