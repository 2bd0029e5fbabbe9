//! The careful path: one line after the other, each complaint with its line and column.

use super::layout::{Cell, Layout, comment, complex, cut_row, lines, shorten};
use crate::error::{Error, Place, Result};
use crate::read::ending::CUT_OFF;
use crate::read::missing::Missing;
use crate::read::number;
use num_complex::Complex64;
use std::path::Path;

/// Columns of numbers and what was met on the way.
#[derive(Debug, Default, PartialEq)]
pub struct Rows {
    /// Values row by row; real ones have no imaginary part. Missing ones are NaN.
    pub values: Vec<Complex64>,
    /// Number of missing values.
    pub missing: usize,
    /// Comment lines between or behind the rows.
    pub comments: Vec<String>,
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
    for (index, _, line) in lines(&bytes[layout.first_byte.min(bytes.len())..]) {
        let number = layout.first_line + index - 1;
        if line.trim_ascii().is_empty() {
            blank_since.get_or_insert(number);
            continue;
        }
        if let Some(text) = comment(line) {
            rows.comments.push(String::from_utf8_lossy(text).into_owned());
            continue;
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
        if layout.columns == 1 && layout.cell == Cell::Complex {
            let text = line.trim_ascii();
            cells.clear();
            cells.push((text.as_ptr() as usize - line.as_ptr() as usize, text));
        } else {
            cut_row(line, layout.separator, &mut cells);
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
                    return Err(if is_last(line, bytes) { error.hint(CUT_OFF) } else { error });
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
    } else {
        "remove the line, or put # before it if it is a remark"
    };
    Error::input(
        Place::line(path, line).column(offset as u64 + 1),
        format!("found {:?}", shorten(&text)),
        expected,
    )
    .hint(hint)
}
