//! Spectra of time records, and frequency response functions of two channels: `[[spectrum]]`, `vibro
//! spectrum`.

pub mod figures;

use super::answer::Answer;
use super::headline::headline;
use super::job::Job;
use super::kind::{Analysis, OfFile, named_in, no_file};
use super::source::Source;
use crate::campaign::{Campaign, Entry, KeyRange, channel};
use crate::error::{Error, Result};
use crate::measure::spectral::{Lines, Method, SpectralOptions, SpectralResult, spectral, stored};
use crate::read::Header;
use crate::record::{
    Finding, Scaling, Traces, Window, doubt_with_record, find_channel, shown, sort_by_number,
};
use crate::report::files::Names;
use crate::report::layout::{degrees, headed, table};
use crate::report::{Cell, Table, files};
use crate::signal::transfer::Estimator;
use serde::Deserialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// How a spectrum is taken, or the function of two channels.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// One transform of the whole record, fft, or the average over segments, welch [default: welch; fft with
    /// tones]
    #[cfg_attr(feature = "cli", arg(value_name = "METHOD", value_parser = crate::campaign::word::<Method>))]
    pub method: Option<Method>,
    /// Fit the N strongest sines of the whole record, 1 to 10: frequency, amplitude and phase with their
    /// uncertainties
    pub tones: Option<usize>,
    /// Samples of a segment [default: 8192, or the whole of a shorter record; for blows, set by their
    /// ringing and spacing]
    pub segment: Option<usize>,
    /// Overlap of the segments, 0 to below 1 [default: 0.5]
    pub overlap: Option<f64>,
    /// Removed before the window: mean or none [default: mean with welch or an integration, else none]
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<Detrend>))]
    pub detrend: Option<Detrend>,
    /// Window: hann, rectangular, hamming, blackman, blackman-harris, flat-top [default: hann]
    #[cfg_attr(feature = "cli", arg(value_name = "NAME", value_parser = crate::campaign::word::<Window>))]
    pub window: Option<Window>,
    /// Scaling of the lines: peak, rms, power or psd [default: peak]
    #[cfg_attr(feature = "cli", arg(value_name = "NAME", value_parser = crate::campaign::word::<Scaling>))]
    pub scaling: Option<Scaling>,
    /// Integrations in frequency: 1 takes velocity to displacement, −1 to acceleration [default: 0]
    #[cfg_attr(feature = "cli", arg(value_parser = crate::record::kind::whole::<i8, -2, 2>))]
    pub integrate: Option<i8>,
    /// Lowest frequency of the result, in Hz [default: two lines where integrated, else 0]
    pub fmin: Option<f64>,
    /// Channel of the excitation, or FILE#CHANNEL, for the frequency response function
    #[serde(deserialize_with = "channel")]
    pub reference: Option<String>,
    /// FRF estimator: h1 for noise in the response, h2 for noise in the excitation, hv for noise in both
    /// [default: h1]
    #[cfg_attr(feature = "cli", arg(value_name = "NAME", value_parser = crate::campaign::word::<Estimator>))]
    pub estimator: Option<Estimator>,
    /// Hammer test: one segment for each blow; the level before the blow is removed
    pub hammer: bool,
    /// Width of the force window in s [default: ten contact times, 64 samples at least]
    pub force_window: Option<f64>,
    /// Value of the exponential window at the end of a segment, e.g. 0.01
    pub left_at_end: Option<f64>,
    /// Channel delay to remove, in s: the channel was recorded later than the reference
    pub delay: Option<f64>,
    /// Give levels in decibels over this reference, in SI units of the channel: 1, or 1e-6 for 1 µm/s²
    pub decibel: Option<f64>,
}

/// Trend that is removed from a segment before the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Detrend {
    /// Nothing.
    None,
    /// Its mean.
    Mean,
}

impl Keys {
    /// The options of the estimator.
    ///
    /// # Errors
    /// If keys contradict each other or a value is impossible.
    pub fn options(&self) -> Result<SpectralOptions> {
        if self.estimator.is_some() && self.reference.is_none() {
            let expected = "the channel of the excitation as reference";
            return Err(Error::usage("estimator without a reference", expected).setting("estimator"));
        }
        let options = self.unchecked();
        options.check()?;
        Ok(options)
    }

