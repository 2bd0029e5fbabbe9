//! Reads the preamble above and beside the rows of a table: keys and values, for the file or for each
//! column.
//!
//! ```text
//! Sample rate; 1000; Hz                  key and value in cells
//! XInc:,5e-4                             … or with a colon
//! "VUnit","V","A"                        one value for each column, or for each except the abscissa
//! Record Length,128,,-0.005,0.25         to the left of the first rows
//! X,CH1,Start,Increment                  a word above a number, to the right of the names
//! ```

use super::decoded::Text;
use super::dialect::Dialect;
use super::lines::{Fields, Line, Lines, Separator, fields};
use super::names::Name;
use crate::format::Format;
use crate::number;
use std::borrow::Cow;
use vibro_record::AxisKind;

/// Most rows that are searched for a preamble beside them.
pub const BESIDE: usize = 40;

/// The lines of a preamble as cells: a key, then one value for all columns or one for each column.
#[derive(Debug, Default)]
pub struct Preamble(Vec<Vec<String>>);

const SOURCE: &[&str] = &[
    "source",
    "tracename",
    "trace name",
    "signal",
    "signal name",
    "channel name",
    "channeltitle",
    "ch",
    "*channel",
    "channel",
    "channel names",
    "kanal",
    "kanalname",
];
pub const UNIT: &[&str] = &[
    "vertical units",
    "vert units",
    "vunit",
    "yunits",
    "y units",
    "unitname",
    "unit",
    "units",
    "*unit",
    "einheit",
];
const AXIS_UNIT: &[&str] = &["horizontal units", "horz units", "hunit", "xunits", "x units"];

/// A cell as a key: in lower case, with blanks for `_`, without a trailing `:` or `=`.
pub fn key(cell: &str) -> String {
    cell.trim_end_matches([':', '=']).trim().replace('_', " ").to_lowercase()
}

impl Preamble {
    /// The preamble in the lines above the rows.
    pub fn of(lines: &[&Line], separator: Separator) -> Preamble {
        let keyed =
            |line: &&&Line| line.text.trim_start_matches([' ', '"', '*']).starts_with(char::is_alphabetic);
        let cells = lines.iter().filter(keyed).filter_map(|line| fields(line.text, separator).ok());
        Preamble(cells.map(|cells| cells.into_iter().map(|(_, cell)| cell.into_owned()).collect()).collect())
    }

    /// Whether a cell is a key with one value for each column.
    pub fn is_of_columns(cell: &str) -> bool {
        [SOURCE, UNIT, AXIS_UNIT].iter().any(|keys| keys.contains(&key(cell).as_str()))
    }

    /// Whether the preamble holds names of columns.
    pub fn names_columns(&self) -> bool {
        self.values(SOURCE).is_some()
    }

    /// Unit of the abscissa, if it is one of time or frequency. Some instruments print `S` for seconds.
    pub fn axis_unit(&self) -> Option<String> {
        let unit = &self.values(AXIS_UNIT)?[0];
        let named = Name::with_unit_row("", if unit == "S" { "s" } else { unit });
        named.unit.clone().filter(|_| named.axis(true).is_some())
    }

    /// The values of the first line whose key is one of `keys`.
    fn values(&self, keys: &[&str]) -> Option<&[String]> {
        let found = self.0.iter().find(|cells| keys.contains(&key(&cells[0]).as_str()))?;
        found.get(1..).filter(|values| values.iter().any(|value| !value.is_empty()))
    }

