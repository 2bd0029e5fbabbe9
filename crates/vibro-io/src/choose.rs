//! Finds the records that the user names: one record of a recording, or time traces that are read block by
//! block.

use crate::format::Format;
use crate::held::rises;
use crate::magnitude::MAGNITUDE;
use crate::options::named;
use crate::packed;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::source::Source;
use crate::text;
use crate::wav::Wave;
use std::path::{Path, PathBuf};
use vibro_record::{
    Error, Finding, Place, Record, Result, Spectrum, Stream, Trace, Traces, code, find_channel, lanes,
};

/// Size in bytes from which a text is streamed. A shorter text is read into memory, which avoids reading it
/// twice: a value and its separator take at least two bytes, so all values take less than 256 MiB.
const STREAMED_SIZE: u64 = 64 << 20;

impl Reader {
    /// Opens all time traces of a file to be read block by block.
    ///
    /// # Errors
    /// As [`Reader::from_path`]; if the file holds no trace, or its traces have no sampling rate, or
    /// different rates, lengths or start times. [`Reader::stream_channels`] reads a selection: name
    /// channels of one rate and length.
    pub fn stream(&self, path: impl AsRef<Path>) -> Result<Traces> {
        self.stream_channels(path, &[])
    }

    /// As [`Reader::stream`] for some channels, by name or number from 1, in the order given; all channels
    /// if none is named.
    ///
    /// # Errors
    /// As [`Reader::stream`]; if there is no such channel.
    pub fn stream_channels(&self, path: impl AsRef<Path>, channels: &[&str]) -> Result<Traces> {
        let source = self.source(path)?;
        let path = source.path().to_owned();
        // An archive or a workbook is read into memory as a whole.
        if packed::is_packed(&source) {
            return self.traces_in_memory(&source, channels);
        }
        let as_it_is = self.options.stretch.is_none() && self.options.resample.is_none();
        let format = self.entry(&source)?.format;
        if as_it_is && format == Format::Wav {
            let mut wave = Wave::open(&source, &self.options)?;
            let all = std::mem::take(&mut wave.channels);
            let chosen = named(&path, channels, all.iter().map(|t| &t.meta))?;
            wave.keep(&chosen);
            let (findings, frames) = (wave.layout.findings.clone(), wave.frames());
            return self.streamed(path, findings, (&all, &chosen), frames, Box::new(wave));
        }
        // If streaming fails, reading the text as a whole below reports the error.
        let long = || text::stream(&source, &self.options, format).ok().flatten();
        if as_it_is
            && self.options.span.is_none()
            && source.len() >= STREAMED_SIZE
            && let Some(text::Streamed { traces, findings, mut columns }) = long()
        {
            let chosen = named(&path, channels, traces.iter().map(|t| &t.meta))?;
            columns.keep(&chosen);
            let frames = traces.first().map_or(0, |trace| trace.axis.len());
            return self.streamed(path, findings, (&traces, &chosen), frames, Box::new(columns));
        }
        self.traces_in_memory(&source, channels)
    }

    /// The `chosen` of all traces of a file, which come from a stream, with the units that are stated for
    /// them.
    fn streamed(
        &self,
        path: PathBuf,
        findings: Vec<Finding>,
        (all, chosen): (&[Trace], &[usize]),
        frames: usize,
        stream: Box<dyn Stream>,
    ) -> Result<Traces> {
        let units = self.options.stated_units(&path, all.iter().map(|trace| &trace.meta))?;
        let traces: Vec<Trace> = chosen.iter().map(|i| all[*i].clone()).collect();
        let mut traces = Traces::of_stream(path, findings, &traces, frames, stream)?;
        for (channel, index) in chosen.iter().enumerate() {
            if let Some((_, unit)) = units.iter().find(|(of, _)| of == index) {
                traces.restate_unit(channel, unit, self.options.unit.is_none());
            }
        }
        Ok(traces)
    }

