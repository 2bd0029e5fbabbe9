//! Finds the lines above a table that name its columns.

use super::header::Stated;
use super::lines::{Fields, Line, Separator, fields};
use super::names::Name;
use super::preamble::{Preamble, UNIT, key};
use super::unit_words::is_unit_row;
use crate::assemble::kind_of;
use crate::number;
use std::borrow::Cow;
use std::ops::Range;
use vibro_record::units::{Quantity, Unit};

/// Finds the lines of `block` (counted upwards) that name the columns, and the names. Either a row of units
/// below a row of names, perhaps with remarks below, or names alone.
pub fn names_in(
    block: &[Fields],
    clock: Option<&Range<usize>>,
    title: bool,
    fits: impl Fn(usize) -> bool,
) -> Option<(Range<usize>, Vec<Name>)> {
    let is_units = |at: &usize| {
        let (units, upper) = (&block[*at], &block[*at + 1]);
        let outside = |i: &usize| !clock.is_some_and(|cells| cells.contains(i));
        let cells = (0..units.len()).filter(outside).map(|i| units[i].1.as_ref());
        // `No.,OUT1` above `Unit,mm`: below a counter, which has no unit, the row of units may begin with a
        // label.
        let labelled = usize::from(is_label(&units[0].1) && Name::parse(&upper[0].1).counts());
        let cells = cells.skip(labelled);
        let quantity = |cell: &str| {
            let used = number::prefix(cell.as_bytes(), b'.').map_or(0, |(_, used)| used);
            used > 0 && Unit::parse(&cell[used..]).is_some_and(|unit| unit.quantity() == Quantity::Time)
        };
        // A row that begins with the unit of the time or frequency above it is a row of units, known or
        // not.
        let of_axis = || {
            let kind = Unit::parse(&units[0].1).and_then(|unit| kind_of(&unit));
            let numbers = units
                .iter()
                .any(|(_, cell)| number::prefix(cell.as_bytes(), b'.').is_some_and(|(_, n)| n == cell.len()));
            kind.is_some() && kind == Name::parse(&upper[0].1).axis(true) && !numbers
        };
        let upper_names = named(upper) && !upper.iter().any(|(_, cell)| quantity(cell));
        units.len() == upper.len()
            && upper_names
            && (*at == 0 || fits(units.len()))
            && (of_axis() || is_unit_row(cells))
    };
    if let Some(at) = (0..block.len() - 1).find(is_units) {
        let named = block[at + 1].iter().zip(&block[at]).map(|((_, name), (_, unit))| {
            let unit = if is_label(unit) { "" } else { unit };
            Name::with_unit_row(name, unit)
        });
        return Some((at..at + 2, named.collect()));
    }
    let lower = block.first().filter(|lower| named(lower) && !title)?;
    // Numbers such as in `Values;64;` state a number of values. Numbers from 1, as in `Angle,1,2`, number
    // the channels.
    let numbers: Vec<f64> = lower.iter().filter_map(|(_, cell)| number::parse(cell.as_bytes())).collect();
    let counts = numbers.iter().zip(1u8..).any(|(number, n)| *number != f64::from(n));
    let first = Name::parse(&lower[0].1);
    if counts && first.axis(true).is_none() && !first.counts() {
        return None;
    }
    // `Second,Volt` below a preamble are units without names.
    let units: Option<Vec<Name>> = lower.iter().map(|(_, n)| Name::of_unit(n)).collect();
    // `V,V` are units without names.
    let first = lower[0].1.as_ref();
    let alike =
        lower.len() > 1 && Unit::parse(first).is_some() && lower.iter().all(|(_, cell)| cell == first);
    let unit = || Name { name: String::new(), unit: Some(first.to_owned()) };
    let units = units.or_else(|| alike.then(|| lower.iter().map(|_| unit()).collect()));
    // `t/s;F/N;a/(m/s²)` after DIN 1313: each quantity is divided by its unit.
    let over = Name::over_unit(&lower[0].1).is_some_and(|first| first.axis(true).is_some());
    let name = |cell: &str| Name::over_unit(cell).filter(|_| over).unwrap_or_else(|| Name::parse(cell));
    Some((0..1, units.unwrap_or_else(|| lower.iter().map(|(_, cell)| name(cell)).collect())))
}

/// Whether a cell is the label of a row of units, such as `Unit`.
fn is_label(cell: &str) -> bool {
    UNIT.contains(&key(cell).as_str())
}

