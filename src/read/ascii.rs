//! Analyser and scope text: columns of numbers, with or without header lines.
//!
//! ```text
//! SPS390 SPECTRUM            header lines: free text, `key: value`, or comments behind # % ! * ' " //
//! 20 Hz 400 lines
//!   4.001992e-02             one value a line; or columns between blanks, tabs, commas or semicolons
//!   2.001233e-02
//! ```
//! Complex values stand as `(re+imj)` or as two columns under a header with `real` and `imag`. Header keys that are
//! understood: lines, base band, sampling rate, dt, df, unit, window, channel; the rest stays as notes.

mod clean;
mod fixed;
mod layout;
mod rows;
pub(super) mod stated;

use super::format::Format;
use super::reader::{Options, Recording};
use super::text;
use super::{Header, Source, Summary};
use crate::error::{Error, Place, Result};
use crate::record::{Axis, AxisKind, Frf, FrfKind, Meta, Record, Scaling, Spectrum, Trace, Values};
use layout::{Cell, Layout};
use num_complex::Complex64;
use stated::Stated;

/// Text of any kind: this is the last format tried.
pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    text::is_text(head)
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let source = &plain(source)?;
    let head = source.head()?;
    let layout = layout::detect(source.path(), &head, source.len() > head.len() as u64, options)?;
    let stated = stated::read(&layout.header);
    let mut doubts = Vec::new();
    let columns = if let Some(values) = fast(source, &layout)? {
        Columns::Real(deal(values, layout.columns))
    } else {
        let bytes = source.all()?;
        let bytes = if lone_cr(&bytes, false) { with_lf(bytes) } else { bytes };
        let rows = rows::read(source.path(), &bytes, &layout, options.allow_missing)?;
        drop(bytes);
        if rows.missing > 0 {
            doubts.push(format!("{} value(s) are missing and kept as such.", rows.missing));
        }
        if !rows.comments.is_empty() {
            doubts.push(format!(
                "{} comment line(s) between the values were passed over.",
                rows.comments.len()
            ));
        }
        match layout.cell {
            Cell::Complex => Columns::Complex(deal(rows.values, layout.columns)),
            Cell::Real => Columns::Real(deal(rows.values.iter().map(|v| v.re).collect(), layout.columns)),
        }
    };
    let records = assemble(source, columns, &layout, &stated, options)?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Ascii, records, doubts })
}

/// Streams a clean single column; anything else is read as a whole.
pub(super) fn survey(source: &Source, options: &Options) -> Result<(Vec<Header>, Vec<String>)> {
    let text = plain(source)?;
    let head = text.head()?;
    let layout = layout::detect(text.path(), &head, text.len() > head.len() as u64, options)?;
    if layout.columns == 1 && layout.cell == Cell::Real {
        let mut summary = Summary::default();
        let clean =
            clean::scan(&text, &layout, layout.first_byte as u64, text.len(), |v| summary.push(v.abs()))?;
        if clean.is_some() {
            let stated = stated::read(&layout.header);
            let mut records = assemble(&text, Columns::Real(vec![Vec::new()]), &layout, &stated, options)?;
            if let Some(record) = records.pop() {
                return Ok((vec![streamed(&record, &summary, &stated, options)], Vec::new()));
            }
        }
    }
    let recording = read(source, options)?;
    Ok((recording.records.iter().map(Header::of).collect(), recording.doubts))
}

/// Header of a single streamed column: `empty` carries everything but the values.
fn streamed(empty: &Record, summary: &Summary, stated: &Stated, options: &Options) -> Header {
    let mut meta = empty.meta().clone();
    let axis = axis_of(summary.n, stated, options, &mut meta);
    let factor =
        unit_of(stated, options).map_or(1.0, |text| crate::units::Unit::parse_or_opaque(&text).factor());
    let mut header = Header::of(empty).with_summary(summary, factor, &axis);
    header.x0 = axis.start();
    header.dx = axis.step();
    header.declared_n = meta.declared_n;
    header.doubts = meta.doubts;
    header
}

/// UTF-16 and lone CRs in the head are turned into UTF-8 with LF; everything else stays on disk.
fn plain(source: &Source) -> Result<Source> {
    let head = source.head()?;
    let bytes = if text::is_utf16(&head) {
        text::decode(&source.all()?).into_owned().into_bytes()
    } else if lone_cr(&head, source.len() > head.len() as u64) {
        source.all()?
    } else {
        return Ok(source.clone());
    };
    Source::memory(source.path(), with_lf(bytes))
}

