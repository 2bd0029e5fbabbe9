//! Detects tables with names above their columns: CSV and TSV.
//!
//! ```text
//! # a remark                         remarks after # or %, kept as notes
//! Sample rate; 1000; Hz              preamble: `key: value`, or key and value in cells
//! time [s]; velocity [mm/s]          names, with units in the usual spellings (see `names`) …
//! s; mm/s                            … or with a second row that holds the units
//! 0,000; 1,5                         rows; comma, semicolon or tab separates, a comma or point is decimal
//! ```
//! Time, frequency or a counter is recognised as the abscissa by its name. Columns `X_re` and `X_im` over
//! frequency become one complex record.

use super::clock;
use super::decoded::{Text, in_line, shorten};
use super::dialect::Dialect;
use super::header::Stated;
use super::headings::{headings, is_title, is_types, names_in, rate_of_columns};
use super::lines::{Fields, Line, Lines, Separator, fields, is_torn};
use super::names::{Name, label};
use super::preamble::{BESIDE, Preamble, beside, beside_rows, key_and_value};
use crate::format::Format;
use crate::number;
use crate::options::Options;
use std::borrow::Cow;
use std::ops::Range;
use vibro_record::units::Unit;
use vibro_record::{AxisKind, Error, Finding, Result};

/// Separators in the order of trial: the comma last, since numbers may contain it.
const SEPARATORS: [u8; 3] = *b"\t;,";

const REMARKS: &[&str] = &["#", "%"];

/// Number of lines above the first row that are searched for column names.
const DEEPEST: usize = 4;

/// Finds the first row of numbers with names directly above it; `None` if there is none.
///
/// In a file named as a table (csv, tsv) one column is enough. A header that does not fit its rows is still
/// a header there, so that reading can name the faulty row.
pub fn detect(text: &Text, options: &Options) -> Option<Dialect> {
    if let Some(found) = beside_rows(text) {
        return Some(found);
    }
    let mut above: Vec<Line> = Vec::new();
    let begin = beginning(&text.head);
    let mut misfit = None;
    let mut before = [None; SEPARATORS.len()];
    for line in Lines::new(&text.head, 0, 1, REMARKS).filter(|l| !l.is_blank()) {
        if line.remark.is_none() && line.number > begin {
            let counts = SEPARATORS.map(|mark| row(line.text, mark, options));
            // A separator with as many cells as in the line before was tried there already. Without this,
            // long files take minutes.
            let new = (0..SEPARATORS.len()).filter(|i| counts[*i] != before[*i]);
            let rows: Vec<(Separator, Option<usize>)> =
                new.map(|i| (Separator::Char(SEPARATORS[i]), counts[i])).collect();
            before = counts;
            let of =
                |n: usize| rows.iter().filter(move |(_, count)| count.is_some_and(|c| (c > 1) == (n > 1)));
            for (separator, count) in of(2) {
                let count = count.unwrap_or(0);
                // Rows above this one that cannot be parsed belong to the table. Reading them reports the
                // error with line and column.
                let torn = above.iter().rev().take_while(|l| is_torn(l.text, *separator, count)).count();
                let (upper, torn) = above.split_at(above.len() - torn);
                let torn = torn.first().and_then(|first| fit(upper, *first, *separator, count, &text.head));
                if let Some((found, true)) = torn {
                    return Some(decided(found, text, options));
                }
                match fit(&above, line, *separator, count, &text.head) {
                    Some((found, true)) => return Some(decided(found, text, options)),
                    found => misfit = misfit.or(found.map(|(found, _)| found)),
                }
            }
            // One column is tried last: `1,5` under `a,b` is two cells, not a number with a decimal comma.
            let alone = |(separator, _): &(Separator, _)| fit(&above, line, *separator, 1, &text.head);
            let mut below = Lines::new(&text.head, line.at, line.number, REMARKS)
                .filter(|l| !l.is_blank() && l.remark.is_none());
            let column = below.nth(1).is_none_or(|l| {
                let one = SEPARATORS.iter().any(|mark| row(l.text, *mark, options) == Some(1));
                one || number::is_missing(l.text.trim().as_bytes())
            });
            if text.called_csv()
                && misfit.is_none()
                && column
                && let Some((found, true)) = of(1).find_map(alone)
            {
                return Some(decided(found, text, options));
            }
        }
        above.push(line);
    }
    misfit.filter(|_| text.called_csv()).map(|found| decided(found, text, options))
}