    /// Traces of a source that is read into memory as a whole.
    fn traces_in_memory(&self, source: &Source, channels: &[&str]) -> Result<Traces> {
        let path = source.path().to_owned();
        let asked = self.clone().only(channels.iter().map(|&name| name.to_owned()));
        let recording = asked.read(source)?;
        let nothing = recording.no_trace();
        let trace = |record| if let Record::Trace(trace) = record { Some(Some(trace)) } else { None };
        let mut all: Vec<Option<Trace>> = recording.records.into_iter().filter_map(trace).collect();
        if all.is_empty() {
            return Err(nothing);
        }
        let chosen = named(&path, channels, all.iter().flatten().map(|t| &t.meta))?;
        let traces = chosen.iter().filter_map(|i| all.get_mut(*i)?.take()).collect();
        Traces::of_file(path, recording.findings, traces)
    }

    /// Opens one channel for reading block by block. With a `reference`, the reference is number 0 and the
    /// chosen channel number 1. `calibration` multiplies the values of the chosen channel. Without
    /// `channel`, the file must hold exactly one channel besides the reference.
    ///
    /// # Errors
    /// As [`Reader::stream_channels`]; if there are several channels and none was named.
    pub fn stream_chosen(
        &self,
        file: impl AsRef<Path>,
        reference: Option<&str>,
        channel: Option<&str>,
        calibration: Option<f64>,
    ) -> Result<Traces> {
        let file = file.as_ref();
        let mut traces = if let Some(channel) = channel {
            let named: Vec<&str> = reference.into_iter().chain([channel]).collect();
            let found = self.stream_channels(file, &named)?;
            if found.channels().len() < named.len() {
                return Err(Error::usage(
                    format!("the channel {channel:?} is its own reference"),
                    "two different channels",
                ));
            }
            found
        } else {
            let mut all = self.stream(file)?;
            let reference = reference.map(|name| all.channel(name)).transpose()?;
            let others: Vec<usize> = (0..all.channels().len()).filter(|i| Some(*i) != reference).collect();
            if others.len() != 1 {
                let names = others.iter().map(|i| (*i, all.channels()[*i].name.as_str()));
                let first = others.iter().position(|i| !all.channels()[*i].has(MAGNITUDE)).unwrap_or(0);
                return Err(none_chosen(file, &names.collect::<Vec<_>>(), first));
            }
            all.keep(&reference.into_iter().chain(others).collect::<Vec<usize>>());
            all
        };
        if let Some(factor) = calibration {
            traces.calibrate(usize::from(reference.is_some()), factor)?;
        }
        Ok(traces)
    }
}

/// Index of the trace that the user most likely wants. Magnitudes are excluded, and traces that only rise,
/// such as a counter. Of the others with the unit of the first one, it is the trace with the largest sum of
/// squares about its mean.
fn likeliest(traces: &[(usize, &Trace)]) -> usize {
    let suited = |i: &usize| !traces[*i].1.meta.has(MAGNITUDE) && !rises(&traces[*i].1.values);
    let Some(first) = (0..traces.len()).find(suited) else { return 0 };
    let motion = |i: &usize| {
        let values = &traces[*i].1.values;
        let mean = lanes::sum(values) / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()
    };
    let alike = |i: &usize| traces[*i].1.meta.unit == traces[first].1.meta.unit;
    let all = (0..traces.len()).rev().filter(|i| suited(i) && alike(i));
    all.max_by(|a, b| motion(a).total_cmp(&motion(b))).unwrap_or(first)
}

/// Error for several channels of which none was chosen; each is given with its index in the file. It
/// suggests the channel at `best`, by name, or by number if the name is not unique.
fn none_chosen(path: &Path, channels: &[(usize, &str)], best: usize) -> Error {
    let names: Vec<&str> = channels.iter().map(|channel| channel.1).collect();
    let found = format!("{} channels, and none was chosen", names.len());
    let error = Error::input(Place::file(path), found, format!("one of {}", names.join(", ")));
    match channels.get(best) {
        Some((_, name)) if channels.iter().filter(|other| other.1 == *name).count() == 1 => {
            error.set("channel", format!("{name:?}"))
        }
        Some((i, _)) => error.set("channel", (i + 1).to_string()),
        None => Error::input(Place::file(path), "its only channel is the reference", "a second channel")
            .hint("another file"),
    }
}

