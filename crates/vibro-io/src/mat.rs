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

mod variable;

use super::format::Format;
use super::reader::{Options, Recording};
use super::{Source, missing};
use crate::assemble::{self, Spectral, from_values, short, to_si};
use num_complex::Complex64;
use variable::{Array, Content, Elements};
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Place, Record, Result, Values};

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes before the first variable.
const HEADER: usize = 128;
/// More columns than this are taken for a matrix that lies on its side.
const MOST_COLUMNS: u64 = 1000;

/// The levels of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    Four,
    Five { big_endian: bool },
    Hdf5,
}

fn level(head: &[u8], source: &Source) -> Option<Level> {
    match head.get(124..128) {
        Some(b"\0\x01IM") => return Some(Level::Five { big_endian: false }),
        Some(b"\x01\0MI") => return Some(Level::Five { big_endian: true }),
        Some(b"\0\x02IM" | b"\x02\0MI") => return Some(Level::Hdf5),
        _ => {}
    }
    if source.extension() != "mat" {
        return None;
    }
    if head.starts_with(HDF5) || head.get(512..520) == Some(HDF5) {
        return Some(Level::Hdf5);
    }
    // Level 4 has no signature: five words of type, rows, columns, complex or not, length of the name.
    let word = |at: usize| head.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b));
    let words = [word(0)?, word(4)?, word(8)?, word(12)?, word(16)?];
    let plausible = |w: [u32; 5]| w[0] < 5000 && w[0] % 10 <= 2 && w[3] <= 1 && (1..=64).contains(&w[4]);
    (plausible(words) || plausible(words.map(u32::swap_bytes))).then_some(Level::Four)
}

pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    level(head, source).is_some()
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let refuse = |found: &str| {
        Error::input(Place::file(source.path()), found, "a level 5 MAT-file")
            .hint("open it in MATLAB and save it again with -v7 or -v6, e.g. save('name.mat', '-v7')")
    };
    let big_endian = match level(source.head(), source) {
        Some(Level::Five { big_endian }) => big_endian,
        Some(Level::Hdf5) => return Err(refuse("a MAT-file of version 7.3, which is HDF5")),
        Some(Level::Four) => return Err(refuse("a MAT-file of version 4")),
        None => return Err(refuse("no MAT-file header")),
    };
    let bytes = source.all()?;
    let place = Place::file(source.path());
    let variables = variable::all(Elements { rest: &bytes[HEADER..], big_endian, place }, bytes.len())?;
    let mut findings = Vec::new();
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
                _ => arrays.push((name, array)),
            },
        }
    }
    let axes = Axes::find(source, &mut arrays, &rates, options, &mut findings)?;
    let mut records = Vec::new();
    for (name, array) in arrays {
        for (name, values) in axes.split(source, name, array)? {
            records.push((name, values));
        }
    }
    if records.is_empty() {
        let expected = "at least one to make a record of";
        return Err(Error::input(Place::file(source.path()), "no numeric vector or matrix", expected));
    }
    allow(source, &mut records, options, &mut findings)?;
    if options.unit.is_none() {
        findings.push(Finding::caution("format-without-units"));
    }
    let record = |(name, mut values): (String, Values)| {
        let axis = axes.of(&values, &name, &mut findings);
        let mut meta = Meta::new(name, Unit::opaque(""));
        meta.notes.clone_from(&notes);
        meta.step("read", &[("file", &source.name()), ("format", &"mat")]);
        let factor = options.unit.as_ref().map_or(1.0, |unit| meta.adopt_unit(unit.symbol()));
        to_si(&mut values, factor).map_err(|e| e.in_file(source.path()))?;
        if axis.kind == AxisKind::Index {
            meta.found(Finding::caution("abscissa-unsaid"));
        }
        Ok(assemble::record(meta, axis, values, Spectral::default()))
    };
    let records = records.into_iter().map(record).collect::<Result<Vec<Record>>>()?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Mat, records, findings })
}

/// Makes values that are not finite missing, or refuses them all at once.
fn allow(
    source: &Source,
    records: &mut [(String, Values)],
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    let mut missing = Vec::new();
    for (name, values) in records {
        for i in 0..values.len() {
            let odd = match values {
                Values::Real(values) => {
                    Some(&mut values[i]).filter(|v| !v.is_finite()).map(|v| *v = f64::NAN)
                }
                Values::Complex(values) => {
                    let gap = Complex64::new(f64::NAN, f64::NAN);
                    Some(&mut values[i]).filter(|v| !v.is_finite()).map(|v| *v = gap)
                }
            };
            missing.extend(odd.map(|()| format!("{} of {name:?}", i + 1)));
        }
    }
    findings.extend(missing::kept(missing.len()));
    if missing.is_empty() || options.allow_missing {
        return Ok(());
    }
    let more = if missing.len() > missing::LISTED { ", …" } else { "" };
    let first = missing[..missing.len().min(missing::LISTED)].join(", ");
    let found = format!("{} value(s) are NaN or infinite: {first}{more}", missing.len());
    Err(missing::refusal(Place::file(source.path()), found))
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
    time: Option<Axis>,
    frequency: Option<Axis>,
    rate: Option<f64>,
}

