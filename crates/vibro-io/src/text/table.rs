//! Tables with names above their columns: CSV and TSV.
//!
//! ```text
//! # a remark                         remarks behind # or %, kept as notes
//! Sample rate; 1000; Hz              preamble: `key: value`, or key and value in cells
//! time [s]; velocity [mm/s]          names, with units in the usual spellings (see `names`) …
//! s; mm/s                            … or with a second row that holds the units
//! 0,000; 1,5                         rows; comma, semicolon or tab separates, with a comma or point in numbers
//! ```
//! A time, a frequency or a counter is the abscissa by its name. Columns `X_re` and `X_im` over frequency are one complex
//! record.

use super::Text;
use super::clock;
use super::dialect::{Dialect, Separator};
use super::lines::{Fields, Line, Lines, fields};
use super::names::{Name, is_unit_row, unit_word};
use crate::{Format, Options, number};
use std::borrow::Cow;
use vibro_record::AxisKind;

/// From the one that stands in numbers least to the one that does most.
const SEPARATORS: [u8; 3] = *b"\t;,";

const REMARKS: &[&str] = &["#", "%"];

/// Rows that are looked at, of which a preamble may stand beside the first.
const BESIDE: usize = 40;

/// Lines between rows and their names, at most, with the names.
const DEEPEST: usize = 4;

/// Finds the first row of numbers with names right above it; `None` where there is none.
///
/// Where the file calls itself CSV a single column will do, and a header that does not fit its rows is still a header, so that
/// reading can name the row at fault.
pub fn detect(text: &Text, options: &Options) -> Option<Dialect> {
    if let Some(found) = beside_rows(text) {
        return Some(found);
    }
    let mut above: Vec<Line> = Vec::new();
    let mut misfit = None;
    for line in Lines::new(&text.head, 0, 1, REMARKS).filter(|l| !l.is_blank()) {
        if line.remark.is_none() {
            let rows = SEPARATORS.map(|mark| (Separator::Char(mark), row(line.text, mark, options)));
            let of =
                |n: usize| rows.iter().filter(move |(_, count)| count.is_some_and(|c| (c > 1) == (n > 1)));
            for (separator, count) in of(2) {
                match fit(&above, line, *separator, count.unwrap_or(0), &text.head) {
                    Some((found, true)) => return Some(decided(found, text, options)),
                    found => misfit = misfit.or(found.map(|(found, _)| found)),
                }
            }
            // One column last: `1,5` under `a,b` is no decimal comma.
            let alone = |(separator, _): &(Separator, _)| fit(&above, line, *separator, 1, &text.head);
            if text.called_csv()
                && misfit.is_none()
                && let Some((found, true)) = of(1).find_map(alone)
            {
                return Some(decided(found, text, options));
            }
        }
        above.push(line);
    }
    misfit.filter(|_| text.called_csv()).map(|found| decided(found, text, options))
}

/// A preamble in the first columns of the first rows, as oscilloscopes of Tektronix write it: key, value and unit, then time and value, with
/// nothing before them further down.
fn beside_rows(text: &Text) -> Option<Dialect> {
    let separator = Separator::Char(b',');
    let lines = Lines::new(&text.head, 0, 1, &[]).filter(|line| !line.is_blank()).take(BESIDE);
    let rows: Vec<(u64, Fields)> =
        lines.map_while(|l| Some((l.number, fields(l.text, separator).ok()?))).collect();
    let number = |field: &(usize, Cow<str>)| number::parse(field.1.as_bytes()).is_some();
    let (first_line, first) = rows.first()?;
    let last = &rows.last()?.1;
    let skipped = last.iter().take_while(blank).count();
    let columns = last.len().checked_sub(skipped)?
        - last.iter().rev().take_while(blank).count().min(last.len() - skipped);
    let whole = |row: &Fields| {
        row.get(skipped..skipped + columns).is_some_and(|cells| cells.iter().all(number))
            && row.iter().skip(skipped + columns).all(|field| blank(&field))
    };
    let keyed = first.first().is_some_and(|(_, key)| key.contains(char::is_alphabetic));
    if skipped < 2 || columns == 0 || !keyed || !rows.iter().all(|(_, row)| whole(row)) {
        return None;
    }
    let cells = rows.iter().map(|(_, row)| row[..skipped].iter().map(|(_, f)| f.trim().to_owned()));
    let preamble = Preamble(cells.map(Iterator::collect).collect());
    let mut names = vec![Name::default(); columns];
    if columns == 2 {
        "time".clone_into(&mut names[0].name);
    }
    preamble.name(&mut names);
    Some(Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        complex: false,
        columns,
        skipped,
        clock: None,
        names: Some(names),
        remarks: &[],
        header: preamble.0.iter().map(|cells| statement(cells)).filter(|said| !said.is_empty()).collect(),
        columns_from: *first_line,
        first_line: *first_line,
    })
}

