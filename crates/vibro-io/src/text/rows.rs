//! The careful path: reads row after row, so that an error names line and column.

use super::clock::Stopwatch;
use super::decoded::{in_line, shorten};
use super::dialect::Dialect;
use super::lines::{Fields, Line, Lines, Separator};
use super::near_number::plain_form;
use super::numbers::complex;
use super::tail::CUT_OFF;
use crate::format::Format;
use crate::held::Held;
use crate::missing::Missing;
use crate::number;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;
use vibro_record::units::notation::counted;
use vibro_record::{Error, Result, Values};

/// Columns of numbers, their missing values, and the blank lines and remarks between the rows.
#[derive(Debug, Default, PartialEq)]
pub struct Rows {
    /// Values of each column, NaN where missing. All columns have the same length, except those in
    /// `sparse`.
    pub columns: Vec<Held>,
    /// For each column with a value only in every second, third, … row: index of the first row with a
    /// value, and rows from one value to the next.
    pub sparse: Vec<Option<(usize, usize)>>,
    /// For each column, whether it has no value in any row; its blanks then do not count as missing. Empty
    /// from the fast path.
    pub without_values: Vec<bool>,
    /// Number of missing values.
    pub missing: usize,
    /// Number of gaps (blank lines) between blocks of rows of one length.
    pub separators: usize,
    /// Number of rows left out because the abscissa and all values are missing in them.
    pub empty: usize,
    /// Remarks between and after the rows.
    pub remarks: Vec<String>,
}

/// Reads all rows from the first one on.
///
/// # Errors
/// On the first field that is not a number, on the first row with another number of fields, and on a
/// missing value in a column that is the abscissa by its name. In text without column names, also on a
/// blank line between rows of several columns. On missing values, all in one error, unless `allow_missing`.
pub fn read(text: &str, dialect: &Dialect, allow_missing: bool) -> Result<Rows> {
    let rows = read_but(text, dialect, allow_missing, &[])?;
    if rows.columns.is_empty() {
        return read_but(text, dialect, allow_missing, &rows.without_values);
    }
    Ok(rows)
}

/// As [`read`]; columns marked in `unused` may be empty. If `unused` is empty and some columns hold no
/// value, returns only `without_values`, for a second pass.
fn read_but(text: &str, dialect: &Dialect, allow_missing: bool, unused: &[bool]) -> Result<Rows> {
    let abscissa = dialect.named_abscissa();
    let parser = FieldParser { text, dialect };
    let mut rows = Rows::default();
    let mut cells = Cells::new(dialect, unused);
    let mut blank_since = None;
    for line in dialect.rows(text) {
        if line.is_blank() {
            blank_since.get_or_insert(line.number);
            continue;
        }
        if let Some(remark) = line.remark {
            rows.remarks.push(remark.to_owned());
            continue;
        }
        let fields = dialect.cut(&line).map_err(|at| {
            fault(&line, at, "text behind a closing quote", "a separator or the end of the line")
        })?;
        let mark = line.text.trim();
        if ENDS.iter().any(|end| mark.eq_ignore_ascii_case(end)) && !parser.rows_behind(&line) {
            rows.remarks.push(mark.to_owned());
            continue;
        }
        if fields.len() != dialect.columns {
            return Err(parser.ragged(&line, &fields));
        }
        if abscissa.is_some() && fields.iter().all(|(_, field)| field.is_empty() || parser.is_missing(field))
        {
            rows.empty += 1;
            continue;
        }
        if let Some(since) = blank_since.take().filter(|_| dialect.format == Format::Ascii) {
            cells.blank_lines(since..line.number)?;
        }
        for (i, (at, field)) in fields.iter().enumerate() {
            cells.take(&parser, &line, i, (*at, field))?;
        }
    }
    cells.into_rows(rows, allow_missing)
}

/// The cells of all rows so far, column by column.
struct Cells<'a> {
    dialect: &'a Dialect,
    /// Columns without any value; their blank cells do not count as missing.
    unused: &'a [bool],
    abscissa: Option<usize>,
    clock: Stopwatch,
    columns: Vec<Vec<Complex64>>,
    missing: Missing,
    /// As `missing`, with each blank line counted as one. Which of the two applies is known after the last
    /// row.
    with_blanks: Missing,
    blanks: Vec<Blank>,
}

