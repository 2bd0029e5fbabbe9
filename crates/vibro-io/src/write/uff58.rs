//! Universal File Format, data sets 58 (text) and 58b (binary).
//!
//! Each record becomes one data set with eleven header lines of 80 columns and its values in one of the eight
//! cases of the standard: real or complex, single or double precision, even or uneven abscissa. See
//! `uff::set58` for the format and its source.

mod header;

use super::listed::{failed, label, parts};
use crate::number;
use crate::uff::set58::Layout;
use std::io::{self, Write};
use vibro_record::{Error, Grid, Record, Result};

/// Precision of the values. An uneven abscissa always has single precision in binary, and six digits in
/// text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Six digits of text, or four bytes.
    Single,
    /// Thirteen digits of text, or eight bytes.
    #[default]
    Double,
}

/// How values are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Storage {
    /// Data set 58b, little-endian IEEE 754, instead of text. Default: text.
    pub binary: bool,
    /// Precision. Default: double.
    pub precision: Precision,
}

/// Writes records in SI units, one data set each, lines ended by LF.
///
/// Name, point and identification lines come from [`vibro_record::Meta::notes`] if the record was read from
/// such a file; otherwise the name becomes the first identification line. The fifth line states scaling,
/// window and noise bandwidth that the function type cannot express. Missing values are written as NaN,
/// which few programs read.
///
/// Double precision in binary keeps every bit of the values. Start and step of an even abscissa have up to
/// nine digits, an uneven abscissa has six digits or single precision: the format has no room for more.
/// More than the usual digits are used if rounding shifts an abscissa value by over a thousandth of the
/// (smallest) step; beyond a tenth of it the record is refused.
///
/// ```
/// use vibro_record::{Axis, Meta, Record, Trace};
/// use vibro_record::units::{Quantity, Unit};
/// use vibro_io::write::uff58::{Storage, write_uff58};
/// let meta = Meta::new("drill housing", Unit::of(Quantity::Acceleration));
/// let trace = Trace { meta, axis: Axis::time(0.0, 1e-4, 3), values: vec![0.0, 1.5, -2.0] };
/// let mut file = Vec::new();
/// write_uff58(&[Record::Trace(trace)], &mut file, Storage::default())?;
/// assert!(file.starts_with(b"    -1"));
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If `out` cannot be written, there are no records, or the format would distort an abscissa.
pub fn write_uff58(records: &[Record], out: &mut impl Write, storage: Storage) -> Result<()> {
    if records.is_empty() {
        return Err(Error::refused("there are no records to write, and a file without any cannot be read"));
    }
    let forms = records.iter().map(|r| form(r, storage.binary)).collect::<Result<Vec<_>>>()?;
    let mut out = io::BufWriter::new(out);
    for (record, form) in records.iter().zip(&forms) {
        let even = matches!(record.axis().grid, Grid::Even { .. });
        let double = storage.precision == Precision::Double;
        let layout = Layout { complex: record.is_complex(), double, even };
        let size = storage.binary.then_some(layout.point_size(false) * record.len());
        let head = header::text(record, layout, size, form);
        let mut block = || {
            out.write_all(head.as_bytes())?;
            if storage.binary {
                binary(record, layout, &mut out)?;
            } else {
                text(record, layout, &mut out)?;
            }
            writeln!(out, "{:80}", "    -1")
        };
        block().map_err(failed)?;
    }
    out.flush().map_err(failed)
}

fn binary(record: &Record, layout: Layout, out: &mut impl Write) -> io::Result<()> {
    for i in 0..record.len() {
        if !layout.even {
            out.write_all(&(record.axis().at(i) as f32).to_le_bytes())?;
        }
        for part in parts(record, i) {
            if layout.double {
                out.write_all(&part.to_le_bytes())?;
            } else {
                out.write_all(&(part as f32).to_le_bytes())?;
            }
        }
    }
    Ok(())
}

fn text(record: &Record, layout: Layout, out: &mut impl Write) -> io::Result<()> {
    let abscissa = |i: usize| (!layout.even).then(|| record.axis().at(i));
    let numbers = (0..record.len()).flat_map(|i| abscissa(i).into_iter().chain(parts(record, i)));
    let widths = layout.widths();
    for (column, value) in numbers.enumerate() {
        if column > 0 && column % widths.len() == 0 {
            out.write_all(b"\n")?;
        }
        let width = widths[column % widths.len()];
        out.write_all(field(value, width, width - 8).as_bytes())?;
    }
    if record.is_empty() { Ok(()) } else { out.write_all(b"\n") }
}

/// A number as Fortran's `1PEw.d` prints it: an exponent of three digits drops the letter E.
fn field(value: f64, width: usize, digits: usize) -> String {
    if !value.is_finite() {
        return format!("{:>width$}", "NaN");
    }
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |e| ('-', e));
    let letter = if exponent.len() > 2 { "" } else { "E" };
    format!("{:>width$}", format!("{mantissa}{letter}{sign}{exponent:0>2}"))
}

/// Largest shift of an abscissa value by rounding, divided by the (smallest) step, for which the usual
/// digits are enough; above it, more digits are tried.
const WANTED: f64 = 1e-3;
/// Largest shift of an abscissa value divided by the (smallest) step; beyond it the record is refused.
const TOLERANCE: f64 = 0.1;
/// Characters of start and step in record 7, and of an abscissa value in text.
const WIDTH: usize = 13;

