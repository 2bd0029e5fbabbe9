//! Time traces, read block by block.

use crate::units::{Unit, notation};
use crate::{Error, Finding, Meta, Place, Result, Trace, code, nearest, units};
use std::path::{Path, PathBuf};

/// Number of samples per channel in a block, for traces in memory: larger blocks take more memory, smaller
/// ones more calls.
const BLOCK: usize = 16 * 1024;

/// Largest time offset between two channels of one record, at its start and at its end, in sampling
/// intervals. A hundredth of an interval shifts the phase by 1.8° at half the sampling rate.
const LARGEST_OFFSET: f64 = 0.01;

/// Samples that come block by block, in SI units.
pub trait Stream: Send {
    /// Appends the next samples to `block`, one `Vec` per channel, and returns their number in each channel;
    /// 0 at the end.
    ///
    /// # Errors
    /// If the source cannot be read, or a sample is missing and that is not allowed.
    fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize>;

    /// From now on returns only these channels, in this order; the indices refer to the present channels.
    fn keep(&mut self, channels: &[usize]);

    /// Adds findings that depend on the values to their channels, after all samples have been read.
    fn finish(&self, channels: &mut [Meta]);
}

/// Time traces of one sampling rate and length, returned block by block in SI units.
///
/// ```
/// use vibro_record::{Axis, Meta, Trace, Traces, units::Unit};
/// let meta = Meta::new("velocity", Unit::parse("m/s").unwrap());
/// let trace = Trace { meta, axis: Axis::time(0.0, 0.5, 2), values: vec![0.002, 0.004] };
/// let mut traces = Traces::from_memory(vec![trace])?;
/// let velocity = traces.channel("velocity")?;
/// let (mut block, mut sum) = (Vec::new(), 0.0);
/// while traces.next_block(&mut block)? > 0 {
///     sum += block[velocity].iter().sum::<f64>();
/// }
/// assert_eq!((traces.rate(), traces.frames(), sum), (2.0, 2, 0.006));
/// # Ok::<(), vibro_record::Error>(())
/// ```
pub struct Traces {
    path: PathBuf,
    channels: Vec<Meta>,
    findings: Vec<Finding>,
    rate: f64,
    start: f64,
    frames: usize,
    /// Calibration factor of each channel; values from the stream are multiplied by it.
    factors: Vec<f64>,
    stream: Box<dyn Stream>,
    /// Samples that [`Traces::peek`] has read and that are still to be returned.
    ahead: Vec<Vec<f64>>,
}

/// Traces that are in memory already.
struct Memory {
    values: Vec<Vec<f64>>,
    /// Index of the next sample.
    at: usize,
}

impl Stream for Memory {
    fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        block.resize_with(self.values.len(), Vec::new);
        let mut frames = 0;
        for (out, column) in block.iter_mut().zip(&self.values) {
            let next = &column[self.at..(self.at + BLOCK).min(column.len())];
            out.extend_from_slice(next);
            frames = next.len();
        }
        self.at += frames;
        Ok(frames)
    }

    fn keep(&mut self, channels: &[usize]) {
        self.values = picked(&self.values, channels);
    }

    fn finish(&self, _: &mut [Meta]) {}
}

fn picked<T: Clone>(all: &[T], indices: &[usize]) -> Vec<T> {
    indices.iter().filter_map(|i| all.get(*i).cloned()).collect()
}

impl Traces {
    /// Traces that are in memory already.
    ///
    /// # Errors
    /// If there are none, or they have no sampling rate, or different rates, lengths or start times.
    pub fn from_memory(traces: Vec<Trace>) -> Result<Traces> {
        Traces::of_file(PathBuf::new(), Vec::new(), traces)
    }

    /// Traces in memory that were read from a file, with the findings about the file.
    ///
    /// # Errors
    /// As [`Traces::from_memory`].
    pub fn of_file(path: PathBuf, findings: Vec<Finding>, mut traces: Vec<Trace>) -> Result<Traces> {
        let length = |trace: &Trace| trace.values.len();
        if let Some(other) = traces.iter().find(|other| length(other) != length(&traces[0])) {
            let (n, first) = (format!("{} samples", length(&traces[0])), &traces[0]);
            return Err(apart(&path, [first, other], &n, &length(other).to_string()));
        }
        let values: Vec<Vec<f64>> = traces.iter_mut().map(|t| std::mem::take(&mut t.values)).collect();
        let frames = values.first().map_or(0, Vec::len);
        Traces::of_stream(path, findings, &traces, frames, Box::new(Memory { values, at: 0 }))
    }

