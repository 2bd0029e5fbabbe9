//! Converts sheets of workbooks to text: tabs between cells, numbers with all their digits, dates as date
//! and time.

use super::{Member, Workbook, damaged, locked};
use crate::limit::Limit;
use crate::number;
use crate::source::Source;
use calamine::{
    Data, ExcelDateTime, ExcelDateTimeType, Ods, OdsError, Reader, Sheet, SheetVisible, Xls, XlsError, Xlsx,
    XlsxError,
};
use std::collections::BTreeMap;
use std::fmt::{Display, Write};
use std::io::{BufReader, Cursor, Read, Seek, Write as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use vibro_record::Result;

/// A cell: row and column, counted from 0, and content.
type Cell = (u32, u32, Data);

/// Microseconds of a day. Times are compared in µs, since a double of days resolves this century to 0.6 µs.
const DAY: i64 = 86_400_000_000;
/// Largest number of decimals of a second that is recognised: down to 1 µs.
const DECIMALS: usize = 6;
/// Largest difference in µs between a time and its printed form, since days are rounded to a double.
const ROUNDING: i64 = 1;

/// All sheets with cells, or the one with this name.
///
/// # Errors
/// If the workbook is damaged or encrypted, or needs more memory than the limit.
pub fn of(source: &Source, kind: Workbook, named: Option<&Path>, limit: Limit) -> Result<Vec<Member>> {
    // The crate calamine panics on a sheet that ends before it begins; the panic becomes an error.
    let read = AssertUnwindSafe(|| match kind {
        Workbook::Compound => {
            let book = Xls::new(checked(source, limit)?).map_err(|why| match why {
                XlsError::Password => locked(source),
                why => damaged(source, why),
            });
            ranges(book?, (source, named), limit)
        }
        Workbook::OpenDocument => {
            let book = Ods::new(BufReader::new(source.open()?)).map_err(|why: OdsError| match why {
                OdsError::Password => locked(source),
                why => damaged(source, why),
            });
            ranges(book?, (source, named), limit)
        }
        Workbook::Xml => streamed((source, named), limit),
    });
    catch_unwind(read).unwrap_or_else(|_| Err(damaged(source, "its records contradict each other")))
}

/// Copies the stream of an `.xls` workbook to a compound file of its own. Its cells are checked first,
/// since calamine reserves memory for all cells between the first and the last.
fn checked(source: &Source, limit: Limit) -> Result<Cursor<Vec<u8>>> {
    let failed = |why| damaged(source, why);
    let mut file = cfb::CompoundFile::open(BufReader::new(source.open()?)).map_err(failed)?;
    if file.is_stream("/EncryptedPackage") {
        return Err(locked(source));
    }
    let name = ["/Workbook", "/Book"].into_iter().find(|name| file.is_stream(name));
    let Some(name) = name else { return Err(damaged(source, "it holds no sheets")) };
    let (mut stream, mut room) = (Vec::new(), 0.0);
    file.open_stream(name).and_then(|mut found| found.read_to_end(&mut stream)).map_err(failed)?;
    for (_, data) in records(&stream).filter(|(kind, _)| *kind == BOUND_SHEET) {
        let at =
            data.get(..4).map_or(usize::MAX, |at| u32::from_le_bytes([at[0], at[1], at[2], at[3]]) as usize);
        room += extent(stream.get(at..).unwrap_or_default())
            .ok_or_else(|| damaged(source, "a cell lies outside"))?;
    }
    // Counted twice: once for values, once for formulas.
    limit.hold(room * 2.0 * size_of::<Cell>() as f64)?;
    let mut own =
        cfb::CompoundFile::create_with_version(cfb::Version::V3, Cursor::new(Vec::new())).map_err(failed)?;
    own.create_stream(name).and_then(|mut new| new.write_all(&stream)).map_err(failed)?;
    own.flush().map_err(failed)?;
    Ok(own.into_inner())
}

/// Kinds of records in `.xls`: place of a sheet in the stream, its dimensions, end of a part.
const BOUND_SHEET: u16 = 0x85;
const DIMENSIONS: u16 = 0x200;
const END: u16 = 0x0a;
/// Kinds of records of one cell: formula, text, number, truth value or error.
const CELLS: [u16; 7] = [0x06, 0xd6, 0xfd, 0x203, 0x204, 0x205, 0x27e];
/// Kind of a record of several cells in a row, which ends with the last column.
const MANY: u16 = 0xbd;
/// Most columns of an `.xls` sheet.
const COLUMNS: u16 = 256;

/// The records of a part of a stream: kind and data.
fn records(stream: &[u8]) -> impl Iterator<Item = (u16, &[u8])> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (head, data) = rest.split_first_chunk::<4>()?;
        let (data, behind) = data.split_at_checked(usize::from(u16::from_le_bytes([head[2], head[3]])))?;
        rest = behind;
        Some((u16::from_le_bytes([head[0], head[1]]), data))
    })
    .take_while(|(kind, _)| *kind != END)
}

