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
mod gaps;
mod grouping;
mod layout;
mod names;
mod rows;
pub(super) mod stated;

use super::abscissa::{self, Printed, to_si};
use super::csv::name::{Name, Part};
use super::cut_off;
use super::format::Format;
use super::missing;
use super::reader::{Options, Recording};
use super::text;
use super::{Header, Source, Summary, SweepList};
pub(super) use layout::shorten;
use layout::{Cell, Layout, Separator};
use num_complex::Complex64;
use stated::Stated;
use std::borrow::Cow;
use vibro_record::{
    Axis, AxisKind, Error, Frf, FrfKind, Meta, Place, Record, Result, Scaling, Spectrum, Trace, Values,
};

/// Text of any kind: this is the last format tried.
pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    text::is_text(head)
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let raw = source.head()?;
    let source = &plain(source)?;
    let head = source.head()?;
    let layout = layout::detect(source.path(), &head, source.len() > head.len() as u64, options)?;
    let stated = stated::read(&layout.header);
    let mut doubts: Vec<String> = cut_off(source, &layout)?.into_iter().collect();
    let mut footer = false;
    let columns = if let Some(values) = fast(source, &layout)? {
        deal(values, layout.columns).into_iter().map(Values::Real).collect()
    } else {
        let bytes = source.all()?;
        let bytes = if lone_cr(&bytes, false) { with_lf(bytes) } else { bytes };
        let rows = rows::read(source.path(), &bytes, &layout, options.allow_missing)?;
        drop(bytes);
        if let Some(words) = &rows.footer {
            if words.ends_list(rows.values.iter().map(|v| v.re)) || SweepList::of(source).is_some() {
                let place = Place::file(source.path());
                return Err(Error::input(place, "names of files behind numbers", "numbers and nothing else").hint(
                    "if this is the list of a sweep, its numbers do not go with its names: correct it and give it to `vibro response`",
                ));
            }
            doubts.push(words.doubt());
            footer = true;
        }
        doubts.extend(missing::kept(rows.missing));
        if !rows.comments.is_empty() {
            doubts.push(format!(
                "{} comment line(s) between the values were passed over.",
                rows.comments.len()
            ));
        }
        let mut columns = match layout.cell {
            Cell::Complex => deal(rows.values, layout.columns).into_iter().map(Values::Complex).collect(),
            Cell::Real => {
                let values = rows.values.iter().map(|v| v.re).collect();
                deal(values, layout.columns).into_iter().map(Values::Real).collect::<Vec<_>>()
            }
        };
        if rows.missing > 0 {
            doubts.extend(gaps::bridge(&mut columns));
        }
        columns
    };
    let n = columns.first().map_or(0, Values::len);
    let mut records = assemble(source, columns, (n, footer), &layout, &stated, options)?;
    for record in &mut records {
        text::read_as(record.meta_mut(), &raw, layout.decimal);
    }
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
            let empty = vec![Values::Real(Vec::new())];
            let mut records = assemble(&text, empty, (summary.n, false), &layout, &stated, options)?;
            if let Some(mut record) = records.pop() {
                text::read_as(record.meta_mut(), &source.head()?, layout.decimal);
                let said = names::of(&layout).and_then(|mut names| names.pop()?.unit).or(stated.unit);
                let factor = options.adopt(&mut record.meta().clone(), said.as_deref());
                // The values themselves are gone: the largest stands for them.
                let largest = summary.max.map(|(_, max)| max).into_iter().collect();
                to_si(text.path(), &mut Values::Real(largest), factor)?;
                let mut header = Header::of(&record).with_summary(&summary, factor, record.axis());
                header.declared_n = record.meta().declared_n;
                return Ok((vec![header], cut_off(&text, &layout)?.into_iter().collect()));
            }
        }
    }
    let recording = read(source, options)?;
    Ok((recording.records.iter().map(Header::of).collect(), recording.doubts))
}

