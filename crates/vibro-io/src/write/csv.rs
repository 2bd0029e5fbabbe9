//! Columns with names and units, which spreadsheets and [`crate::Reader`] read.
//!
//! ```text
//! # scaling: rms of v               remarks on a column, if there are any
//! frequency [Hz],v [m/s],H_re [m/N],H_im [m/N]
//! 0,0.001,1.5e-7,-2e-9
//! ```
//! The first column is the abscissa; a complex record takes two columns. Numbers have the fewest digits
//! that read back as the same double. An uneven abscissa is printed with all its digits, so that its values
//! are not read as rounded even ones.

use super::listed::{failed, label, parts, together};
use std::fmt::Write as _;
use std::io::Write;
use vibro_record::{Axis, AxisKind, Error, FROM_BLOWS, Frf, Grid, Record, Result, Scaling, Spectrum, Values};

/// Writes records over one axis, `separator` between the columns (comma, semicolon or tab).
///
/// # Errors
/// If there are none, they have no values, their axes differ, or the output cannot be written.
pub fn write(records: &[Record], separator: char, out: &mut impl Write) -> Result<()> {
    let first = together(records, "abscissae: a table has one")?;
    if let Some(empty) = records.iter().find(|r| r.is_empty()) {
        return Err(Error::refused(format!("{} has no values to write", label(empty))));
    }
    let mut text = String::new();
    let columns: Vec<_> = records.iter().enumerate().map(|(i, r)| column(i, r)).collect();
    for (record, name, _) in &columns {
        remarks(record, name, &mut text);
    }
    text.push_str(&field(axis_name(first.axis()), separator));
    for (record, name, unit) in &columns {
        let parts: &[&str] = if record.is_complex() { &["_re", "_im"] } else { &[""] };
        for part in parts {
            text.push(separator);
            text.push_str(&field(&format!("{name}{part} [{unit}]"), separator));
        }
    }
    text.push('\n');
    let uneven = matches!(first.axis().grid, Grid::Uneven(_));
    for i in 0..first.len() {
        let x = first.axis().at(i);
        if uneven {
            let _ = write!(text, "{x:.16e}");
        } else {
            number(x, &mut text);
        }
        for record in records {
            for value in parts(record, i) {
                text.push(separator);
                number(value, &mut text);
            }
        }
        text.push('\n');
        if text.len() > BLOCK {
            out.write_all(text.as_bytes()).map_err(failed)?;
            text.clear();
        }
    }
    out.write_all(text.as_bytes()).map_err(failed)
}

/// Characters that a spreadsheet reads as the start of a formula, or of a command to another program.
const FORMULA: [char; 9] = ['=', '+', '-', '@', '|', '＝', '＋', '－', '＠'];

/// Whether a spreadsheet would read a text as a formula; a sign alone is not one.
pub fn begins_formula(text: &str) -> bool {
    text.starts_with(FORMULA) && text.chars().nth(1).is_some()
}

/// Bytes of text that are collected before they are written.
const BLOCK: usize = 64 * 1024;

/// Name and unit of the column of a record.
fn column(index: usize, record: &Record) -> (&Record, String, String) {
    let meta = record.meta();
    let mut name = plain(&meta.name);
    if name.is_empty() {
        name = format!("record {}", index + 1);
    }
    if begins_formula(&name) {
        name.insert(0, '\'');
    }
    // A square bracket within the unit would end it too early for a reader.
    let unit = plain(meta.unit.symbol()).replace('[', "(").replace(']', ")");
    (record, name, unit)
}

fn remarks(record: &Record, name: &str, text: &mut String) {
    let remarks = match record {
        Record::Trace(_) => Default::default(),
        Record::Frf(Frf { meta, .. }) => [
            Some(("kind", "frf".to_owned())),
            meta.added_decay().map(|decay| ("added decay", decay.to_string())),
            meta.from_blows().then(|| (FROM_BLOWS, "yes".to_owned())),
            meta.averaged_with().map(|window| ("averaged with", window.name().to_owned())),
        ],
        Record::Spectrum(Spectrum { values, scaling, window, enbw, .. }) => {
            // Without its scaling, a complex spectrum would be read as a frequency response function.
            let scaled = matches!(values, Values::Complex(_)) || *scaling != Scaling::Unknown;
            [
                scaled.then(|| ("scaling", scaling.name().to_owned())),
                window.map(|window| ("window", window.name().to_owned())),
                enbw.map(|enbw| ("enbw", enbw.to_string())),
                None,
            ]
        }
    };
    for (key, value) in remarks.into_iter().flatten() {
        let _ = writeln!(text, "# {key}: {value} of {name}");
    }
}

fn axis_name(axis: &Axis) -> &str {
    match &axis.kind {
        AxisKind::Time => "time [s]",
        AxisKind::Frequency => "frequency [Hz]",
        AxisKind::Index => "index",
        AxisKind::Other(name) => name,
    }
}

/// Fewest digits that read back as `value`; with an exponent below 1e-5 and from 1e16 on, to avoid rows of
/// zeros.
fn number(value: f64, text: &mut String) {
    let _ = if value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite() {
        write!(text, "{value}")
    } else {
        write!(text, "{value:e}")
    };
}

/// The text as one line, trimmed.
fn plain(text: &str) -> String {
    text.replace(char::is_control, " ").trim().to_owned()
}

/// A field, quoted as RFC 4180 requires, and also if it contains `#` or `%`, which would make the line a
/// comment.
fn field(text: &str, separator: char) -> String {
    if text.contains([separator, '"', '#', '%', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests;