/// Number of fields of a row: all are numbers, missing values or a clock, and at least one is a number.
/// `None` for other lines.
fn row(text: &str, mark: u8, options: &Options) -> Option<usize> {
    let fields = fields(text, Separator::Char(mark)).ok()?;
    let clock = clock::columns(&fields).unwrap_or(0..0);
    let point = options.decimal_comma != Some(true);
    // With commas as separators, a number with a decimal comma must be in quotes.
    let comma = options.decimal_comma != Some(false) && (mark != b',' || text.contains('"'));
    // `Overload, 0` is preamble and no row. A single cell such as `1,234.5` is ambiguous, so the user is
    // asked for the decimal mark.
    let word = |text: &str| {
        text.starts_with(|c: char| c.is_ascii_alphabetic()) && !text.to_lowercase().starts_with("nan")
    };
    let doubtful =
        fields.len() == 1 && text.contains(',') && text.contains('.') && options.decimal_comma.is_none();
    if word(&fields[0].1) || doubtful {
        return None;
    }
    let mut numbers = 0;
    for (i, (_, field)) in fields.iter().enumerate() {
        let field = field.as_bytes();
        let stated = |mark| number::parse_stated(field, mark).is_some() && options.decimal_comma.is_some();
        let number = |mark| number::parse_with(field, mark).is_some() || stated(mark);
        let number = (point && number(b'.')) || (comma && number(b','));
        if !number && !number::is_missing(field) && !clock.contains(&i) {
            return None;
        }
        numbers += usize::from(number);
    }
    (numbers > 0).then_some(fields.len())
}

/// Sets the decimal mark in the dialect: the stated one, else the last comma or point of the first number
/// that has one.
fn decided(found: Dialect, text: &Text, options: &Options) -> Dialect {
    let rows = found.rows(&text.head).filter(|line| line.remark.is_none());
    let cells = rows.flat_map(|line| found.cut(&line).unwrap_or_default().into_iter().enumerate());
    let mut marks = cells
        .filter(|(i, _)| found.clock_at() != Some(*i))
        .filter_map(|(_, (_, cell))| cell.bytes().rfind(|b| matches!(b, b',' | b'.')));
    let comma = options.decimal_comma.or_else(|| marks.next().map(|mark| mark == b','));
    drop(marks);
    let stated = options.decimal_comma.is_some();
    Dialect { decimal: if comma == Some(true) { b',' } else { b'.' }, stated, ..found }
}

/// Refuses a column with `1,000` beside `998`, since its mark may separate thousands. A finding lists
/// columns that hold only numbers like `1,000`. A number like `1,5` in any column shows the decimal mark
/// and removes the doubt.
///
/// # Errors
/// Names the first ambiguous cell.
pub fn grouped(text: &Text, dialect: &Dialect) -> Result<Option<Finding>> {
    let mut columns = vec![(None, false); dialect.columns];
    for line in dialect.rows(&text.head).filter(|line| line.remark.is_none() && !dialect.stated) {
        let cells = dialect.cut(&line).unwrap_or_default().into_iter().zip(&mut columns).enumerate();
        for (_, ((at, cell), (first, whole))) in cells.filter(|(i, _)| dialect.clock_at() != Some(*i)) {
            if number::may_be_grouped(cell.as_bytes()) {
                first.get_or_insert((in_line(line.number).column(line.column(at)), shorten(&cell)));
            } else if cell.contains([',', '.']) {
                return Ok(None);
            } else {
                *whole |= !cell.is_empty();
            }
        }
    }
    if let Some((place, cell)) = columns.iter().find_map(|(first, whole)| first.as_ref().filter(|_| *whole)) {
        let found = format!("{cell:?} beside whole numbers may be grouped digits");
        return Err(Error::input(place.clone(), found, "a file where this can be told")
            .hint("say which mark is the decimal one: comma or point; the other groups digits")
            .setting("decimal"));
    }
    let names = dialect.names.as_deref().unwrap_or_default();
    let label = |at: usize| label(names.get(at).map_or("", |name| &name.name), at + 1);
    let all = columns.iter().enumerate().filter_map(|(at, (first, _))| Some((at, first.as_ref()?)));
    let labels: Vec<String> = all.clone().map(|(at, _)| label(at)).collect();
    let first = all.map(|(_, (_, cell))| cell).next();
    Ok(first.map(|cell| {
        let other = if dialect.decimal == b',' { "point" } else { "comma" };
        let found = Finding::doubt("digits-may-be-grouped").name("columns", labels.join(", "));
        found.name("cell", cell.as_str()).name("other", other).without_estimate()
    }))
}