/// A doubt about the last number.
fn cut_off(source: &Source, layout: &Layout) -> Result<Option<String>> {
    let separator = if let Separator::Char(mark) = layout.separator { mark } else { b' ' };
    cut_off::doubt_of(source, separator, layout.decimal)
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
    // Most files have none at all, and that is told quickly.
    bytes.contains(&b'\r')
        && (bytes.windows(2).any(|w| w[0] == b'\r' && !matches!(w[1], b'\r' | b'\n'))
            || (!cut && bytes.last() == Some(&b'\r')))
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

/// Row-wise values to columns.
fn deal<T: Copy>(values: Vec<T>, columns: usize) -> Vec<Vec<T>> {
    if columns == 1 {
        return vec![values];
    }
    (0..columns).map(|c| values.iter().skip(c).step_by(columns).copied().collect()).collect()
}

/// Records of `n` rows, with a `footer` behind them or without.
fn assemble(
    source: &Source,
    mut columns: Vec<Values>,
    (n, footer): (usize, bool),
    layout: &Layout,
    stated: &Stated,
    options: &Options,
) -> Result<Vec<Record>> {
    let found = names::of(layout);
    let named = found.is_some();
    let nameless = Name { name: String::new(), unit: None };
    let mut names = found.unwrap_or_else(|| vec![nameless; layout.columns]);
    let mut doubts = stated.doubts.clone();
    let pair = options.complex && columns.len() == 2 && layout.cell == Cell::Real;
    let printed = if columns.len() > 1 && !pair && is_abscissa(&columns[0], &names[0]) {
        let values = columns.remove(0);
        Some(printed(source, &names.remove(0), &real_parts(&values), layout, stated, options)?)
    } else {
        None
    };
    let has_axis = printed.is_some();
    let axis = abscissa::choose(source.path(), printed, (n, footer), stated, options, &mut doubts)?;
    let mut meta = Meta::new(stated.name.clone().unwrap_or_default(), vibro_record::units::Unit::opaque(""));
    meta.notes.clone_from(&stated.notes);
    meta.step("read", &[("file", &source.name()), ("format", &"ascii")]);
    for doubt in doubts {
        meta.doubt(doubt);
    }
    if axis.kind == AxisKind::Frequency
        && !has_axis
        && let Some(lines) = stated.lines
        && n != lines as usize
        && n != lines as usize + 1
    {
        let expected = lines as usize + 1;
        meta.declared_n = Some(expected);
        meta.doubt(format!("The header declares {lines} lines, so {expected} values; the file holds {n}."));
    }
    join_parts(source, &mut columns, &mut names, &axis, layout, options)?;
    if columns.len() == 2 && !has_axis && !named {
        meta.doubt(
            "Two columns are read as two channels; if they are real and imaginary part, give --complex.",
        );
    }
    let alone = layout.columns == 1;
    let made = columns.into_iter().zip(names).enumerate().map(|(i, (mut values, name))| {
        let mut meta = if alone { meta.clone() } else { numbered(&meta, i, &name) };
        if alone && meta.name.is_empty() {
            meta.name = name.name;
        }
        let factor = options.adopt(&mut meta, name.unit.as_deref().or(stated.unit.as_deref()));
        to_si(source.path(), &mut values, factor)?;
        record(source, meta, axis.clone(), values, stated)
    });
    made.collect()
}

/// The first column is an abscissa by name, or because it rises.
fn is_abscissa(values: &Values, name: &Name) -> bool {
    let nameless = Name { name: name.name.clone(), unit: None };
    let values = real_parts(values);
    rising(&values) || (nameless.axis(true).is_some() && values.iter().all(|v| v.is_finite()))
}

/// Two columns become one where they are real and imaginary part, by their names or because a person says so.
fn join_parts(
    source: &Source,
    columns: &mut Vec<Values>,
    names: &mut Vec<Name>,
    axis: &Axis,
    layout: &Layout,
    options: &Options,
) -> Result<()> {
    if layout.cell == Cell::Complex {
        return Ok(());
    }
    if options.complex && columns.len() != 2 {
        return Err(Error::input(
            Place::file(source.path()),
            format!("{} column(s) of values, where complex values were stated", columns.len()),
            "two columns of values: real and imaginary part",
        )
        .hint("leave out --complex"));
    }
    let parts: Vec<_> = names.iter().map(Name::part).collect();
    let whole = match parts.as_slice() {
        [Some((Part::Real, whole)), Some((Part::Imaginary, other))] if whole == other => Some(whole.clone()),
        _ => None,
    };
    if !options.complex && (whole.is_none() || axis.kind == AxisKind::Time) {
        return Ok(());
    }
    if let [Values::Real(real), Values::Real(imaginary)] = columns.as_slice() {
        let values = real.iter().zip(imaginary).map(|(re, im)| Complex64::new(*re, *im)).collect();
        let unit = names.iter_mut().find_map(|name| name.unit.take());
        *columns = vec![Values::Complex(values)];
        *names = vec![Name { name: whole.unwrap_or_default(), unit }];
    }
    Ok(())
}

/// Several columns without names are told apart by number.
fn numbered(meta: &Meta, index: usize, name: &Name) -> Meta {
    let mut meta = meta.clone();
    if !name.name.is_empty() {
        meta.name.clone_from(&name.name);
    } else if index > 0 || meta.name.is_empty() {
        meta.name = format!("{} {}", if meta.name.is_empty() { "column" } else { &meta.name }, index + 1);
    }
    meta
}

fn real_parts(values: &Values) -> Cow<'_, [f64]> {
    match values {
        Values::Real(values) => values.into(),
        Values::Complex(values) => values.iter().map(|v| v.re).collect(),
    }
}