/// Whether a CR stands before anything but LF or another CR; the last byte of a head that is `cut` off tells nothing.
fn lone_cr(bytes: &[u8], cut: bool) -> bool {
    bytes.windows(2).any(|w| w[0] == b'\r' && !matches!(w[1], b'\r' | b'\n'))
        || (!cut && bytes.last() == Some(&b'\r'))
}

/// Every CR that no LF follows becomes LF; several CRs before LF are one line end, as text that was converted twice has it.
fn with_lf(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut before_lf = false;
    for b in bytes.iter_mut().rev() {
        if *b == b'\r' && !before_lf {
            *b = b'\n';
        } else {
            before_lf = matches!(*b, b'\n' | b'\r');
        }
    }
    bytes
}

fn fast(source: &Source, layout: &Layout) -> Result<Option<Vec<f64>>> {
    if layout.cell == Cell::Complex {
        return Ok(None);
    }
    match fixed::read(source, layout)? {
        Some(values) => Ok(Some(values)),
        None => clean::read(source, layout),
    }
}

enum Columns {
    Real(Vec<Vec<f64>>),
    Complex(Vec<Vec<Complex64>>),
}

/// Row-wise values to columns.
fn deal<T: Copy>(values: Vec<T>, columns: usize) -> Vec<Vec<T>> {
    if columns == 1 {
        return vec![values];
    }
    (0..columns).map(|c| values.iter().skip(c).step_by(columns).copied().collect()).collect()
}

fn assemble(
    source: &Source,
    columns: Columns,
    layout: &Layout,
    stated: &Stated,
    options: &Options,
) -> Result<Vec<Record>> {
    let mut meta = Meta::new(stated.name.clone().unwrap_or_default(), crate::units::Unit::opaque(""));
    meta.notes.clone_from(&stated.notes);
    meta.step("read", &[("file", &source.name()), ("format", &"ascii")]);
    let factor = match unit_of(stated, options) {
        Some(text) => meta.adopt_unit(&text),
        None => 1.0,
    };
    match columns {
        Columns::Complex(mut columns) => {
            let axis_column =
                (columns.len() > 1 && rising(&real_parts(&columns[0]))).then(|| columns.remove(0));
            let axis = match axis_column {
                Some(column) => abscissa(real_parts(&column), layout, stated, options, &mut meta),
                None => axis_of(columns[0].len(), stated, options, &mut meta),
            };
            columns
                .into_iter()
                .enumerate()
                .map(|(i, values)| complex_record(source, numbered(&meta, i), &axis, values, factor, stated))
                .collect()
        }
        Columns::Real(mut columns) => {
            let first_is_axis = columns.len() > 1 && rising(&columns[0]);
            let axis = if first_is_axis {
                let column = columns.remove(0);
                abscissa(column, layout, stated, options, &mut meta)
            } else {
                axis_of(columns[0].len(), stated, options, &mut meta)
            };
            if columns.len() == 2 && (stated.complex || options.complex) {
                let imaginary = columns.pop().unwrap_or_default();
                let values =
                    columns[0].iter().zip(&imaginary).map(|(re, im)| Complex64::new(*re, *im)).collect();
                return Ok(vec![complex_record(source, meta, &axis, values, factor, stated)?]);
            }
            if columns.len() == 2 && !first_is_axis {
                meta.doubt(
                    "Two columns are read as two channels; if they are real and imaginary part, give --complex.",
                );
            }
            Ok(columns
                .into_iter()
                .enumerate()
                .map(|(i, values)| {
                    real_record(numbered(&meta, i), &axis, values, factor, stated, layout.columns)
                })
                .collect())
        }
    }
}

/// Several columns without names are told apart by number.
fn numbered(meta: &Meta, index: usize) -> Meta {
    let mut meta = meta.clone();
    if index > 0 || meta.name.is_empty() {
        meta.name = format!("{} {}", if meta.name.is_empty() { "column" } else { &meta.name }, index + 1);
    }
    meta
}

fn real_parts(values: &[Complex64]) -> Vec<f64> {
    values.iter().map(|v| v.re).collect()
}

fn rising(values: &[f64]) -> bool {
    values.len() > 2 && values.windows(2).all(|w| w[1] > w[0])
}

fn unit_of(stated: &Stated, options: &Options) -> Option<String> {
    options.unit.as_ref().map(|u| u.symbol().to_owned()).or_else(|| stated.unit.clone())
}