impl<'a> Cells<'a> {
    fn new(dialect: &'a Dialect, unused: &'a [bool]) -> Cells<'a> {
        Cells {
            dialect,
            unused,
            abscissa: dialect.named_abscissa(),
            clock: Stopwatch::default(),
            columns: vec![Vec::new(); dialect.columns],
            missing: Missing::default(),
            with_blanks: Missing::default(),
            blanks: Vec::new(),
        }
    }

    /// Takes blank lines between rows: in one column a possible missing value each; with several columns an
    /// error.
    fn blank_lines(&mut self, lines: Range<u64>) -> Result<()> {
        if self.columns.len() > 1 {
            let expected = "rows of numbers, one behind the other";
            return Err(Error::input(in_line(lines.start), "a blank line between rows", expected)
                .hint("remove it, or write NaN for the values that are missing there"));
        }
        lines.clone().for_each(|blank| self.with_blanks.take(&in_line(blank), blank.to_string()));
        self.blanks.push((self.columns[0].len(), lines));
        Ok(())
    }

    /// Takes the cell of column `i` in a line, given as byte offset and text.
    fn take(
        &mut self,
        parser: &FieldParser,
        line: &Line,
        i: usize,
        (at, field): (usize, &str),
    ) -> Result<()> {
        let timed = self.dialect.clock_at() == Some(i);
        let value = if timed { self.clock.seconds(field).map(Into::into) } else { parser.value(field) };
        if let Some(value) = value {
            self.columns[i].push(value);
            return Ok(());
        }
        if timed || !parser.is_missing(field) {
            return Err(parser.not_a_number(line, at, field));
        }
        if self.abscissa == Some(i) {
            let expected = "a number in every row of the abscissa";
            let fault = fault(line, at, &format!("found {field:?}"), expected);
            return Err(fault.hint("remove the row"));
        }
        self.columns[i].push(MISSING);
        if self.unused.get(i) != Some(&true) {
            let name = self.dialect.names.as_ref().map_or("", |names| &names[i].name);
            let listed = if name.is_empty() { String::new() } else { format!(" ({name:?})") };
            for missing in [&mut self.missing, &mut self.with_blanks] {
                missing.take(&in_line(line.number), format!("{}{listed}", line.number));
            }
        }
        Ok(())
    }

    /// The columns of the `rows`; those of a lower rate without their blank cells.
    fn into_rows(self, mut rows: Rows, allow_missing: bool) -> Result<Rows> {
        let Cells { dialect, unused, mut columns, mut missing, with_blanks, blanks, .. } = self;
        if separate(&blanks) {
            rows.separators = blanks.len();
        } else {
            columns[0] = with_missing(&columns[0], blanks);
            missing = with_blanks;
        }
        let named = dialect.names.is_some() && !dialect.complex;
        let without = |values: &Vec<Complex64>| named && values.iter().all(|v| v.re.is_nan());
        rows.without_values = columns.iter().map(without).collect();
        if unused.is_empty() && rows.without_values.iter().any(|w| *w) && rows.without_values.contains(&false)
        {
            return Ok(rows);
        }
        rows.sparse = columns.iter().map(|values| sparse(values).filter(|_| named)).collect();
        let mut gaps = 0;
        for (values, sparse) in columns.iter_mut().zip(&rows.sparse) {
            match sparse {
                Some((first, every)) => {
                    *values = values.iter().skip(*first).step_by(*every).copied().collect();
                }
                None if without(values) && !unused.is_empty() => {}
                None => gaps += values.iter().filter(|v| v.re.is_nan()).count(),
            }
        }
        if gaps > 0 {
            checked(missing, &columns, allow_missing)?;
        }
        rows.missing = gaps;
        let real = |values: Vec<Complex64>| Values::Real(values.iter().map(|v| v.re).collect());
        let held = |c| if dialect.complex { Values::Complex(c).into() } else { real(c).into() };
        rows.columns = columns.into_iter().map(held).collect();
        Ok(rows)
    }
}

/// Refuses missing values unless they are `allowed`. If columns only end early, the error tells how to
/// export them.
fn checked(missing: Missing, columns: &[Vec<Complex64>], allowed: bool) -> Result<usize> {
    let gaps = |values: &[Complex64]| values.iter().filter(|v| v.re.is_nan()).count();
    let behind = |values: &[Complex64]| values.iter().rev().take_while(|v| v.re.is_nan()).count();
    let end_early = columns.iter().all(|values| gaps(values) == behind(values));
    let checked = missing.check("missing value", "(NaN, Inf, over-range, error or blank), in line", allowed);
    checked.map_err(|why| if end_early { why.hint(END_EARLY).setting("allow_missing") } else { why })
}

/// Hint for columns of different lengths.
const END_EARLY: &str = "write the columns that end early to a file of their own, with their axis; or keep what is missing as such";

/// Hint for a line of words that is followed by rows of another table.
pub const TABLES: &str =
    "write each table of the file to a file of its own, the lines above its rows with it";

/// Words that end the rows when alone on a line.
const ENDS: [&str; 3] = ["end", "endcurve", "eof"];

