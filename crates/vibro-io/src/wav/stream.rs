//! Wave files block by block.

use super::layout::{self, Layout};
use super::scales::Scales;
use crate::Source;
use crate::source::ReadSeek;
use std::io::{Read, SeekFrom};
use vibro_record::{Error, Finding, Result};

/// Bytes of one block, more or less: large enough for the disk, small enough for the cache.
const BLOCK: usize = 256 * 1024;

/// A wave file that is read block by block, so that memory does not grow with its length.
pub(crate) struct WavStream {
    layout: Layout,
    reader: Box<dyn ReadSeek>,
    path: std::path::PathBuf,
    bytes: Vec<u8>,
    left: u64,
}

impl WavStream {
    /// Reads the chunks of a file up to and behind its samples, and stands before the first of them.
    ///
    /// # Errors
    /// If the file is no wave file, its samples are of a kind that is not read here, or there are none.
    pub fn open(source: &Source) -> Result<WavStream> {
        let mut reader = source.open()?;
        let layout = layout::read(source, &mut *reader)?;
        reader.seek(SeekFrom::Start(layout.data_at)).map_err(|e| Error::io("read", source.path(), e))?;
        let left = layout.frames;
        Ok(WavStream { layout, reader, path: source.path().to_owned(), bytes: Vec::new(), left })
    }

    /// Sampling rate in Hz.
    pub fn rate(&self) -> f64 {
        self.layout.rate
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.layout.channels
    }

    /// Number of frames (samples a channel) that the file holds, whatever it declares.
    pub fn frames(&self) -> u64 {
        self.layout.frames
    }

    /// Number of frames that the file declares, where it does.
    pub(crate) fn declared_frames(&self) -> Option<u64> {
        self.layout.declared_frames
    }

    /// Where the file is cut off or leaves something open.
    pub fn findings(&self) -> &[Finding] {
        &self.layout.findings
    }

    /// Texts of the file by key.
    pub fn notes(&self) -> &[(String, String)] {
        &self.layout.notes
    }

    /// Kind of sample, e.g. `24-bit integer`.
    pub(super) fn sample(&self) -> String {
        self.layout.sample.to_string()
    }

    pub(super) fn scales(&self) -> Option<&Scales> {
        self.layout.scales.as_ref()
    }

    /// Reads the next frames: replaces the content of `block` by one `Vec` a channel, in fractions of full scale (floats
    /// as they stand, NaN and infinity too), and returns how many frames these are; 0 at the end.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn next_block(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let all: Vec<usize> = (0..self.layout.channels).collect();
        block.iter_mut().for_each(Vec::clear);
        self.append(&all, block)
    }

    /// As [`WavStream::next_block`] for these channels only, each below [`WavStream::channels`], behind what `block` holds.
    pub(super) fn append(&mut self, channels: &[usize], block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let sample = self.layout.sample;
        let frame = sample.bytes() * self.layout.channels;
        let frames = ((BLOCK / frame).max(1) as u64).min(self.left);
        self.bytes.clear();
        (&mut self.reader)
            .take(frames * frame as u64)
            .read_to_end(&mut self.bytes)
            .map_err(|e| Error::io("read", &self.path, e))?;
        // A file that shrank since it was opened ends early.
        let frames = self.bytes.len() / frame;
        self.left = if frames == 0 { 0 } else { self.left - frames as u64 };
        block.resize_with(channels.len(), Vec::new);
        for (channel, values) in channels.iter().zip(&mut *block) {
            let samples = self.bytes.chunks_exact(frame).map(|f| &f[channel * sample.bytes()..]);
            values.extend(samples.map(|s| sample.value(&s[..sample.bytes()])));
        }
        Ok(frames)
    }
}
