//! Columns of numbers, with or without header lines: what analysers print.
//!
//! ```text
//! SPS390 SPECTRUM            header lines: free text, `key: value`, or remarks behind # % ! * ' " //
//! 20 Hz 400 lines
//!   4.001992e-02             one value a line; or columns between blanks, tabs, commas or semicolons
//!   2.001233e-02
//! ```
//! Complex values stand as `(re+imj)` or as two columns under a header with `real` and `imag`.

use super::dialect::{Abscissa, Cell, Dialect, Head, Separator};
use super::lines::{Line, Lines, fields};
use super::{names, shorten};
use crate::{Format, Options, number};
use vibro_record::{Error, Place, Result};

const REMARKS: &[&str] = &["#", "%", "!", "*", "'", "\"", "//"];

/// Rows that tell the dialect where no comma makes it doubtful.
const ENOUGH: usize = 24;

/// What to try where digits may be grouped; such numbers are not read.
pub(crate) const GROUPED: &str = "state the decimal mark if a comma separates two numbers; if digits are grouped in threes, export them without";

/// Finds the dialect from the first rows.
///
/// # Errors
/// If there is no row of numbers, or if it cannot be told whether commas are decimal marks.
pub fn detect(head: &Head, options: &Options) -> Result<Dialect> {
    let mut header = Vec::new();
    let mut rows: Vec<Line> = Vec::new();
    let mut comma = false;
    for line in Lines::new(&head.text, 0, 1, REMARKS).filter(|l| !l.is_blank()) {
        if rows.len() >= ENOUGH && !comma {
            break;
        }
        if line.remark.is_none() && is_row(line.text.as_bytes()) {
            comma |= line.text.contains(',');
            rows.push(line);
        } else if rows.is_empty() {
            header.push((line.number, line.remark.unwrap_or(line.text.trim()).to_owned()));
        } else if line.remark.is_none() {
            break; // reading the rows will complain, with the place
        }
    }
    let Some(first) = rows.first() else {
        let found = match header.first() {
            Some((n, text)) => format!("no row of numbers (line {n} is {:?})", shorten(text)),
            None => "no row of numbers".to_owned(),
        };
        return Err(Error::input(Place::file(&head.path), found, "one or more numbers a line")
            .hint("name the format if it is another; give a list of files to `vibro response`")
            .setting("format"));
    };
    let (separator, decimal) = marks(head, &rows, options)?;
    let mut cells = fields(first.text, separator).unwrap_or_default();
    while cells.len() > 1 && cells.last().is_some_and(|(_, c)| c.is_empty()) {
        cells.pop();
    }
    let imaginary = |c: &str| {
        number::parse_with(c.as_bytes(), decimal).is_none() && complex(c.as_bytes(), decimal).is_some()
    };
    let whole = imaginary(first.text.trim());
    let cell = if whole || cells.iter().any(|(_, c)| imaginary(c)) { Cell::Complex } else { Cell::Real };
    let columns = if whole && separator == Separator::Blank { 1 } else { cells.len() };
    Ok(Dialect {
        format: Format::Ascii,
        separator,
        decimal,
        decimal_open: false,
        cell,
        columns,
        names: names::above(&header, columns, separator),
        abscissa: Abscissa::Rising,
        remarks: REMARKS,
        blank_rows: true,
        columns_from: first.number,
        first_line: first.number,
        header,
    })
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

/// Separator and decimal mark.
fn marks(head: &Head, rows: &[Line], options: &Options) -> Result<(Separator, u8)> {
    const COMMA: Separator = Separator::Char(b',');
    let any = |test: &dyn Fn(&str) -> bool| rows.iter().any(|r| test(r.text.trim()));
    let explicit = [b';', b'\t'].into_iter().find(|mark| any(&|line| line.as_bytes().contains(mark)));
    let explicit = explicit.map(Separator::Char);
    if !any(&|line| line.contains(',')) {
        return Ok((explicit.unwrap_or(Separator::Blank), b'.'));
    }
    let ask = |what: &str| {
        let Line { number, text, .. } = rows[0];
        let found = format!("{:?} may be one number {what} or two numbers", shorten(text.trim()));
        Error::input(Place::line(&head.path, number), found, "a file where this can be told")
    };
    let points = any(&|line| line.contains('.'));
    let comma = match options.decimal_comma {
        Some(comma) => comma,
        None if points && explicit.is_none() && grouped(rows) => {
            return Err(ask("with grouped digits").hint(GROUPED).setting("decimal"));
        }
        // Points are decimal marks, so commas separate.
        None if points => false,
        None if explicit.is_some() => true,
        // `1, 2` or a field with two commas: commas separate.
        None if any(&|line| {
            line.ends_with(',')
                || line.as_bytes().windows(2).any(|w| w[0] == b',' && w[1].is_ascii_whitespace())
                || line.split_ascii_whitespace().any(|f| f.find(',') != f.rfind(','))
        }) =>
        {
            false
        }
        // Several fields between blanks, each with at most one comma; or one that no integer column would print.
        None if any(&|line| line.split_ascii_whitespace().count() > 1) || any(&no_integers) => true,
        None => {
            return Err(ask("with a decimal comma").hint("say which: comma or point").setting("decimal"));
        }
    };
    Ok(if comma { (explicit.unwrap_or(Separator::Blank), b',') } else { (explicit.unwrap_or(COMMA), b'.') })
}

/// Whether a comma in a line cannot stand between two integers.
fn no_integers(line: &str) -> bool {
    let Some((left, right)) = line.split_once(',') else { return false };
    let leading_zero = right.starts_with('0') && right[1..].starts_with(|c: char| c.is_ascii_digit());
    left == "-0" || leading_zero || right.contains(['e', 'E', 'd', 'D'])
}

/// Whether every row is one number with decimals, and some have their digits grouped in threes: `1.234,50` or `1,234.50`.
fn grouped(rows: &[Line]) -> bool {
    [('.', ','), (',', '.')].iter().any(|&(group, decimal)| {
        let groups: Option<Vec<usize>> =
            rows.iter().map(|row| groups(row.text.trim(), group, decimal)).collect();
        groups.is_some_and(|groups| groups.iter().any(|n| *n > 1))
    })
}

/// Number of groups of digits before the decimal mark; `None` where a line is no such number.
fn groups(line: &str, group: char, decimal: char) -> Option<usize> {
    let (whole, decimals) = line.strip_prefix(['-', '+']).unwrap_or(line).split_once(decimal)?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let mut parts = whole.split(group);
    let first = parts.next()?;
    let rest: Vec<&str> = parts.collect();
    // Nobody groups `0.123`.
    let leads = first.len() <= 3 && digits(first) && (rest.is_empty() || !first.starts_with('0'));
    let all = leads && digits(decimals) && rest.iter().all(|part| part.len() == 3 && digits(part));
    all.then_some(1 + rest.len())
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

    fn with(text: &str, options: &Options) -> Result<Dialect> {
        detect(&Head::of(&crate::Source::memory("x.txt", text.as_bytes())?)?, options)
    }

    fn layout(text: &str) -> Result<Dialect> {
        with(text, &Options::default())
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
        assert!(error.contains("(decimal)"), "{error}");
        let comma = Options { decimal_comma: Some(true), ..Options::default() };
        assert_eq!(with("1,5\n", &comma).unwrap().columns, 1);
        let point = Options { decimal_comma: Some(false), ..Options::default() };
        assert_eq!(with("1,5\n", &point).unwrap().columns, 2);
    }

    #[test]
    fn grouped_digits_are_asked_about() {
        for text in ["1.234,50\n2.345,60\n", "-1,234.50\n", "999,50\n1.000,25\n"] {
            let error = layout(text).unwrap_err().to_string();
            assert!(error.contains("grouped") && error.contains("(decimal)"), "{text}: {error}");
            let point = Options { decimal_comma: Some(false), ..Options::default() };
            let columns = with(text, &point).unwrap().columns;
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
