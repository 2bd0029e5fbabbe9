//! Detects columns of numbers, with or without header lines, as analysers print them.
//!
//! ```text
//! SPS390 SPECTRUM            header lines: free text, `key: value`, or remarks after # % ! * ' " //
//! 20 Hz 400 lines
//!   4.001992e-02             one value a line; or columns between blanks, tabs, commas or semicolons
//!   2.001233e-02
//! ```
//! Complex values are written `(re+imj)`, or as two columns under a header with `real` and `imag`.

use super::decoded::{Text, in_line, shorten};
use super::dialect::Dialect;
use super::lines::{Fields, Line, Lines, Separator, fields, is_torn};
use super::names::Name;
use super::near_number::{plain_form, unit_of};
use super::table::beginning;
use super::{clock, name_line};
use crate::format::Format;
use crate::number;
use crate::options::Options;
use num_complex::Complex64;
use vibro_record::{Error, Result};

/// Marks that begin a remark above the rows. Between rows only the first five (`BETWEEN`) do, since a quote
/// there begins a cell.
const REMARKS: [&str; 7] = ["#", "%", "!", "*", "//", "'", "\""];
const BETWEEN: &[&str] = REMARKS.split_at(5).0;

/// Number of rows from which the dialect is detected. If one of them has a comma, which may be a separator
/// or a decimal mark, all rows in the head of the file are used.
const ENOUGH: usize = 24;

/// Finds the dialect from the first rows.
///
/// # Errors
/// If there is no row of numbers, or if it is ambiguous whether commas are decimal marks.
pub fn detect(text: &Text, options: &Options) -> Result<Dialect> {
    let (above, mut rows) = first_rows(text);
    let said = |l: &Line| l.remark.unwrap_or(l.text.trim()).to_owned();
    let mut header: Vec<String> = above.iter().map(said).collect();
    let stated = count_and_step(&rows);
    rows.drain(..usize::from(stated.is_some()));
    header.extend(stated);
    let Some(mut first) = rows.first() else {
        return Err(stray(&above).unwrap_or_else(|| without_rows(header.first())));
    };
    let (separator, decimal) = marks(&rows, options)?;
    let mut cells = fields(first.text, separator).unwrap_or_default();
    while cells.len() > 1 && cells.last().is_some_and(|(_, c)| c.is_empty()) {
        cells.pop();
    }
    let imaginary = |c: &str| {
        number::parse_with(c.as_bytes(), decimal).is_none() && complex(c.as_bytes(), decimal).is_some()
    };
    // In a line with a comma there are two numbers, not one complex number.
    let whole = !first.text.contains(',') && imaginary(first.text.trim());
    let complex = whole || cells.iter().any(|(_, c)| imaginary(c));
    // Rows above the first good one that cannot be parsed belong to the table. Reading them reports the
    // error with line and column.
    let torn = |l: &&Line| l.remark.is_none() && is_torn(l.text, separator, cells.len());
    let named = above.len() - above.iter().rev().take_while(torn).count();
    if named < above.len() && name_line::above(&header[..named], cells.len(), separator).is_some() {
        first = &above[named];
        header.truncate(named);
    }
    let clock = clock::columns(&cells);
    let joined = clock.as_ref().map_or(0, |cells| cells.len() - 1);
    let columns = if whole && separator == Separator::Blank { 1 } else { cells.len() - joined };
    Ok(Dialect {
        format: Format::Ascii,
        separator,
        decimal,
        stated: options.decimal_comma.is_some(),
        complex,
        columns,
        skipped: 0,
        clock,
        names: names_above(&header, &rows, columns, separator),
        remarks: BETWEEN,
        columns_from: first.number,
        first_line: first.number,
        header,
    })
}

