//! The layout of a text of numbers, as data.

use super::clock;
use super::lines::{Fields, Line, Lines, Separator, fields};
use super::names::Name;
use crate::format::Format;
use crate::number;
use std::ops::Range;

/// Most rows that are searched for the decimal mark.
const ENOUGH: usize = 1000;

/// How rows are cut and read, and what the lines above them hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// CSV: the abscissa is the first column whose name says so. ASCII: the abscissa is the first column,
    /// if its name says so or it rises; a blank line between rows of one column is a row without a value.
    pub format: Format,
    pub separator: Separator,
    /// Decimal mark.
    pub decimal: u8,
    /// Whether the user stated the decimal mark.
    pub stated: bool,
    /// Whether a cell holds a complex number, `(re+imj)`, `re+imj`, `re - im i`, … instead of a real one.
    pub complex: bool,
    /// Columns of a row; date and time count as one column.
    pub columns: usize,
    /// Number of cells before these columns; they hold a preamble to the left of the first rows.
    pub skipped: usize,
    /// Cells of date and time, counted after the skipped ones; together they are one column.
    pub clock: Option<Range<usize>>,
    /// One name for each column, where the text has names.
    pub names: Option<Vec<Name>>,
    /// Marks that begin a remark.
    pub remarks: &'static [&'static str],
    /// Preamble and remarks above the rows.
    pub header: Vec<String>,
    /// Number of the line from which the number of columns is taken, from 1.
    pub columns_from: u64,
    /// Number of the line of the first row, from 1.
    pub first_line: u64,
}

impl Dialect {
    /// Byte offset of the first row in `head`, after any byte order mark.
    pub(crate) fn first_byte(&self, head: &[u8]) -> usize {
        let mark = if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        line_start(head, self.first_line).unwrap_or(head.len()).max(mark)
    }

    /// The lines of `text` from the first row on.
    pub fn rows<'a>(&self, text: &'a str) -> Lines<'a> {
        let from = line_start(text.as_bytes(), self.first_line).unwrap_or(text.len());
        Lines::new(text, from, self.first_line, self.remarks)
    }

    /// The column of a table that is the abscissa by its name.
    pub(crate) fn named_abscissa(&self) -> Option<usize> {
        let names = self.names.as_deref().filter(|_| self.format == Format::Csv)?;
        let named = |i: &usize| names[*i].axis(*i == 0).is_some() && self.clock_at() != Some(*i);
        let sure = |i: &usize| named(i) && !names[*i].is_vague();
        (0..names.len()).find(sure).or(self.clock_at()).or((0..names.len()).find(named))
    }

    /// The column of date and time.
    pub(crate) fn clock_at(&self) -> Option<usize> {
        self.clock.as_ref().map(|cells| cells.start)
    }

    /// The decimal mark, if the user stated it or a number in the first rows shows it: `1.000` does not.
    pub(crate) fn shown_mark(&self, head: &str) -> Option<u8> {
        let has =
            |cell: &str| cell.as_bytes().contains(&self.decimal) && !number::may_be_grouped(cell.as_bytes());
        let rows = self.rows(head).filter(|line| line.remark.is_none());
        let shows = |line: Line| {
            let cells = self.cut(&line).unwrap_or_default();
            cells.iter().enumerate().any(|(i, (_, cell))| self.clock_at() != Some(i) && has(cell))
        };
        (self.stated || rows.take(ENOUGH).any(shows)).then_some(self.decimal)
    }

    /// The real number in a cell; `None` if the cell is not a number.
    pub(crate) fn number(&self, cell: &[u8]) -> Option<f64> {
        let parse = if self.stated { number::parse_stated } else { number::parse_with };
        parse(cell, self.decimal)
    }

    /// Fields of a row. A single complex number may contain blanks. Blank fields after the last column do
    /// not count.
    ///
    /// # Errors
    /// The byte offset of text after a closing quote.
    pub fn cut<'a>(&self, line: &Line<'a>) -> Result<Fields<'a>, usize> {
        if self.columns == 1 && self.complex {
            let text = line.text.trim();
            return Ok(vec![(line.text.len() - line.text.trim_start().len(), text.into())]);
        }
        let mut fields = fields(line.text, self.separator)?;
        fields.drain(..self.skipped.min(fields.len()));
        if let Some(cells) = self.clock.clone().filter(|cells| cells.end <= fields.len()) {
            let whole = (fields[cells.start].0, clock::joined(&fields[cells.clone()]).into());
            fields.splice(cells, [whole]);
        }
        while fields.len() > self.columns && fields.last().is_some_and(|(_, f)| f.is_empty()) {
            fields.pop();
        }
        Ok(fields)
    }
}

/// Byte offset at which line `number`, counted from 1, begins.
fn line_start(bytes: &[u8], number: u64) -> Option<usize> {
    let mut ends = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(at, _)| at + 1);
    if number <= 1 { Some(0) } else { ends.nth(number as usize - 2) }
}
