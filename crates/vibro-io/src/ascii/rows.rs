//! The careful path: one line after the other, each complaint with its line and column.

use super::grouping::GROUPED;
use super::layout::{Cell, Layout, comment, complex, cut_row, lines, shorten};
use crate::cut_off::CUT_OFF;
use crate::footer::{Footer, again};
use crate::missing::Missing;
use crate::number;
use num_complex::Complex64;
use std::path::Path;
use vibro_record::{Error, Place, Result};

/// Columns of numbers and what was met on the way.
#[derive(Debug, Default, PartialEq)]
pub struct Rows {
    /// Values row by row; real ones have no imaginary part. Missing ones are NaN.
    pub values: Vec<Complex64>,
    /// Number of missing values.
    pub missing: usize,
    /// Comment lines between or behind the rows.
    pub comments: Vec<String>,
    /// Words behind the rows.
    pub footer: Option<Footer>,
}

/// Reads all rows from the first one on.
///
/// # Errors
/// On the first word that is no number and the first row with another number of values; on missing values, all at once,
/// unless `allow_missing`; on more blank lines than values that the bytes could hold.
pub fn read(path: &Path, bytes: &[u8], layout: &Layout, allow_missing: bool) -> Result<Rows> {
    let mut rows = Rows::default();
    let bytes = without_end_mark(bytes);
    let mut missing = Missing::default();
    let mut blank_since: Option<u64> = None;
    let mut cells = Vec::new();
    let bytes_of_rows = &bytes[layout.first_byte.min(bytes.len())..];
    for (index, at, line) in lines(bytes_of_rows) {
        let number = layout.first_line + index - 1;
        if line.trim_ascii().is_empty() {
            blank_since.get_or_insert(number);
            continue;
        }
        if let Some(text) = comment(line) {
            rows.comments.push(String::from_utf8_lossy(text).into_owned());
            continue;
        }
        cut(line, layout, &mut cells);
        let words = layout.columns == 1 && cells.first().is_some_and(|c| c.1.contains(&b' '));
        if cells.len() != layout.columns || words {
            let (whole, rest) = (rows.values.len() / layout.columns, lines(&bytes_of_rows[at..]));
            rows.footer = Footer::of(whole, layout.columns, rest.map(|(_, _, line)| texts(line, layout)));
            if rows.footer.is_some() {
                break;
            }
        }
        if let Some(since) = blank_since.take() {
            // Blank lines with rows behind them are rows without values.
            let blanks = usize::try_from(number - since).unwrap_or(usize::MAX);
            for blank in since..number {
                missing.take(blank, layout.columns, String::new);
            }
            if allow_missing {
                // A blank line is one byte: many columns would make much of nothing.
                let wanted = blanks.saturating_mul(layout.columns);
                if wanted > bytes.len().saturating_sub(rows.values.len()) {
                    return Err(too_many(path, since, blanks, layout.columns));
                }
                rows.values.extend(std::iter::repeat_n(Complex64::new(f64::NAN, 0.0), wanted));
            }
        }
        let mut gaps = 0;
        for &(offset, cell) in &cells {
            let value = match layout.cell {
                Cell::Real => number::parse_with(cell, layout.decimal).map(|v| Complex64::new(v, 0.0)),
                Cell::Complex => complex(cell, layout.decimal).map(|(re, im)| Complex64::new(re, im)),
            };
            let value = match value {
                Some(value) => value,
                None if number::is_missing(cell) || (layout.cell == Cell::Complex && holds_nan(cell)) => {
                    gaps += 1;
                    Complex64::new(f64::NAN, 0.0)
                }
                None => {
                    let error = not_a_number(path, number, offset, cell, layout);
                    let behind = lines(&bytes_of_rows[at..]).skip(1);
                    let behind = behind.map(|(i, _, other)| (number + i - 1, String::from_utf8_lossy(other)));
                    return Err(match again(&String::from_utf8_lossy(cell), behind) {
                        Some(others) => error.aside(others),
                        None if is_last(line, bytes) => error.hint(CUT_OFF),
                        None => error,
                    });
                }
            };
            rows.values.push(value);
        }
        if cells.len() != layout.columns {
            return Err(Error::input(
                Place::line(path, number),
                format!("found {} values in this row", cells.len()),
                format!("{} as in line {}", layout.columns, layout.first_line),
            )
            .hint(if is_last(line, bytes) { CUT_OFF } else { "mend or remove the row" }));
        }
        if gaps > 0 {
            missing.take(number, gaps, String::new);
        }
    }
    missing.check(path, allow_missing)?;
    rows.missing = missing.count;
    Ok(rows)
}

/// Cuts a line into cells; a complex number may have blanks in it.
fn cut<'a>(line: &'a [u8], layout: &Layout, cells: &mut Vec<(usize, &'a [u8])>) {
    if layout.columns == 1 && layout.cell == Cell::Complex {
        let text = line.trim_ascii();
        cells.clear();
        cells.push((text.as_ptr() as usize - line.as_ptr() as usize, text));
    } else {
        cut_row(line, layout.separator, cells);
    }
}

/// A line and its cells.
fn texts(line: &[u8], layout: &Layout) -> (String, Vec<String>) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let mut cells = Vec::new();
    cut(line, layout, &mut cells);
    (text(line), cells.into_iter().map(|(_, cell)| text(cell)).collect())
}

/// Whether a line ends with the file and not with a line end.
fn is_last(line: &[u8], bytes: &[u8]) -> bool {
    line.as_ptr_range().end == bytes.as_ptr_range().end
}

/// Without the mark that DOS programs end a text with.
pub fn without_end_mark(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|b| *b != 0x1a).map_or(0, |last| last + 1);
    &bytes[..end]
}

fn too_many(path: &Path, line: u64, blanks: usize, columns: usize) -> Error {
    Error::input(
        Place::line(path, line),
        format!("{blanks} blank lines between rows of {columns} values"),
        "at most one missing value for each byte of the file",
    )
    .hint("remove the blank lines")
}

fn holds_nan(cell: &[u8]) -> bool {
    let lower = cell.to_ascii_lowercase();
    [b"nan", b"inf"].iter().any(|word| lower.windows(3).any(|w| w == *word))
}

fn not_a_number(path: &Path, line: u64, offset: usize, cell: &[u8], layout: &Layout) -> Error {
    let text = String::from_utf8_lossy(cell);
    let expected = match layout.cell {
        Cell::Real if layout.decimal == b',' => "a number with a decimal comma",
        Cell::Real => "a number",
        Cell::Complex => "a complex number such as (1.5-2j)",
    };
    let hint = if number::parse_with(cell, if layout.decimal == b'.' { b',' } else { b'.' }).is_some() {
        "if the decimal mark is a comma, give --decimal comma; if it is a point, --decimal point"
    } else if cell.contains(&b'.') && cell.contains(&b',') {
        GROUPED
    } else {
        "write NaN in the place of a bad value and give --allow-missing; put # before the line if it is a remark"
    };
    Error::input(
        Place::line(path, line).column(offset as u64 + 1),
        format!("found {:?}", shorten(&text)),
        expected,
    )
    .hint(hint)
}