/// Axis from a printed first column.
fn abscissa(values: Vec<f64>, layout: &Layout, stated: &Stated, options: &Options, meta: &mut Meta) -> Axis {
    let frequency =
        if options.base_band.is_some() || stated.base_band.is_some() || stated.line_width.is_some() {
            Some(true)
        } else if options.rate.is_some() || stated.rate.is_some() {
            Some(false)
        } else {
            stated.frequency.or((layout.cell == Cell::Complex).then_some(true))
        };
    let kind = match frequency {
        Some(true) => AxisKind::Frequency,
        Some(false) => AxisKind::Time,
        None => {
            meta.doubt(
                "The first column rises and is taken as the abscissa; the file does not say whether it is time or frequency (give --rate or --base-band).",
            );
            AxisKind::Other("first column".into())
        }
    };
    let resolution = printed_resolution(&values);
    let (axis, doubt) = super::abscissa::from_values(kind, values, resolution, "The first column");
    if let Some(doubt) = doubt {
        meta.doubt(doubt);
    }
    axis
}

/// Half a unit in the last printed digit, judged from the values themselves: the coarsest power of ten (between 1 and
/// 10⁻¹²) of which all are multiples.
fn printed_resolution(values: &[f64]) -> f64 {
    (0..=12)
        .map(|digits| 10f64.powi(-digits))
        .find(|unit| {
            values.iter().all(|v| {
                let scaled = v / unit;
                (scaled - scaled.round()).abs() <= 1e-6_f64.max(scaled.abs() * 4.0 * f64::EPSILON)
            })
        })
        .map_or(0.0, |unit| unit / 2.0)
}

/// Axis of values without an abscissa of their own.
fn axis_of(n: usize, stated: &Stated, options: &Options, meta: &mut Meta) -> Axis {
    if let Some(rate) = options.rate {
        return Axis::time(0.0, 1.0 / rate, n);
    }
    let base_band = options.base_band.or(stated.base_band);
    if let (Some(said), Some(written)) = (options.base_band, stated.base_band)
        && said != written
    {
        meta.doubt(format!("The file says a base band of {written} Hz; {said} Hz was given and is used."));
    }
    if let Some(df) = stated.line_width {
        return Axis::frequency(0.0, df, n);
    }
    if let Some(base_band) = base_band {
        let lines = stated.lines.unwrap_or_else(|| n.saturating_sub(1).max(1) as f64);
        if let Some(lines) = stated.lines {
            let expected = lines as usize + 1;
            if n != expected && n + 1 != expected {
                meta.declared_n = Some(expected);
                meta.doubt(format!(
                    "The header declares {lines} lines, so {expected} values; the file holds {n}."
                ));
            }
        }
        return Axis::frequency(0.0, base_band / lines, n);
    }
    if let Some(rate) = stated.rate {
        return Axis::time(0.0, 1.0 / rate, n);
    }
    meta.doubt(
        "The file says nothing of its abscissa: values are numbered (give --rate for a time trace, --base-band for a spectrum).",
    );
    Axis::index(n)
}

fn real_record(
    mut meta: Meta,
    axis: &Axis,
    mut values: Vec<f64>,
    factor: f64,
    stated: &Stated,
    columns: usize,
) -> Record {
    if columns == 1 {
        meta.name = stated.name.clone().unwrap_or_default();
    }
    if factor != 1.0 {
        for value in &mut values {
            *value *= factor;
        }
    }
    if axis.kind == AxisKind::Frequency {
        meta.doubt(SCALING_UNSAID);
        return Record::Spectrum(Spectrum {
            meta,
            axis: axis.clone(),
            values: Values::Real(values),
            scaling: Scaling::Unknown,
            window: stated.window,
            enbw: None,
        });
    }
    Record::Trace(Trace { meta, axis: axis.clone(), values })
}

pub(super) const SCALING_UNSAID: &str =
    "The file does not say how its spectrum is scaled; where it matters, peak amplitudes are assumed.";

fn complex_record(
    source: &Source,
    mut meta: Meta,
    axis: &Axis,
    mut values: Vec<Complex64>,
    factor: f64,
    stated: &Stated,
) -> Result<Record> {
    if axis.kind == AxisKind::Time {
        return Err(Error::input(
            Place::file(source.path()),
            "complex values over time",
            "complex values over frequency, or real values over time",
        )
        .hint("give --base-band instead of --rate"));
    }
    if factor != 1.0 {
        for value in &mut values {
            *value *= factor;
        }
    }
    let kind = FrfKind::of(meta.quantity);
    if kind == FrfKind::Other {
        meta.doubt(SCALING_UNSAID);
        return Ok(Record::Spectrum(Spectrum {
            meta,
            axis: axis.clone(),
            values: Values::Complex(values),
            scaling: Scaling::Unknown,
            window: stated.window,
            enbw: None,
        }));
    }
    Ok(Record::Frf(Frf { meta, axis: axis.clone(), values, kind }))
}