/// The dialect of rows that begin at `first`, and whether there are as many names as columns. The names are
/// in lines of their own above, or in a line of the preamble after a key.
fn fit(
    above: &[Line],
    first: Line,
    separator: Separator,
    count: usize,
    head: &str,
) -> Option<(Dialect, bool)> {
    let rows =
        Lines::new(head, first.at, first.number, REMARKS).filter(|l| !l.is_blank() && l.remark.is_none());
    let rows: Vec<Fields> = rows.take(BESIDE).map_while(|l| fields(l.text, separator).ok()).collect();
    // Keys of a preamble may have a column of their own, which is empty in the rows.
    let skipped = usize::from(rows.len() > 1 && rows.iter().all(|row| row.len() > 1 && row[0].1.is_empty()));
    // A line that has no cell above the values cannot name their columns.
    let empty = |line: &Line| {
        let cells = fields(line.text, separator).unwrap_or_default();
        skipped > 0 && cells.iter().skip(skipped).all(|(_, cell)| cell.is_empty())
    };
    let names = |l: &&Line| l.remark.is_none() && !is_types(l, separator) && !empty(l);
    let spoken = above.iter().filter(names).filter(|l| rate_of_columns(l, separator).is_none());
    let spoken: Vec<&Line> = spoken.rev().collect();
    let values = rows.first()?.get(skipped..)?;
    let width = values.iter().rposition(|(_, f)| !f.is_empty()).map_or(0, |last| last + 1);
    let deepest = spoken.iter().take(DEEPEST);
    let mut block: Vec<Fields> = deepest.map_while(|l| headings(l, separator, skipped, values)).collect();
    let (lower, uppers) = block.split_first_mut()?;
    let stated = beside(uppers.first_mut(), lower, width);
    let clock = clock_cells(&block, values);
    let preamble = Preamble::of(&spoken, separator);
    let fits = |columns: usize| count - skipped == columns || width == columns;
    let title = is_title(&block[0], width, &preamble);
    let (used, mut names) =
        names_in(&block, clock.as_ref(), title, fits).unwrap_or_else(|| (0..0, vec![Name::default(); width]));
    let columns = names.len();
    if columns == 1 && count > 1 && !used.is_empty() {
        return None;
    }
    if let Some(cells) = clock.clone().filter(|cells| cells.end <= columns) {
        names.splice(cells, [Name { name: "time".to_owned(), unit: Some("s".to_owned()) }]);
    }
    let begin = || rows.iter().map(|row| number::either(row.get(skipped)?.1.as_bytes()));
    let rises = || begin().zip(begin().skip(1)).all(|(a, b)| a < b);
    if used.is_empty() && columns > 1 && rises() {
        names[0].unit = preamble.axis_unit();
    }
    let extremes = names.first().is_some_and(|first| first.name == "min")
        && spoken[0].text.to_lowercase().contains("max");
    if columns > 1 && !extremes && rises() {
        name_by_unit(&mut names);
    }
    let whole = |(_, cell): &(usize, Cow<str>)| cell.bytes().all(|b| b.is_ascii_digit() || b == b'-');
    let keyed = preamble.name(&mut names, rows.iter().flatten().all(whole));
    // Whether the line above is itself a row of values.
    let is_row = |mark| row(spoken[0].text, mark, &Options::default()).is_some();
    if used.is_empty() && (!keyed || matches!(separator, Separator::Char(mark) if is_row(mark))) {
        return None;
    }
    let last = spoken.get(used.end.max(1) - 1)?.number;
    let used: Vec<u64> = spoken.get(used)?.iter().map(|line| line.number).collect();
    let head: Vec<&Line> = above.iter().filter(|l| !used.contains(&l.number)).collect();
    let dialect = Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        stated: false,
        complex: false,
        columns: names.len(),
        skipped,
        clock,
        names: Some(names),
        remarks: REMARKS,
        header: statements(&head, separator).into_iter().chain(stated).collect(),
        columns_from: last,
        first_line: first.number,
    };
    Some((dialect, fits(columns)))
}