/// The lines above the rows of numbers, and the first rows.
fn first_rows<'a>(text: &'a Text) -> (Vec<Line<'a>>, Vec<Line<'a>>) {
    let (mut above, mut rows) = (Vec::new(), Vec::new());
    let mut comma = false;
    let begin = beginning(&text.head);
    for line in Lines::new(&text.head, 0, 1, &REMARKS).filter(|l| !l.is_blank()) {
        if rows.len() >= ENOUGH && !comma {
            break;
        }
        if line.remark.is_none() && line.number > begin && is_row(line.text.as_bytes()) {
            comma |= line.text.contains(',');
            rows.push(line);
        } else if rows.is_empty() {
            above.push(line);
        } else if line.remark.is_none() {
            break; // reading the rows will report the error with its place
        }
    }
    (above, rows)
}

/// Error for a text without rows of numbers that begins with the line `first`.
fn without_rows(first: Option<&String>) -> Error {
    let found = match first {
        Some(line) => format!("no table of numbers; the first line is {:?}", shorten(line)),
        None => "no table of numbers".to_owned(),
    };
    Error::usage(found, "one or more numbers a line").hint(
        "export it again as a table: names in the first line, then rows of numbers between commas or tabs",
    )
}

/// Names of the columns in the last line of the header.
fn names_above(header: &[String], rows: &[Line], columns: usize, separator: Separator) -> Option<Vec<Name>> {
    // A first column that counts the rows often has no name.
    let number = |line: &Line| number::parse(fields(line.text, separator).ok()?.first()?.1.as_bytes());
    let counted = || rows.windows(2).all(|w| number(&w[0]).map(|n| n + 1.0) == number(&w[1]));
    let named = |columns| name_line::above(header, columns, separator);
    let unnumbered = || named(columns.checked_sub(1).filter(|n| *n > 0 && counted())?);
    let behind = |names: Vec<Name>| [vec![Name::default()], names].concat();
    named(columns).or_else(|| unnumbered().map(behind))
}

/// Cuts a line at tabs, semicolons or commas, else at blanks.
fn cells<'a>(line: &Line<'a>) -> Option<Fields<'a>> {
    let cut = |separator| fields(line.text, separator).ok();
    let marks = [b'\t', b';', b','].map(Separator::Char).into_iter();
    marks.filter_map(cut).find(|cells| cells.len() > 1).or_else(|| cut(Separator::Blank))
}

/// Error for a file without a row of numbers: names the first cell that is not a number. It is in the first
/// of the last lines, all of which have numbers in the same cells.
fn stray(lines: &[Line]) -> Option<Error> {
    let begins = |cell: &str| number::prefix(cell.as_bytes(), b'.').is_some();
    let numbers = |line: &Line| -> Vec<bool> {
        cells(line).unwrap_or_default().iter().map(|(_, cell)| begins(cell)).collect()
    };
    let lines: Vec<&Line> = lines.iter().filter(|line| line.remark.is_none()).collect();
    let last = numbers(lines.last()?);
    let first = lines.iter().rposition(|line| numbers(line) != last).map_or(0, |above| above + 1);
    if lines.len() < first + 2 || !last.contains(&true) {
        return None;
    }
    let fine = |cell: &str| {
        let bytes = cell.as_bytes();
        number::either(bytes).is_some() || number::is_missing(bytes) || clock::is_clock(cell)
    };
    let row = cells(lines[first])?;
    let at = row.iter().position(|(_, cell)| !fine(cell))?;
    let (byte, cell) = &row[at];
    let place = in_line(lines[first].number).column(lines[first].column(*byte));
    let error = |cell: &str| {
        Error::input(place, format!("{cell:?}, and no row of numbers"), "a number in every cell of a row")
    };
    let turned = at == 0 && row.len() > lines.len() - first && !begins(cell);
    if turned {
        return Some(error(&shorten(cell)).hint(
            "if each row is a channel, turn the table so that each is a column: in a sheet, copy and paste transposed",
        ));
    }
    let Some(unit) = unit_of(cell) else {
        let as_text = || "take out the column, or what is no number in its cells, and read again".to_owned();
        return Some(error(&shorten(cell)).hint(plain_form(cell).unwrap_or_else(as_text)));
    };
    let is_other = |line: &&Line| {
        let row = cells(line).unwrap_or_default();
        row.get(at).and_then(|(_, cell)| unit_of(cell)).is_some_and(|other| other != unit)
    };
    Some(error(cell).hint(if lines[first..].iter().any(is_other) {
        format!("export all cells of this column in one unit: here {unit} and others stand")
    } else {
        // Without the unit, a time in ms would be read in s.
        format!(
            "take {unit} out of all cells of this column, and write it behind the column's name above the rows: \
             name [{unit}]"
        )
    }))
}