    /// The options of the estimator, without a check for contradictions.
    pub(crate) fn unchecked(&self) -> SpectralOptions {
        SpectralOptions {
            method: self.method,
            segment: self.segment,
            overlap: self.overlap,
            detrend: self.detrend.map(|d| d == Detrend::Mean),
            window: self.window,
            scaling: self.scaling,
            integrate: self.integrate.unwrap_or(0),
            fmin: self.fmin,
            estimator: self.reference.as_ref().map(|_| self.estimator.unwrap_or(Estimator::H1)),
            hammer: self.hammer,
            force_window: self.force_window,
            left_at_end: self.left_at_end,
            delay: self.delay,
            decibel: self.decibel,
            tones: self.tones,
        }
    }

    /// Spectral lines of a record, or of the spectrum that a file stores.
    ///
    /// # Errors
    /// If the file cannot be read, or the record allows no answer.
    pub fn lines(&self, source: &Source<'_>) -> Result<SpectralResult> {
        let options = self.options()?;
        let traces = match self.traces(source) {
            Ok(traces) => traces,
            // A stated base band then belongs to the stored lines and gives no sampling rate.
            Err(why) => match source.reader()?.survey(source.path) {
                Ok((_, headers, _)) if is_of_spectra(source, &headers) => {
                    return stored_lines(source, &options);
                }
                Err(other) if source.reading.base_band.is_some() => return Err(other),
                _ => return Err(why),
            },
        };
        self.lines_of(traces, source)
    }

    /// Spectral lines of traces.
    ///
    /// # Errors
    /// If the traces allow no answer.
    pub fn lines_of(&self, mut traces: Traces, source: &Source<'_>) -> Result<SpectralResult> {
        let all = traces.frames();
        let mut found = spectral(&mut traces, &self.options()?, |done| source.progress.at(done, all))?;
        doubt_with_record(&traces.findings(), &mut found);
        Ok(found)
    }
}

/// The spectral lines that a file stores.
fn stored_lines(source: &Source<'_>, options: &SpectralOptions) -> Result<SpectralResult> {
    if let Some(factor) = source.channel.calibration {
        let found = format!("a calibration of {factor} of a spectrum that the file holds");
        return Err(Error::usage(found, "the unit of its lines").setting("calibration").setting("unit"));
    }
    let all = source.reader()?.from_path(source.path)?;
    let spectrum = all.spectrum(source.channel.channel.as_deref())?;
    let mut found = stored(spectrum, options)?;
    doubt_with_record(all.findings.iter().chain(&spectrum.meta.findings), &mut found);
    found.findings.extend(all.findings);
    Ok(found)
}

/// Whether a file stores spectra and no traces, or the named channel is a spectrum.
fn is_of_spectra(source: &Source<'_>, headers: &[Header]) -> bool {
    let records_of = |kind| headers.iter().filter(move |header| header.kind == kind);
    if records_of("trace").next().is_none() {
        return records_of("spectrum").next().is_some();
    }
    let spectra = records_of("spectrum").map(|header| (header.name.as_str(), header.quantity));
    let named = source.channel.channel.as_deref().filter(|name| name.parse::<usize>().is_err());
    named.is_some_and(|name| find_channel(source.path, name, spectra).is_ok())
}

impl Keys {
    /// Traces of a record: first its reference, if any, which may lie in another file, then the channel.
    ///
    /// # Errors
    /// If a file cannot be read, or two differ in rate, length or begin.
    pub(super) fn traces(&self, source: &Source<'_>) -> Result<Traces> {
        let reader = source.reader()?.rate_of_base_band();
        let (channel, reference) = (source.channel, self.reference.as_deref());
        let elsewhere = reference.and_then(in_other_file);
        let elsewhere =
            elsewhere.and_then(|(file, name)| Some(((source.beside)("reference", file).ok()?, name)));
        let Some((file, name)) = elsewhere.filter(|(file, _)| source.folder.exists(file)) else {
            let (named, factor) = (channel.channel.as_deref(), channel.calibration);
            return match reference.filter(|_| self.hammer) {
                Some(reference) => reader.stream_repeated(source.path, reference, named, factor),
                None => reader.stream_chosen(source.path, reference, named, factor),
            };
        };
        let reference_recording = reader.from_path(&file)?;
        let force = reference_recording.trace(Some(name), None)?;
        let recording = reader.from_path(source.path)?;
        let response = source.trace(&recording)?;
        let findings = [reference_recording.findings, recording.findings].concat();
        let traces = Traces::of_file(source.path.to_owned(), findings, vec![force, response]);
        traces.map_err(|error| error.aside(format!("reference in {}", shown(&file))))
    }
}