fn rising(values: &[f64]) -> bool {
    values.len() > 2 && values.windows(2).all(|w| w[1] > w[0])
}

/// Axis from a printed first column.
fn printed(
    source: &Source,
    name: &Name,
    values: &[f64],
    layout: &Layout,
    stated: &Stated,
    options: &Options,
) -> Result<Printed> {
    let mut doubts = Vec::new();
    let label = match name.name.as_str() {
        "" => "The first column".to_owned(),
        name => format!("The column {name:?}"),
    };
    let by_name = name.axis(true);
    let by_header = || {
        if options.rate.is_some() {
            Some(AxisKind::Time)
        } else if options.base_band.is_some() || stated.all_lines(values.len()) {
            Some(AxisKind::Frequency)
        } else if stated.rate.is_some() {
            Some(AxisKind::Time)
        } else if stated.spacing(values.len()).is_some() || layout.cell == Cell::Complex {
            Some(AxisKind::Frequency)
        } else {
            None
        }
    };
    let assumed = by_name.is_none();
    let (kind, factor) = if let Some(kind) = by_name {
        let (factor, doubt) = name.to_axis(&kind, &label).map_err(|found| {
            Error::input(Place::file(source.path()), format!("{found} {:?}", name.name), "s, ms, Hz, kHz, …")
                .hint("name another unit in the header, e.g. time [s]")
        })?;
        doubts.extend(doubt);
        (kind, factor)
    } else if let Some(kind) = by_header() {
        let (what, unit) = if kind == AxisKind::Time { ("time", "seconds") } else { ("frequency", "hertz") };
        doubts.push(format!("{label} is taken as the {what}; no unit is stated: {unit} are assumed."));
        (kind, 1.0)
    } else {
        doubts.push(format!(
            "{label} rises and is taken as the abscissa; the file does not say whether it is time or frequency (give --rate or --base-band)."
        ));
        let name = if name.name.is_empty() { "first column" } else { &name.name };
        (AxisKind::Other(name.into()), 1.0)
    };
    let resolution = printed_resolution(values) * factor;
    let values = values.iter().map(|v| v * factor).collect();
    let (axis, doubt) = abscissa::from_values(kind, values, resolution, &label);
    doubts.extend(doubt);
    Ok(Printed { axis, label, resolution, assumed, doubts })
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

pub(super) const SCALING_UNSAID: &str =
    "The file does not say how its spectrum is scaled; where it matters, peak amplitudes are assumed.";

fn record(source: &Source, mut meta: Meta, axis: Axis, values: Values, stated: &Stated) -> Result<Record> {
    let values = match values {
        Values::Real(values) if axis.kind != AxisKind::Frequency => {
            return Ok(Record::Trace(Trace { meta, axis, values }));
        }
        Values::Complex(_) if axis.kind == AxisKind::Time => {
            return Err(Error::input(
                Place::file(source.path()),
                "complex values over time",
                "complex values over frequency, or real values over time",
            )
            .hint("give --base-band instead of --rate"));
        }
        Values::Complex(values) if FrfKind::of(meta.quantity) != FrfKind::Other => {
            let kind = FrfKind::of(meta.quantity);
            return Ok(Record::Frf(Frf { meta, axis, values, kind }));
        }
        values => values,
    };
    meta.doubt(SCALING_UNSAID);
    let (scaling, window) = (Scaling::Unknown, stated.window);
    Ok(Record::Spectrum(Spectrum { meta, axis, values, scaling, window, enbw: None }))
}