/// For a channel of a lower rate: index of the first row with a value, and rows from one value to the next.
/// Only where all values are evenly spaced.
fn sparse(values: &[Complex64]) -> Option<(usize, usize)> {
    let has = |i: &usize| !values[*i].re.is_nan();
    let mut with = (0..values.len()).filter(has);
    let (first, second) = (with.next()?, with.next()?);
    let every = second - first;
    let regular = (0..values.len()).all(|i| has(&i) == (i >= first && (i - first).is_multiple_of(every)));
    (every > 1 && regular && values.len() > 3 * every).then_some((first, every))
}

/// A gap of blank lines: the number of rows before it, and its line numbers.
type Blank = (usize, Range<u64>);

/// Whether gaps of equal length separate blocks of equal length; blank lines then are not missing values.
fn separate(blanks: &[Blank]) -> bool {
    let alike = |w: &[Blank]| {
        w[1].0 - w[0].0 == blanks[0].0 && (w[0].1.end - w[0].1.start) == (w[1].1.end - w[1].1.start)
    };
    blanks.len() >= FEWEST_BLANKS && blanks.windows(2).all(alike)
}

/// Fewest gaps that count as even; fewer may be even by chance.
const FEWEST_BLANKS: usize = 3;

/// Inserts a missing value (NaN) for each blank line.
fn with_missing(values: &[Complex64], blanks: Vec<Blank>) -> Vec<Complex64> {
    let (mut all, mut taken) = (Vec::with_capacity(values.len()), 0);
    for (before, lines) in blanks {
        all.extend(&values[taken..before]);
        all.extend(lines.map(|_| MISSING));
        taken = before;
    }
    all.extend(&values[taken..]);
    all
}

const MISSING: Complex64 = Complex64::new(f64::NAN, 0.0);

fn fault(line: &Line, at: usize, found: &str, expected: &str) -> Error {
    Error::input(in_line(line.number).column(line.column(at)), found, expected)
}

/// Parses the fields of a text, and words the errors.
struct FieldParser<'a> {
    text: &'a str,
    dialect: &'a Dialect,
}

