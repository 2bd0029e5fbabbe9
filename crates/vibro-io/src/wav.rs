//! Wave audio files of sound cards, recorders and laser vibrometers with an audio output.
//!
//! ```text
//! RIFF size WAVE               or RF64/BW64 with a ds64 chunk that holds the 64-bit sizes
//! fmt  size  format tag, channels, rate, bytes a frame, bits
//! LIST size  INFO ICMT …       any other chunks, passed over; the texts of INFO are kept as notes
//! data size  frames: one sample of each channel after the other, little endian
//! ```
//! Integers of 8 (unsigned), 16, 24 and 32 bits and floats of 32 and 64 bits. Values are fractions of full
//! scale, ±1, in the opaque unit `FS`, until [`vibro_record::Trace::calibrate`] gives them a unit. A file
//! written by `write::wav` carries its calibration in a comment (see [`Scales`]), which is applied.

pub(crate) mod layout;
mod scales;

pub(crate) use scales::{Scale, Scales};

use super::missing::Missing;
use super::source::ReadSeek;
use crate::binary::NumberType;
use crate::held::Contents;
use crate::options::Options;
use crate::options::named;
use crate::source::Source;
use crate::span;
use layout::WavHeader;
use std::io::{Read, SeekFrom};
use std::path::PathBuf;
use vibro_record::lanes::{self, Extremes};
use vibro_record::units::{self, Unit};
use vibro_record::{Axis, Error, Finding, Meta, Place, Record, Result, Stream, Trace, code};

/// The unit of values without a calibration.
const FULL_SCALE: &str = "FS";

/// Approximate number of bytes read at a time: large enough for the disk, and fits into the processor's
/// cache.
const BLOCK: usize = 256 * 1024;

/// Reads the samples block by block; a survey keeps only their extremes.
pub(super) fn read(source: &Source, options: &Options, survey: bool) -> Result<Contents> {
    let mut wave = Wave::open(source, options)?;
    let n = wave.channels.len();
    let named = named(source.path(), &options.only, wave.channels.iter().map(|t| &t.meta))?;
    if !survey {
        options.hold_traces(named.len(), &wave.axis)?;
        wave.keep(&named);
    }
    let room = if survey { 0 } else { wave.frames() };
    let mut values: Vec<Vec<f64>> = vec![Vec::with_capacity(room); wave.kept.len()];
    let mut summaries = vec![Extremes::NONE; n];
    while wave.append(&mut values)? > 0 {
        for (values, summary) in values.iter_mut().zip(&mut summaries).filter(|_| survey) {
            summary.take(values);
            values.clear();
        }
    }
    let mut metas: Vec<Meta> = wave.kept.iter().map(|i| wave.channels[*i].meta.clone()).collect();
    wave.finish(&mut metas);
    for ((i, meta), values) in wave.kept.iter().zip(metas).zip(values) {
        wave.channels[*i] = Trace { meta, values, ..wave.channels[*i].clone() };
    }
    let records = wave
        .channels
        .into_iter()
        .map(Record::Trace)
        .zip(summaries.into_iter().map(|summary| survey.then_some(summary)));
    Ok(Contents { records: records.collect(), findings: wave.layout.findings })
}

/// Some channels of a wave file, read block by block in their units, so that memory does not grow with its
/// length.
pub(crate) struct Wave {
    pub layout: WavHeader,
    reader: Box<dyn ReadSeek>,
    path: PathBuf,
    bytes: Vec<u8>,
    /// Frame of the file at which the part to be read begins.
    first: u64,
    left: u64,
    /// Time axis of the part to be read.
    axis: Axis,
    /// Every channel of the file without its values.
    pub channels: Vec<Trace>,
    factors: Vec<f64>,
    /// Indices of the channels that are returned.
    kept: Vec<usize>,
    largest: Vec<f64>,
    allow_missing: bool,
    scaled: bool,
}

impl Wave {
    /// Reads all chunks of a file except the samples, and moves to the first sample to read.
    ///
    /// # Errors
    /// If the kind of its samples is unknown, or there are none; if the user states a base band.
    pub fn open(source: &Source, options: &Options) -> Result<Wave> {
        if options.base_band.is_some() {
            let found = "a base band was stated, but a wave file holds samples over time";
            let expected = "a sampling rate, or nothing: the file says its own";
            return Err(Error::input(Place::file(source.path()), found, expected).setting("base_band"));
        }
        let mut reader = source.open()?;
        let layout = layout::read(source, &mut *reader)?;
        let n = layout.channels;
        let start = layout.scales.as_ref().map_or(0.0, |s| s.start);
        let whole = Axis::time(start, 1.0 / options.rate.unwrap_or(layout.rate), layout.frames as usize);
        let part = options.span.map_or(Ok(0..whole.len()), |span| span::within(&whole, span));
        let part = part.map_err(|e| e.in_file(source.path()))?;
        let beyond = options.span.and_then(|(_, to)| span::beyond(&whole, to));
        let at = layout.data_at + (part.start * n) as u64 * layout.sample.size();
        reader.seek(SeekFrom::Start(at)).map_err(|e| Error::io("read", source.path(), e))?;
        let mut wave = Wave {
            reader,
            path: source.path().to_owned(),
            bytes: Vec::new(),
            left: part.len() as u64,
            first: part.start as u64,
            axis: whole.part(part),
            channels: Vec::with_capacity(n),
            factors: Vec::with_capacity(n),
            kept: (0..n).collect(),
            largest: vec![0.0; n],
            allow_missing: options.allow_missing,
            scaled: layout.scales.is_some() || options.states_units(),
            layout,
        };
        for channel in 0..n {
            let (mut trace, factor) =
                wave.describe(source, options, channel).map_err(|e| e.in_file(source.path()))?;
            trace.meta.findings.extend(beyond.clone());
            wave.channels.push(trace);
            wave.factors.push(factor);
        }
        Ok(wave)
    }

