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
use super::dialect::{Dialect, Separator};
use super::lines::{Fields, Line, Lines, fields};
use super::names::{Name, is_unit_row, unit_word};
use crate::{Format, Options, number};
use std::borrow::Cow;

/// From the one that stands in numbers least to the one that does most.
const SEPARATORS: [u8; 3] = *b"\t;,";

const REMARKS: &[&str] = &["#", "%"];

/// Rows that have a preamble beside them, at most.
const BESIDE: usize = 40;

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
                match fit(&above, line, *separator, count.unwrap_or(0)) {
                    Some((found, true)) => return Some(decided(found, text, options)),
                    found => misfit = misfit.or(found.map(|(found, _)| found)),
                }
            }
            // One column last: `1,5` under `a,b` is no decimal comma.
            if text.called_csv()
                && misfit.is_none()
                && let Some((separator, _)) = of(1).next()
                && let Some((found, true)) = fit(&above, line, *separator, 1)
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
    let blank = |field: &&(usize, Cow<str>)| field.1.is_empty();
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
    let cells =
        rows.iter().map(|(_, row)| row[..skipped].iter().map(|(_, f)| f.trim()).filter(|f| !f.is_empty()));
    let said: Vec<Vec<&str>> =
        cells.map(Iterator::collect).filter(|cells: &Vec<&str>| cells.len() > 1).collect();
    let value = |key: &str| {
        said.iter().find(|cells| cells[0].eq_ignore_ascii_case(key)).map(|cells| cells[1].to_owned())
    };
    let name = |name: Option<String>, unit| Name { name: name.unwrap_or_default(), unit: value(unit) };
    let names = match columns {
        2 => vec![name(Some("time".to_owned()), "horizontal units"), name(value("source"), "vertical units")],
        _ => vec![Name::default(); columns],
    };
    Some(Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        complex: false,
        columns,
        skipped,
        names: Some(names),
        remarks: &[],
        header: said.iter().map(|cells| format!("{}: {}", cells[0], cells[1..].join(" "))).collect(),
        columns_from: *first_line,
        first_line: *first_line,
    })
}

/// Number of fields, where all are numbers or missing and at least one is a number.
fn row(text: &str, mark: u8, options: &Options) -> Option<usize> {
    let fields = fields(text, Separator::Char(mark)).ok()?;
    let point = options.decimal_comma != Some(true);
    let comma = options.decimal_comma != Some(false) && mark != b',';
    let mut numbers = 0;
    for (_, field) in &fields {
        let field = field.as_bytes();
        let number =
            (point && number::parse(field).is_some()) || (comma && number::parse_with(field, b',').is_some());
        if !number && !number::is_missing(field) {
            return None;
        }
        numbers += usize::from(number);
    }
    (numbers > 0).then_some(fields.len())
}

/// The dialect with the decimal mark: as stated, else the first comma or point in the rows, where commas do not separate.
fn decided(found: Dialect, text: &Text, options: &Options) -> Dialect {
    let mut rows = found.rows(&text.head).filter(|line| line.remark.is_none());
    let mut first = || rows.find_map(|line| line.text.bytes().find(|b| matches!(b, b',' | b'.')));
    let comma = options.decimal_comma.or_else(|| first().map(|mark| mark == b','));
    let comma = comma == Some(true) && found.separator != Separator::Char(b',');
    Dialect { decimal: if comma { b',' } else { b'.' }, ..found }
}

/// The dialect with the names that stand in the last lines above `first`, and whether there are as many as columns.
fn fit(above: &[Line], first: Line, separator: Separator, count: usize) -> Option<(Dialect, bool)> {
    let mut spoken = above.iter().filter(|l| l.remark.is_none()).rev();
    let last = spoken.next()?;
    let values = fields(first.text, separator).ok()?;
    let mut names = headings(last, separator, &values)?;
    let mut upper = spoken.next().and_then(|l| Some((l, headings(l, separator, &values)?)));
    let width = values.iter().rposition(|(_, f)| !f.is_empty()).map_or(0, |last| last + 1);
    let stated = beside(upper.as_mut().map(|(_, fields)| fields), &mut names, width);
    let columns = names.len();
    if columns == 1 && count > 1 {
        return None;
    }
    let fits = count == columns || width == columns;
    let (line, names) = match upper {
        Some((line, upper))
            if upper.len() == columns
                && named(&upper)
                && is_unit_row(names.iter().map(|(_, f)| f.as_ref())) =>
        {
            let pairs = upper.iter().zip(&names);
            (line, pairs.map(|((_, n), (_, u))| Name::with_unit_row(n, u)).collect::<Vec<Name>>())
        }
        _ if named(&names) => {
            // `Second,Volt` under a preamble: units, and no names.
            let units: Option<Vec<Name>> = names.iter().map(|(_, n)| unit_word(n)).collect();
            (last, units.unwrap_or_else(|| names.iter().map(|(_, n)| Name::parse(n)).collect()))
        }
        _ => return None,
    };
    let preamble = above.iter().filter(|l| *l != last && *l != line).map(|l| said(l, separator));
    let dialect = Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        complex: false,
        columns,
        skipped: 0,
        names: Some(names),
        remarks: REMARKS,
        header: preamble.chain(stated).collect(),
        columns_from: line.number,
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

/// The fields of a line above the row `values`, without a blank one at the end that the row has no value for.
fn headings<'a>(line: &Line<'a>, separator: Separator, values: &Fields) -> Option<Fields<'a>> {
    let mut fields = fields(line.text, separator).ok()?;
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
    if let Some(text) = line.remark {
        return text.to_owned();
    }
    let Some(fields) = fields(line.text, separator).ok().filter(|_| !line.text.contains([':', '='])) else {
        return line.text.trim().to_owned();
    };
    let mut cells = fields.iter().map(|(_, f)| f.trim()).filter(|f| !f.is_empty());
    let key = cells.next().unwrap_or_default().to_owned();
    let value = cells.collect::<Vec<_>>().join(" ");
    if value.is_empty() { key } else { format!("{key}: {value}") }
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