fn blank(field: &&(usize, Cow<str>)) -> bool {
    field.1.is_empty()
}

/// Keys in the first cell of a line, each with its values in the cells behind: one for all columns, or one for each.
struct Preamble(Vec<Vec<String>>);

const SOURCE: &[&str] = &["source", "tracename", "trace name", "signal", "signal name", "channel name"];
const UNIT: &[&str] = &["vertical units", "vert units", "vunit", "yunits", "y units"];
const AXIS_UNIT: &[&str] = &["horizontal units", "horz units", "hunit", "xunits", "x units"];

/// The first cell as a key.
fn key(cells: &[String]) -> String {
    cells[0].trim_end_matches(':').trim().replace('_', " ").to_lowercase()
}

impl Preamble {
    /// The values of the first of some keys.
    fn values(&self, keys: &[&str]) -> Option<&[String]> {
        let found = self.0.iter().find(|cells| cells.len() > 1 && keys.contains(&key(cells).as_str()))?;
        let said = found.iter().rposition(|cell| !cell.is_empty())?;
        found.get(1..=said).filter(|values| !values.is_empty())
    }

    /// Gives columns the names and units that they lack: one for each, or for each but the abscissa. Says whether there are any.
    fn name(&self, names: &mut [Name]) -> bool {
        let axis = names.first().and_then(|name| name.axis(true));
        let n = names.len();
        let of = |keys| self.values(keys).filter(|v| v.len() == n || (v.len() + 1 == n && axis.is_some()));
        let (sources, units) = (of(SOURCE), of(UNIT));
        for (name, source) in names.iter_mut().rev().zip(sources.unwrap_or_default().iter().rev()) {
            if name.name.is_empty() {
                name.name.clone_from(source);
            }
        }
        let mut adopt = |at: usize, unit: &str| {
            // Seconds are printed as `S`, too.
            let second = at == 0 && unit == "S" && axis == Some(AxisKind::Time);
            let said = Name::with_unit_row(&names[at].name, if second { "s" } else { unit });
            names[at].unit = names[at].unit.take().or(said.unit).filter(|unit| !unit.is_empty());
        };
        for (i, unit) in units.unwrap_or_default().iter().rev().enumerate() {
            adopt(n - 1 - i, unit);
        }
        if let Some([unit, ..]) = self.values(AXIS_UNIT).filter(|_| axis.is_some()) {
            adopt(0, unit);
        }
        sources.or(units).is_some()
    }
}

/// Number of fields, where all are numbers or missing or a clock and at least one is a number.
fn row(text: &str, mark: u8, options: &Options) -> Option<usize> {
    let fields = fields(text, Separator::Char(mark)).ok()?;
    let clock = clock::columns(&fields).unwrap_or(0..0);
    let point = options.decimal_comma != Some(true);
    let comma = options.decimal_comma != Some(false) && mark != b',';
    let mut numbers = 0;
    for (i, (_, field)) in fields.iter().enumerate() {
        let field = field.as_bytes();
        let number =
            (point && number::parse(field).is_some()) || (comma && number::parse_with(field, b',').is_some());
        if !number && !number::is_missing(field) && !clock.contains(&i) {
            return None;
        }
        numbers += usize::from(number);
    }
    (numbers > 0).then_some(fields.len())
}

/// The dialect with the decimal mark: as stated, else the last comma or point of the first number that has one, where commas do not separate.
fn decided(found: Dialect, text: &Text, options: &Options) -> Dialect {
    let rows = found.rows(&text.head).filter(|line| line.remark.is_none());
    let cells = rows.flat_map(|line| found.cut(&line).unwrap_or_default().into_iter().enumerate());
    let mut marks = cells
        .filter(|(i, _)| found.clock_at() != Some(*i))
        .filter_map(|(_, (_, cell))| cell.bytes().rfind(|b| matches!(b, b',' | b'.')));
    let comma = options.decimal_comma.or_else(|| marks.next().map(|mark| mark == b','));
    let comma = comma == Some(true) && found.separator != Separator::Char(b',');
    drop(marks);
    Dialect { decimal: if comma { b',' } else { b'.' }, ..found }
}