    /// A channel without its values, and the factor from fractions of full scale to SI that the user or the
    /// file's comment states; 1 if none is stated.
    fn describe(&self, source: &Source, options: &Options, channel: usize) -> Result<(Trace, f64)> {
        let layout = &self.layout;
        let scale = layout.scales.as_ref().and_then(|s| s.channels.get(channel));
        let name = scale.map(|s| s.name.clone()).filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("channel {}", channel + 1));
        let mut meta = Meta::new(name, Unit::opaque(FULL_SCALE));
        let kind =
            if matches!(layout.sample, NumberType::F32 | NumberType::F64) { "float" } else { "integer" };
        let samples = format!("{}-bit {kind}", 8 * layout.sample.size());
        meta.step("read", &[("file", &source.name()), ("format", &"wav"), ("samples", &samples)]);
        meta.notes.clone_from(&layout.notes);
        meta.found(Finding::caution(Trace::UNCALIBRATED));
        if let Some(stated) = options.rate.filter(|stated| *stated != layout.rate) {
            let differs = Finding::caution("statement-overrides-file").name("what", "sampling rate");
            meta.found(differs.number("file", layout.rate).number("used", stated));
        }
        let declared = layout.declared_frames.map(|n| n as usize);
        span::note(&mut meta, options.span, declared);
        let mut trace = Trace { meta, axis: self.axis.clone(), values: Vec::new() };
        let (full_scale, unit, said) = match (&options.unit, scale) {
            (Some(unit), _) => (1.0, unit.clone(), Finding::note("full-scale-stated")),
            (None, Some(scale)) => {
                let said = Finding::caution(code::FULL_SCALE_BY_COMMENT).number("factor", scale.factor);
                (scale.factor, Unit::parse_or_opaque(&scale.unit), said)
            }
            (None, None) => return Ok((trace, 1.0)),
        };
        trace.calibrate(full_scale, &unit)?;
        // A comment with the unit `FS` restores only the level: the values were never calibrated.
        let calibrated = options.unit.is_some() || unit.symbol() != FULL_SCALE;
        let said = said.name("unit", unit.symbol());
        trace.meta.found(if calibrated { said } else { Finding::caution(Trace::UNCALIBRATED) });
        Ok((trace, full_scale * unit.factor()))
    }

    /// Number of frames (samples per channel) of the part that is read, whatever the file declares.
    pub fn frames(&self) -> usize {
        self.axis.len()
    }
}

/// The integer that means zero, and full scale counted from it. Floats are fractions of full scale: (0, 1).
fn full_scale(sample: NumberType) -> (f64, f64) {
    match sample {
        NumberType::U8 => (128.0, 128.0),
        NumberType::I16 => (0.0, 32_768.0),
        NumberType::I24 => (0.0, 8_388_608.0),
        NumberType::I32 => (0.0, 2_147_483_648.0),
        _ => (0.0, 1.0),
    }
}

impl Stream for Wave {
    fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let sample = self.layout.sample;
        let (size, (zero, full)) = (sample.size() as usize, full_scale(sample));
        let frame = size * self.layout.channels;
        let frames = ((BLOCK / frame).max(1) as u64).min(self.left);
        let first = self.first + self.frames() as u64 - self.left;
        self.bytes.clear();
        (&mut self.reader)
            .take(frames * frame as u64)
            .read_to_end(&mut self.bytes)
            .map_err(|e| Error::io("read", &self.path, e))?;
        // A file that shrank since it was opened ends early.
        let frames = self.bytes.len() / frame;
        self.left = if frames == 0 { 0 } else { self.left - frames as u64 };
        block.resize_with(self.kept.len(), Vec::new);
        for ((channel, column), largest) in self.kept.iter().zip(&mut *block).zip(&mut self.largest) {
            let from = column.len();
            sample.take(&self.bytes, channel * size, frame, false, column);
            let values = &mut column[from..];
            // Floats are fractions of full scale already.
            if full != 1.0 {
                for v in &mut *values {
                    *v = (*v - zero) / full;
                }
            }
            let seen = lanes::survey(values);
            *largest = largest.max(seen.high).max(-seen.low);
            if !seen.finite {
                let mut missing = Missing::default();
                for i in (0..frames).filter(|i| !values[*i].is_finite()) {
                    let frame = first + i as u64;
                    missing.take(&Place::file(&self.path), format!("{frame} of channel {}", channel + 1));
                }
                missing.check("sample", "NaN or infinite: frame", self.allow_missing)?;
                values.iter_mut().filter(|v| !v.is_finite()).for_each(|v| *v = f64::NAN);
            }
            let factor = self.factors.get(*channel).copied().unwrap_or(1.0);
            if factor != 1.0 {
                units::scale(values.iter_mut(), factor).map_err(|e| e.in_file(&self.path))?;
            }
        }
        Ok(frames)
    }

    fn keep(&mut self, channels: &[usize]) {
        self.kept = channels.iter().filter_map(|i| self.kept.get(*i).copied()).collect();
        self.largest = vec![0.0; self.kept.len()];
    }

    fn finish(&self, metas: &mut [Meta]) {
        // Values without a calibration are fractions of full scale, which cannot exceed 1.
        for (meta, largest) in metas.iter_mut().zip(&self.largest).filter(|(_, largest)| **largest > 1.0) {
            if !self.scaled {
                meta.found(Finding::caution("beyond-full-scale").number("max", *largest));
            }
        }
    }
}

#[cfg(test)]
mod tests;
