//! MATLAB's level 5 MAT-file (`save -v6` and `-v7`), which scipy writes too.
//!
//! ```text
//! 124 bytes of text, version 0x0100, IM (little endian) or MI (big endian)
//! variable: kind 14, size, then elements: flags, dimensions, name, real part, imaginary part
//! variable: kind 15, size, then the same packed by zlib
//! ```
//! A numeric vector is a record, and so is each column of a matrix; what stands in structs and cell arrays is named as MATLAB writes it:
//! `bearing.gs`, `run(2).v`, `data{1}.x`. Scalars and texts are notes on the records of their struct. The abscissa comes from a vector
//! `t` or `time` (`f`, `freq` or `frequency`) of the same length, or from scalars such as `fs`, `SampleRate`, `dt`, or `Tinterval` and
//! `Tstart` ([`axes`]). The file knows no units, but a struct may state that of its vector (`Unit`).

mod axes;
pub(crate) mod variable;

use super::Source;
use super::format::Format;
use super::missing::{self, Missing};
use super::reader::{Options, Recording};
use crate::assemble::{self, Spectral, to_si};
use axes::{Axes, Scoped};
use num_complex::Complex64;
use variable::{Array, Content};
use vibro_record::units::Unit;
use vibro_record::{Error, Finding, Meta, Place, Record, Result, Values};

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes before the first variable.
const HEADER: usize = 128;
/// More columns than this are taken for a matrix that lies on its side.
const MOST_COLUMNS: u64 = 1000;
/// Notes that a record takes at most: many scalars beside many vectors would fill the memory.
const MOST_NOTES: usize = 200;

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
    let (mut arrays, mut notes) = (Vec::new(), Vec::new());
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
                Values::Real(values) if values.len() == 1 => notes.push((name, values[0].to_string())),
                _ if array.dimensions.iter().filter(|d| **d > 1).count() > 2 => {
                    let found = Finding::note("variable-many-dimensions").name("variable", name);
                    findings.push(found.count("dimensions", array.dimensions.len()));
                }
                _ => arrays.push((name, array)),
            },
        }
    }
    let mut axes = Axes::find(&mut arrays, &notes, options, &mut findings);
    let units = axes::units(&notes, &arrays);
    let mut vectors: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
    vectors.sort_unstable();
    let beside = Scoped::of(notes.iter().map(|note| (axes::scope(&note.0, &vectors), note)));
    let (mut records, mut missing) = (Vec::new(), Missing::default());
    for (name, array) in arrays {
        let unit = units.get(axes::container(&name)).copied();
        for (name, mut values) in split(name, array, &axes, options, &mut findings) {
            for i in missing::mark(&mut values) {
                missing.take(&Place::default(), format!("{} of {name:?}", i + 1));
            }
            records.push((name, values, unit));
        }
    }
    if records.is_empty() {
        return Err(Error::usage("no numeric vector or matrix", "at least one to make a record of"));
    }
    if options.complex && records.iter().all(|(_, values, _)| matches!(values, Values::Real(_))) {
        return Err(Error::usage("no matrix of two columns", "one, for complex values were stated")
            .hint("leave out that values are complex")
            .setting("complex"));
    }
    findings.extend(missing::kept(missing.check("value(s) are NaN or infinite:", options.allow_missing)?));
    if options.unit.is_none() && records.iter().any(|(.., unit)| unit.is_none()) {
        findings.push(Finding::caution("format-without-units"));
    }
    axes.offer(records.iter().map(|(name, values, _)| (name, values)));
    let record = |(name, mut values, unit): (String, Values, Option<&str>)| {
        let mut meta = Meta::new(name, Unit::opaque(""));
        let axis = axes.of(&values, &mut meta, &mut findings)?;
        let notes = beside.over(&meta.name).map(|(_, note)| (*note).clone());
        meta.notes = notes.take(MOST_NOTES).collect();
        meta.step("read", &[("file", &source.name()), ("format", &"mat")]);
        let stated = options.unit.is_some() || unit.is_some();
        let factor = if stated { options.adopt(&mut meta, unit) } else { 1.0 };
        to_si(&mut values, factor)?;
        assemble::record(meta, axis, values, Spectral::default())
    };
    let records = records.into_iter().map(record).collect::<Result<Vec<Record>>>()?;
    Ok(Recording { path: source.path().to_owned(), format: Format::Mat, records, findings })
}

/// A vector is one record, a matrix one a column; or one a row, where only the rows have the length of the abscissa. Where complex values
/// were stated, two columns are one record.
fn split(
    name: String,
    Array { dimensions, values, .. }: Array,
    axes: &Axes,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Vec<(String, Values)> {
    let mut long = dimensions.into_iter().filter(|d| *d > 1);
    let (Some(rows), Some(columns)) = (long.next(), long.next()) else {
        return vec![(name, values)];
    };
    let has = |n: u64| axes.has(&name, n);
    let wide = columns > rows.max(MOST_COLUMNS);
    let pair = options.complex && rows == 2 && columns > 2;
    let lying = !has(rows) && (wide || pair || (has(columns) && rows <= columns.max(MOST_COLUMNS)));
    if lying && !pair && !has(columns) {
        let found = Finding::caution("matrix-by-rows").name("variable", name.as_str());
        findings.push(found.number("rows", rows as f64).number("columns", columns as f64));
    }
    let (rows, columns) = (rows as usize, columns as usize);
    let (n, count) = if lying { (columns, rows) } else { (rows, columns) };
    let (first, step) = if lying { (1, rows) } else { (rows, 1) };
    let part = |k: usize| match &values {
        Values::Real(all) => Values::Real(every(all, k * first, step, n)),
        Values::Complex(all) => Values::Complex(every(all, k * first, step, n)),
    };
    if options.complex
        && count == 2
        && let (Values::Real(re), Values::Real(im)) = (part(0), part(1))
    {
        let pairs = re.into_iter().zip(im).map(|(re, im)| Complex64::new(re, im));
        return vec![(name, Values::Complex(pairs.collect()))];
    }
    let index = |k: usize| if lying { format!("({k},:)") } else { format!("(:,{k})") };
    (0..count).map(|k| (format!("{name}{}", index(k + 1)), part(k))).collect()
}

pub(super) fn every<T: Copy>(all: &[T], from: usize, step: usize, n: usize) -> Vec<T> {
    all.iter().skip(from).step_by(step).take(n).copied().collect()
}

#[cfg(test)]
mod tests;
