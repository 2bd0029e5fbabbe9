//! Universal File Format, data sets 58 (text) and 58b (binary).
//!
//! Each record becomes one data set with eleven header lines of 80 columns and its values in one of the eight cases of
//! the standard: real or complex, single or double precision, even or uneven abscissa. See `read::uff58` for the format
//! and its source.

mod abscissa;
mod header;

use header::Header;
use std::io::Write;
use vibro_record::{Error, Grid, Record, Result, Values};

/// Precision of the values. An uneven abscissa has single precision, or six digits, in either.
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
/// Name, point and identification lines come from [`vibro_record::Meta::notes`] where the record was read from such a
/// file, else the name becomes the first identification line. A scaling, a window and a noise bandwidth that the function
/// type cannot tell stand in the fifth. Missing values are written as NaN, which few programs can read.
///
/// Double precision in binary keeps every bit of the values. Start and step of an even abscissa are printed with up to
/// nine digits, an uneven abscissa is rounded to six digits or single precision: the format has no room for more. Where
/// that would move a value by more than a thousandth of the (smallest) step, the record is refused.
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
/// If `out` cannot be written, there are no records, or one has more values than ten digits can count or an abscissa that
/// the format would distort.
pub fn write_uff58(records: &[Record], out: &mut impl Write, storage: Storage) -> Result<()> {
    if records.is_empty() {
        return Err(Error::refused("there are no records to write, and a file without any cannot be read"));
    }
    let mut forms = Vec::with_capacity(records.len());
    for record in records {
        if record.len() as u64 > 9_999_999_999 {
            return Err(Error::refused(format!(
                "record {:?} has {} values, and data set 58 has ten columns for their number",
                record.meta().name,
                record.len()
            )));
        }
        forms.push(abscissa::form(record, storage.binary)?);
    }
    for (record, form) in records.iter().zip(&forms) {
        write(record, form, out, storage).map_err(|e| Error::io("write", "the UFF data", e))?;
    }
    Ok(())
}

fn write(record: &Record, form: &[String; 2], out: &mut impl Write, storage: Storage) -> std::io::Result<()> {
    let layout = Layout::of(record, storage.precision);
    let bytes = layout.point_size() * record.len();
    Header::of(record).write(out, layout, storage.binary.then_some(bytes), form, record)?;
    if storage.binary {
        points(record, &mut Binary { out, layout })?;
    } else {
        let mut text = Text { out, widths: layout.widths(), line: Vec::with_capacity(81), column: 0 };
        points(record, &mut text)?;
        text.end()?;
    }
    writeln!(out, "{:80}", "    -1")
}

/// One of the eight cases.
#[derive(Debug, Clone, Copy)]
struct Layout {
    complex: bool,
    double: bool,
    even: bool,
}

impl Layout {
    fn of(record: &Record, precision: Precision) -> Layout {
        let even = matches!(record.axis().grid, Grid::Even { .. });
        Layout { complex: record.is_complex(), double: precision == Precision::Double, even }
    }

    /// Bytes of one point in binary.
    fn point_size(self) -> usize {
        let value = if self.double { 8 } else { 4 };
        value * (1 + usize::from(self.complex)) + if self.even { 0 } else { 4 }
    }

    /// Field widths of one line of text.
    fn widths(self) -> &'static [usize] {
        match (self.double, self.even, self.complex) {
            (false, _, _) => &[13; 6],
            (true, true, _) => &[20; 4],
            (true, false, false) => &[13, 20, 13, 20],
            (true, false, true) => &[13, 20, 20],
        }
    }
}

/// Takes abscissa and values one number after the other.
trait Numbers {
    fn abscissa(&mut self, value: f64) -> std::io::Result<()>;
    fn value(&mut self, value: f64) -> std::io::Result<()>;
}

fn points(record: &Record, numbers: &mut impl Numbers) -> std::io::Result<()> {
    let uneven = match &record.axis().grid {
        Grid::Even { .. } => None,
        Grid::Uneven(values) => Some(values),
    };
    let mut point = |i: usize, parts: &[f64]| {
        if let Some(abscissa) = uneven {
            numbers.abscissa(abscissa.get(i).copied().unwrap_or(f64::NAN))?;
        }
        parts.iter().try_for_each(|part| numbers.value(*part))
    };
    let complex = match record {
        Record::Frf(frf) => &frf.values,
        Record::Spectrum(spectrum) => match &spectrum.values {
            Values::Complex(values) => values,
            Values::Real(values) => {
                return values.iter().enumerate().try_for_each(|(i, v)| point(i, &[*v]));
            }
        },
        Record::Trace(trace) => {
            return trace.values.iter().enumerate().try_for_each(|(i, v)| point(i, &[*v]));
        }
    };
    complex.iter().enumerate().try_for_each(|(i, v)| point(i, &[v.re, v.im]))
}

struct Binary<'a, W> {
    out: &'a mut W,
    layout: Layout,
}

impl<W: Write> Numbers for Binary<'_, W> {
    fn abscissa(&mut self, value: f64) -> std::io::Result<()> {
        self.out.write_all(&(value as f32).to_le_bytes())
    }

    fn value(&mut self, value: f64) -> std::io::Result<()> {
        if self.layout.double {
            self.out.write_all(&value.to_le_bytes())
        } else {
            self.out.write_all(&(value as f32).to_le_bytes())
        }
    }
}

struct Text<'a, W> {
    out: &'a mut W,
    widths: &'static [usize],
    line: Vec<u8>,
    column: usize,
}

impl<W: Write> Text<'_, W> {
    fn number(&mut self, value: f64) -> std::io::Result<()> {
        let width = self.widths[self.column];
        self.line.extend_from_slice(field(value, width, width - 8).as_bytes());
        self.column += 1;
        if self.column == self.widths.len() { self.end() } else { Ok(()) }
    }

    fn end(&mut self) -> std::io::Result<()> {
        if self.column > 0 {
            self.line.push(b'\n');
            self.out.write_all(&self.line)?;
            self.line.clear();
            self.column = 0;
        }
        Ok(())
    }
}

impl<W: Write> Numbers for Text<'_, W> {
    fn abscissa(&mut self, value: f64) -> std::io::Result<()> {
        self.number(value)
    }

    fn value(&mut self, value: f64) -> std::io::Result<()> {
        self.number(value)
    }
}

/// Fortran's `1PEw.d`: the letter makes room for a third digit of the exponent.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
