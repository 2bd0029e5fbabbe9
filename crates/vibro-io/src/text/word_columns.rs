//! Leaves out columns of text between columns of numbers: frame names, states such as `7 / 12`, dates in a
//! format that is not recognised as a clock, and the unit of the value before it.

use super::clock;
use super::decoded::{Text, in_line, shorten};
use super::encoding;
use super::lines::{Fields, Line, Lines, Separator, fields};
use super::names::{Name, label};
use super::numbers::complex;
use super::preamble::{UNIT, key};
use super::unit_words::symbol;
use crate::number;
use crate::source::Source;
use std::collections::HashSet;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::ops::Range;
use vibro_record::units::Unit;
use vibro_record::{Error, Finding, Result};

/// Number of last rows in the head that decide which columns hold text.
const ENOUGH: usize = 24;

/// A column of states such as `7 / 12` returns to an earlier text at most once in 10 rows. A column that
/// returns more often may name the channel or sensor of each row. Dates and frame numbers never return.
const STATE: usize = 10;

/// A text without its columns of text, and findings on them.
pub struct LeftOut {
    pub source: Source,
    /// Findings that name the columns left out and their content.
    pub found: Vec<Finding>,
    /// Whether a text that was left out changes from row to row. It may then name channels or be the time,
    /// unless the remaining times rise.
    pub changes: bool,
}

/// The line of names above the rows.
struct Head {
    /// One name for each column; empty for a column of text without a name.
    names: Vec<String>,
    /// Byte range of this line in `kept`.
    at: Range<usize>,
}

/// Content of the cells of a column of text.
#[derive(Default)]
struct Held {
    first: String,
    last: String,
    /// Error that names the first change of the text.
    mixed: Option<Error>,
    /// Hashes of all texts of the column.
    words: HashSet<u64>,
    /// Number of cells that differ from the cell above; `returns` counts those whose text occurred earlier.
    changes: usize,
    returns: usize,
    /// Whether a text that begins with a letter occurs again: it may name the channel of its row.
    names: bool,
}

/// The text without its columns of text, which hold no number in any row. `None` if there are none: the
/// text then is unreadable for another reason.
///
/// # Errors
/// If a column often returns to earlier texts: rows of several channels or sensors may be below each
/// other.
pub fn left_out(text: &Text) -> Result<Option<LeftOut>> {
    let head: Vec<Line> = lines(&text.head).filter(|line| line.remark.is_none()).collect();
    let Some((separator, first, columns)) = columns(&head) else {
        return Ok(None);
    };
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let Some(mut scan) = Scan::of(&whole, separator, first, &columns) else { return Ok(None) };
    let rows = scan.rows;
    let named = |held: &&mut Held| held.names || held.returns * STATE > rows;
    if let Some(held) = scan.held.iter_mut().find(named)
        && let Some(why) = held.mixed.take()
    {
        // Words that change in most rows name sensors; words that change now and then may be states of one
        // sensor.
        let turns = 2 * held.changes > rows;
        return Err(why.hint(if turns {
            "keep the rows of one word in a file, those of the others each in a file of their own"
        } else {
            "if the words name sensors, keep the rows of one; if they are a state of one sensor, take out the column"
        }));
    }
    let found = scan.named_with_units(separator, &columns);
    let source = text.source.with_bytes(scan.kept)?;
    Ok(Some(LeftOut { source, found, changes: scan.held.iter().any(|held| held.changes > 0) }))
}

/// The text without its columns of text, and the content of these.
struct Scan {
    kept: String,
    held: Vec<Held>,
    head: Option<Head>,
    rows: usize,
}

impl Scan {
    /// Scans the whole text; `None` if a column of text also holds a number.
    fn of(whole: &str, separator: Separator, first: u64, columns: &[bool]) -> Option<Scan> {
        let (mut kept, mut ended, mut rows) = (String::with_capacity(whole.len()), 1, 0);
        let (mut head, mut held) = (None, Vec::new());
        held.resize_with(columns.len(), Held::default);
        for line in lines(whole) {
            // A bracket belongs to the name before it, so no blank may separate them.
            let above = line.number < first && separator == Separator::Blank;
            let name = above.then(|| line.text.replace(" [", "[").replace(" (", "("));
            let line = Line { text: name.as_deref().unwrap_or(line.text), ..line };
            let cells = fields(line.text, separator).unwrap_or_default();
            // Blank lines keep the line numbers as in the file.
            kept.extend((ended..line.number).map(|_| '\n'));
            ended = line.number;
            let (begin, is_row) = (kept.len(), line.number >= first);
            if cells.len() != columns.len() || line.remark.is_some() && line.number > first {
                kept += line.text;
            } else {
                rows += usize::from(is_row);
                for (i, (at, cell)) in cells.iter().enumerate().filter(|(i, _)| columns[*i] && is_row) {
                    match Cell::of(cell) {
                        Cell::Value => return None,
                        Cell::Blank => {}
                        Cell::Text | Cell::Neither => held[i].take(cell, &line, *at),
                    }
                }
                without(&mut kept, &line, &cells, separator, columns);
            }
            if !is_row && let Some(names) = one_a_column(&cells, columns) {
                head = Some(Head { names, at: begin..kept.len() });
            }
        }
        kept.push('\n');
        Some(Scan { kept, held, head, rows })
    }