    /// Traces that come from a stream; the values in `traces` are ignored.
    ///
    /// # Errors
    /// As [`Traces::from_memory`].
    pub fn of_stream(
        path: PathBuf,
        findings: Vec<Finding>,
        traces: &[Trace],
        frames: usize,
        stream: Box<dyn Stream>,
    ) -> Result<Traces> {
        let (rate, start) = clock(&path, traces, frames)?;
        let channels: Vec<Meta> = traces.iter().map(|t| t.meta.clone()).collect();
        let factors = vec![1.0; channels.len()];
        Ok(Traces { path, channels, findings, rate, start, frames, factors, stream, ahead: Vec::new() })
    }

    /// The file; an empty path for traces that were not read from a file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Name, unit, findings and history of each channel; the values are in its unit.
    pub fn channels(&self) -> &[Meta] {
        &self.channels
    }

    /// Index of a channel by its name or by its number from 1.
    ///
    /// # Errors
    /// If there is none, or two have this name.
    pub fn channel(&self, channel: &str) -> Result<usize> {
        find_channel(&self.path, channel, self.channels.iter().map(Meta::called))
    }

    /// Sampling rate in Hz.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Time of the first sample in s.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Number of samples in each channel.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Findings about the file and its channels; the latter name their channel where there are several.
    /// Findings that need all values are added once all have been read.
    pub fn findings(&self) -> Vec<Finding> {
        let channels: Vec<_> =
            self.channels.iter().map(|m| (m.name.as_str(), m.findings.as_slice())).collect();
        let mut all = self.findings.clone();
        all.extend(Finding::gathered(&channels));
        all
    }

    /// Replaces the content of `block` by the next samples, one `Vec` per channel in SI units, and returns
    /// their number in each channel; 0 at the end. Missing samples are NaN, where they are allowed.
    ///
    /// # Errors
    /// If the file cannot be read, or a sample is missing (or too large for a double in SI units) and that is
    /// not allowed.
    pub fn next_block(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        block.iter_mut().for_each(Vec::clear);
        self.append(block)
    }

    /// As [`Traces::next_block`], but appends the samples to `block`, which saves a copy where they are
    /// collected.
    ///
    /// # Errors
    /// As [`Traces::next_block`].
    pub fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let ahead = std::mem::take(&mut self.ahead);
        let Some(frames) = ahead.first().map(Vec::len).filter(|frames| *frames > 0) else {
            return self.read(block);
        };
        block.resize_with(ahead.len(), Vec::new);
        block.iter_mut().zip(&ahead).for_each(|(column, ahead)| column.extend_from_slice(ahead));
        Ok(frames)
    }

    /// The next samples of each channel, at least `frames` or all that are left; [`Traces::append`] still
    /// returns them. Channels must be chosen and calibrated before.
    ///
    /// # Errors
    /// As [`Traces::next_block`].
    pub fn peek(&mut self, frames: usize) -> Result<&[Vec<f64>]> {
        let mut ahead = std::mem::take(&mut self.ahead);
        while ahead.first().map_or(0, Vec::len) < frames && self.read(&mut ahead)? > 0 {}
        self.ahead = ahead;
        Ok(&self.ahead)
    }

    /// Appends the next samples of the stream to `block`.
    fn read(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let frames = self.stream.append(block)?;
        if frames == 0 {
            self.stream.finish(&mut self.channels);
        }
        for (column, factor) in block.iter_mut().zip(&self.factors).filter(|(_, factor)| **factor != 1.0) {
            let from = column.len() - frames;
            units::scale(&mut column[from..], *factor)?;
        }
        Ok(frames)
    }

    /// From now on returns only these channels, in this order; indices that do not exist are ignored.
    pub fn keep(&mut self, channels: &[usize]) {
        self.stream.keep(channels);
        self.factors = picked(&self.factors, channels);
        self.channels = picked(&self.channels, channels);
    }

    /// Multiplies a channel by a factor from now on.
    ///
    /// # Errors
    /// If there is no such channel, the factor is 0 or not finite, or the channel is in fractions of full
    /// scale and no unit was stated.
    pub fn calibrate(&mut self, channel: usize, factor: f64) -> Result<()> {
        let (Some(meta), Some(known)) = (self.channels.get_mut(channel), self.factors.get_mut(channel))
        else {
            return Err(Error::usage(format!("channel {}", channel + 1), "a channel of the file"));
        };
        if factor == 0.0 || !factor.is_finite() {
            return Err(Error::usage(format!("a calibration of {factor}"), "a number that is not 0"));
        }
        if meta.has(Trace::UNCALIBRATED) {
            let found = format!("a calibration of {factor} without a unit");
            return Err(Error::usage(found, "the unit, too").setting("unit"));
        }
        *known *= factor;
        self.findings.retain(|found| found.code != code::SCALE_IN_HEAD);
        meta.step("calibrate", &[("factor", &factor)]);
        Ok(())
    }

    /// Replaces the unit of a channel, see [`Meta::restate_unit`]; an index that does not exist is ignored.
    pub fn restate_unit(&mut self, channel: usize, unit: &Unit, of_file: bool) {
        if let (Some(meta), Some(known)) = (self.channels.get_mut(channel), self.factors.get_mut(channel)) {
            *known *= meta.restate_unit(unit, of_file);
        }
    }
}