impl Recording {
    /// The trace with the name `channel`, or with this number (traces count from 1). `None` takes the only
    /// trace. A `calibration` multiplies the values.
    ///
    /// ```
    /// use vibro_io::Reader;
    /// let text = "time [s],force [N],velocity [mm/s]\n0,1,2\n0.1,3,4\n0.2,5,6\n";
    /// let recording = Reader::new().from_reader("bench.csv", text.as_bytes())?;
    /// assert_eq!(recording.trace(Some("velocity"), None)?.values[1], 4e-3);
    /// assert_eq!(recording.trace(Some("1"), Some(10.0))?.values[1], 30.0);
    /// assert!(recording.trace(None, None).unwrap_err().to_string().contains("force, velocity"));
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is no such trace, or several and none was named; if the calibration is 0 or not finite; or
    /// if the trace is a fraction of full scale, which also needs a unit.
    pub fn trace(&self, channel: Option<&str>, calibration: Option<f64>) -> Result<Trace> {
        calibrated(self.chosen(channel)?.1.clone(), calibration)
    }

    /// As [`Recording::trace`], but moves the values out of the recording, which saves memory.
    ///
    /// # Errors
    /// As [`Recording::trace`].
    pub fn take_trace(&mut self, channel: Option<&str>, calibration: Option<f64>) -> Result<Trace> {
        let (chosen, nothing) = (self.chosen(channel)?.0, self.no_trace());
        let Record::Trace(trace) = &mut self.records[chosen] else { return Err(nothing) };
        let values = std::mem::take(&mut trace.values);
        if calibration.is_some() {
            self.findings.retain(|found| found.code != code::SCALE_IN_HEAD);
        }
        calibrated(Trace { values, ..trace.clone() }, calibration)
    }

    /// The stored spectrum with the name `channel`, or with this number (spectra count from 1). `None` takes
    /// the only one.
    ///
    /// # Errors
    /// If there is no such spectrum, or several and none was named.
    pub fn spectrum(&self, channel: Option<&str>) -> Result<&Spectrum> {
        let spectra: Vec<&Spectrum> = self
            .records
            .iter()
            .filter_map(|record| if let Record::Spectrum(spectrum) = record { Some(spectrum) } else { None })
            .collect();
        let chosen = match (channel, spectra.len()) {
            (_, 0) => {
                let place = Place::file(&self.path);
                return Err(Error::input(place, "no spectrum", "a file that holds a spectrum"));
            }
            (None, 1) => Ok(0),
            (None, _) => {
                let names = spectra.iter().map(|s| s.meta.name.as_str()).enumerate();
                return Err(none_chosen(&self.path, &names.collect::<Vec<_>>(), 0));
            }
            (Some(name), _) => find_channel(&self.path, name, spectra.iter().map(|s| s.meta.called())),
        };
        Ok(spectra[chosen.map_err(|e| e.setting("channel"))?])
    }

    /// The chosen trace, and its index among the records.
    fn chosen(&self, channel: Option<&str>) -> Result<(usize, &Trace)> {
        let trace =
            |i: usize| if let Record::Trace(trace) = &self.records[i] { Some((i, trace)) } else { None };
        let traces: Vec<(usize, &Trace)> = (0..self.records.len()).filter_map(trace).collect();
        let chosen = match (channel, traces.len()) {
            (_, 0) => return Err(self.no_trace()),
            (None, 1) => Ok(0),
            (None, _) => {
                let names = traces.iter().map(|(_, t)| t.meta.name.as_str()).enumerate();
                return Err(none_chosen(&self.path, &names.collect::<Vec<_>>(), likeliest(&traces)));
            }
            (Some(name), _) => find_channel(&self.path, name, traces.iter().map(|(_, t)| t.meta.called())),
        };
        Ok(traces[chosen.map_err(|e| e.setting("channel"))?])
    }

    /// Error for a recording without a trace.
    fn no_trace(&self) -> Error {
        Error::input(Place::file(&self.path), "no trace", "a file that holds a trace")
            .hint("`vibro info` lists what is in the file; samples over time need a sampling rate")
            .setting("rate")
    }
}

/// The trace with its values multiplied by a calibration factor, if there is one.
fn calibrated(mut trace: Trace, calibration: Option<f64>) -> Result<Trace> {
    if let Some(factor) = calibration {
        if trace.meta.has(Trace::UNCALIBRATED) {
            let found = format!("a calibration of {factor} without a unit");
            return Err(Error::usage(found, "the unit, too").setting("unit"));
        }
        let unit = trace.meta.unit.clone();
        trace.calibrate(factor, &unit)?;
    }
    Ok(trace)
}
