//! Variables to records: abscissa, columns, what is passed over.

use super::variable::{Array, Content, Variable};
use crate::assemble::{self, Spectral};
use crate::axis::{from_values, short};
use crate::reader::Options;
use crate::{Source, missing};
use num_complex::Complex64;
use vibro_record::units::{self, Unit};
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Place, Record, Result, Values};

/// How many scalars and texts are kept.
const MOST_NOTES: usize = 256;
const MOST_NOTE_BYTES: usize = 16 * 1024;
/// More columns than this are taken for a matrix that lies on its side.
const MOST_COLUMNS: u64 = 1000;

/// Records of all numeric variables that are neither abscissa nor scalar.
pub fn build(
    source: &Source,
    variables: Vec<Variable>,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Record>> {
    let (mut arrays, mut notes, mut rates) = (Vec::new(), Vec::new(), Vec::new());
    for Variable { name, content } in variables {
        match content {
            Content::Text(text) => notes.push((name, text)),
            Content::Other(class) if name.is_empty() => {
                findings.push(Finding::note("variable-passed-over").name("class", class));
            }
            Content::Other(class) => {
                findings
                    .push(Finding::note("variable-passed-over").name("variable", name).name("class", class));
            }
            // MATLAB keeps the inside of objects and functions in a nameless array.
            Content::Array(_) if name.is_empty() => {}
            Content::Array(array) => match (array.real.as_slice(), &array.imaginary) {
                ([], _) => findings.push(Finding::note("variable-empty").name("variable", name)),
                ([value], None) => {
                    rates.extend(rate(&name, *value).map(|rate| (name.clone(), rate)));
                    notes.push((name, value.to_string()));
                }
                _ if array.dimensions.iter().filter(|d| **d > 1).count() > 2 => {
                    let found = Finding::note("variable-many-dimensions").name("variable", name);
                    findings.push(found.count("dimensions", array.dimensions.len()));
                }
                _ => {
                    if array.rounded {
                        findings.push(Finding::caution("integers-rounded").name("variable", name.as_str()));
                    }
                    arrays.push((name, array));
                }
            },
        }
    }
    // Every record has a copy of them.
    let mut room = MOST_NOTE_BYTES;
    let kept = notes.iter().take(MOST_NOTES).take_while(|(name, text)| {
        let size = name.len() + text.len();
        let fits = size <= room;
        room = room.saturating_sub(size);
        fits
    });
    let kept = kept.count();
    if notes.len() > kept {
        findings.push(Finding::note("remarks-dropped").count("n", notes.len()).count("kept", kept));
        notes.truncate(kept);
    }
    let axes = Axes::find(source, &mut arrays, &rates, options, findings)?;
    let mut made = Made { source, options, notes, axes, missing: 0, gaps: Vec::new() };
    let mut records = Vec::new();
    for (name, array) in arrays {
        made.split(&name, array, &mut records, findings)?;
    }
    if records.is_empty() {
        return Err(Error::input(
            Place::file(source.path()),
            "no numeric vector or matrix",
            "at least one to make a record of",
        ));
    }
    if made.missing > 0 && !options.allow_missing {
        let more = if made.missing > made.gaps.len() { ", …" } else { "" };
        let found = format!("{} value(s) are NaN or infinite: {}{more}", made.missing, made.gaps.join(", "));
        return Err(missing::refusal(Place::file(source.path()), found));
    }
    findings.extend(missing::kept(made.missing));
    if options.unit.is_none() {
        findings.push(Finding::caution("format-without-units"));
    }
    Ok(records)
}

/// Sampling rate in Hz that a scalar of this name states.
fn rate(name: &str, value: f64) -> Option<f64> {
    let key = name.replace('_', "").to_lowercase();
    let rate = match key.as_str() {
        "fs" | "rate" | "samplerate" | "samplingrate" | "samplefrequency" | "samplingfrequency" => value,
        "dt" | "ts" | "sampletime" | "samplinginterval" => 1.0 / value,
        _ => return None,
    };
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// The kind of abscissa that a vector of this name holds.
fn kind(name: &str) -> Option<AxisKind> {
    match name {
        "t" | "time" | "Time" => Some(AxisKind::Time),
        "f" | "freq" | "Freq" | "frequency" | "Frequency" => Some(AxisKind::Frequency),
        _ => None,
    }
}

/// What the file and the person say of abscissae.
#[derive(Default)]
struct Axes {
    stated: Option<Axis>,
    time: Option<Axis>,
    frequency: Option<Axis>,
    rate: Option<f64>,
}

impl Axes {
    /// Takes the rising vectors named as abscissae out of `arrays` where another array has their length.
    fn find(
        source: &Source,
        arrays: &mut Vec<(String, Array)>,
        rates: &[(String, f64)],
        options: &Options,
        findings: &mut Vec<Finding>,
    ) -> Result<Axes> {
        let mut axes = Axes { rate: rates.first().map(|(_, rate)| *rate), ..Axes::default() };
        if let [(first, a), rest @ ..] = rates
            && let Some((other, b)) = rest.iter().find(|(_, b)| (b / a - 1.0).abs() > 1e-6)
            && options.rate.is_none()
        {
            let found =
                format!("{first:?} says a sampling rate of {} Hz, {other:?} {} Hz", short(*a), short(*b));
            return Err(Error::input(Place::file(source.path()), found, "one sampling rate")
                .hint("state the sampling rate")
                .setting("rate"));
        }
        axes.stated = match (options.rate, options.base_band) {
            (Some(rate), _) => Some(Axis::time(0.0, 1.0 / rate, 0)),
            (None, Some(band)) => Some(Axis::frequency(0.0, band, 0)),
            _ => None,
        };
        for axis_kind in [AxisKind::Time, AxisKind::Frequency] {
            let Some(at) = arrays.iter().position(|(name, _)| kind(name).as_ref() == Some(&axis_kind)) else {
                continue;
            };
            let (name, array) = &arrays[at];
            let n = array.real.len() as u64;
            let rises = array.real.windows(2).all(|w| w[1] > w[0]) && array.imaginary.is_none();
            let vector = array.dimensions.contains(&n);
            let fits = arrays.iter().enumerate().any(|(i, (_, a))| i != at && a.dimensions.contains(&n));
            if !(rises && vector && fits) {
                let found = if rises {
                    Finding::caution("abscissa-of-other-length")
                } else {
                    Finding::caution("abscissa-not-rising")
                };
                findings.push(found.name("variable", name.as_str()));
                continue;
            }
            let (name, array) = arrays.remove(at);
            let (axis, finding) = vector_axis(axis_kind.clone(), array, &name);
            findings.extend(finding);
            if axis_kind == AxisKind::Time {
                axes.check_rate(&name, &axis, options, findings);
                axes.time = Some(axis);
            } else {
                axes.frequency = Some(axis);
            }
        }
        Ok(axes)
    }

    fn check_rate(&self, name: &str, axis: &Axis, options: &Options, findings: &mut Vec<Finding>) {
        let Some(rate) = options.rate.or(self.rate) else { return };
        if axis.step().is_none_or(|dt| (dt * rate - 1.0).abs() > 1e-6) {
            let used = if options.rate.is_some() { "rate" } else { "vector" };
            let found = Finding::caution("vector-against-rate").name("variable", name).name("used", used);
            findings.push(found.number("rate", rate));
        }
    }

    /// Axis for `n` real or complex values.
    fn of(&self, n: usize, complex: bool, name: &str, findings: &mut Vec<Finding>) -> Axis {
        if let Some(stated) = self.stated.as_ref().filter(|s| !complex || s.kind == AxisKind::Frequency) {
            let step = stated.step().unwrap_or(1.0);
            return match stated.kind {
                AxisKind::Time => {
                    let start = self.time.as_ref().filter(|t| t.len() == n).map_or(0.0, Axis::start);
                    Axis::time(start, step, n)
                }
                _ => Axis::frequency(0.0, step / n.saturating_sub(1).max(1) as f64, n),
            };
        }
        let time = self.time.as_ref().filter(|t| t.len() == n && !complex);
        let frequency = self.frequency.as_ref().filter(|f| f.len() == n);
        if time.is_some() && frequency.is_some() {
            findings.push(Finding::caution("time-or-frequency").name("variable", name));
        }
        if let Some(axis) = time.or(frequency) {
            return axis.clone();
        }
        match self.rate.filter(|_| !complex) {
            Some(rate) => Axis::time(0.0, 1.0 / rate, n),
            None => Axis::index(n),
        }
    }

    fn has(&self, n: u64) -> bool {
        [&self.time, &self.frequency].into_iter().flatten().any(|axis| axis.len() as u64 == n)
    }
}

fn vector_axis(kind: AxisKind, array: Array, name: &str) -> (Axis, Option<Finding>) {
    let (first, last) = (array.real.first().copied(), array.real.last().copied());
    let (first, last) = (first.unwrap_or(0.0), last.unwrap_or(0.0));
    let step = (last - first).abs() / array.real.len().saturating_sub(1).max(1) as f64;
    // Sums of steps drift by rounding: a millionth of a step is no unevenness. Floats of 32 bits round to 2⁻²⁴.
    let single = if array.single { first.abs().max(last.abs()) * f64::from(f32::EPSILON) / 2.0 } else { 0.0 };
    from_values(kind, array.real, single.max(0.5e-6 * step), &format!("vector {name:?}"))
}

/// Columns of a matrix: cut from the end, so that memory is given back as they are made.
fn by_columns(mut values: Vec<f64>, rows: usize, columns: usize) -> Vec<Vec<f64>> {
    let mut cut = Vec::new();
    for column in (1..columns).rev() {
        cut.push(values.split_off((column * rows).min(values.len())));
        values.shrink_to_fit();
    }
    cut.push(values);
    cut.reverse();
    cut
}

fn by_rows(values: &[f64], rows: usize) -> Vec<Vec<f64>> {
    (0..rows).map(|row| values.iter().skip(row).step_by(rows).copied().collect()).collect()
}

/// What all records share.
struct Made<'a> {
    source: &'a Source,
    options: &'a Options,
    notes: Vec<(String, String)>,
    axes: Axes,
    missing: usize,
    gaps: Vec<String>,
}

impl Made<'_> {
    /// A vector is one record, a matrix one a column; or one a row, where only the rows have the length of the abscissa.
    fn split(
        &mut self,
        name: &str,
        array: Array,
        records: &mut Vec<Record>,
        findings: &mut Vec<Finding>,
    ) -> Result<()> {
        let mut long = array.dimensions.iter().copied().filter(|d| *d > 1);
        let (Some(rows), Some(columns)) = (long.next(), long.next()) else {
            let record = self.record(name.to_owned(), array.real, array.imaginary, findings)?;
            records.push(record);
            return Ok(());
        };
        let lying = self.axes.has(columns) && !self.axes.has(rows) && rows <= columns.max(MOST_COLUMNS);
        if !lying && columns > rows && columns > MOST_COLUMNS {
            return Err(Error::input(
                Place::file(self.source.path()),
                format!("{name:?} has {rows} rows and {columns} columns: {columns} records of {rows} values"),
                "one channel a column",
            )
            .hint(format!("transpose it and save it again: {name} = {name}.';")));
        }
        let (rows, columns) = (rows as usize, columns as usize);
        let cut = |values: Vec<f64>| {
            if lying { by_rows(&values, rows) } else { by_columns(values, rows, columns) }
        };
        let mut imaginary = array.imaginary.map(cut).into_iter().flatten();
        for (k, real) in cut(array.real).into_iter().enumerate() {
            let part = if lying { format!("{name}({},:)", k + 1) } else { format!("{name}(:,{})", k + 1) };
            let record = self.record(part, real, imaginary.next(), findings)?;
            records.push(record);
        }
        Ok(())
    }

    fn record(
        &mut self,
        name: String,
        mut real: Vec<f64>,
        mut imaginary: Option<Vec<f64>>,
        findings: &mut Vec<Finding>,
    ) -> Result<Record> {
        self.mark_missing(&name, &mut real, imaginary.as_deref_mut());
        let axis = self.axes.of(real.len(), imaginary.is_some(), &name, findings);
        let mut meta = Meta::new(name, Unit::opaque(""));
        meta.notes.clone_from(&self.notes);
        meta.step("read", &[("file", &self.source.name()), ("format", &"mat")]);
        let factor = self.options.unit.as_ref().map_or(1.0, |unit| meta.adopt_unit(unit.symbol()));
        if factor != 1.0 {
            units::scale(real.iter_mut().chain(imaginary.iter_mut().flatten()), factor)
                .map_err(|e| e.in_file(self.source.path()))?;
        }
        if axis.kind == AxisKind::Index {
            meta.found(Finding::caution("abscissa-unsaid"));
        }
        let values = match imaginary {
            None => Values::Real(real),
            Some(imaginary) => Values::Complex(
                real.iter().zip(&imaginary).map(|(re, im)| Complex64::new(*re, *im)).collect(),
            ),
        };
        Ok(assemble::record(meta, axis, values, Spectral::default()))
    }

    /// Infinite values are as missing as NaN; a complex value is missing as a whole.
    fn mark_missing(&mut self, name: &str, real: &mut [f64], mut imaginary: Option<&mut [f64]>) {
        for (i, re) in real.iter_mut().enumerate() {
            let im = imaginary.as_deref_mut().and_then(|im| im.get_mut(i));
            if re.is_finite() && im.as_ref().is_none_or(|im| im.is_finite()) {
                continue;
            }
            *re = f64::NAN;
            if let Some(im) = im {
                *im = f64::NAN;
            }
            self.missing += 1;
            if self.gaps.len() < missing::LISTED {
                self.gaps.push(format!("{} of {name:?}", i + 1));
            }
        }
    }
}
