//! The careful path: one row after the other, each complaint with its line and column.

use super::dialect::{Cell, Dialect};
use super::footer::{Footer, again};
use super::lines::Line;
use super::numbers::{GROUPED, complex};
use super::tail::CUT_OFF;
use super::{shorten, table};
use crate::missing::Missing;
use crate::number;
use num_complex::Complex64;
use std::path::Path;
use vibro_record::{Error, Place, Result, Values};

/// How many remarks between rows are kept.
const KEPT: usize = 32;

/// Columns of numbers and what was met on the way.
#[derive(Debug, Default, PartialEq)]
pub struct Rows {
    /// One a column, all of one length; a missing value is NaN.
    pub columns: Vec<Values>,
    /// Number of missing values.
    pub missing: usize,
    /// Number of remarks between and behind the rows.
    pub remarks: usize,
    /// The first of them with their lines.
    pub kept: Vec<(u64, String)>,
    /// Words behind the rows.
    pub footer: Option<Footer>,
    /// Number of rows where only the largest value is kept.
    pub counted: Option<usize>,
}

/// Reads all rows from the first one on.
///
/// # Errors
/// On the first field that is no number and the first row with another number of fields; on missing values, all at once, unless
/// they are allowed; on a missing value in a column that its name makes the abscissa always; on more blank lines than values that
/// the bytes could hold.
pub fn read(path: &Path, text: &str, dialect: &Dialect, allow_missing: bool) -> Result<Rows> {
    let late = dialect.decimal_open && table::first_mark(dialect, text) == Some(true);
    let dialect = &Dialect { decimal: if late { b',' } else { dialect.decimal }, ..dialect.clone() };
    let (n, abscissa) = (dialect.columns, dialect.named_abscissa());
    let reader = Reader { path, text, dialect };
    let mut rows = Rows::default();
    let mut columns: Vec<Vec<Complex64>> = vec![Vec::new(); n];
    let (mut missing, mut blank_since) = (Missing::default(), None);
    let lines = dialect.rows(text);
    for line in lines.clone() {
        if line.is_blank() {
            blank_since.get_or_insert(line.number);
            continue;
        }
        if let Some(remark) = line.remark {
            rows.remarks += 1;
            if rows.kept.len() < KEPT {
                rows.kept.push((line.number, remark.to_owned()));
            }
            continue;
        }
        let fields = dialect.cut(&line).map_err(|at| {
            reader.fault(&line, at, "text behind a closing quote", "a separator or the end of the line")
        })?;
        // One value a line: several words in it are no value.
        let words = n == 1 && dialect.cell == Cell::Real && fields[0].1.contains(' ');
        if fields.len() != n || words {
            let rest = lines.again(&line).map(|l| (l.text, reader.texts(&l)));
            rows.footer = Footer::of(columns[0].len(), n, rest);
            if rows.footer.is_some() {
                break;
            }
        }
        if fields.len() != n {
            return Err(reader.ragged(&line, &fields));
        }
        if let Some(since) = blank_since.take().filter(|_| dialect.blank_rows) {
            // Blank lines with rows behind them are rows without values.
            (since..line.number).for_each(|blank| missing.take(blank, n, ""));
            if allow_missing {
                let blanks = (line.number - since) as usize;
                // A blank line is one byte: many columns would make much of nothing.
                if blanks.saturating_mul(n) > text.len().saturating_sub(n * columns[0].len()) {
                    return Err(reader.too_many(since, blanks));
                }
                for column in &mut columns {
                    column.extend(std::iter::repeat_n(Complex64::new(f64::NAN, 0.0), blanks));
                }
            }
        }
        for (i, ((at, field), values)) in fields.iter().zip(&mut columns).enumerate() {
            values.push(match reader.value(field) {
                Some(value) => value,
                None if reader.is_missing(field) => {
                    if abscissa == Some(i) {
                        let expected = "a number in every row of the abscissa";
                        let fault = reader.fault(&line, *at, &format!("found {field:?}"), expected);
                        return Err(fault.hint("remove the row"));
                    }
                    missing.take(line.number, 1, dialect.names.as_ref().map_or("", |names| &names[i].name));
                    Complex64::new(f64::NAN, 0.0)
                }
                None => {
                    let error = reader.not_a_number(&line, *at, field);
                    let behind = lines.again(&line).skip(1).map(|l| (l.number, l.text));
                    return Err(match again(field, behind) {
                        Some(others) => error.aside(others),
                        None if reader.is_last(&line) => error.hint(CUT_OFF),
                        None => error,
                    });
                }
            });
        }
    }
    missing.check(path, allow_missing)?;
    rows.missing = missing.count;
    rows.columns = columns
        .into_iter()
        .map(|values| match dialect.cell {
            Cell::Complex => Values::Complex(values),
            Cell::Real => Values::Real(values.iter().map(|v| v.re).collect()),
        })
        .collect();
    Ok(rows)
}

/// What is read, for values and complaints.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    dialect: &'a Dialect,
}