/// Header line made from `300 0.005` above rows of three or more columns: number of values and step in s,
/// as Fortran programs write them.
fn count_and_step(rows: &[Line]) -> Option<String> {
    let columns = |i: usize| rows.get(i).map_or(0, |line| line.text.split_whitespace().count());
    let (count, step) = rows.first()?.text.trim().split_once(char::is_whitespace)?;
    let whole = count.bytes().all(|b| b.is_ascii_digit()) && step.contains('.');
    let stated = whole && number::parse(step.as_bytes()).is_some();
    (stated && columns(2) > 2 && columns(1) == columns(2))
        .then(|| format!("NPTS={count}, DT={}", step.trim()))
}

/// Whether a line is a row: every token is a number, a part of a complex number, a missing value or a clock
/// time, and at least one is a number.
fn is_row(line: &[u8]) -> bool {
    let timed = line.contains(&b':');
    let mut numbers = 0;
    let polar = |cell: &[u8]| number::parse(cell).is_some() || complex(cell, b'.').is_some();
    if line.contains(&b'\t') && line.contains(&b'(') && line.split(|b| *b == b'\t').all(polar) {
        return true;
    }
    for token in line.split(|b| b" \t,;\r".contains(b)).filter(|t| !t.is_empty()) {
        if number::parse(token).is_some() || complex(token, b'.').is_some() {
            numbers += 1;
        } else {
            let neutral = number::is_missing(token) || matches!(token, b"+" | b"-" | b"->");
            let timed = timed && std::str::from_utf8(token).is_ok_and(clock::is_clock);
            if !(neutral || timed) {
                return false;
            }
        }
    }
    numbers > 0
}

/// Detects separator and decimal mark; an error if a comma may be either.
fn marks(rows: &[Line], options: &Options) -> Result<(Separator, u8)> {
    const COMMA: Separator = Separator::Char(b',');
    let any = |test: &dyn Fn(&str) -> bool| rows.iter().any(|r| test(r.text.trim()));
    let explicit = [b';', b'\t'].into_iter().find(|mark| any(&|line| line.as_bytes().contains(mark)));
    let explicit = explicit.map(Separator::Char);
    if !any(&|line| line.contains(',')) {
        return Ok((explicit.unwrap_or(Separator::Blank), b'.'));
    }
    let doubtful = || {
        let Line { number, text: row, .. } = rows[0];
        let found = format!("{:?} may be one number or two numbers", shorten(row.trim()));
        Error::input(in_line(number), found, "a file where this can be told")
            .hint("say which mark is the decimal one: comma or point; export grouped digits without groups")
            .setting("decimal")
    };
    let comma = match options.decimal_comma {
        // All rows are whole numbers, and one has a comma that cannot separate two integers: it separates
        // thousands.
        Some(false) if explicit.is_none() && any(&no_integers) && !any(&|line| !is_whole(line)) => {
            return Ok((Separator::Blank, b'.'));
        }
        Some(comma) => comma,
        None if explicit.is_none() && grouped(rows) => return Err(doubtful()),
        // With decimal points, commas separate.
        None if any(&|line| line.contains('.')) => false,
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
        // Commas are decimal marks if blanks separate the fields, or if a comma cannot separate two
        // integers.
        None if any(&|line| line.split_ascii_whitespace().count() > 1) || any(&no_integers) => true,
        None => return Err(doubtful()),
    };
    Ok(if comma { (explicit.unwrap_or(Separator::Blank), b',') } else { (explicit.unwrap_or(COMMA), b'.') })
}