impl<'a> Axes<'a> {
    /// Takes the rising vectors named as abscissae out of `arrays` where another array has their length.
    fn find(
        source: &Source,
        arrays: &mut Vec<(String, Array)>,
        rates: &[(String, f64)],
        options: &'a Options,
        findings: &mut Vec<Finding>,
    ) -> Result<Axes<'a>> {
        let rate = rates.first().map(|(_, rate)| *rate);
        let mut axes = Axes { options, time: None, frequency: None, rate };
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
            let (name, Array { real: values, single, .. }) = arrays.remove(at);
            let (first, last) = (values[0], values[values.len() - 1]);
            // Sums of steps drift by rounding: a millionth of a step is no unevenness. Floats of 32 bits round to 2⁻²⁴.
            let drift = 0.5e-6 * (last - first) / (values.len() - 1).max(1) as f64;
            let rounding =
                if single { first.abs().max(last.abs()) * f64::from(f32::EPSILON) / 2.0 } else { 0.0 };
            let label = format!("vector {name:?}");
            let (axis, finding) = from_values(axis_kind.clone(), values, drift.max(rounding), &label);
            findings.extend(finding);
            if axis_kind == AxisKind::Frequency {
                axes.frequency = Some(axis);
                continue;
            }
            if let Some(rate) = options.rate.or(axes.rate)
                && axis.step().is_none_or(|dt| (dt * rate - 1.0).abs() > 1e-6)
            {
                let used = if options.rate.is_some() { "rate" } else { "vector" };
                let found = Finding::caution("vector-against-rate").name("variable", name).name("used", used);
                findings.push(found.number("rate", rate));
            }
            axes.time = Some(axis);
        }
        Ok(axes)
    }

    /// The axis of a record.
    fn of(&self, values: &Values, name: &str, findings: &mut Vec<Finding>) -> Axis {
        let (n, complex) = (values.len(), matches!(values, Values::Complex(_)));
        let time = self.time.as_ref().filter(|t| t.len() == n && !complex);
        let frequency = self.frequency.as_ref().filter(|f| f.len() == n);
        match (self.options.rate, self.options.base_band) {
            (Some(rate), _) if !complex => return Axis::time(time.map_or(0.0, Axis::start), 1.0 / rate, n),
            (None, Some(band)) => return Axis::frequency(0.0, band / n.saturating_sub(1).max(1) as f64, n),
            _ => {}
        }
        if time.is_some() && frequency.is_some() {
            findings.push(Finding::caution("time-or-frequency").name("variable", name));
        }
        match (time.or(frequency), self.rate.filter(|_| !complex)) {
            (Some(axis), _) => axis.clone(),
            (None, Some(rate)) => Axis::time(0.0, 1.0 / rate, n),
            (None, None) => Axis::index(n),
        }
    }

    fn has(&self, n: u64) -> bool {
        [&self.time, &self.frequency].into_iter().flatten().any(|axis| axis.len() as u64 == n)
    }

    /// A vector is one record, a matrix one a column; or one a row, where only the rows have the length of the abscissa.
    fn split(&self, source: &Source, name: String, array: Array) -> Result<Vec<(String, Values)>> {
        let values = match &array.imaginary {
            None => Values::Real(array.real),
            Some(imaginary) => {
                let pairs = array.real.iter().zip(imaginary);
                Values::Complex(pairs.map(|(re, im)| Complex64::new(*re, *im)).collect())
            }
        };
        let mut long = array.dimensions.iter().copied().filter(|d| *d > 1);
        let (Some(rows), Some(columns)) = (long.next(), long.next()) else {
            return Ok(vec![(name, values)]);
        };
        let lying = self.has(columns) && !self.has(rows) && rows <= columns.max(MOST_COLUMNS);
        if !lying && columns > rows && columns > MOST_COLUMNS {
            return Err(Error::input(
                Place::file(source.path()),
                format!("{name:?} has {rows} rows and {columns} columns: {columns} records of {rows} values"),
                "one channel a column",
            )
            .hint(format!("transpose it and save it again: {name} = {name}.';")));
        }
        let (rows, columns) = (rows as usize, columns as usize);
        // Value i of record k is `from(k)` plus i times `step`.
        let (records, n, step) = if lying { (rows, columns, rows) } else { (columns, rows, 1) };
        let part = |k: usize| {
            let from = if lying { k } else { k * rows };
            let name = if lying { format!("{name}({},:)", k + 1) } else { format!("{name}(:,{})", k + 1) };
            let cut = match &values {
                Values::Real(all) => {
                    Values::Real(all.iter().skip(from).step_by(step).take(n).copied().collect())
                }
                Values::Complex(all) => {
                    Values::Complex(all.iter().skip(from).step_by(step).take(n).copied().collect())
                }
            };
            (name, cut)
        };
        Ok((0..records).map(part).collect())
    }
}

#[cfg(test)]
mod tests;
