//! How a text of numbers is laid out, as data.

use super::header::Stated;
use super::lines::{Fields, Line, Lines, fields};
use super::names::Name;
use super::{encoding, numbers, table};
use crate::{Format, Options, Source};
use std::path::PathBuf;
use vibro_record::Result;

/// How rows are to be cut and read, and what stands above them.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    pub format: Format,
    pub separator: Separator,
    /// Decimal mark.
    pub decimal: u8,
    /// Whether the first rows hold no mark that tells the decimal one.
    pub decimal_open: bool,
    pub cell: Cell,
    /// Columns of a row.
    pub columns: usize,
    /// One a column, where the text has them.
    pub names: Option<Vec<Name>>,
    pub abscissa: Abscissa,
    /// What begins a remark.
    pub remarks: &'static [&'static str],
    /// Whether a blank line between rows is a row without values.
    pub blank_rows: bool,
    /// Preamble and remarks above the rows, with their line numbers.
    pub header: Vec<(u64, String)>,
    /// Line that the number of columns is taken from.
    pub columns_from: u64,
    /// Line of the first row, from 1.
    pub first_line: u64,
}

/// What stands between two values of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// Any run of spaces and tabs.
    Blank,
    /// One character: `,`, `;` or tab. Fields may stand in quotes.
    Char(u8),
}

/// What one cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// One real number.
    Real,
    /// `(re+imj)`, `re+imj`, `re - im i`, …
    Complex,
}

/// Which column is the abscissa.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Abscissa {
    /// The first whose name says so.
    Named,
    /// The first column, by its name or because it rises.
    Rising,
}

/// The beginning of a text.
pub struct Head {
    pub path: PathBuf,
    pub bytes: Vec<u8>,
    /// Without a line that is cut off.
    pub text: String,
    /// Whether the file calls itself CSV: then one column will do, and names need not fit the rows.
    pub called_csv: bool,
}

impl Head {
    /// The head of a source that [`super::plain`] made, without the end mark of DOS.
    pub fn of(source: &Source) -> Result<Head> {
        let bytes = source.head()?;
        let cut = source.len() > bytes.len() as u64;
        let whole = if cut { bytes.iter().rposition(|b| *b == b'\n').unwrap_or(0) } else { bytes.len() };
        let text = encoding::decode(&bytes[..whole]).trim_end_matches('\u{1a}').to_owned();
        let called_csv = matches!(source.extension().as_str(), "csv" | "tsv");
        Ok(Head { path: source.path().to_owned(), bytes, text, called_csv })
    }
}

/// Finds out whether a text is of a dialect; `None` where it is not.
type Detect = fn(&Head, &Options) -> Result<Option<Dialect>>;

/// Tables with names above their columns, the strictest first. The dialect of an instrument is a function here.
const TABLES: &[Detect] = &[table::detect];

/// The dialect of a table with names; `None` where the text is none.
///
/// # Errors
/// If it is one that cannot be read without a statement.
pub(crate) fn of_table(head: &Head, options: &Options) -> Result<Option<Dialect>> {
    for detect in TABLES {
        if let Some(found) = detect(head, options)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The dialect of plain columns of numbers.
///
/// # Errors
/// If there is no row of numbers, or if it cannot be told whether commas are decimal marks.
pub fn of_numbers(head: &Head, options: &Options) -> Result<Dialect> {
    numbers::detect(head, options)
}

impl Dialect {
    /// Byte of the first row in the bytes of a head.
    pub(crate) fn first_byte(&self, head: &[u8]) -> usize {
        let mark = if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        line_start(head, self.first_line).unwrap_or(head.len()).max(mark)
    }

    /// The lines of `text` from the first row on.
    pub fn rows<'a>(&self, text: &'a str) -> Lines<'a> {
        let from = line_start(text.as_bytes(), self.first_line).unwrap_or(text.len());
        Lines::new(text, from, self.first_line, self.remarks)
    }

    /// The column that its name makes the abscissa.
    pub(crate) fn named_abscissa(&self) -> Option<usize> {
        let names = self.names.as_deref().filter(|_| self.abscissa == Abscissa::Named)?;
        names.iter().enumerate().find_map(|(i, name)| name.axis(i == 0).map(|_| i))
    }

    /// What the lines above the rows and the `remarks` between them state.
    pub fn stated(&self, remarks: &[(u64, String)]) -> Stated {
        Stated::of(self.header.iter().chain(remarks).map(|(_, line)| line.as_str()))
    }

    /// Fields of a row; a complex number may have blanks in it. Blank fields behind the last column do not count.
    ///
    /// # Errors
    /// The byte at which something stands behind a closing quote.
    pub fn cut<'a>(&self, line: &Line<'a>) -> std::result::Result<Fields<'a>, usize> {
        if self.columns == 1 && self.cell == Cell::Complex {
            let text = line.text.trim();
            return Ok(vec![(line.text.len() - line.text.trim_start().len(), text.into())]);
        }
        let mut fields = fields(line.text, self.separator)?;
        while fields.len() > self.columns && fields.last().is_some_and(|(_, f)| f.is_empty()) {
            fields.pop();
        }
        Ok(fields)
    }
}

/// Where line `number` begins, counted from 1.
fn line_start(bytes: &[u8], number: u64) -> Option<usize> {
    let mut ends = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(at, _)| at + 1);
    if number <= 1 { Some(0) } else { ends.nth(number as usize - 2) }
}