/// The dialect with the names that stand in the lines above `first`, in a row of their own or behind keys, and whether there are as many as
/// columns.
fn fit(
    above: &[Line],
    first: Line,
    separator: Separator,
    count: usize,
    head: &str,
) -> Option<(Dialect, bool)> {
    let spoken: Vec<&Line> = above.iter().filter(|l| l.remark.is_none()).rev().collect();
    let last = *spoken.first()?;
    let rows =
        Lines::new(head, first.at, first.number, REMARKS).filter(|l| !l.is_blank() && l.remark.is_none());
    let rows: Vec<Fields> = rows.take(BESIDE).map_while(|l| fields(l.text, separator).ok()).collect();
    // Keys of a preamble may have a column of their own, which is empty below.
    let skipped = usize::from(rows.len() > 1 && rows.iter().all(|row| row.len() > 1 && row[0].1.is_empty()));
    let values = rows.first()?.get(skipped..)?;
    let width = values.iter().rposition(|(_, f)| !f.is_empty()).map_or(0, |last| last + 1);
    let count = count - skipped;
    let deepest = spoken.iter().take(DEEPEST);
    let mut block: Vec<Fields> = deepest.map_while(|l| headings(l, separator, skipped, values)).collect();
    let (lower, uppers) = block.split_first_mut()?;
    let stated = beside(uppers.first_mut(), lower, width);
    let clock = clock::columns(values).map(|cells| {
        let ms = block.iter().any(|line| line.get(cells.end).is_some_and(|(_, cell)| cell == "ms"));
        cells.start..cells.end + usize::from(ms)
    });
    let fits = |columns: usize| count == columns || width == columns;
    let is_units = |at: &usize| {
        let (units, upper) = (&block[*at], &block[*at + 1]);
        let outside = |i: &usize| !clock.as_ref().is_some_and(|cells| cells.contains(i));
        let cells = (0..units.len()).filter(outside).map(|i| units[i].1.as_ref());
        units.len() == upper.len() && named(upper) && (*at == 0 || fits(units.len())) && is_unit_row(cells)
    };
    let cells = |line: &Line| {
        Some(fields(line.text, separator).ok()?.into_iter().map(|(_, f)| f.into_owned()).collect())
    };
    let preamble = Preamble(spoken.iter().filter_map(|line| cells(line)).collect());
    let lower = &block[0];
    let title = lower.iter().filter(|(_, f)| !f.is_empty()).count() == 1
        && (width > 1 || (preamble.values(SOURCE).is_some() && unit_word(&lower[0].1).is_none()));
    let units = (0..block.len() - 1).find(is_units);
    let (used, mut names) = match units {
        Some(at) => {
            let pairs = block[at + 1].iter().zip(&block[at]);
            (at..at + 2, pairs.map(|((_, n), (_, u))| Name::with_unit_row(n, u)).collect::<Vec<Name>>())
        }
        None if named(lower) && !title => {
            // `Second,Volt` under a preamble: units, and no names.
            let units: Option<Vec<Name>> = lower.iter().map(|(_, n)| unit_word(n)).collect();
            (0..1, units.unwrap_or_else(|| lower.iter().map(|(_, n)| Name::parse(n)).collect()))
        }
        None => (0..0, vec![Name::default(); width]),
    };
    let columns = names.len();
    let fits = fits(columns);
    if let Some(cells) = clock.clone().filter(|cells| cells.end <= columns) {
        names.splice(cells, [Name { name: "time".to_owned(), unit: Some("s".to_owned()) }]);
    }
    // Under a scale, whole numbers are counts of a converter, whatever the unit of the scale.
    let whole = |(_, cell): &(usize, Cow<str>)| cell.bytes().all(|b| b.is_ascii_digit() || b == b'-');
    let counts = preamble.values(&["vertical scale"]).is_some() && rows.iter().flatten().all(whole);
    let preamble = Preamble(
        preamble.0.into_iter().filter(|cells| !counts || !UNIT.contains(&key(cells).as_str())).collect(),
    );
    if used.is_empty() {
        let first = rows.iter().filter_map(|row| number::parse(row.get(skipped)?.1.as_bytes()));
        let first: Vec<f64> = first.collect();
        let rises = first.len() > 1 && first.windows(2).all(|w| w[1] > w[0]);
        if names.len() > 1 && rises {
            "time".clone_into(&mut names[0].name);
        }
    }
    let keyed = preamble.name(&mut names);
    if (used.is_empty() && !keyed) || (columns == 1 && count > 1 && !used.is_empty()) {
        return None;
    }
    let unused =
        |line: &Line| !spoken.get(used.clone()).is_some_and(|used| used.iter().any(|l| **l == *line));
    let preamble = above.iter().filter(|l| unused(l)).map(|l| said(l, separator));
    let dialect = Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        complex: false,
        columns: names.len(),
        skipped,
        clock,
        names: Some(names),
        remarks: REMARKS,
        header: preamble.chain(stated).collect(),
        columns_from: spoken.get(used.end.max(1) - 1).unwrap_or(&last).number,
        first_line: first.number,
    };
    Some((dialect, fits))
}

