//! Wave audio: what sound cards, recorders and laser vibrometers with an audio output write.
//!
//! ```text
//! RIFF size WAVE               or RF64/BW64 with a ds64 chunk that holds the 64-bit sizes
//! fmt  size  format tag, channels, rate, bytes a frame, bits
//! LIST size  INFO ICMT …       any other chunks, passed over; the texts of INFO are kept as notes
//! data size  frames: one sample of each channel after the other, little endian
//! ```
//! Integers of 8 (unsigned), 16, 24 and 32 bits and floats of 32 and 64 bits. Values are fractions of full scale, ±1, in
//! the opaque unit `FS`, until [`vibro_record::Trace::calibrate`] gives them a unit. A file written by `write::wav`
//! carries its calibration in a comment (see [`scales`]), which is applied.

mod calibrated;
mod layout;
mod scales;
mod stream;

pub(super) use calibrated::Calibrated;
pub(crate) use scales::{Scale, Scales};
use stream::WavStream;

use super::format::{Format, Survey};
use super::reader::{Options, Recording};
use super::{Header, Source, Summary, missing};
use std::path::Path;
use vibro_record::units::{self, Unit};
use vibro_record::{Axis, Error, Finding, Meta, Place, Record, Result, Trace};

/// The unit of values without a calibration.
const FULL_SCALE: &str = "FS";

/// How many bytes of texts are copied for all channels together.
const MOST_COPIED: usize = 256 * 1024;

pub(super) fn sniff(head: &[u8], _: &Source) -> bool {
    let form = head.get(..4);
    (form == Some(b"RIFF") || form == Some(b"RF64") || form == Some(b"BW64") || form == Some(b"RIFX"))
        && head.get(8..12) == Some(b"WAVE")
}

pub(super) fn read(source: &Source, options: &Options) -> Result<Recording> {
    let mut stream = open(source, options)?;
    let frames = stream.frames() as usize;
    let mut values: Vec<Vec<f64>> = (0..stream.channels()).map(|_| Vec::with_capacity(frames)).collect();
    let found = pass(source, &mut stream, options, |channel, block| {
        if let Some(column) = values.get_mut(channel) {
            column.extend(block);
        }
    })?;
    let mut records = Vec::with_capacity(values.len());
    for (channel, (column, summary)) in values.into_iter().zip(&found).enumerate() {
        let mut trace = describe(source, &stream, options, channel, summary);
        trace.values = column;
        dress(&mut trace, &stream, options, channel).map_err(|e| e.in_file(source.path()))?;
        records.push(Record::Trace(trace));
    }
    let path = source.path().to_owned();
    Ok(Recording { path, format: Format::Wav, records, findings: stream.findings().to_vec() })
}

/// Goes over the samples a block at a time.
pub(super) fn survey(source: &Source, options: &Options) -> Result<Survey> {
    let mut stream = open(source, options)?;
    let found = pass(source, &mut stream, options, |_, _| {})?;
    let mut headers = Vec::with_capacity(found.len());
    for (channel, summary) in found.iter().enumerate() {
        let mut trace = describe(source, &stream, options, channel, summary);
        let factor = dress(&mut trace, &stream, options, channel).map_err(|e| e.in_file(source.path()))?;
        if let Some((_, mut max)) = summary.max {
            units::scale([&mut max], factor).map_err(|e| e.in_file(source.path()))?;
        }
        let axis = trace.axis.clone();
        headers.push(Header::of(&Record::Trace(trace)).summed(summary, factor, &axis));
    }
    Ok((headers, stream.findings().to_vec()))
}

fn open(source: &Source, options: &Options) -> Result<WavStream> {
    if options.base_band.is_some() {
        return Err(Error::input(
            Place::file(source.path()),
            "a base band was stated, but a wave file holds samples over time",
            "a sampling rate, or nothing: the file says its own",
        )
        .setting("base_band"));
    }
    WavStream::open(source)
}