    /// Fills in missing names and units of columns, if the preamble has one for each column or for each
    /// except the abscissa; returns whether it has. If the preamble has a vertical scale and the values are
    /// `whole` numbers, they are converter counts and get no unit.
    pub fn name<'a>(&'a self, names: &mut [Name], whole: bool) -> bool {
        let n = names.len();
        let axis = names.first().and_then(|name| name.axis(true));
        // Some instruments print `S` for seconds.
        let of_axis = |unit: &String| {
            let unit = if unit == "S" && axis == Some(AxisKind::Time) { "s" } else { unit };
            let named = Name::with_unit_row(&names[0].name, unit);
            named.unit.clone().filter(|_| named.axis(true) == axis)
        };
        let own = self.axis_unit().and_then(|unit| of_axis(&unit));
        // A line may end with blank cells, which may or may not be values: both counts are tried.
        let fit = |values: &'a [String], all: &dyn Fn(&[String]) -> bool| {
            let said = values.iter().rposition(|value| !value.is_empty()).map_or(0, |last| last + 1);
            let fits = |n_values: &usize| {
                (n_values + 1 == n && axis.is_some()) || (*n_values == n && (axis.is_none() || all(values)))
            };
            [said, values.len()].into_iter().find(fits).map(|n_values| &values[..n_values])
        };
        let counts = whole && self.values(&["vertical scale"]).is_some();
        let units =
            self.values(UNIT).filter(|_| !counts).and_then(|units| fit(units, &|u| of_axis(&u[0]).is_some()));
        let own =
            own.or(units.filter(|units| units.len() == n && axis.is_some()).and_then(|u| of_axis(&u[0])));
        let sources = self.values(SOURCE).and_then(|sources| fit(sources, &|_| true));
        for (i, name) in names.iter_mut().rev().enumerate() {
            let of = |values: Option<&[String]>| values?.iter().rev().nth(i).cloned();
            if name.name.is_empty() {
                name.name = of(sources).unwrap_or_default();
            }
            if axis.is_none() || i + 1 < n {
                let unit = of(units).and_then(|unit| Name::with_unit_row("", &unit).unit);
                name.unit = name.unit.take().or(unit);
            }
        }
        if let Some(name) = names.first_mut().filter(|_| axis.is_some()) {
            name.unit = name.unit.take().or(own);
        }
        sources.or(units).is_some()
    }
}

/// Dialect of a table with a preamble in the first columns of its first rows, as Tektronix oscilloscopes
/// write it: key, value and unit, then time and value. Below the preamble its columns are empty.
pub fn beside_rows(text: &Text) -> Option<Dialect> {
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
    let cells = rows.iter().map(|(_, row)| row[..skipped].iter().map(|(_, f)| f.trim().to_owned()));
    let preamble = Preamble(cells.map(Iterator::collect).collect());
    let mut names = vec![Name::default(); columns];
    if columns == 2 {
        "time".clone_into(&mut names[0].name);
    }
    preamble.name(&mut names, false);
    Some(Dialect {
        format: Format::Csv,
        separator,
        decimal: b'.',
        stated: false,
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

/// Removes statements from the cells to the right of the `width` columns of the rows: a word above a
/// number, `Start` above `-2e-3`, or `t0 = -5e-7`.
pub fn beside(upper: Option<&mut Fields>, lower: &mut Fields, width: usize) -> Vec<String> {
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

/// A preamble line as `key: value`; spreadsheets have key, value and unit in cells.
pub fn key_and_value(line: &Line, separator: Separator) -> String {
    let whole = || line.remark.unwrap_or(line.text.trim()).to_owned();
    let Some(cells) = fields(line.text, separator).ok().filter(|_| line.remark.is_none()) else {
        return whole();
    };
    let mut cells: Vec<String> = cells.into_iter().map(|(_, cell)| cell.into_owned()).collect();
    // Rows of one column show no separator. A key with a unit in brackets, followed by a number, shows it.
    if let Some((key, value)) = line.text.split_once([',', ';']).filter(|_| cells.len() == 1)
        && key.ends_with([')', ']'])
        && number::parse(value.as_bytes()).is_some()
    {
        cells = vec![key.to_owned(), value.to_owned()];
    }
    if cells[0].trim_end_matches(':').contains([':', '=']) { whole() } else { statement(&cells) }
}

/// Key and values of a preamble line as text; values that are all equal are written once.
fn statement(cells: &[String]) -> String {
    let mut cells = cells.iter().map(|cell| cell.trim()).filter(|cell| !cell.is_empty());
    let key = cells.next().unwrap_or_default();
    let mut values: Vec<&str> = cells.collect();
    if values.iter().all(|value| *value == values[0]) {
        values.truncate(1);
    }
    let Some(first) = values.first() else { return key.to_owned() };
    // A number is followed by its unit; other values are one for each column.
    let joint = if number::prefix(first.as_bytes(), b'.').is_some() { " " } else { "; " };
    format!("{}: {}", key.trim_end_matches(':'), values.join(joint))
}