/// Statements in cells beyond the `width` of the rows: a word over a number, `Start` over `-2e-3`, or `t0 = -5e-7`. They are taken out.
fn beside(upper: Option<&mut Fields>, lower: &mut Fields, width: usize) -> Vec<String> {
    let over = |upper: &Fields| {
        let mut pairs = upper.iter().zip(&*lower).skip(width);
        upper.len() == lower.len() && pairs.all(|(key, value)| is_pair(&key.1, &value.1))
    };
    if width == 0 || lower.len() <= width {
        return Vec::new();
    }
    match upper {
        Some(upper) if over(upper) => {
            let keys = upper.split_off(width).into_iter().zip(lower.split_off(width));
            keys.map(|((_, key), (_, value))| format!("{key}: {value}")).collect()
        }
        _ if lower[width..].iter().all(|(_, f)| f.is_empty() || f.contains('=')) => {
            lower.split_off(width).into_iter().map(|(_, field)| field.into_owned()).collect()
        }
        _ => Vec::new(),
    }
}

fn is_pair(key: &str, value: &str) -> bool {
    key.contains(char::is_alphabetic) && number::parse(value.as_bytes()).is_some()
}

/// The fields of a line above the row `values`, without `skipped` ones at its start and a blank one at its end that the row has no value for.
fn headings<'a>(
    line: &Line<'a>,
    separator: Separator,
    skipped: usize,
    values: &[(usize, Cow<str>)],
) -> Option<Fields<'a>> {
    let mut fields = fields(line.text, separator).ok()?;
    fields.drain(..skipped.min(fields.len()));
    let last = fields.len().checked_sub(1)?;
    let unused = values.get(last).is_none_or(|(_, v)| v.is_empty());
    if last > 0 && fields[last].1.is_empty() && unused {
        fields.pop();
    }
    Some(fields)
}

/// Whether fields name columns: some letters that are no exponent, and not `key: value`.
fn named(fields: &Fields) -> bool {
    let statement =
        fields.first().is_some_and(|(_, f)| f.contains(": ") || f.ends_with(':') || f.contains('='));
    let is_name = |field: &str| {
        let bytes = field.as_bytes();
        let number = number::parse(bytes).is_some() || number::parse_with(bytes, b',').is_some();
        field.contains(char::is_alphabetic) && !number && !number::is_missing(bytes)
    };
    !statement && fields.iter().any(|(_, f)| is_name(f))
}

/// A preamble line as `key: value`: spreadsheets put key, value and unit into cells.
fn said(line: &Line, separator: Separator) -> String {
    let whole = || line.remark.unwrap_or(line.text.trim()).to_owned();
    let Some(cells) = fields(line.text, separator).ok().filter(|_| line.remark.is_none()) else {
        return whole();
    };
    let cells: Vec<String> = cells.into_iter().map(|(_, cell)| cell.into_owned()).collect();
    if cells[0].trim_end_matches(':').contains([':', '=']) { whole() } else { statement(&cells) }
}

/// Key and values of a preamble; values that are all the same are one.
fn statement(cells: &[String]) -> String {
    let mut cells = cells.iter().map(|cell| cell.trim()).filter(|cell| !cell.is_empty());
    let key = cells.next().unwrap_or_default();
    let mut values: Vec<&str> = cells.collect();
    if values.iter().all(|value| *value == values[0]) {
        values.truncate(1);
    }
    if values.is_empty() {
        key.to_owned()
    } else {
        format!("{}: {}", key.trim_end_matches(':'), values.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, called_csv: bool) -> Option<Dialect> {
        let name = if called_csv { "x.csv" } else { "x" };
        let source = crate::Source::memory(name, text.as_bytes()).ok()?;
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
        assert_eq!(layout("note\ns,V\n0,1\n"), Some((',', names(&["s|", "V|"]), 2, 3)));
    }

    #[test]
    fn preamble_and_comments_are_kept() {
        let text = "# by hand\nSample rate;1000;Hz\nOperator: A;B\n12;13\nt;a\n% more\n0;1\n";
        let d = found(text, false).unwrap();
        assert_eq!((d.columns_from, d.first_line), (5, 7));
        let said: Vec<&str> = d.header.iter().map(String::as_str).collect();
        assert_eq!(said, ["by hand", "Sample rate: 1000 Hz", "Operator: A;B", "12: 13", "more"]);
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