/// Index of a channel in `all` (name and quantity of each), by its name or by its number from 1. Letter case
/// is ignored where no name fits exactly. `path` is the file that an error names.
///
/// # Errors
/// If there is none, or two have this name.
pub fn find_channel<'a>(
    path: &Path,
    wanted: &str,
    all: impl Iterator<Item = (&'a str, &'a str)>,
) -> Result<usize> {
    let all: Vec<_> = all.collect();
    find_among(path, wanted, &all)
}

fn find_among(path: &Path, wanted: &str, all: &[(&str, &str)]) -> Result<usize> {
    let names = all.iter().map(|(name, _)| *name);
    let named = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
        names.clone().enumerate().filter(|(_, name)| is(name)).map(|(i, _)| i).collect()
    };
    let mut same = named(&|name| name == wanted);
    let small = wanted.to_lowercase();
    if same.is_empty() {
        same = named(&|name| name.to_lowercase() == small);
    }
    let n = all.len();
    let mut of_quantity = all.iter().filter(|(_, quantity)| *quantity == small);
    let only = of_quantity.next().filter(|_| of_quantity.next().is_none());
    let mut near = nearest(wanted, names.clone()).or(only.map(|(name, _)| *name));
    let number = wanted.parse::<usize>().ok().filter(|i| (1..=n).contains(i));
    let list: Vec<String> =
        names.take(20).enumerate().map(|(i, name)| format!("{} {name:?}", i + 1)).collect();
    let (found, expected) = match (same.as_slice(), number) {
        ([one], _) => return Ok(*one),
        ([], Some(number)) => return Ok(number - 1),
        ([], None) if n == 1 => (format!("no channel {wanted:?}"), "the only one".to_owned()),
        ([], None) => (format!("no channel {wanted:?}"), format!("one of the {n}")),
        (several, _) => {
            near = None;
            (format!("{} channels are called {wanted:?}", several.len()), "the number of one".to_owned())
        }
    };
    let error = Error::input(place(path), found, format!("{expected}: {}", list.join(", ")));
    Err(match near {
        Some(name) => error.hint(format!("{name:?}")),
        None => error.hint("one of these names, or its number"),
    })
}

/// The file as the place of an error; no place where there is no file.
fn place(path: &Path) -> Place {
    if path.as_os_str().is_empty() { Place::default() } else { Place::file(path) }
}

/// Error that two traces were not sampled together; `of_a` and `of_b` describe the difference.
fn apart(path: &Path, [a, b]: [&Trace; 2], of_a: &str, of_b: &str) -> Error {
    let found = format!("channel {:?} has {of_a} and channel {:?} {of_b}", a.meta.name, b.meta.name);
    Error::input(place(path), found, "channels that were sampled together")
        .hint("name the channels that belong together")
}

/// The sampling rate in Hz and the start in s that all traces share.
fn clock(path: &Path, traces: &[Trace], frames: usize) -> Result<(f64, f64)> {
    let rate_of = |trace: &Trace| {
        let of = |e: Error| e.in_file(path).of_record(&path.display().to_string());
        let named = |e: Error| if path.as_os_str().is_empty() { e } else { of(e) };
        trace.sampling_rate().map_err(named)
    };
    let first = traces.first().ok_or_else(|| Error::input(place(path), "no channel", "at least one"))?;
    let (rate, start) = (rate_of(first)?, first.axis.start());
    for trace in traces {
        let (own, begin) = (rate_of(trace)?, trace.axis.start());
        let of = [first, trace];
        if (own / rate - 1.0).abs() * frames as f64 > LARGEST_OFFSET {
            return Err(apart(path, of, &format!("a rate of {rate} Hz"), &format!("{own} Hz")));
        }
        // Traces of two files may count time from different origins.
        let origin = trace.meta.origin - first.meta.origin;
        if (origin + (begin - start)).abs() * rate > LARGEST_OFFSET {
            let later = format!("{} s", notation::significant(origin + begin, 6));
            return Err(apart(path, of, &format!("its first sample at {start} s"), &later));
        }
    }
    Ok((rate, start))
}

#[cfg(test)]
mod tests;