impl FieldParser<'_> {
    fn value(&self, field: &str) -> Option<Complex64> {
        let (field, decimal) = (field.as_bytes(), self.dialect.decimal);
        if self.dialect.complex { complex(field, decimal) } else { Some(self.dialect.number(field)?.into()) }
    }

    fn is_missing(&self, field: &str) -> bool {
        let lower = field.to_ascii_lowercase();
        let half = self.dialect.complex && (lower.contains("nan") || lower.contains("inf"));
        half || number::is_missing(field.as_bytes())
    }

    /// Whether the first field with text is a word, as in the line of names above another table.
    fn begins_with_word(&self, fields: &Fields) -> bool {
        let first = fields.iter().map(|(_, field)| field).find(|field| !field.is_empty());
        first.is_some_and(|first| {
            first.starts_with(char::is_alphabetic) && self.value(first).is_none() && !self.is_missing(first)
        })
    }

    /// Whether any row after this line holds a number.
    fn rows_behind(&self, line: &Line) -> bool {
        let behind = (line.at + line.text.len()).min(self.text.len());
        let has = |line: &Line| {
            let values = |fields: &Fields| fields.iter().any(|(_, field)| self.value(field).is_some());
            self.dialect.cut(line).is_ok_and(|fields| values(&fields))
        };
        Lines::new(self.text, behind, line.number, self.dialect.remarks)
            .any(|line| line.remark.is_none() && has(&line))
    }

    fn ragged(&self, line: &Line, fields: &Fields) -> Error {
        let n = self.dialect.columns;
        // A field that is not a number is a better message than the number of fields.
        let odd = fields.iter().find(|(_, f)| self.value(f).is_none() && !self.is_missing(f));
        if let Some((at, field)) = odd.filter(|_| self.dialect.names.is_none()) {
            return self.not_a_number(line, *at, field);
        }
        let at = fields.get(n).map_or(line.text.len(), |(at, _)| *at);
        let found = counted(fields.len(), "field") + " in this row";
        let expected = format!("{n}, as many as in line {}", self.dialect.columns_from);
        let error = fault(line, at, &found, &expected);
        let whole = |(_, field): &(usize, Cow<str>)| !field.contains('.') && self.value(field).is_some();
        if self.dialect.separator == Separator::Char(b',')
            && fields.len() == 2 * n
            && fields.iter().all(whole)
        {
            return error.hint(
                "if commas are decimal marks here, they cannot separate cells, too: export with semicolons or tabs \
                 between cells, or with decimal points",
            );
        }
        error.hint(self.hint(line, "mend or remove the row"))
    }

    fn not_a_number(&self, line: &Line, at: usize, field: &str) -> Error {
        let (expected, other) = match (self.dialect.complex, self.dialect.decimal) {
            (true, _) => ("a complex number such as (1.5-2j)", b','),
            (false, b',') => ("a number with a decimal comma", b'.'),
            (false, _) => ("a number", b','),
        };
        let error = fault(line, at, &format!("found {:?}", shorten(field)), expected);
        if number::parse_with(field.as_bytes(), other).is_some()
            || (field.contains('.') && field.contains(','))
        {
            let hint = "state whether the decimal mark is a comma or a point; the other mark groups digits";
            return error.hint(hint).setting("decimal");
        }
        let inner = field.strip_prefix('(').and_then(|inner| inner.strip_suffix(')'));
        if let Some(inner) = inner.filter(|inner| self.value(inner).is_some()) {
            return error.hint(format!("if brackets mean less than zero, write -{inner}; in all rows alike"));
        }
        if let Some(form) = plain_form(field) {
            return error.hint(form);
        }
        // In the first cell the hint is to remove the line, not to write NaN.
        if self.dialect.names.is_some() && line.text[..at].trim_matches([' ', '"']).is_empty() {
            return error.hint(self.hint(line, "remove the line, or put # before it"));
        }
        let hint = "write NaN in place of a bad value and allow missing values; put # before a remark";
        error.hint(self.hint(line, hint)).setting("allow_missing")
    }

    /// The hint for an error in `line`: [`TABLES`] if another table begins there, [`CUT_OFF`] if the text
    /// ends with this line, otherwise `hint`.
    fn hint(&self, line: &Line, hint: &'static str) -> &'static str {
        if self.dialect.cut(line).is_ok_and(|fields| self.begins_with_word(&fields)) && self.rows_behind(line)
        {
            TABLES
        } else if line.at + line.text.len() == self.text.len() {
            CUT_OFF
        } else {
            hint
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::decoded::Text;
    use super::super::table;
    use super::*;
    use crate::options::Options;
    use crate::source::Source;

    fn rows(text: &str, allow_missing: bool) -> Result<Rows> {
        let source = Source::memory("x.csv", text.as_bytes()).unwrap();
        let dialect = table::detect(&Text::of(&source, None), &Options::default()).unwrap();
        read(text.trim_end_matches('\u{1a}'), &dialect, allow_missing)
    }

    fn column(rows: &Rows, at: usize) -> &[f64] {
        rows.columns[at].reals()
    }

    fn complaint(text: &str) -> String {
        rows(text, false).unwrap_err().to_string()
    }

    #[test]
    fn numbers_and_marks() {
        let plain = rows("t,a\n0,1.5\n1,-2e-3\n\n# end\n\u{1a}", false).unwrap();
        assert_eq!((column(&plain, 0), column(&plain, 1)), ([0.0, 1.0].as_slice(), [1.5, -2e-3].as_slice()));
        assert_eq!(plain.remarks, ["end"]);
        // The first decimal mark decides for all rows, however late it occurs.
        let comma = rows("t;a\n0;1\n1;\"2,5\"\n", false).unwrap();
        assert_eq!(column(&comma, 1), [1.0, 2.5]);
    }

    #[test]
    fn complaints_name_line_and_column() {
        assert!(complaint("t,a\n0,1\n1,x\n").starts_with("line 3, column 3: found \"x\"; expected a number"));
        assert!(
            complaint("t;a\n0;1,5\n1;2.5\n")
                .contains("line 3, column 3: found \"2.5\"; expected a number with a decimal comma")
        );
        let ragged = complaint("t,a\n0,1\n1,2,3\n");
        assert!(
            ragged.contains("line 3, column 5: 3 fields in this row; expected 2, as many as in line 1"),
            "{ragged}"
        );
        assert!(complaint("t,a\n0,1\n1\n").contains("line 3, column 2: 1 field in"));
        assert!(complaint("t,a\n0,1\n1,\"2\"3\n").contains("line 3, column 6: text behind a closing quote"));
        assert!(complaint("t,a\n0,1\nNaN,3\n").contains("line 3, column 1: found \"NaN\""));
    }

    #[test]
    fn missing_values_are_refused_with_their_lines_or_kept() {
        let text = "t,a,b\n0,1,2\n1,,NaN\n2,-inf,1\n";
        let error = complaint(text);
        assert!(
            error.contains("line 3: 3 missing values") && error.contains("3 (\"a\"), 3 (\"b\"), 4 (\"a\")"),
            "{error}"
        );
        let kept = rows(text, true).unwrap();
        assert_eq!(kept.missing, 3);
        assert!(column(&kept, 1)[1].is_nan() && column(&kept, 1)[2].is_nan() && column(&kept, 2)[2] == 1.0);
    }
}
