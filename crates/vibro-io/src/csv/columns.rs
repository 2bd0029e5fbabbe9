//! Rows of numbers to columns.

use super::layout::Layout;
use super::rows::{Line, Lines, cut};
use crate::cut_off::CUT_OFF;
use crate::footer::{Footer, again};
use crate::missing::Missing;
use crate::number;
use crate::reader::Options;
use std::path::Path;
use vibro_record::{Error, Place, Result};

/// How many comments between rows are kept.
const KEPT: usize = 32;

/// The numbers of a file.
#[derive(Debug, Default, PartialEq)]
pub struct Columns {
    /// One a name, all of one length; a missing value is NaN.
    pub values: Vec<Vec<f64>>,
    /// Number of missing values.
    pub missing: usize,
    /// Half a unit in the last digit that the abscissa was printed with, in its own unit.
    pub resolution: f64,
    /// Whether the decimal mark is a comma.
    pub comma: bool,
    /// Number of comments between and behind the rows.
    pub comments: usize,
    /// The first of them with their lines.
    pub kept: Vec<(u64, String)>,
    /// Words behind the rows.
    pub footer: Option<Footer>,
}

/// Reads all rows; `axis` is the column whose digits count.
///
/// # Errors
/// On the first field that is no number and the first row with another number of fields; on missing values, all at
/// once, unless they are allowed; on a missing value in the abscissa always.
pub fn read(
    path: &Path,
    text: &str,
    layout: &Layout,
    options: &Options,
    axis: Option<usize>,
) -> Result<Columns> {
    let decimal = decimal(text, layout, options);
    let n = layout.names.len();
    let mut columns = Columns { values: vec![Vec::new(); n], comma: decimal == b',', ..Columns::default() };
    let (mut fields, mut missing, mut digits) = (Vec::new(), Missing::default(), Digits::default());
    for line in Lines::from(text, layout.first.at, layout.first.number) {
        if let Some(comment) = line.comment() {
            columns.comments += 1;
            if columns.kept.len() < KEPT {
                columns.kept.push((line.number, comment.to_owned()));
            }
            continue;
        }
        if line.is_blank() || line.text == "\u{1a}" {
            continue;
        }
        cut(line.text, layout.separator, &mut fields).map_err(|at| {
            fault(path, &line, at, "text behind a closing quote", "a separator or the end of the line")
        })?;
        let last = line.at + line.text.len() == text.len();
        let blank_end = fields.last().is_some_and(|(_, f)| f.is_empty());
        let fits = fields.len() == n || (fields.len() == n + 1 && blank_end);
        if !fits || (n == 1 && fields.iter().any(|(_, f)| f.contains(' '))) {
            let rest = Lines::from(text, line.at, line.number);
            let whole = columns.values.first().map_or(0, Vec::len);
            columns.footer = Footer::of(whole, n, rest.map(|l| texts(&l, layout.separator)));
            if columns.footer.is_some() {
                break;
            }
        }
        if !fits {
            let at = fields.get(n).map_or(line.text.len(), |(at, _)| *at);
            let found = format!("{} field(s) in this row", fields.len());
            let expected = format!("{n}, as many as line {} names", layout.named_in);
            return Err(fault(path, &line, at, &found, &expected).hint(if last {
                CUT_OFF
            } else {
                "mend or remove the row"
            }));
        }
        for (i, ((at, field), values)) in fields.iter().zip(&mut columns.values).enumerate() {
            let bytes = field.as_bytes();
            let value = match number::parse_with(bytes, decimal) {
                Some(value) => value,
                None if number::is_missing(bytes) => {
                    if axis == Some(i) {
                        let expected = "a number in every row of the abscissa";
                        return Err(fault(path, &line, *at, &format!("found {field:?}"), expected)
                            .hint("remove the row"));
                    }
                    missing.take(line.number, 1, || layout.names[i].name.clone());
                    f64::NAN
                }
                None => {
                    let error = not_a_number(path, &line, *at, field, decimal);
                    let behind = Lines::from(text, line.at, line.number).skip(1);
                    return Err(match again(field, behind.map(|l| (l.number, l.text))) {
                        Some(others) => error.aside(others),
                        None if last => error.hint(CUT_OFF),
                        None => error,
                    });
                }
            };
            if axis == Some(i) {
                digits.take(bytes, decimal, value);
            }
            values.push(value);
        }
    }
    missing.check(path, options.allow_missing)?;
    columns.missing = missing.count;
    columns.resolution = digits.resolution();
    Ok(columns)
}

/// A line and its fields; itself where it cannot be cut.
fn texts(line: &Line, separator: char) -> (String, Vec<String>) {
    let mut fields = Vec::new();
    let cut = cut(line.text, separator, &mut fields);
    let whole = || vec![line.text.to_owned()];
    let fields = cut.map_or_else(|_| whole(), |()| fields.into_iter().map(|(_, f)| f.into_owned()).collect());
    (line.text.to_owned(), fields)
}

fn fault(path: &Path, line: &Line, at: usize, found: &str, expected: &str) -> Error {
    Error::input(Place::line(path, line.number).column(line.column(at)), found, expected)
}

fn not_a_number(path: &Path, line: &Line, at: usize, field: &str, decimal: u8) -> Error {
    let (expected, other) =
        if decimal == b',' { ("a number with a decimal comma", b'.') } else { ("a number", b',') };
    let hint = if number::parse_with(field.as_bytes(), other).is_some() {
        "if the decimal mark is a comma, give --decimal comma; if it is a point, --decimal point"
    } else {
        "write NaN in the place of a bad value and give --allow-missing; put # before the line if it is a remark"
    };
    let shown: String = field.chars().take(40).collect();
    fault(path, line, at, &format!("found {shown:?}"), expected).hint(hint)
}