/// Start and step of an even abscissa as printed in record 7; zeros for an uneven one.
///
/// # Errors
/// If the format has too few digits for the abscissa of this record.
fn form(record: &Record, binary: bool) -> Result<[String; 2]> {
    let refused = |what: String| {
        let why = format!("the abscissa of {} {what}: data set 58 has too few digits for it", label(record));
        Error::refused(why)
            .hint("write .csv or .npy, which keep every digit, or binary values (58b), or fewer at once")
    };
    match &record.axis().grid {
        Grid::Even { start, step, n } => {
            let last = n.saturating_sub(1) as f64;
            // Start and step may each use half of the tolerance; the error of the step accumulates up to
            // the last value.
            let fitting = |value: f64, times: f64| {
                [WANTED, TOLERANCE].into_iter().find_map(|part| {
                    let bound = 0.5 * part * step.abs();
                    spellings(value).into_iter().find(|text| (read(text) - value).abs() * times <= bound)
                })
            };
            let found = fitting(*start, 1.0).zip(fitting(*step, last)).map(|(start, step)| [start, step]);
            found.ok_or_else(|| refused(format!("begins at {start} with a step of {step}, {n} values long")))
        }
        Grid::Uneven(values) => {
            let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
            let smallest = steps.fold(f64::INFINITY, f64::min);
            let off = |value: f64| {
                let kept = if binary { f64::from(value as f32) } else { read(&field(value, WIDTH, 5)) };
                (kept - value).abs() / smallest
            };
            match values.iter().find(|value| off(**value).is_nan() || off(**value) > TOLERANCE) {
                Some(value) => Err(refused(format!("holds {value}, with neighbours {smallest} apart"))),
                None => Ok([0.0, 0.0].map(|zero| field(zero, WIDTH, 6))),
            }
        }
    }
}

/// Ways to print a number in 13 columns, the usual one first: E13.5, with one more digit if it is not
/// negative; then as many digits as fit after a blank; then as many as fill all columns.
fn spellings(value: f64) -> [String; 3] {
    let dense = |room: usize| {
        let fits = |digits: &usize| format!("{value:.digits$E}").len() <= room;
        let digits = (0..room).rev().find(fits).unwrap_or(0);
        format!("{:>WIDTH$}", format!("{value:.digits$E}"))
    };
    [field(value, WIDTH, if value < 0.0 { 5 } else { 6 }), dense(WIDTH - 1), dense(WIDTH)]
}

fn read(text: &str) -> f64 {
    number::parse(text.trim().as_bytes()).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, AxisKind, Meta, Trace};

    #[test]
    fn fields_fill_their_columns() {
        for (value, single, double) in [
            (0.0, "  0.00000E+00", "  0.000000000000E+00"),
            (-0.014_755_3, " -1.47553E-02", " -1.475530000000E-02"),
            (1.0 / 3.0, "  3.33333E-01", "  3.333333333333E-01"),
            (-9.999_999_9e9, " -1.00000E+10", " -9.999999900000E+09"),
            (1.5e-101, "  1.50000-101", "  1.500000000000-101"),
            (f64::MAX, "  1.79769+308", "  1.797693134862+308"),
            (f64::NAN, "          NaN", "                 NaN"),
        ] {
            assert_eq!(field(value, 13, 5), single);
            assert_eq!(field(value, 20, 12), double);
        }
    }

    fn of(grid: Grid, binary: bool) -> Result<[String; 2]> {
        let axis = Axis { kind: AxisKind::Time, grid };
        let values = vec![0.0; axis.len()];
        form(&Record::Trace(Trace { meta: Meta::new("x", Unit::none()), axis, values }), binary)
    }

    /// A record of one value over a long axis: `form` looks only at the axis.
    fn form_of_axis(axis: Axis) -> Result<[String; 2]> {
        form(&Record::Trace(Trace { meta: Meta::new("x", Unit::none()), axis, values: vec![0.0] }), false)
    }

    #[test]
    fn digits_are_taken_where_there_is_room() {
        let even = |start, step, n| of(Grid::Even { start, step, n }, false).unwrap();
        assert_eq!(even(0.0, 1.0 / 44_100.0, 7), [" 0.000000E+00", " 2.267574E-05"]);
        assert_eq!(even(123_456.789, 1.0 / 1024.0, 7), [" 1.23456789E5", " 9.765625E-04"]);
        assert_eq!(even(0.0, 1.0 / 48_000.0, 20_000)[1], " 2.0833333E-5");
        assert_eq!(even(0.0, 1.0 / 48_000.0, 200_000)[1], "2.08333333E-5");
        assert_eq!(even(-1.5, 1.0, 1)[0], " -1.50000E+00");
    }

    #[test]
    fn an_abscissa_that_would_be_distorted_is_refused() {
        let words = |result: Result<[String; 2]>| result.unwrap_err().to_string();
        let late = words(of(Grid::Even { start: 123_456.789_123_4, step: 1e-4, n: 7 }, true));
        assert!(
            late.contains("the trace \"x\" begins at 123456.7891234") && late.contains("try: write .csv"),
            "{late}"
        );
        // 1/48000 with nine digits is off by 3.3e-14, so by 0.16 of a step after a hundred million steps.
        let axis = |n| form_of_axis(Axis::time(0.0, 1.0 / 48_000.0, n));
        assert!(axis(1_000_000).is_ok());
        let long = words(axis(100_000_000));
        assert!(long.contains("100000000 values"), "{long}");
        for binary in [false, true] {
            let far = words(of(Grid::Uneven(vec![100_000.0, 100_000.001, 100_000.003]), binary));
            assert!(far.contains("holds 100000.001"), "{far}");
            assert!(of(Grid::Uneven(vec![0.0, 0.5, 2.0, 2.0]), binary).is_ok());
            assert!(of(Grid::Uneven(vec![100_000.001]), binary).is_ok());
            assert!(of(Grid::Uneven(vec![0.0, f64::NAN]), binary).is_err());
        }
    }
}