/// File and channel of `FILE#CHANNEL`, such as a reference in another file.
pub(crate) fn in_other_file(reference: &str) -> Option<(&Path, &str)> {
    let (file, channel) = reference.rsplit_once('#')?;
    let file = Path::new(file);
    file.extension().map(|_| (file, channel))
}

/// The files of a table, and the file of its reference.
///
/// # Errors
/// If one leads outside the folder or does not exist.
pub(super) fn with_reference<A: Analysis>(
    campaign: &Campaign,
    entry: &Entry<A>,
    reference: Option<&String>,
) -> Result<Vec<PathBuf>> {
    let mut files = named_in(campaign, entry)?;
    if let Some((file, _)) = reference.and_then(|reference| in_other_file(reference)) {
        files.push(campaign.file(entry, "reference", file)?);
    }
    Ok(files)
}

/// The reference, if it is a channel of the record's own file.
pub(super) fn own_reference(reference: Option<&String>) -> Vec<(&'static str, &String)> {
    let in_this_file = reference.filter(|reference| in_other_file(reference).is_none());
    in_this_file.into_iter().map(|name| ("reference", name)).collect()
}

impl OfFile for Keys {
    /// The lines of a record, with their figure, tables and files.
    fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        let mut found = self.lines(source)?;
        let is_spectrum = matches!(found.found, Lines::Spectrum(_)) && found.tones.is_empty();
        let main_peaks = if is_spectrum { found.peaks(MAIN_PEAKS) } else { Vec::new() };
        if is_spectrum && main_peaks.is_empty() {
            found.findings.push(Finding::caution("spectrum-without-lines"));
        }
        let mut answer = Answer::of(&found)?;
        answer.result.insert("channel".to_owned(), found.name.clone().into());
        answer.add("", &found.findings);
        answer.headlines.push(headline(
            "Tones",
            &found.tones,
            &[
                ("frequency", "Hz", &|tone| Cell::from(&tone.frequency)),
                ("amplitude", "", &|tone| Cell::from(&tone.amplitude)),
                ("unit", "", &|tone| Cell::from(tone.amplitude.unit)),
            ],
        ));
        let amplitude = match reads_low(&found) {
            Some(low) => format!("amplitude (of a sine up to {low} low)"),
            None => "amplitude".to_owned(),
        };
        answer.headlines.push(headline(
            "Largest spectral lines",
            main_peaks,
            &[
                ("frequency", "Hz", &|k| frequency_of(&found, *k)),
                (amplitude.as_str(), "", &|k| value_of(&found, *k)),
                ("unit", "", &|_| Cell::from(found.unit.as_str())),
            ],
        ));
        answer.tables = vec![peaks(source.name, &found), tones(source.name, &found)];
        answer.details.push(settings_table([(found.name.as_str(), &found)]));
        let name = if self.reference.is_some() { "frf" } else { "spectrum" };
        answer.figure(name, figures::lines(source.name, &found));
        answer.figure("argand_frf", figures::argand(source.name, &found));
        let (files, unwritten) = files::records(name, &found.records())?;
        answer.files = files;
        answer.add("", unwritten);
        Ok(answer)
    }
}

/// Compares spectra or functions of several records: one figure, and one table with the peaks of all.
///
/// # Errors
/// If their units or scalings differ.
pub fn compared(found: &[(String, SpectralResult)]) -> Result<Answer> {
    let mut answer = Answer::default();
    let Some((first, like)) = found.first() else { return Ok(answer) };
    let mut spectra = Vec::new();
    // The name `peaks` is kept for the table of common peaks.
    let slugs = files::slugs(std::iter::once("peaks").chain(found.iter().map(|(name, _)| name.as_str())));
    for ((name, result), slug) in found.iter().zip(&slugs[1..]) {
        let ordinate = |of: &SpectralResult| format!("{} ({})", of.unit, of.scaling);
        if ordinate(result) != ordinate(like) {
            let found = format!("{first} in {}, {name} in {}", ordinate(like), ordinate(result));
            return Err(Error::usage(found, "spectra of one quantity, unit and scaling"));
        }
        let mut one = Answer::of(result)?;
        one.result.insert("name".to_owned(), name.as_str().into());
        one.result.insert("channel".to_owned(), result.name.as_str().into());
        spectra.push(Value::Object(std::mem::take(&mut one.result)));
        one.add(name, &result.findings);
        one.tables.push(tones(name, result));
        let (files, unwritten) = files::records(&format!("{}_{slug}", kind(result)), &result.records())?;
        one.files = files;
        one.add(name, unwritten);
        answer.append(one);
    }
    answer.result.insert("spectra".to_owned(), spectra.into());
    answer.table(&format!("{}_peaks", kind(like)), common_peaks(found));
    answer.details.push(settings_table(found.iter().map(|(name, result)| (name.as_str(), result))));
    answer.figure(kind(like), figures::together(found));
    Ok(answer)
}