/// Whether a line is a whole number, with or without thousands separators.
fn is_whole(line: &str) -> bool {
    number::may_be_grouped(line.as_bytes()) || line.bytes().all(|b| b.is_ascii_digit() || b == b'-')
}

/// Whether the comma in a line cannot separate two integers: `-0,5`, `1,057`, `1,5e3`.
fn no_integers(line: &str) -> bool {
    let Some((left, right)) = line.split_once(',') else { return false };
    let leading_zero = right.starts_with('0') && right[1..].starts_with(|c: char| c.is_ascii_digit());
    left == "-0" || leading_zero || right.contains(['e', 'E', 'd', 'D'])
}

/// Whether every row is one number with decimals, and some have thousands separators: `1.234,50` or
/// `1,234.50`.
fn grouped(rows: &[Line]) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    // Number of groups of three digits after the first group: 0 for `0.123`. `None` if the line is not such
    // a number.
    let groups = |line: &str, group: char, decimal: char| {
        let (whole, decimals) = line.strip_prefix(['-', '+']).unwrap_or(line).split_once(decimal)?;
        let (first, rest) = whole.split_once(group).unwrap_or((whole, ""));
        let rest: Vec<&str> = rest.split(group).filter(|part| !part.is_empty()).collect();
        let leads = first.len() <= 3 && digits(first) && (rest.is_empty() || !first.starts_with('0'));
        let all = leads && digits(decimals) && rest.iter().all(|part| part.len() == 3 && digits(part));
        all.then_some(rest.len())
    };
    [('.', ','), (',', '.')].iter().any(|&(group, decimal)| {
        let all: Option<Vec<usize>> = rows.iter().map(|r| groups(r.text.trim(), group, decimal)).collect();
        all.is_some_and(|all| all.iter().any(|n| *n > 0))
    })
}

/// Reads a complex number, `(re+imj)`, `re + im i` and the like, or a pair as circuit simulators print it.
/// A bare number has the imaginary part 0.
pub fn complex(text: &[u8], decimal: u8) -> Option<Complex64> {
    let text = text.trim_ascii();
    if let Some(comma) = text.iter().position(|b| *b == b',').filter(|_| decimal == b'.') {
        return pair(&text[..comma], &text[comma + 1..]);
    }
    let text = match text.strip_prefix(b"(") {
        Some(inner) => inner.strip_suffix(b")")?.trim_ascii(),
        None => text,
    };
    let Some((b'i' | b'j' | b'I' | b'J', imaginary)) = text.split_last() else {
        return number::parse_with(text, decimal).map(Into::into);
    };
    let imaginary = imaginary.strip_suffix(b"*").unwrap_or(imaginary).trim_ascii();
    // The parts are split at the last sign that is not part of an exponent. `1.5+210i` is two parts, since
    // an exponent needs its letter.
    let sign = |at: &usize| matches!(imaginary[*at], b'+' | b'-') && !b"eEdDqQ".contains(&imaginary[*at - 1]);
    let (real, imaginary) = match (1..imaginary.len()).rfind(sign) {
        None => (0.0, number::parse_with(imaginary, decimal)?),
        Some(at) => {
            let part = number::parse_with(imaginary[at + 1..].trim_ascii(), decimal)?;
            let real = number::parse_with(&imaginary[..at], decimal)?;
            (real, if imaginary[at] == b'-' { -part } else { part })
        }
    };
    Some(Complex64::new(real, imaginary))
}