/// Number of cells, used or not, up to the last row and column of a sheet; `None` if a cell lies beyond
/// column [`COLUMNS`].
fn extent(sheet: &[u8]) -> Option<f64> {
    let (mut rows, mut columns) = (1.0f64, 1.0f64);
    for (kind, data) in records(sheet) {
        let word = |at: usize| data.get(at..at + 2).map(|word| u16::from_le_bytes([word[0], word[1]]));
        let column = match kind {
            DIMENSIONS => {
                let to = data.get(4..8).map_or(0, |to| u32::from_le_bytes([to[0], to[1], to[2], to[3]]));
                rows = rows.max(f64::from(to));
                word(10)?.saturating_sub(1)
            }
            MANY => word(data.len().checked_sub(2)?)?,
            kind if CELLS.contains(&kind) => word(2)?,
            _ => continue,
        };
        if column >= COLUMNS {
            return None;
        }
        if kind != DIMENSIONS {
            rows = rows.max(f64::from(word(0)?) + 1.0);
        }
        columns = columns.max(f64::from(column) + 1.0);
    }
    Some(rows * columns)
}

/// The sheets of a workbook to read: all, or the one with this name.
fn meant(sheets: &[Sheet], named: Option<&Path>) -> Vec<Sheet> {
    sheets.iter().filter(|of| named.is_none_or(|named| named == Path::new(&of.name))).cloned().collect()
}

fn ranges<R: Read + Seek, B: Reader<R>>(
    mut book: B,
    (source, named): (&Source, Option<&Path>),
    limit: Limit,
) -> Result<Vec<Member>>
where
    B::Error: Display,
{
    let mut parts = Vec::new();
    for of in meant(book.sheets_metadata(), named) {
        let range = book.worksheet_range(&of.name).map_err(|why| damaged(source, why))?;
        let (row, column) = range.start().unwrap_or_default();
        let place = |(r, c, cell): (usize, usize, &Data)| (row + r as u32, column + c as u32, cell.clone());
        parts.extend(sheet(source, of, range.used_cells().map(place).collect(), limit)?);
    }
    Ok(parts)
}

/// As [`ranges`] for `.xlsx`, cell by cell: no memory is reserved for empty cells between used ones.
fn streamed((source, named): (&Source, Option<&Path>), limit: Limit) -> Result<Vec<Member>> {
    let mut book =
        Xlsx::new(BufReader::new(source.open()?)).map_err(|why: XlsxError| damaged(source, why))?;
    let mut parts = Vec::new();
    for of in meant(book.sheets_metadata(), named) {
        let mut reader = match book.worksheet_cells_reader(&of.name) {
            Err(XlsxError::NotAWorksheet(_)) => continue,
            reader => reader.map_err(|why| damaged(source, why))?,
        };
        let mut cells: Vec<Cell> = Vec::new();
        while let Some(cell) = reader.next_cell().map_err(|why| damaged(source, why))? {
            let (row, column) = cell.get_position();
            if cells.len() == cells.capacity() {
                limit.hold((2 * cells.len() * size_of::<Cell>()) as f64)?;
            }
            cells.push((row, column, cell.get_value().clone().into()));
        }
        parts.extend(sheet(source, of, cells, limit)?);
    }
    Ok(parts)
}

/// A sheet as text, one line for each row of the sheet, so that line numbers of errors are row numbers.
fn sheet(source: &Source, of: Sheet, mut cells: Vec<Cell>, limit: Limit) -> Result<Option<Member>> {
    cells.retain(|(.., cell)| *cell != Data::Empty);
    with_points(&mut cells);
    cells.sort_by_key(|(row, column, _)| (*row, *column));
    let Some(last) = cells.last().map(|last| last.0) else { return Ok(None) };
    let columns = || cells.iter().map(|cell| cell.1);
    let (left, right) = (columns().min().unwrap_or(0), columns().max().unwrap_or(0));
    let rows = cells.chunk_by(|a, b| a.0 == b.0).count();
    limit.hold(f64::from(last) + rows as f64 * f64::from(right - left))?;
    let mut instants: BTreeMap<u32, Vec<ExcelDateTime>> = BTreeMap::new();
    for (_, column, cell) in &cells {
        if let Data::DateTime(instant) = cell {
            instants.entry(*column).or_default().push(*instant);
        }
    }
    let clocks: BTreeMap<u32, DateFormat> =
        instants.iter().map(|(at, all)| (*at, DateFormat::of(all))).collect();
    let (mut text, mut at) = (String::new(), 0);
    for row in cells.chunk_by(|a, b| a.0 == b.0) {
        text.extend((at..row[0].0).map(|_| '\n'));
        let mut column = left;
        for (_, of, cell) in row {
            text.extend((column..*of).map(|_| '\t'));
            column = *of;
            write_cell(&mut text, cell, clocks.get(of));
        }
        text.extend((column..right).map(|_| '\t'));
        at = row[0].0;
    }
    text.push('\n');
    let hidden = of.visible != SheetVisible::Visible;
    let source = Source::memory(source.path().join(&of.name), text)?.of_sheet(left);
    Ok(Some(Member { name: of.name, source, hidden }))
}

