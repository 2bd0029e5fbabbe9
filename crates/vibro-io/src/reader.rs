//! The reader: options, then a path or bytes, then records.

use super::assemble::domain;
use super::held::Contents;
use super::missing::LISTED;
use super::options::{Options, POSSIBLE};
use super::registry::{Entry, TABLE};
use crate::folder::Folder;
use crate::format::Format;
use crate::limit::Limit;
use crate::recording::Recording;
use crate::source::Source;
use crate::sweep_list::SweepList;
use crate::{foreign, level, magnitude, packed, span, text};
use rayon::prelude::*;
use std::io::Read;
use std::path::{Path, PathBuf};
use vibro_record::lanes::Extremes;
use vibro_record::units::Unit;
use vibro_record::{AxisKind, Error, Finding, Meta, Place, RATE_OVER_BASE_BAND, Record, Result};

/// Reads measurement files of any known format.
#[derive(Debug, Clone, Default)]
pub struct Reader {
    format: Option<Format>,
    folder: Folder,
    pub(super) options: Options,
}

impl Reader {
    /// A reader that detects the format and refuses missing values.
    pub fn new() -> Reader {
        Reader::default()
    }

    /// Sets the folder of all paths, on the disk or in memory. Default: on the disk.
    pub fn within(mut self, folder: &Folder) -> Reader {
        self.folder = folder.clone();
        self
    }

    /// Opens a file of the reader's folder, or a part of an archive or workbook (`walk.zip/Gyroscope.csv`).
    ///
    /// # Errors
    /// As [`packed::file_or_part`].
    pub(super) fn source(&self, path: impl AsRef<Path>) -> Result<Source> {
        packed::file_or_part(&self.folder, path.as_ref(), self.options.limit)
    }

    /// Paths of the tables of an archive or a workbook that holds several of comparable length, so that one
    /// must be named; empty for every other file.
    ///
    /// # Errors
    /// If it cannot be opened or unpacked.
    pub fn parts(&self, path: impl AsRef<Path>) -> Result<Vec<PathBuf>> {
        packed::alike(&self.source(path)?, self.options.limit)
    }

    /// Forces a format. Default: detected from the first bytes.
    pub fn format(mut self, format: Option<Format>) -> Reader {
        self.format = format;
        self
    }

    /// Keeps NaN, Inf, over-range words and blanks as missing values. Default: they are refused with their
    /// line numbers.
    pub fn allow_missing(mut self, allow: bool) -> Reader {
        self.options.allow_missing = allow;
        self
    }

    /// States the sampling rate in Hz. Default: the file's, else the abscissa is the sample number.
    pub fn rate(mut self, rate: Option<f64>) -> Reader {
        self.options.rate = rate;
        self
    }

    /// States the base band in Hz of a spectrum. Default: the file's.
    pub fn base_band(mut self, base_band: Option<f64>) -> Reader {
        self.options.base_band = base_band;
        self
    }

    /// Turns a stated base band into the sampling rate of a time trace: 2.56 times the base band, as
    /// analysers sample. A stated rate takes precedence. A text of spectral lines stays a spectrum.
    /// Default: a base band means a spectrum.
    pub fn rate_of_base_band(mut self) -> Reader {
        self.options.rate_of_band = self.options.base_band.take().filter(|_| self.options.rate.is_none());
        self.options.rate =
            self.options.rate.or(self.options.rate_of_band.map(|band| RATE_OVER_BASE_BAND * band));
        self
    }

    /// States the unit of the values. Default: the file's.
    pub fn unit(mut self, unit: Option<Unit>) -> Reader {
        self.options.unit = unit;
        self
    }

    /// States the units of single channels, each by its name or by its number from 1. They take precedence
    /// over [`Reader::unit`]. Default: none.
    pub fn channel_units(mut self, units: Vec<(String, Unit)>) -> Reader {
        self.options.channel_units = units;
        self
    }

    /// States whether a comma is the decimal mark. Default: detected; an ambiguous file is refused.
    pub fn decimal_comma(mut self, comma: Option<bool>) -> Reader {
        self.options.decimal_comma = comma;
        self
    }