    /// Moves units that have a column of their own after the values into the names of these. Returns the
    /// findings on the content of the columns of text.
    fn named_with_units(&mut self, separator: Separator, columns: &[bool]) -> Vec<Finding> {
        let units: Vec<Option<&str>> = (0..columns.len()).map(|i| self.unit_behind(i, columns)).collect();
        let name = |i: usize| self.head.as_ref().map_or("", |head| &head.names[i]);
        let numbered = |i: usize| label(name(i), i + 1);
        let is_unit = |i: usize| i > 0 && units[i - 1].is_some();
        let words = self.held.iter().enumerate().filter(|(i, _)| !is_unit(*i));
        let words: Vec<String> =
            words.filter_map(|(i, held)| Some(format!("{} ({})", numbered(i), held.said()?))).collect();
        let with_units = units.iter().enumerate();
        let with_units: Vec<String> =
            with_units.filter_map(|(i, unit)| Some(format!("{} ({})", numbered(i), (*unit)?))).collect();
        let found = [("columns-of-words", words), ("units-in-cells", with_units)];
        let head = self.head.as_ref().filter(|_| units.iter().any(Option::is_some));
        let head = head.map(|head| (head.at.clone(), head.with(&units, separator, columns)));
        let said = found.into_iter().filter(|(_, columns)| !columns.is_empty());
        let said =
            said.map(|(code, columns)| Finding::note(code).name("columns", columns.join(", "))).collect();
        if let Some((at, line)) = head {
            self.kept.replace_range(at, &line);
        }
        said
    }

    /// Unit of column `i` from the column after it, if column `i` has no unit and all those cells hold the
    /// same one.
    fn unit_behind(&self, i: usize, columns: &[bool]) -> Option<&str> {
        let names = &self.head.as_ref()?.names;
        let values = !columns[i] && !names[i].is_empty() && Name::parse(&names[i]).unit.is_none();
        let held = self.held.get(i + 1).filter(|held| columns[i + 1] && held.changes == 0 && values)?;
        let is_unit = names[i + 1].is_empty() || UNIT.contains(&key(&names[i + 1]).as_str());
        let unit =
            Some(held.first.as_str()).filter(|unit| unit.starts_with(char::is_alphabetic) && is_unit)?;
        Unit::parse(symbol(unit)).map(|_| unit)
    }
}

fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    Lines::new(text, 0, 1, &["#", "%"]).filter(|line| !line.is_blank())
}

/// The names in a line, one for each column; columns of text may have none.
fn one_a_column(cells: &Fields, columns: &[bool]) -> Option<Vec<String>> {
    let mut names = cells.iter().map(|(_, name)| name.clone().into_owned());
    if cells.len() == columns.len() {
        return Some(names.collect());
    }
    let values = columns.iter().filter(|text| !**text).count();
    let mut next = |text: &bool| if *text { String::new() } else { names.next().unwrap_or_default() };
    (cells.len() == values).then(|| columns.iter().map(&mut next).collect())
}