/// The decimal mark: as stated, else the first comma or point in the rows, where commas do not separate.
fn decimal(text: &str, layout: &Layout, options: &Options) -> u8 {
    let comma = options.decimal_comma.unwrap_or_else(|| {
        Lines::from(text, layout.first.at, layout.first.number)
            .filter(|line| line.comment().is_none())
            .find_map(|line| line.text.bytes().find(|b| matches!(b, b',' | b'.')))
            == Some(b',')
    });
    if comma && layout.separator != ',' { b',' } else { b'.' }
}

/// How precisely a column is printed: with a fixed number of decimals, or of significant digits.
#[derive(Debug, Default)]
struct Digits {
    significant: i32,
    decimals: i32,
    largest: f64,
}

impl Digits {
    fn take(&mut self, field: &[u8], decimal: u8, value: f64) {
        let end = field.iter().position(u8::is_ascii_alphabetic).unwrap_or(field.len());
        let (mantissa, exponent) = field.split_at(end);
        let exponent =
            exponent.get(1..).and_then(|e| std::str::from_utf8(e).ok()?.parse::<i32>().ok()).unwrap_or(0);
        let count = |bytes: &[u8]| bytes.iter().filter(|b| b.is_ascii_digit()).count() as i32;
        let behind = mantissa.iter().position(|b| *b == decimal).map_or(0, |at| count(&mantissa[at..]));
        let leading = mantissa.iter().position(|b| (b'1'..=b'9').contains(b)).unwrap_or(mantissa.len());
        self.significant = self.significant.max(count(&mantissa[leading..]));
        self.decimals = self.decimals.max(behind.saturating_sub(exponent));
        self.largest = self.largest.max(value.abs());
    }

    /// Numbers printed with `%.3f` share their last decimal, those of `%.6g` their number of digits: the coarser of both
    /// bounds is right for either, and for the shortest form that reads back.
    fn resolution(&self) -> f64 {
        let leading = if self.largest > 0.0 { self.largest.log10().floor() as i32 + 1 } else { 0 };
        let unit = |exponent: i32| 10f64.powi(exponent);
        0.5 * unit(-self.decimals).max(unit(leading.saturating_sub(self.significant)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::detect;
    use super::*;

    fn columns(text: &str, options: &Options) -> Result<Columns> {
        let layout = detect(text, options, true).unwrap();
        read(Path::new("x.csv"), text, &layout, options, Some(0))
    }

    fn complaint(text: &str) -> String {
        columns(text, &Options::default()).unwrap_err().to_string()
    }

    #[test]
    fn numbers_and_marks() {
        let plain = columns("t,a\n0,1.5\n1,-2e-3\n\n# end\n\u{1a}", &Options::default()).unwrap();
        assert_eq!(plain.values, [[0.0, 1.0], [1.5, -2e-3]]);
        assert_eq!((plain.comments, plain.kept), (1, vec![(5, "end".to_owned())]));
        // The first mark decides, however late it comes.
        let comma = columns("t;a\n0;1\n1;\"2,5\"\n", &Options::default()).unwrap();
        assert_eq!((comma.values[1].as_slice(), comma.comma), ([1.0, 2.5].as_slice(), true));
    }

    #[test]
    fn complaints_name_line_and_column() {
        assert!(
            complaint("t,a\n0,1\n1,x\n")
                .starts_with("x.csv, line 3, column 3: found \"x\"; expected a number")
        );
        assert!(
            complaint("t;a\n0;1,5\n1;2.5\n")
                .contains("line 3, column 3: found \"2.5\"; expected a number with a decimal comma")
        );
        let ragged = complaint("t,a\n0,1\n1,2,3\n");
        assert!(
            ragged.contains("line 3, column 5: 3 field(s) in this row; expected 2, as many as line 1 names"),
            "{ragged}"
        );
        assert!(complaint("t,a\n0,1\n1\n").contains("line 3, column 2: 1 field(s)"));
        assert!(complaint("t,a\n0,1\n1,\"2\"3\n").contains("line 3, column 6: text behind a closing quote"));
        assert!(complaint("t,a\n0,1\nNaN,3\n").contains("line 3, column 1: found \"NaN\""));
    }

    #[test]
    fn missing_values_are_refused_with_their_lines_or_kept() {
        let text = "t,a,b\n0,1,2\n1,,NaN\n2,-inf,1\n";
        let error = complaint(text);
        assert!(
            error.contains("line 3: 3 missing value(s)") && error.contains("3 (\"a\"), 3 (\"b\"), 4 (\"a\")"),
            "{error}"
        );
        let options = Options { allow_missing: true, ..Options::default() };
        let kept = columns(text, &options).unwrap();
        assert_eq!(kept.missing, 3);
        assert!(kept.values[1][1].is_nan() && kept.values[1][2].is_nan() && kept.values[2][2] == 1.0);
    }

    #[test]
    fn the_resolution_of_printed_digits() {
        let of = |texts: &[&str]| {
            let mut digits = Digits::default();
            for text in texts {
                digits.take(text.as_bytes(), b'.', number::parse(text.as_bytes()).unwrap());
            }
            digits.resolution()
        };
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(of(&["0.000", "0.001", "12.345"]), 0.5e-3));
        assert!(close(of(&["1.000E-03", "1.234E+01"]), 0.5e-2));
        assert!(close(of(&["0.0009765", "10.0001"]), 0.5e-4));
        assert!(close(of(&["0", "1", "2"]), 0.5));
        // Shortest forms: 0.1 + 0.2 has 17 digits, and so may the others have had.
        assert!(of(&["0", "0.1", "0.30000000000000004", "0.5"]) < 1e-16);
    }
}
