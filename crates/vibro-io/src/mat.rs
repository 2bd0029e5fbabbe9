//! MATLAB's level 5 MAT-file (`save -v6` and `-v7`), which scipy writes too.
//!
//! ```text
//! 124 bytes of text, version 0x0100, IM (little endian) or MI (big endian)
//! variable: kind 14, size, then elements: flags, dimensions, name, real part, imaginary part
//! variable: kind 15, size, then the same packed by zlib
//! ```
//! A numeric vector is a record, and so is each column of a matrix. Scalars and texts are notes on every record. The
//! abscissa comes from a vector `t` or `time` (`f`, `freq` or `frequency`) of the same length, or from a scalar `fs`,
//! `rate`, `SampleRate`, `dt` or `Ts`; the file knows no units.

pub(crate) mod variable;

use super::Source;
use super::format::Format;
use super::missing::{self, Missing};
use super::reader::{Options, Recording};
use crate::assemble::{self, Spectral, from_values, short, to_si};
use variable::{Array, Content};
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Place, Record, Result, Values};

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes before the first variable.
const HEADER: usize = 128;
/// More columns than this are taken for a matrix that lies on its side.
const MOST_COLUMNS: u64 = 1000;

/// Whether the numbers of a MAT-file are big endian, or which MAT-file it is that is not read here; `None` for other files.
fn big_endian(head: &[u8], source: &Source) -> Option<std::result::Result<bool, &'static str>> {
    const LEVEL_7: &str = "a MAT-file of version 7.3, which is HDF5";
    match head.get(124..128) {
        Some(b"\0\x01IM") => return Some(Ok(false)),
        Some(b"\x01\0MI") => return Some(Ok(true)),
        Some(b"\0\x02IM" | b"\x02\0MI") => return Some(Err(LEVEL_7)),
        _ => {}
    }
    if source.extension() != "mat" {
        return None;
    }
    if head.starts_with(HDF5) || head.get(512..520) == Some(HDF5) {
        return Some(Err(LEVEL_7));
    }
    // Level 4 has no signature: five words of type, rows, columns, complex or not, length of the name.
    let words: Vec<u32> = head.as_chunks().0.iter().take(5).map(|b| u32::from_le_bytes(*b)).collect();
    let words: [u32; 5] = words.try_into().ok()?;
    let plausible = |w: [u32; 5]| w[0] < 5000 && w[0] % 10 <= 2 && w[3] <= 1 && (1..=64).contains(&w[4]);
    (plausible(words) || plausible(words.map(u32::swap_bytes))).then_some(Err("a MAT-file of version 4"))
}

pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    big_endian(head, source).is_some()
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    #[cfg(feature = "hdf5")]
    if super::hdf5::sniff(source.head(), source) {
        return super::hdf5::read(source, options);
    }
    let big_endian =
        big_endian(source.head(), source).unwrap_or(Err("no MAT-file header")).map_err(|found| {
            Error::usage(found, "a level 5 MAT-file")
                .hint("open it in MATLAB and save it again with -v7 or -v6, e.g. save('name.mat', '-v7')")
        })?;
    let bytes = source.all()?;
    recording(source, variable::all(&bytes, HEADER, big_endian)?, Vec::new(), options)
}