impl Reader<'_> {
    fn value(&self, field: &str) -> Option<Complex64> {
        let (field, decimal) = (field.as_bytes(), self.dialect.decimal);
        match self.dialect.cell {
            Cell::Real => number::parse_with(field, decimal).map(|v| Complex64::new(v, 0.0)),
            Cell::Complex => complex(field, decimal).map(|(re, im)| Complex64::new(re, im)),
        }
    }

    fn is_missing(&self, field: &str) -> bool {
        let half = || {
            let lower = field.to_ascii_lowercase();
            self.dialect.cell == Cell::Complex && (lower.contains("nan") || lower.contains("inf"))
        };
        number::is_missing(field.as_bytes()) || half()
    }

    /// The fields of a line; itself where it cannot be cut.
    fn texts(&self, line: &Line) -> Vec<String> {
        let whole = || vec![line.text.to_owned()];
        self.dialect
            .cut(line)
            .map_or_else(|_| whole(), |f| f.into_iter().map(|(_, f)| f.into_owned()).collect())
    }

    /// Whether a line ends with the file and not with a line end.
    fn is_last(&self, line: &Line) -> bool {
        line.at + line.text.len() == self.text.len()
    }

    fn fault(&self, line: &Line, at: usize, found: &str, expected: &str) -> Error {
        Error::input(Place::line(self.path, line.number).column(line.column(at)), found, expected)
    }

    fn ragged(&self, line: &Line, fields: &super::lines::Fields) -> Error {
        let n = self.dialect.columns;
        let at = fields.get(n).map_or(line.text.len(), |(at, _)| *at);
        // A field that is no number says more than the number of fields.
        let odd = fields.iter().find(|(_, f)| self.value(f).is_none() && !self.is_missing(f));
        if let Some((at, field)) = odd.filter(|_| self.dialect.names.is_none()) {
            return self.not_a_number(line, *at, field);
        }
        let found = format!("{} field(s) in this row", fields.len());
        let expected = format!("{n}, as many as in line {}", self.dialect.columns_from);
        let hint = if self.is_last(line) { CUT_OFF } else { "mend or remove the row" };
        self.fault(line, at, &found, &expected).hint(hint)
    }

    fn not_a_number(&self, line: &Line, at: usize, field: &str) -> Error {
        let (expected, other) = match (self.dialect.cell, self.dialect.decimal) {
            (Cell::Complex, _) => ("a complex number such as (1.5-2j)", b','),
            (Cell::Real, b',') => ("a number with a decimal comma", b'.'),
            (Cell::Real, _) => ("a number", b','),
        };
        let error = self.fault(line, at, &format!("found {:?}", shorten(field)), expected);
        if number::parse_with(field.as_bytes(), other).is_some() {
            error.hint("state whether the decimal mark is a comma or a point").setting("decimal")
        } else if field.contains('.') && field.contains(',') {
            error.hint(GROUPED).setting("decimal")
        } else {
            let hint = "write NaN in place of a bad value and allow missing values; put # before a remark";
            error.hint(hint).setting("allow_missing")
        }
    }

    fn too_many(&self, line: u64, blanks: usize) -> Error {
        Error::input(
            Place::line(self.path, line),
            format!("{blanks} blank lines between rows of {} values", self.dialect.columns),
            "at most one missing value for each byte of the file",
        )
        .hint("remove the blank lines")
    }
}

#[cfg(test)]
mod tests {
    use super::super::dialect::{Head, of_table};
    use super::*;
    use crate::{Options, Source};

    fn rows(text: &str, allow_missing: bool) -> Result<Rows> {
        let head = Head::of(&Source::memory("x.csv", text.as_bytes()).unwrap()).unwrap();
        let dialect = of_table(&head, &Options::default()).unwrap().unwrap();
        read(Path::new("x.csv"), text.trim_end_matches('\u{1a}'), &dialect, allow_missing)
    }

    fn column(rows: &Rows, at: usize) -> &[f64] {
        let Values::Real(values) = &rows.columns[at] else { panic!() };
        values
    }

    fn complaint(text: &str) -> String {
        rows(text, false).unwrap_err().to_string()
    }

    #[test]
    fn numbers_and_marks() {
        let plain = rows("t,a\n0,1.5\n1,-2e-3\n\n# end\n\u{1a}", false).unwrap();
        assert_eq!((column(&plain, 0), column(&plain, 1)), ([0.0, 1.0].as_slice(), [1.5, -2e-3].as_slice()));
        assert_eq!((plain.remarks, plain.kept), (1, vec![(5, "end".to_owned())]));
        // The first mark decides, however late it comes.
        let comma = rows("t;a\n0;1\n1;\"2,5\"\n", false).unwrap();
        assert_eq!(column(&comma, 1), [1.0, 2.5]);
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
            ragged.contains("line 3, column 5: 3 field(s) in this row; expected 2, as many as in line 1"),
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
        let kept = rows(text, true).unwrap();
        assert_eq!(kept.missing, 3);
        assert!(column(&kept, 1)[1].is_nan() && column(&kept, 1)[2].is_nan() && column(&kept, 2)[2] == 1.0);
    }
}