const TYPES: [&str; 8] = ["f4", "f8", "float", "double", "single", "real32", "real64", "number"];

/// Whether a line holds only number types, `f8` or `float`, or repeats one label in all cells: `Interp:
/// zoh`.
pub fn is_types(line: &Line, separator: Separator) -> bool {
    let label =
        |cell: &str| Some(cell.split_once(": ")?.0.to_owned()).filter(|l| l == "Type" || l == "Interp");
    if let Ok(cells) = fields(line.text, separator)
        && cells.len() > 1
        && let Some(first) = label(&cells[0].1)
    {
        return cells.iter().all(|(_, cell)| label(cell).as_ref() == Some(&first));
    }
    let known = |(_, cell): &(usize, Cow<str>)| TYPES.contains(&cell.to_lowercase().as_str());
    let begins = |kind: &&str| {
        let first = line.text.trim_start_matches(['"', ' ']).get(..kind.len());
        first.is_some_and(|first| first.eq_ignore_ascii_case(kind))
    };
    TYPES.iter().any(begins)
        && fields(line.text, separator).is_ok_and(|fields| fields.len() > 1 && fields.iter().all(known))
}

/// The statement in a line that gives every column the same rate, perhaps after one key for all: `1200 Hz`,
/// `Sample rate 1200 Hz`, `Messrate` and `1200 1/s`. `None` for other lines.
pub fn rate_of_columns(line: &Line, separator: Separator) -> Option<String> {
    let cells = fields(line.text, separator).ok()?;
    let cells: Vec<&str> =
        cells.iter().map(|(_, cell)| cell.as_ref()).filter(|cell| !cell.is_empty()).collect();
    let last = cells.last().filter(|last| cells.len() > 1 && last.contains(char::is_alphabetic))?;
    let alike = cells.iter().rev().take_while(|cell| *cell == last).count();
    let stated = match cells.len() - alike {
        0 if number::prefix(last.as_bytes(), b'.').is_some() => format!("Sample rate: {last}"),
        0 => (*last).to_owned(),
        1 => format!("{}: {last}", cells[0].trim_end_matches(':')),
        _ => return None,
    };
    Stated::of(std::iter::once(stated.as_str()), None).states_rate().then_some(stated)
}

/// Whether a line is a title above all columns, such as `Waveform Data`, or a line of the preamble.
pub fn is_title(line: &Fields, width: usize, preamble: &Preamble) -> bool {
    let alone = !line[0].1.is_empty() && line.iter().filter(|(_, f)| !f.is_empty()).count() == 1;
    let keyed = line.len() > width && Preamble::is_of_columns(&line[0].1);
    keyed || alone && (width > 1 || (preamble.names_columns() && Name::of_unit(&line[0].1).is_none()))
}

/// The fields of a line above the row `values`, without the first `skipped` fields, and without a blank
/// last field if the row has no value below it.
pub fn headings<'a>(
    line: &Line<'a>,
    separator: Separator,
    skipped: usize,
    values: &[(usize, Cow<str>)],
) -> Option<Fields<'a>> {
    let mut fields = fields(line.text, separator).ok()?;
    fields.drain(..skipped.min(fields.len()));
    // `;Headers, time,Ax,Ay,Az`
    let keyed = |cell: &str| cell.trim_start_matches([';', '#']).eq_ignore_ascii_case("headers");
    if fields.len() == values.len() + 1 && keyed(&fields[0].1) {
        fields.remove(0);
    }
    let last = fields.len().checked_sub(1)?;
    let unused = values.get(last).is_none_or(|(_, v)| v.is_empty());
    if last > 0 && fields[last].1.is_empty() && unused {
        fields.pop();
    }
    Some(fields)
}

/// Whether fields may name columns: at least one has letters and is not a number, and the line is not `key:
/// value`.
fn named(fields: &Fields) -> bool {
    let statement =
        fields.first().is_some_and(|(_, f)| f.contains(": ") || f.ends_with(':') || f.contains('='));
    let is_name = |field: &str| {
        let bytes = field.as_bytes();
        let number = number::either(bytes).is_some();
        field.contains(char::is_alphabetic) && !number && !number::is_missing(bytes)
    };
    // `Run 1: Time (s),Run 1: Force (N)`
    let all = fields.len() > 1 && fields.iter().all(|(_, f)| f.contains(": "));
    (!statement || all) && fields.iter().any(|(_, f)| is_name(f))
}