/// Hands out every block and sums up each channel. Missing values become NaN, or are refused with their frames.
fn pass(
    source: &Source,
    stream: &mut WavStream,
    options: &Options,
    mut each: impl FnMut(usize, &[f64]),
) -> Result<Vec<Summary>> {
    let mut found = vec![Summary::default(); stream.channels()];
    let mut block = Vec::new();
    let (mut count, mut listed, mut first) = (0usize, Vec::new(), 0usize);
    loop {
        let frames = stream.next_block(&mut block)?;
        if frames == 0 {
            break;
        }
        for (channel, (values, summary)) in block.iter_mut().zip(&mut found).enumerate() {
            for (i, value) in values.iter_mut().enumerate() {
                if !value.is_finite() {
                    *value = f64::NAN;
                    count += 1;
                    if listed.len() < missing::LISTED {
                        listed.push((first + i, channel));
                    }
                }
                summary.push(value.abs());
            }
            each(channel, values);
        }
        first += frames;
    }
    if count > 0 && !options.allow_missing {
        return Err(gaps(source.path(), count, listed.into_iter()));
    }
    Ok(found)
}

/// The complaint about `count` missing samples, of which the first are listed by frame and channel.
fn gaps(path: &Path, count: usize, listed: impl Iterator<Item = (usize, usize)>) -> Error {
    let places: Vec<String> = listed
        .take(missing::LISTED)
        .map(|(frame, channel)| format!("{frame} of channel {}", channel + 1))
        .collect();
    let found = format!("{count} sample(s) are NaN or infinite: frame {}", places.join(", "));
    missing::refusal(Place::file(path), found)
}

/// Values without a calibration that a fraction of full scale cannot have.
fn beyond_full_scale(max: f64) -> Finding {
    Finding::caution("beyond-full-scale").number("max", max)
}

/// Channel `channel` without values and without calibration.
fn describe(
    source: &Source,
    stream: &WavStream,
    options: &Options,
    channel: usize,
    summary: &Summary,
) -> Trace {
    let scales = stream.scales();
    let name = scales.and_then(|s| s.channels.get(channel)).map(|s| s.name.clone());
    let name = name.filter(|n| !n.is_empty()).unwrap_or_else(|| format!("channel {}", channel + 1));
    let mut meta = Meta::new(name, Unit::opaque(FULL_SCALE));
    meta.step("read", &[("file", &source.name()), ("format", &"wav"), ("samples", &stream.sample())]);
    // Each channel has its own copy of the texts, unless these are many: then the first has them.
    let bytes: usize = stream.notes().iter().map(|(key, text)| key.len() + text.len()).sum();
    if channel == 0 || bytes.saturating_mul(stream.channels()) <= MOST_COPIED {
        meta.notes = stream.notes().to_vec();
    }
    meta.declared_n = stream.declared_frames().map(|n| n as usize);
    meta.found(Finding::caution("uncalibrated"));
    let scaled = scales.is_some() || options.unit.is_some();
    if let Some((_, max)) = summary.max.filter(|(_, max)| *max > 1.0 && !scaled) {
        meta.found(beyond_full_scale(max));
    }
    let mut rate = stream.rate();
    if let Some(stated) = options.rate.filter(|stated| *stated != rate) {
        let differs = Finding::caution("statement-overrides-file").name("what", "sampling rate");
        meta.found(differs.number("file", rate).number("used", stated));
        rate = stated;
    }
    let start = scales.map_or(0.0, |s| s.start);
    Trace { meta, axis: Axis::time(start, 1.0 / rate, summary.n), values: Vec::new() }
}

/// Applies the calibration that is stated or that the file carries; returns the factor to SI.
fn dress(trace: &mut Trace, stream: &WavStream, options: &Options, channel: usize) -> Result<f64> {
    if let Some(unit) = &options.unit {
        trace.calibrate(1.0, unit)?;
        trace.meta.found(Finding::note("full-scale-stated").name("unit", unit.symbol()));
        return Ok(unit.factor());
    }
    let Some(scale) = stream.scales().and_then(|s| s.channels.get(channel)) else { return Ok(1.0) };
    let unit = Unit::parse_or_opaque(&scale.unit);
    trace.calibrate(scale.factor, &unit)?;
    if scale.unit == FULL_SCALE {
        // Only the level was kept: there never was a calibration.
        trace.meta.found(Finding::caution("uncalibrated"));
        return Ok(scale.factor);
    }
    let said = Finding::caution("full-scale-by-comment").number("factor", scale.factor);
    trace.meta.found(said.name("unit", scale.unit.as_str()));
    Ok(scale.factor * unit.factor())
}

#[cfg(test)]
mod tests;