impl Head {
    /// The line of names of the value columns, each with its unit from `units` in brackets.
    fn with(&self, units: &[Option<&str>], separator: Separator, columns: &[bool]) -> String {
        let mark = if let Separator::Char(mark) = separator { char::from(mark) } else { ' ' };
        let values = self.names.iter().zip(units.iter().copied()).zip(columns).filter(|(_, text)| !**text);
        let cell = |((name, unit), _): ((&String, Option<&str>), &bool)| {
            let name = unit.map_or(name.clone(), |unit| format!("{name}[{unit}]"));
            if name.contains([mark, '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
        };
        values.map(cell).collect::<Vec<_>>().join(&mark.to_string())
    }
}

impl Held {
    fn take(&mut self, cell: &str, line: &Line, at: usize) {
        let new = self.words.insert(BuildHasherDefault::<DefaultHasher>::default().hash_one(cell));
        if self.last == cell {
            return;
        }
        if self.first.is_empty() {
            cell.clone_into(&mut self.first);
        } else {
            self.changes += 1;
            self.returns += usize::from(!new);
            self.names |= !new && cell.starts_with(char::is_alphabetic);
            let last = &self.last;
            self.mixed.get_or_insert_with(|| {
                let found = format!("{:?} below {:?}", shorten(cell), shorten(last));
                let place = in_line(line.number).column(line.column(at));
                Error::input(place, found, "numbers, or words that do not come back")
            });
        }
        cell.clone_into(&mut self.last);
    }

    /// First and last text, for the finding; `None` if there is no letter or digit in the first.
    fn said(&self) -> Option<String> {
        let first = Some(shorten(&self.first)).filter(|first| first.contains(char::is_alphanumeric))?;
        let to = if self.changes > 0 { format!(" … {}", shorten(&self.last)) } else { String::new() };
        Some(format!("{first}{to}"))
    }
}

/// Adds a line to `kept`, with blanks in place of the cells of text and their separators. All other
/// characters keep their column numbers.
pub fn without(kept: &mut String, line: &Line, cells: &Fields, separator: Separator, text: &[bool]) {
    let begin = kept.len();
    kept.push_str(&line.text[..cells[0].0]);
    for (i, (at, _)) in cells.iter().enumerate() {
        let end = cells.get(i + 1).map_or(line.text.len(), |(next, _)| *next);
        let cell = &line.text[*at..end];
        if text[i] { kept.extend(cell.chars().map(|_| ' ')) } else { kept.push_str(cell) }
    }
    if text.last() == Some(&true) {
        let ends = |c: char| c == ' ' || matches!(separator, Separator::Blank) && c == '\t';
        let end = kept[begin..].trim_end_matches(ends).len();
        kept.truncate(begin + end);
        if let Separator::Char(mark) = separator
            && kept.ends_with(char::from(mark))
        {
            kept.pop();
        }
    }
}

/// Separator, line number of the first row, and which columns hold text: those in which more than half of
/// the non-blank cells of the last rows are text. All these rows have the same number of cells, and values
/// or blanks in all other columns.
fn columns(lines: &[Line]) -> Option<(Separator, u64, Vec<bool>)> {
    let of = |line: &Line, separator| -> Vec<Cell> {
        fields(line.text, separator).unwrap_or_default().iter().map(|(_, cell)| Cell::of(cell)).collect()
    };
    let marks = [b'\t', b';', b','].map(Separator::Char).into_iter().chain([Separator::Blank]);
    let last = lines.last()?;
    let separator = marks.into_iter().find(|mark| of(last, *mark).len() > 1)?;
    let n = of(last, separator).len();
    let cells = lines.iter().rev().map(|line| of(line, separator)).take_while(|cells| cells.len() == n);
    let cells: Vec<Vec<Cell>> = cells.collect();
    let sample = &cells[..cells.len().min(ENOUGH)];
    let text = |i: usize| {
        let count = |of: Cell| sample.iter().filter(|row| row[i] == of).count();
        2 * count(Cell::Text) > sample.len() - count(Cell::Blank)
    };
    let text: Vec<bool> = (0..n).map(text).collect();
    // The search upwards ends at the line of names, which has text in all columns.
    let is_row = |row: &&Vec<Cell>| {
        row.iter().zip(&text).all(|(cell, text)| *text || matches!(cell, Cell::Value | Cell::Blank))
    };
    let rows = cells.iter().take_while(is_row).count();
    let told = rows > 1 && rows >= ENOUGH.min(lines.len() / 2);
    (told && text.contains(&true) && text.contains(&false))
        .then(|| (separator, lines[lines.len() - rows].number, text))
}

/// Content of a cell.
#[derive(Clone, Copy, PartialEq)]
enum Cell {
    Text,
    /// A number or a time.
    Value,
    Blank,
    /// Begins with a number but is not one: `1.5 V`, `(1-2j)`.
    Neither,
}

impl Cell {
    fn of(cell: &str) -> Cell {
        let bytes = cell.as_bytes();
        if number::is_missing(bytes) || cell.is_empty() {
            return Cell::Blank;
        }
        if number::either(bytes).is_some() || clock::is_clock(cell) {
            return Cell::Value;
        }
        let inner = cell.trim_start_matches(['(', '[', '"']).as_bytes();
        let begins = number::prefix(inner, b'.').is_some() && !cell.starts_with("0x");
        // Digits before one of the marks / - _ : are text: `7 / 12`, `2020-01-24 12-00-00_500`.
        let behind = cell.trim_start_matches(|c: char| c.is_ascii_digit());
        let marked = behind.len() < cell.len() && behind.trim_start().starts_with(['/', '-', '_', ':']);
        let whole = complex(bytes, b'.').or_else(|| complex(bytes, b',')).is_some();
        if !begins || marked && !whole { Cell::Text } else { Cell::Neither }
    }
}