/// Converts texts with a decimal comma to numbers if other cells are numbers with decimals. Not done if in
/// each such text the comma may separate thousands (`1,000`).
fn with_points(cells: &mut [Cell]) {
    let decimals = |cell: &Cell| matches!(cell.2, Data::Float(value) if value.fract() != 0.0);
    let comma = |cell: &Cell| match &cell.2 {
        Data::String(words) if words.rfind([',', '.']) == words.rfind(',') => {
            number::parse_with(words.as_bytes(), b',').filter(|_| words.contains(','))
        }
        _ => None,
    };
    let grouped = |cell: &Cell| matches!(&cell.2, Data::String(words) if number::may_be_grouped(words.trim().as_bytes()));
    if cells.iter().any(decimals) && cells.iter().any(|cell| comma(cell).is_some() && !grouped(cell)) {
        for cell in cells {
            if let Some(value) = comma(cell) {
                cell.2 = Data::Float(value);
            }
        }
    }
}

fn write_cell(text: &mut String, cell: &Data, clock: Option<&DateFormat>) {
    // Writing to a string cannot fail.
    let _ = match cell {
        Data::Float(value) => {
            text.push_str(&digits(*value));
            Ok(())
        }
        Data::Int(value) => write!(text, "{value}"),
        Data::Bool(value) => write!(text, "{}", u8::from(*value)),
        // A formula that failed is a missing value.
        Data::Error(_) => write!(text, "NaN"),
        Data::String(words) | Data::DateTimeIso(words) | Data::DurationIso(words) => {
            text.extend(words.chars().map(|c| match c {
                '\t' | '\n' | '\r' => ' ',
                '"' => '\'',
                c => c,
            }));
            Ok(())
        }
        Data::DateTime(instant) => clock.map_or(Ok(()), |clock| clock.write(text, instant)),
        Data::Empty => Ok(()),
    };
}

/// The fewest digits that read back as the same double, in a form that cannot be mistaken for thousands
/// separators.
fn digits(value: f64) -> String {
    // Beyond 2⁵³ not every whole number is a double.
    let whole = value.trunc() == value && value.abs() < 9e15;
    let text = if whole { format!("{value}") } else { format!("{value:?}") };
    if !number::may_be_grouped(text.as_bytes()) {
        return text;
    }
    let decimals = text.rfind('.').map_or(0, |point| text.len() - point - 1);
    format!("{}e-{decimals}", text.replace('.', ""))
}

/// Printed form of the dates of a column, with the decimals of a second that they had before they were
/// stored as days.
struct DateFormat {
    decimals: usize,
    /// Whether the date is printed.
    dated: bool,
    /// Whether the time of day is printed.
    timed: bool,
}

fn microseconds(instant: &ExcelDateTime) -> i64 {
    (instant.as_f64() * DAY as f64).round() as i64
}

impl DateFormat {
    fn of(all: &[ExcelDateTime]) -> DateFormat {
        let fits = |decimals: &usize| {
            let unit = 10i64.pow((DECIMALS - decimals) as u32);
            let off = |instant| (microseconds(instant) + unit / 2).rem_euclid(unit) - unit / 2;
            all.iter().all(|instant| off(instant).abs() <= ROUNDING)
        };
        let days = |instant: &ExcelDateTime| instant.as_f64();
        DateFormat {
            decimals: (0..DECIMALS).find(fits).unwrap_or(DECIMALS),
            dated: all.iter().any(|instant| days(instant) >= 1.0),
            timed: all.iter().any(|instant| days(instant).fract() != 0.0)
                || all.iter().all(|i| days(i) < 1.0),
        }
    }

    fn write(&self, text: &mut String, instant: &ExcelDateTime) -> std::fmt::Result {
        let unit = 10i64.pow((DECIMALS - self.decimals) as u32);
        let ticks = (microseconds(instant) + unit / 2).div_euclid(unit);
        let (day, second) = (DAY / unit, 1_000_000 / unit);
        let (days, tick) = (ticks.div_euclid(day), ticks.rem_euclid(day));
        if self.dated {
            let from = |since_1904| {
                let date = ExcelDateTime::new(days as f64, ExcelDateTimeType::DateTime, since_1904);
                date.to_ymd_hms_milli()
            };
            // Days count from 1900 or 1904. They count from 1904 if the year counted from 1900 is off by
            // more than 2.
            let since_1904 = instant.to_ymd_hms_milli().0.abs_diff(from(false).0) > 2;
            let (year, month, day, ..) = from(since_1904);
            write!(text, "{year:04}-{month:02}-{day:02}{}", if self.timed { " " } else { "" })?;
        }
        if !self.timed {
            return Ok(());
        }
        let (seconds, part) = (tick / second, tick % second);
        write!(text, "{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)?;
        if self.decimals > 0 { write!(text, ".{part:0width$}", width = self.decimals) } else { Ok(()) }
    }
}
