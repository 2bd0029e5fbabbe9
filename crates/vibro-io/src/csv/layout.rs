//! Where the names end and the numbers begin, and what separates them.

use super::name::{Name, is_unit_row};
use super::rows::{Line, Lines, cut};
use crate::number;
use crate::reader::Options;
use crate::source::HEAD;
use std::borrow::Cow;

/// From the one that stands in numbers least to the one that does most.
const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// What stands above the rows of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout<'a> {
    pub separator: char,
    /// One a column.
    pub names: Vec<Name>,
    /// Line of the names.
    pub named_in: u64,
    /// The first row of numbers.
    pub first: Line<'a>,
    /// Comments and preamble with their lines.
    pub preamble: Vec<(u64, String)>,
}

type Fields<'a> = Vec<(usize, Cow<'a, str>)>;

/// Finds the first row of numbers with names right above it; `None` where there is none in the first 64 KiB.
///
/// Where `named_csv` the file calls itself CSV: then a single column will do, and a header that does not fit its rows is
/// still a header, so that reading can name the row at fault.
pub fn detect<'a>(text: &'a str, options: &Options, named_csv: bool) -> Option<Layout<'a>> {
    let mut above: Vec<Line> = Vec::new();
    let mut unfit = None;
    for line in Lines::from(text, 0, 1).take_while(|l| l.at < HEAD).filter(|l| !l.is_blank()) {
        if line.comment().is_none() {
            let rows = SEPARATORS.map(|separator| (separator, row(line.text, separator, options)));
            let several = |(_, count): &&(char, Option<usize>)| count.is_some_and(|n| n > 1);
            for (separator, count) in rows.iter().filter(several) {
                match fit(&above, line, *separator, count.unwrap_or(0)) {
                    Some((layout, true)) => return Some(layout),
                    Some((layout, false)) => unfit = unfit.or(Some(layout)),
                    None => {}
                }
            }
            // One column last: `1,5` under `a,b` is no decimal comma.
            if named_csv
                && unfit.is_none()
                && let Some((separator, _)) = rows.iter().find(|(_, count)| *count == Some(1))
                && let Some((layout, true)) = fit(&above, line, *separator, 1)
            {
                return Some(layout);
            }
        }
        above.push(line);
    }
    unfit.filter(|_| named_csv)
}

/// Number of fields, where all are numbers or missing and at least one is a number.
fn row(text: &str, separator: char, options: &Options) -> Option<usize> {
    let mut fields = Vec::new();
    cut(text, separator, &mut fields).ok()?;
    let point = options.decimal_comma != Some(true);
    let comma = options.decimal_comma != Some(false) && separator != ',';
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

/// The layout with the names that stand in the last lines above `first`, and whether there are as many as columns.
fn fit<'a>(above: &[Line], first: Line<'a>, separator: char, count: usize) -> Option<(Layout<'a>, bool)> {
    let mut spoken = above.iter().filter(|l| l.comment().is_none()).rev();
    let last = spoken.next()?;
    let mut values = Vec::new();
    cut(first.text, separator, &mut values).ok()?;
    let names = headings(last, separator, &values)?;
    let columns = names.len();
    if columns == 1 && count > 1 {
        return None;
    }
    let blank_end = values.last().is_some_and(|(_, f)| f.is_empty());
    let fits = count == columns || (count == columns + 1 && blank_end);
    let upper = spoken.next().and_then(|l| Some((l, headings(l, separator, &values)?)));
    let (line, names) = match upper {
        Some((line, upper)) if upper.len() == columns && named(&upper) && units(&names) => {
            let pairs = upper.iter().zip(&names);
            (line, pairs.map(|((_, n), (_, u))| Name::with_unit_row(n, u)).collect::<Vec<Name>>())
        }
        _ if named(&names) => (last, names.iter().map(|(_, n)| Name::parse(n)).collect()),
        _ => return None,
    };
    let preamble = above.iter().filter(|l| *l != last && *l != line).map(|l| (l.number, said(l, separator)));
    let layout = Layout { separator, names, named_in: line.number, first, preamble: preamble.collect() };
    Some((layout, fits))
}

/// The fields of a line above the row `values`, without a blank one at the end that the row has no value for.
fn headings<'a>(line: &Line<'a>, separator: char, values: &Fields) -> Option<Fields<'a>> {
    let mut fields = Vec::new();
    cut(line.text, separator, &mut fields).ok()?;
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

fn units(fields: &Fields) -> bool {
    is_unit_row(fields.iter().map(|(_, f)| f.as_ref()))
}

/// A preamble line as `key: value`: spreadsheets put key, value and unit into cells.
fn said(line: &Line, separator: char) -> String {
    if let Some(text) = line.comment() {
        return text.to_owned();
    }
    let mut fields = Vec::new();
    if line.text.contains([':', '=']) || cut(line.text, separator, &mut fields).is_err() {
        return line.text.trim().to_owned();
    }
    let mut cells = fields.iter().map(|(_, f)| f.trim()).filter(|f| !f.is_empty());
    let key = cells.next().unwrap_or_default().to_owned();
    let value = cells.collect::<Vec<_>>().join(" ");
    if value.is_empty() { key } else { format!("{key}: {value}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Option<(char, Vec<String>, u64, u64)> {
        shape(text, false)
    }

    fn shape(text: &str, named_csv: bool) -> Option<(char, Vec<String>, u64, u64)> {
        let l = detect(text, &Options::default(), named_csv)?;
        let names = l.names.into_iter().map(|n| format!("{}|{}", n.name, n.unit.unwrap_or_default()));
        Some((l.separator, names.collect(), l.named_in, l.first.number))
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
        assert_eq!(layout("\"t\" , \"a\"\r\r1,-\r"), Some((',', plain.clone(), 1, 3)));
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
        let l = detect(text, &Options::default(), false).unwrap();
        assert_eq!((l.named_in, l.first.number), (5, 7));
        let said: Vec<&str> = l.preamble.iter().map(|(_, s)| s.as_str()).collect();
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