/// Start of the names of files of a result.
fn kind(result: &SpectralResult) -> &'static str {
    if matches!(result.found, Lines::Transfer(_)) { "frf" } else { "spectrum" }
}

/// Largest peaks of several spectra. Peaks of different spectra share a row if they are at most 1.5 line
/// spacings of the coarsest spectrum apart; the nearest pairs are joined first.
fn common_peaks(found: &[(String, SpectralResult)]) -> Table {
    let spacing = |result: &SpectralResult| result.frequency.windows(2).next().map_or(0.0, |w| w[1] - w[0]);
    let near = 1.5 * found.iter().map(|(_, result)| spacing(result)).fold(0.0, f64::max);
    let mut peaks: Vec<(f64, usize, usize)> = Vec::new();
    for (record, (_, result)) in found.iter().enumerate() {
        peaks.extend(result.peaks(SHOWN_PEAKS).into_iter().map(|k| (result.frequency[k], record, k)));
    }
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in peaks.iter().enumerate() {
        let others = peaks.iter().enumerate().skip(i + 1);
        pairs.extend(others.map(|(j, b)| ((a.0 - b.0).abs(), i, j)).filter(|pair| pair.0 <= near));
    }
    sort_by_number(&mut pairs, |a| a.0);
    // Each peak is a row of its own until it joins another; `rows` holds indices of peaks.
    let mut rows: Vec<Vec<usize>> = (0..peaks.len()).map(|i| vec![i]).collect();
    for (_, i, j) in pairs {
        let row_of = |peak| rows.iter().position(|row| row.contains(&peak));
        let (Some(one), Some(other)) = (row_of(i), row_of(j)) else { continue };
        let records = |row: usize| rows[row].iter().map(|k| peaks[*k].1);
        if one != other && !records(one).any(|record| records(other).any(|r| r == record)) {
            let joined = std::mem::take(&mut rows[other]);
            rows[one].extend(joined);
        }
    }
    rows.retain(|row| !row.is_empty());
    let lowest = |row: &[usize]| row.iter().map(|k| peaks[*k].0).fold(f64::INFINITY, f64::min);
    sort_by_number(&mut rows, |row| lowest(row));
    let columns: Vec<(String, &str)> = found
        .iter()
        .flat_map(|(name, result)| [(name.clone(), "Hz"), (format!("{name}, value"), result.unit.as_str())])
        .collect();
    let columns: Vec<(&str, &str)> = columns.iter().map(|(name, unit)| (name.as_str(), *unit)).collect();
    let cells = |row: Vec<usize>| {
        let of = |(record, (_, result)): (usize, &(String, SpectralResult))| {
            let peak = row.iter().map(|k| &peaks[*k]).find(|peak| peak.1 == record).map(|peak| peak.2);
            [peak.map(|k| result.frequency[k]).into(), peak.map(|k| result.value[k]).into()]
        };
        found.iter().enumerate().flat_map(of).collect::<Vec<Cell>>()
    };
    rows.into_iter().map(cells).fold(headed("Largest peaks", &columns), Table::row)
}

/// Number of largest peaks in the table of a record.
const SHOWN_PEAKS: usize = 8;

/// Number of peaks of a spectrum at the head of a report.
const MAIN_PEAKS: usize = 3;

/// Frequency of a peak: it lies anywhere within half a line spacing of its line, a rectangular distribution
/// of the standard uncertainty spacing/√12.
fn frequency_of(found: &SpectralResult, k: usize) -> Cell {
    let std = found.frequency.windows(2).next().map_or(f64::NAN, |w| (w[1] - w[0]) / f64::sqrt(12.0));
    Cell::Estimate { value: found.frequency[k], std: Some(std) }
}

/// Value of a line.
fn value_of(found: &SpectralResult, k: usize) -> Cell {
    Cell::Estimate {
        value: found.value[k],
        std: found.value_std.get(k).copied().filter(|std| std.is_finite()),
    }
}