/// Records of the vectors and matrices among `variables`, with what they say of each other; `findings` are those of the file.
pub(super) fn recording(
    source: &Source,
    variables: Vec<(String, Content)>,
    mut findings: Vec<Finding>,
    options: &Options,
) -> Result<Recording> {
    let (mut arrays, mut notes, mut rates) = (Vec::new(), Vec::new(), Vec::new());
    for (name, content) in variables {
        match content {
            Content::Text(text) => notes.push((name, text)),
            Content::Other(class) => {
                let passed = Finding::note("variable-passed-over");
                let passed = if name.is_empty() { passed } else { passed.name("variable", name) };
                findings.push(passed.name("class", class));
            }
            // MATLAB keeps the inside of objects and functions in a nameless array.
            Content::Array(_) if name.is_empty() => {}
            Content::Array(array) => match &array.values {
                values if values.is_empty() => {
                    findings.push(Finding::note("variable-empty").name("variable", name));
                }
                Values::Real(values) if values.len() == 1 => {
                    rates.extend(rate(&name, values[0]).map(|rate| (name.clone(), rate)));
                    notes.push((name, values[0].to_string()));
                }
                _ if array.dimensions.iter().filter(|d| **d > 1).count() > 2 => {
                    let found = Finding::note("variable-many-dimensions").name("variable", name);
                    findings.push(found.count("dimensions", array.dimensions.len()));
                }
                _ => arrays.push((name, array)),
            },
        }
    }
    let axes = Axes::find(&mut arrays, &rates, options, &mut findings)?;
    let mut records = Vec::new();
    for (name, array) in arrays {
        records.extend(axes.split(name, array)?);
    }
    if records.is_empty() {
        return Err(Error::usage("no numeric vector or matrix", "at least one to make a record of"));
    }
    let mut missing = Missing::default();
    for (name, values) in &mut records {
        for i in missing::mark(values) {
            missing.take(&Place::default(), format!("{} of {name:?}", i + 1));
        }
    }
    findings.extend(missing::kept(missing.check("value(s) are NaN or infinite:", options.allow_missing)?));
    if options.unit.is_none() {
        findings.push(Finding::caution("format-without-units"));
    }
    let record = |(name, mut values): (String, Values)| {
        let axis = axes.of(&values, &name, &mut findings);
        let mut meta = Meta::new(name, Unit::opaque(""));
        meta.notes.clone_from(&notes);
        meta.step("read", &[("file", &source.name()), ("format", &"mat")]);
        let factor = options.unit.as_ref().map_or(1.0, |unit| meta.adopt_unit(unit.symbol()));
        to_si(&mut values, factor)?;
        if axis.kind == AxisKind::Index {
            meta.found(Finding::caution("abscissa-unsaid"));
        }
        assemble::record(meta, axis, values, Spectral::default())
    };
    let records = records.into_iter().map(record).collect::<Result<Vec<Record>>>()?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Mat, records, findings })
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
struct Axes<'a> {
    options: &'a Options,
    /// Of vectors of the file: time, then frequency.
    vectors: Vec<Axis>,
    rate: Option<f64>,
}