/// Real and imaginary part, both with an exponent, since `1,234` may be one number. Or level in dB and
/// angle in degrees: `(-3.1e+00dB,4.5e+01°)`.
fn pair(first: &[u8], second: &[u8]) -> Option<Complex64> {
    let level = first.strip_prefix(b"(").and_then(|first| first.strip_suffix(b"dB"));
    if let Some(level) = level.map(number::parse) {
        let degrees = second.strip_suffix("°)".as_bytes()).and_then(number::parse)?;
        return Some(Complex64::from_polar(10f64.powf(level? / 20.0), degrees.to_radians()));
    }
    let part = |text: &[u8]| number::parse(text).filter(|_| text.contains(&b'e'));
    Some(Complex64::new(part(first)?, part(second)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(text: &str, options: &Options) -> Result<Dialect> {
        detect(&Text::of(&crate::source::Source::memory("x.txt", text.as_bytes())?, None), options)
    }

    fn layout(text: &str) -> Result<Dialect> {
        with(text, &Options::default())
    }

    fn shape(text: &str) -> (Separator, u8, usize, bool) {
        let l = layout(text).unwrap();
        (l.separator, l.decimal, l.columns, l.complex)
    }

    #[test]
    fn separators_and_decimal_marks() {
        use Separator::{Blank, Char};
        assert_eq!(shape("1.5\n2.5\n"), (Blank, b'.', 1, false));
        assert_eq!(shape("  1.5  2.5\n"), (Blank, b'.', 2, false));
        assert_eq!(shape("1.5,2.5\n"), (Char(b','), b'.', 2, false));
        assert_eq!(shape("1,5;2,5\n"), (Char(b';'), b',', 2, false));
        assert_eq!(shape("1,5\t2,5\n"), (Char(b'\t'), b',', 2, false));
        assert_eq!(shape("1,5 2,5\n"), (Blank, b',', 2, false));
        assert_eq!(shape("1, 2\n3, 4\n"), (Char(b','), b'.', 2, false));
        assert_eq!(shape("1,2,3\n"), (Char(b','), b'.', 3, false));
        assert_eq!(shape("3,0517\n"), (Blank, b',', 1, false));
        assert_eq!(shape("1,5E-3\n"), (Blank, b',', 1, false));
        assert_eq!(shape("1;2;\n"), (Char(b';'), b'.', 2, false));
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
        // No thousands separators, since the digits are not in threes, have an exponent or a leading zero:
        // commas separate.
        for text in ["0.123,50\n", "1.234,50\n1.2345,5\n", "1.234,5e1\n", "1.234,50\n12,5\n0.100,5\n"] {
            assert_eq!(shape(text), (Separator::Char(b','), b'.', 2, false), "{text}");
        }
    }

    #[test]
    fn complex_spellings() {
        for text in ["(1.5-2e-3j)", "1.5-2e-3i", "1.5 - 2e-3i", "(1.5-2e-3*I)"] {
            assert_eq!(complex(text.as_bytes(), b'.'), Some(Complex64::new(1.5, -2e-3)), "{text}");
        }
        assert_eq!(complex(b"2j", b'.'), Some(Complex64::new(0.0, 2.0)));
        // No exponent without its letter.
        for (text, re, im) in [
            ("1.5+210i", 1.5, 210.0),
            ("(1101.5-201j)", 1101.5, -201.0),
            ("0+210.551560556573i", 0.0, 210.551_560_556_573),
            ("-0.00395030847979745+2.9645842249887E-6i", -0.003_950_308_479_797_45, 2.964_584_224_988_7e-6),
            ("1e-3-101j", 1e-3, -101.0),
        ] {
            assert_eq!(complex(text.as_bytes(), b'.'), Some(Complex64::new(re, im)), "{text}");
        }
        for text in ["(1+2j", "1+2", "1+2jj", "j", "1+j", "", "()"] {
            assert_eq!(complex(text.as_bytes(), b'.'), None, "{text}");
        }
        assert_eq!(shape("(1-2j)\n"), (Separator::Blank, b'.', 1, true));
        assert_eq!(shape("1.0 - 2.0i\n"), (Separator::Blank, b'.', 1, true));
        assert_eq!(shape("5.0;(1-2j)\n"), (Separator::Char(b';'), b'.', 2, true));
    }

    #[test]
    fn header_lines_end_where_numbers_begin() {
        let l = layout("SPS390 SPECTRUM\n20 Hz 400 lines\n# note\n\n 4.0e-02\n").unwrap();
        assert_eq!(l.header.len(), 3);
        assert_eq!(l.first_line, 5);
        assert_eq!(l.header[2], "note");
        assert!(layout("no numbers\nat all\n").is_err());
    }
}