/// The cells of date and time in the first row of `values` below a `block` of names, including a cell of
/// milliseconds.
fn clock_cells(block: &[Fields], values: &[(usize, Cow<str>)]) -> Option<Range<usize>> {
    clock::columns(values).map(|cells| {
        let ms = block.iter().any(|line| line.get(cells.end).is_some_and(|(_, cell)| cell == "ms"));
        // A clock that prints decimals of a second already includes the milliseconds.
        let whole = !clock::printed_seconds(&clock::joined(&values[cells.clone()])).contains('.');
        cells.start..cells.end + usize::from(ms && whole)
    })
}

/// Names the first column time or frequency if its name is only a unit of one of them: `min,CH1`.
fn name_by_unit(names: &mut [Name]) {
    // `s` is time only if all other names are also units.
    let units = names.iter().skip(1).all(|name| Unit::parse(&name.name).is_some());
    let Some(first) = names.first_mut().filter(|first| first.unit.is_none()) else { return };
    let timed = Name::with_unit_row("", &first.name);
    if let Some(kind) = timed.axis(true).filter(|_| first.name != "s" || units) {
        let name = if kind == AxisKind::Time { "time" } else { "frequency" };
        *first = Name { name: name.to_owned(), ..timed };
    }
}

/// The statements of header lines, as `key: value` if a line has a key.
fn statements(head: &[&Line], separator: Separator) -> Vec<String> {
    // A rate after its key takes precedence: a row with one rate for each column may hold those of filters.
    let mut keyed: Vec<String> = head.iter().map(|l| key_and_value(l, separator)).collect();
    if !Stated::of(keyed.iter().map(String::as_str), None).states_rate() {
        for (line, keyed) in head.iter().zip(&mut keyed).filter(|(line, _)| line.remark.is_none()) {
            if let Some(rate) = rate_of_columns(line, separator) {
                *keyed = rate;
            }
        }
    }
    keyed
}

