//! Time traces of one file block by block.

use crate::wav::Wave;
use crate::{Format, Reader, Source};
use std::path::Path;
use vibro_record::{Error, Meta, Place, Record, Result, Stream as _, Trace, Traces, find_channel};

impl Reader {
    /// Opens all time traces of a file to be read block by block.
    ///
    /// # Errors
    /// As [`Reader::from_path`]; if the file holds no trace, or its traces have no sampling rate, or different rates,
    /// lengths or start times: [`Reader::stream_channels`] takes those that belong together.
    pub fn stream(&self, path: impl AsRef<Path>) -> Result<Traces> {
        self.stream_channels(path, &[])
    }

    /// As [`Reader::stream`] for some channels, by name or number from 1, in the order given; all where none is named.
    ///
    /// # Errors
    /// As [`Reader::stream`]; if there is no such channel.
    pub fn stream_channels(&self, path: impl AsRef<Path>, channels: &[&str]) -> Result<Traces> {
        let source = Source::file(path)?;
        let path = source.path().to_owned();
        if self.entry(&source)?.format == Format::Wav {
            let mut wave = Wave::open(&source, self.options())?;
            let chosen = choose(&path, channels, wave.channels().iter().map(|t| &t.meta))?;
            let traces: Vec<Trace> = chosen.iter().map(|i| wave.channels()[*i].clone()).collect();
            wave.keep(&chosen);
            let (findings, frames) = (wave.findings().to_vec(), wave.frames());
            return Traces::of_stream(path, findings, &traces, frames, Box::new(wave));
        }
        let recording = self.read(&source)?;
        let kinds: Vec<&str> = recording.records.iter().map(Record::kind).collect();
        let nothing = no_trace(&path, &kinds);
        let traces = recording.records.into_iter().filter_map(|record| match record {
            Record::Trace(trace) => Some(trace),
            _ => None,
        });
        let mut all: Vec<Option<Trace>> = traces.map(Some).collect();
        if all.is_empty() {
            return Err(nothing);
        }
        let chosen = choose(&path, channels, all.iter().flatten().map(|t| &t.meta))?;
        let traces = chosen.iter().filter_map(|i| all.get_mut(*i)?.take()).collect();
        Traces::of_file(path, recording.findings, traces)
    }
}

/// Indices of the channels named; of all where none is.
fn choose<'a>(
    path: &Path,
    named: &[&str],
    all: impl Iterator<Item = &'a Meta> + Clone,
) -> Result<Vec<usize>> {
    if named.is_empty() {
        return Ok((0..all.count()).collect());
    }
    named.iter().map(|name| find_channel(path, name, all.clone())).collect()
}

fn no_trace(path: &Path, kinds: &[&str]) -> Error {
    let found = match kinds {
        [] => "no record".to_owned(),
        [one] => format!("a {one} and no time trace"),
        all => format!("{} records and no time trace among them (the first is a {})", all.len(), all[0]),
    };
    Error::input(Place::file(path), found, "samples over time")
        .hint("state the sampling rate, if the values are samples over time")
        .setting("rate")
}