impl<'a> Axes<'a> {
    /// Takes the rising vectors named as abscissae out of `arrays` where another array has their length.
    fn find(
        arrays: &mut Vec<(String, Array)>,
        rates: &[(String, f64)],
        options: &'a Options,
        findings: &mut Vec<Finding>,
    ) -> Result<Axes<'a>> {
        let rate = rates.first().map(|(_, rate)| *rate);
        let mut axes = Axes { options, vectors: Vec::new(), rate };
        if let [(first, a), rest @ ..] = rates
            && let Some((other, b)) = rest.iter().find(|(_, b)| (b / a - 1.0).abs() > 1e-6)
            && options.rate.is_none()
        {
            let found =
                format!("{first:?} says a sampling rate of {} Hz, {other:?} {} Hz", short(*a), short(*b));
            return Err(Error::usage(found, "one sampling rate")
                .hint("state the sampling rate")
                .setting("rate"));
        }
        for axis_kind in [AxisKind::Time, AxisKind::Frequency] {
            let Some(at) = arrays.iter().position(|(name, _)| kind(name).as_ref() == Some(&axis_kind)) else {
                continue;
            };
            let (name, Array { dimensions, values, single }) = arrays.remove(at);
            let n = values.len() as u64;
            let fits = dimensions.contains(&n) && arrays.iter().any(|(_, a)| a.dimensions.contains(&n));
            let values = match values {
                Values::Real(values) if fits && values.is_sorted_by(|a, b| a < b) => values,
                values => {
                    let rises = matches!(&values, Values::Real(v) if v.is_sorted_by(|a, b| a < b));
                    let code = if rises { "abscissa-of-other-length" } else { "abscissa-not-rising" };
                    findings.push(Finding::caution(code).name("variable", name.as_str()));
                    arrays.insert(at, (name, Array { dimensions, values, single }));
                    continue;
                }
            };
            let (first, last) = (values[0], values[values.len() - 1]);
            // Sums of steps drift by rounding: a millionth of a step is no unevenness. Floats of 32 bits round to 2⁻²⁴.
            let drift = 0.5e-6 * (last - first) / (values.len() - 1).max(1) as f64;
            let rounding =
                if single { first.abs().max(last.abs()) * f64::from(f32::EPSILON) / 2.0 } else { 0.0 };
            let label = format!("vector {name:?}");
            let (axis, finding) = from_values(axis_kind, values, drift.max(rounding), &label);
            findings.extend(finding);
            if let Some(rate) = options.rate.or(rate).filter(|_| axis.kind == AxisKind::Time)
                && axis.step().is_none_or(|dt| (dt * rate - 1.0).abs() > 1e-6)
            {
                let used = if options.rate.is_some() { "rate" } else { "vector" };
                let found = Finding::caution("vector-against-rate").name("variable", name).name("used", used);
                findings.push(found.number("rate", rate));
            }
            axes.vectors.push(axis);
        }
        Ok(axes)
    }

    /// The axis of a record.
    fn of(&self, values: &Values, name: &str, findings: &mut Vec<Finding>) -> Axis {
        let (n, complex) = (values.len(), matches!(values, Values::Complex(_)));
        let over = |axis: &&Axis| axis.len() == n && !(complex && axis.kind == AxisKind::Time);
        let fitting: Vec<&Axis> = self.vectors.iter().filter(over).collect();
        match (self.options.rate, self.options.base_band) {
            (Some(rate), _) if !complex => {
                let time = fitting.first().filter(|axis| axis.kind == AxisKind::Time);
                return Axis::time(time.map_or(0.0, |axis| axis.start()), 1.0 / rate, n);
            }
            (None, Some(band)) => return Axis::frequency(0.0, band / n.saturating_sub(1).max(1) as f64, n),
            _ => {}
        }
        if fitting.len() > 1 {
            findings.push(Finding::caution("time-or-frequency").name("variable", name));
        }
        match (fitting.first(), self.rate.filter(|_| !complex)) {
            (Some(axis), _) => (*axis).clone(),
            (None, Some(rate)) => Axis::time(0.0, 1.0 / rate, n),
            (None, None) => Axis::index(n),
        }
    }

    /// A vector is one record, a matrix one a column; or one a row, where only the rows have the length of the abscissa.
    fn split(&self, name: String, Array { dimensions, values, .. }: Array) -> Result<Vec<(String, Values)>> {
        let mut long = dimensions.into_iter().filter(|d| *d > 1);
        let (Some(rows), Some(columns)) = (long.next(), long.next()) else {
            return Ok(vec![(name, values)]);
        };
        let has = |n: u64| self.vectors.iter().any(|axis| axis.len() as u64 == n);
        let lying = has(columns) && !has(rows) && rows <= columns.max(MOST_COLUMNS);
        if !lying && columns > rows && columns > MOST_COLUMNS {
            let found =
                format!("{name:?} has {rows} rows and {columns} columns: {columns} records of {rows} values");
            return Err(Error::usage(found, "one channel a column")
                .hint(format!("transpose it and save it again: {name} = {name}.';")));
        }
        let (rows, columns) = (rows as usize, columns as usize);
        let record = |k: usize| {
            let (name, from, step, n) = if lying {
                (format!("{name}({},:)", k + 1), k, rows, columns)
            } else {
                (format!("{name}(:,{})", k + 1), k * rows, 1, rows)
            };
            let values = match &values {
                Values::Real(all) => Values::Real(every(all, from, step, n)),
                Values::Complex(all) => Values::Complex(every(all, from, step, n)),
            };
            (name, values)
        };
        Ok((0..if lying { rows } else { columns }).map(record).collect())
    }
}

pub(super) fn every<T: Copy>(all: &[T], from: usize, step: usize, n: usize) -> Vec<T> {
    all.iter().skip(from).step_by(step).take(n).copied().collect()
}

#[cfg(test)]
mod tests;