    /// States that two value columns are real and imaginary part. Default: only where a header says so.
    pub fn complex(mut self, complex: bool) -> Reader {
        self.options.complex = complex;
        self
    }

    /// States whether rows of several columns continue each other as one series. Default: as the header
    /// states. Without such a header, rows that look continued are refused.
    pub fn wrapped(mut self, wrapped: Option<bool>) -> Reader {
        self.options.wrapped = wrapped;
        self
    }

    /// States the unit of the times or frequencies of a text whose column names none, such as ms or kHz.
    /// Default: s or Hz, with a finding.
    ///
    /// # Errors
    /// If it is no unit of time or frequency.
    pub fn axis_unit(mut self, unit: Option<&str>) -> Result<Reader> {
        self.options.axis_unit = unit.map(text::axis_unit).transpose()?;
        Ok(self)
    }

    /// States the part of time traces that is read, in s: from the first time (included) to the second
    /// (excluded). Default: all.
    pub fn span(mut self, span: Option<(f64, f64)>) -> Reader {
        self.options.span = span;
        self
    }

    /// Keeps only the even stretch with this number, from 1, of traces with gaps. Default: all samples; a
    /// trace with gaps then has no sampling rate.
    pub fn stretch(mut self, stretch: Option<usize>) -> Reader {
        self.options.stretch = stretch;
        self
    }

    /// Resamples traces to this rate in Hz by interpolation. Default: samples keep their own times.
    pub fn resample(mut self, rate: Option<f64>) -> Reader {
        self.options.resample = rate;
        self
    }

    /// Limits the memory for values. Default: see [`Limit`].
    pub fn max_memory(mut self, limit: Limit) -> Reader {
        self.options.limit = limit;
        self
    }

    /// States the memory for results computed from the values, as a multiple of the values' own size: it
    /// counts towards the memory limit. Default: 0.
    pub fn beside(mut self, times: f64) -> Reader {
        self.options.beside = times;
        self
    }

    /// Names the channels whose values are needed, by name or number from 1; other channels may be returned
    /// without values. Default: all.
    pub fn only(mut self, channels: impl IntoIterator<Item = String>) -> Reader {
        self.options.only = channels.into_iter().collect();
        self
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be opened, is of no known format, or its content is not what its format requires.
    pub fn from_path(&self, path: impl AsRef<Path>) -> Result<Recording> {
        self.read(&self.source(path)?)
    }

    /// Reads many files, in parallel, in the order given.
    ///
    /// # Errors
    /// As [`Reader::from_path`], for the first file that fails. If several files fail because of their
    /// content, the error also names the others.
    pub fn from_paths<P: AsRef<Path> + Sync>(&self, paths: &[P]) -> Result<Vec<Recording>> {
        let results: Vec<Result<Recording>> = paths.par_iter().map(|p| self.from_path(p)).collect();
        let failed = paths.iter().zip(&results).filter(|(_, result)| result.is_err());
        let name = |path: &P| path.as_ref().file_name().map(|name| name.to_string_lossy().into_owned());
        let mut names: Vec<String> = failed.filter_map(|(path, _)| name(path)).collect();
        let n = names.len();
        if n > LISTED {
            names.truncate(LISTED);
            names.push("…".to_owned());
        }
        let many = format!("{n} of {} files cannot be read so: {}", paths.len(), names.join(", "));
        let whole: Result<Vec<Recording>> = results.into_iter().collect();
        whole.map_err(|error| if n > 1 { error.aside(many) } else { error })
    }

    /// Reads bytes; `name` is the path shown in messages, and helps to detect the format.
    ///
    /// # Errors
    /// As [`Reader::from_path`].
    pub fn from_reader(&self, name: impl Into<PathBuf>, mut reader: impl Read) -> Result<Recording> {
        let name = name.into();
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).map_err(|e| Error::io("read", &name, e))?;
        self.read(&Source::memory(name, bytes)?)
    }