/// Number of the line `data:` that announces the rows; 0 if there is none.
pub(super) fn beginning(head: &str) -> u64 {
    let number = |line: &str| line.starts_with(|c: char| c.is_ascii_digit() || "+-. \t".contains(c));
    let begin = |at: &usize| head[..*at].rfind('\n').map_or(0, |end| end + 1);
    // Fast, since only lines with a colon are examined, and few headers have one.
    let says = |at: &usize| {
        let rest = head[at + 1..].lines().next().unwrap_or_default();
        head[begin(at)..*at].eq_ignore_ascii_case("data")
            && rest.trim_matches([',', ';', '\t', ' ']).is_empty()
    };
    // Rows must follow the line and not precede it; a single number before it may be the value of a key.
    let begins = |at: &usize| {
        let before = head[..begin(at)].lines().rev().take(2).filter(|line| number(line)).count();
        before < 2 && head[*at..].lines().nth(1).is_some_and(number)
    };
    let colons = head.rmatch_indices(':').map(|(at, _)| at);
    let found = colons.filter(says).find(begins);
    found.map_or(0, |at| head[..at].matches('\n').count() as u64 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, called_csv: bool) -> Option<Dialect> {
        let name = if called_csv { "x.csv" } else { "x" };
        let source = crate::source::Source::memory(name, text.as_bytes()).ok()?;
        detect(&Text::of(&source, None), &Options::default())
    }

    fn layout(text: &str) -> Option<(char, Vec<String>, u64, u64)> {
        shape(text, false)
    }

    fn shape(text: &str, called_csv: bool) -> Option<(char, Vec<String>, u64, u64)> {
        let d = found(text, called_csv)?;
        let Separator::Char(mark) = d.separator else { panic!() };
        let names = d.names?.into_iter().map(|n| format!("{}|{}", n.name, n.unit.unwrap_or_default()));
        Some((char::from(mark), names.collect(), d.columns_from, d.first_line))
    }

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|n| (*n).to_owned()).collect()
    }

    #[test]
    fn separators() {
        let plain = names(&["t|", "a|"]);
        assert_eq!(layout("t,a\n0,1\n"), Some((',', plain.clone(), 1, 2)));
        assert_eq!(layout("t;a\n0,5;1,5\n"), Some((';', plain.clone(), 1, 2)));
        assert_eq!(layout("t\ta\n0,5\t1,5\n"), Some(('\t', plain.clone(), 1, 2)));
        assert_eq!(layout("\"t\" , \"a\"\n\n1,-\n"), Some((',', plain.clone(), 1, 3)));
        assert_eq!(layout("t,a,\n0,1,\n"), Some((',', plain.clone(), 1, 2)));
        assert_eq!(layout("t,a\n0,1,\n"), Some((',', plain, 1, 2)));
        // A last column without a name is a column.
        assert_eq!(layout("t,a,\n0,1,2\n"), Some((',', names(&["t|", "a|", "|"]), 1, 2)));
    }

    #[test]
    fn a_second_row_of_units() {
        let expected = names(&["Time|ms", "Channel A|V"]);
        assert_eq!(layout("Time,Channel A\n(ms),(V)\n\n0,1\n"), Some((',', expected, 1, 4)));
        assert_eq!(layout("note\ns,V\n0,1\n"), Some((',', names(&["time|s", "V|"]), 2, 3)));
    }

    #[test]
    fn preamble_and_comments_are_kept() {
        let text = "# by hand\nSample rate;1000;Hz\nOperator: A;B\n12;13\nt;a\n% more\n0;1\n";
        let d = found(text, false).unwrap();
        assert_eq!((d.columns_from, d.first_line), (5, 7));
        let said: Vec<&str> = d.header.iter().map(String::as_str).collect();
        assert_eq!(said, ["by hand", "Sample rate: 1000 Hz", "Operator: A;B", "12: 13", "more"]);
    }

    /// Free text above thousands of rows, and no names: trying each row as the first row of a table took
    /// minutes.
    #[test]
    fn rows_without_names_are_given_up_at_once() {
        let rows: String = (0..10_000).map(|i| ["1,2,3\n", "4,5,6\n"][i % 2]).collect();
        let start = std::time::Instant::now();
        assert_eq!(found(&format!("Zorro recording\n\n12 units of it\n{rows}"), false), None);
        assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
    }

    #[test]
    fn what_is_no_named_columns() {
        for text in [
            "1,2\n3,4\n",
            "time velocity\n0 1\n",
            "# t,a\n0,1\n",
            "t,a\nb,c\n",
            "Date: 1, x\n0,1\n",
            "fs=5, x\n0,1\n",
            "t,a,b\n0,1\n",
            "1,5E-03\n2,5E-03\n",
            "1.5E-03;2\n2.5D-03;2\n",
            "velocity\n1\n",
            "",
            "-,-\n1,2\n",
        ] {
            assert_eq!(layout(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_file_that_calls_itself_csv_may_have_one_column_or_a_row_that_does_not_fit() {
        assert_eq!(shape("velocity\n1\n", true).unwrap().1, ["velocity|"]);
        assert_eq!(shape("velocity\n1,5\n", true), Some(('\t', names(&["velocity|"]), 1, 2)));
        assert_eq!(shape("t,a,b\n0,1\n", true).unwrap().1.len(), 3);
        assert_eq!(shape("a,b\n1,5\n", true).unwrap().1.len(), 2);
        assert_eq!(shape("1\n2\n", true), None);
    }
}