/// The largest peaks of a record, one row a peak.
fn peaks(name: &str, found: &SpectralResult) -> Table {
    let finite_at = |values: &[f64], k: usize| values.get(k).copied().filter(|v| v.is_finite());
    let response = found.response.as_ref();
    let peaks = table(
        "Largest peaks of spectra",
        found.peaks(SHOWN_PEAKS),
        &[
            ("record", "", &|_| Cell::from(name)),
            ("frequency", "Hz", &|k| frequency_of(found, *k)),
            ("value", "", &|k| value_of(found, *k)),
            ("unit", "", &|_| Cell::from(found.unit.as_str())),
            ("scaling", "", &|_| Cell::from(found.scaling)),
            ("phase", "°", &|k| Cell::from(response.and_then(|r| finite_at(&r.phase, *k)))),
            ("coherence", "", &|k| Cell::from(response.and_then(|r| finite_at(r.coherence.as_ref()?, *k)))),
        ],
    );
    match reads_low(found) {
        Some(low) if found.tones.is_empty() => peaks.note(format!(
            "A sine between two lines reads low, by up to {low}; tones = 1 gives its true amplitude."
        )),
        _ => peaks,
    }
}

/// How much of its amplitude a sine between two lines of a spectrum lacks; `None` for a window that loses
/// little, and for functions.
fn reads_low(found: &SpectralResult) -> Option<&'static str> {
    let (_, low) = READS_LOW.iter().find(|(window, _)| *window == found.window)?;
    matches!(found.found, Lines::Spectrum(_)).then_some(*low)
}

/// Amplitude lost by a sine half-way between two lines (scalloping loss), by window.
const READS_LOW: [(&str, &str); 3] = [("hann", "15 %"), ("rectangular", "36 %"), ("hamming", "18 %")];

/// Settings with which the lines of each record were computed.
fn settings_table<'a>(results: impl IntoIterator<Item = (&'a str, &'a SpectralResult)>) -> Table {
    table(
        "Settings of the spectra",
        results,
        &[
            ("record", "", &|(name, _)| Cell::from(*name)),
            ("lines", "", &|(_, f)| Cell::from(f.frequency.len())),
            ("scaling", "", &|(_, f)| Cell::from(f.scaling)),
            ("unit", "", &|(_, f)| Cell::from(f.unit.as_str())),
            ("level unit", "", &|(_, f)| Cell::from(f.level_unit.as_deref().unwrap_or("-"))),
            ("window", "", &|(_, f)| Cell::from(f.window)),
            ("ENBW", "lines", &|(_, f)| Cell::Number(f.enbw)),
            ("detrend", "", &|(_, f)| Cell::from(f.detrend)),
            ("averages", "", &|(_, f)| Cell::from(f.averages)),
        ],
    )
}

/// The sines fitted to a record, one row a sine.
fn tones(name: &str, found: &SpectralResult) -> Table {
    table(
        "Tones",
        &found.tones,
        &[
            ("record", "", &|_| Cell::from(name)),
            ("frequency", "Hz", &|t| Cell::from(&t.frequency)),
            ("amplitude", "", &|t| Cell::from(&t.amplitude)),
            ("unit", "", &|t| Cell::from(t.amplitude.unit)),
            ("phase", "°", &|t| degrees(&t.phase)),
        ],
    )
}

impl Analysis for Keys {
    const SECTION: &'static str = "spectrum";
    const TITLE: &'static str = "Spectra";
    const FILES: Names = Names::Named(&["spectrum", "frf", "argand_frf", "argand_spectrum"]);
    const RANGES: &'static [KeyRange] =
        &[KeyRange::above_zero("", &["decibel"]), KeyRange::count(1e3, &["tones"])];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.file.as_ref().ok_or_else(no_file)?;
        entry.keys.options().map(drop)
    }

    fn channels(&self) -> Vec<(&'static str, &String)> {
        own_reference(self.reference.as_ref())
    }

    fn files(campaign: &Campaign, entry: &Entry<Keys>) -> Result<Vec<PathBuf>> {
        with_reference(campaign, entry, entry.keys.reference.as_ref())
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("spectra", entries, |entry, source| {
            let mut answer = entry.keys.measure(source)?;
            // In a campaign, file names with `frf` and a number belong to [[frf]]: here all are named
            // `spectrum`.
            let names = answer.figures.iter_mut().map(|f| &mut f.0);
            for name in names.chain(answer.files.iter_mut().map(|f| &mut f.0)) {
                *name = name.replacen("frf", "spectrum", 1);
            }
            Ok(vec![answer])
        })
    }
}