    /// Reads a source.
    ///
    /// # Errors
    /// As [`Reader::from_path`].
    pub(crate) fn read(&self, source: &Source) -> Result<Recording> {
        let (format, Contents { records, findings }) = self.contents(source, false)?;
        let records = records.into_iter().map(|(record, _)| record).collect();
        Ok(Recording { path: source.path().to_owned(), format, records, findings })
    }

    /// Headers of the records of a file, without values. If the format allows, memory use does not grow
    /// with the file.
    ///
    /// # Errors
    /// As [`Reader::from_path`].
    pub fn survey(&self, path: impl AsRef<Path>) -> Result<(Format, Vec<Header>, Vec<Finding>)> {
        self.headers(&self.source(path)?)
    }

    /// As [`Reader::survey`], of a source.
    pub(crate) fn headers(&self, source: &Source) -> Result<(Format, Vec<Header>, Vec<Finding>)> {
        let (format, Contents { records, findings }) = self.contents(source, true)?;
        let header = |(record, summary): &(Record, Option<Extremes>)| {
            summary.as_ref().map_or_else(|| Header::of(record), |summary| Header::with(record, summary))
        };
        Ok((format, records.par_iter().map(header).collect(), findings))
    }

    fn contents(&self, source: &Source, survey: bool) -> Result<(Format, Contents)> {
        if let Some((part, found)) = packed::main_part(source, self.options.limit)? {
            let (format, mut contents) = self.contents_of(&part, survey)?;
            contents.findings.extend(found);
            return Ok((format, contents));
        }
        self.contents_of(source, survey)
    }

    fn contents_of(&self, source: &Source, survey: bool) -> Result<(Format, Contents)> {
        let entry = self.entry(source)?;
        let room = self.options.limit.hold(if entry.whole { 2.0 * source.len() as f64 } else { 0.0 });
        // The wave reader already reads only the span.
        let span = self.options.span.filter(|_| entry.format != Format::Wav);
        let read = |survey| {
            (entry.read)(source, &self.options, survey)?.with_stated_units(source.path(), &self.options)
        };
        let changes = span.is_some() || self.options.stretch.is_some() || self.options.resample.is_some();
        let contents = room.and_then(|()| read(survey && !changes)).and_then(|all| {
            let mut all = if level::needs_values(&all) { read(false)? } else { all };
            all.findings.extend(packed::percent(source));
            magnitude::mark(&mut all);
            level::levels_to_amplitudes(
                span::cut(all.with_even_axes(&self.options)?, span)?,
                entry.format,
                &self.options,
            )
        });
        let format = if source.is_sheet() { Format::Workbook } else { entry.format };
        let placed =
            |e| no_list(source, e).in_cell(|line, column| source.cell(line, column)).in_file(source.path());
        Ok((format, contents.map_err(placed)?))
    }

    /// The table entry for a source's format, forced or detected. Impossible spans, rates and base bands are
    /// refused.
    pub(super) fn entry(&self, source: &Source) -> Result<&'static Entry> {
        if let Some((from, to)) =
            self.options.span.filter(|(from, to)| from.is_nan() || from >= to || to.is_nan())
        {
            let found = format!("a part from {from} to {to} s was stated");
            return Err(Error::usage(found, "a time, and a later one").setting("span"));
        }
        for (what, value) in [("sampling rate", self.options.rate), ("base band", self.options.base_band)] {
            if let Some(value) = value.filter(|v| !POSSIBLE.contains(v)) {
                let found = format!("a {what} of {value} Hz was stated");
                return Err(Error::input(Place::file(source.path()), found, "a possible number of hertz"));
            }
        }
        if let Some(foreign) = foreign::complaint(source).filter(|_| self.format.is_none()) {
            return Err(foreign);
        }
        let forced = self.format.and_then(|format| TABLE.iter().find(|e| e.format == format));
        forced.or_else(|| Entry::of(source)).ok_or_else(|| {
            let names = Format::names().join(", ");
            Error::input(Place::file(source.path()), "not a format that is known here", names)
                .hint("name the format, or export the record as text or UFF-58")
                .setting("format")
        })
    }
}

/// Largest file in bytes that is tried as a sweep list: 10 000 points of about 100 bytes.
const LONGEST_LIST: u64 = 1 << 20;

/// Adds to a reading `error` that the file is a sweep list, if it is one: a list is easily taken for a
/// measurement.
fn no_list(source: &Source, error: Error) -> Error {
    let short = source.len() <= LONGEST_LIST;
    let Some(list) = short.then(|| SweepList::of(source)).flatten() else { return error };
    let (points, lines, band) = (list.len(), list.lines, list.base_band);
    error
        .aside(format!("this reads as the list of a sweep: {points} points, {lines} lines to {band} Hz"))
        .hint("give the list to `vibro response`, or name the files that stand in it")
}

/// One record of a file, without its values.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Header {
    /// Channel or record name.
    pub name: String,
    /// `trace`, `spectrum` or `frf`.
    pub kind: &'static str,
    /// Quantity by name.
    pub quantity: &'static str,
    /// SI unit.
    pub unit: String,
    /// Number of values present.
    pub n: usize,
    /// Number of values that the file declares.
    pub declared_n: Option<usize>,
    /// First abscissa value, in `x_unit`.
    pub x0: f64,
    /// `s` or `Hz`; empty if the file does not state the kind of abscissa.
    pub x_unit: &'static str,
    /// Step of the abscissa, in `x_unit`; `None` if uneven.
    pub dx: Option<f64>,
    /// Sampling rate in Hz of an even time axis.
    pub rate: Option<f64>,
    /// Duration in s of an even time axis.
    pub duration: Option<f64>,
    /// Whether values are complex.
    pub complex: bool,
    /// Smallest value, in SI units; `None` for complex values, and if `max_abs` is `None`.
    pub min: Option<f64>,
    /// Largest value, in SI units; `None` as for `min`.
    pub max: Option<f64>,
    /// Largest magnitude in SI units; `None` if the values were not read or are all missing.
    pub max_abs: Option<f64>,
    /// Abscissa of the largest magnitude.
    pub max_at: Option<f64>,
    /// Header lines that were kept but not interpreted; for text files also the encoding and the decimal
    /// mark.
    pub notes: Vec<String>,
    /// Findings on the record: what the user must know before trusting its values.
    pub findings: Vec<Finding>,
}

impl Header {
    /// Header of a record that is in memory.
    pub fn of(record: &Record) -> Header {
        Header::with(record, &record.extremes())
    }

    /// Header of a record whose values have these extremes; the values themselves may have been dropped.
    pub(super) fn with(record: &Record, extremes: &Extremes) -> Header {
        let (meta, axis, largest) = (record.meta(), record.axis(), extremes.largest());
        let range = extremes.range().filter(|_| !record.is_complex());
        let step = axis.step().filter(|_| axis.kind == AxisKind::Time);
        Header {
            rate: step.map(|step| 1.0 / step),
            duration: step.map(|step| step * axis.len() as f64),
            min: range.map(|(min, _)| min),
            max: range.map(|(_, max)| max),
            name: meta.name.clone(),
            kind: record.kind(),
            quantity: meta.quantity.name(),
            unit: meta.unit.symbol().to_owned(),
            n: record.len(),
            declared_n: meta.declared_n,
            x0: axis.start(),
            x_unit: domain(&axis.kind).1,
            dx: axis.step(),
            complex: record.is_complex(),
            max_abs: largest.map(|(_, m)| m),
            max_at: largest.map(|(i, _)| axis.at(i)),
            notes: notes(meta),
            findings: meta.findings.clone(),
        }
    }
}

/// Header lines, then encoding and decimal mark from the history step `read`.
fn notes(meta: &Meta) -> Vec<String> {
    let how = meta.history.iter().filter(|step| step.name == "read").flat_map(|step| &step.arguments);
    let how = how.filter(|(key, _)| matches!(key.as_str(), "encoding" | "decimal mark"));
    let line = |(key, value): &(String, String)| {
        if key.is_empty() { value.clone() } else { format!("{key}: {value}") }
    };
    meta.notes.iter().chain(how).map(line).collect()
}
