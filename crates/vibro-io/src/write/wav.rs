//! Wave audio of 32- or 64-bit floats.
//!
//! Only traces with one even time axis and without missing values can be written. Each channel is divided
//! by its full scale, the power of two at or next above its largest magnitude, so that the division is
//! exact. A comment (LIST INFO ICMT) holds full scale, unit, name, exact sampling rate and start.
//! [`crate::Reader`] reads the comment and restores all of it; an audio program plays the file and ignores
//! the comment.

use super::listed::{failed, label, together};
use super::uff58::Precision;
use crate::wav::{Scale, Scales};
use std::io::Write;
use vibro_record::units::notation::counted;
use vibro_record::{AxisKind, Error, Record, Result, Trace};

/// Writes traces as the channels of one file.
///
/// # Errors
/// If there are none, one is not a trace over evenly sampled time, their axes differ, a sample is missing,
/// the sampling rate is not between 1 Hz and 4.29 GHz, they take more than 4 GiB, or the output cannot be
/// written.
pub fn write(records: &[Record], precision: Precision, out: &mut impl Write) -> Result<()> {
    let traces = records.iter().map(checked).collect::<Result<Vec<&Trace>>>()?;
    together(records, "time axes: a wave file has one")?;
    let first = traces[0];
    let rate = first.rate().unwrap_or(f64::NAN);
    let whole_rate = rate.round();
    if !(1.0..=f64::from(u32::MAX)).contains(&whole_rate) {
        return Err(Error::refused(format!(
            "a wave file holds sampling rates from 1 Hz to 4.29 GHz, not {rate} Hz"
        ))
        .hint("write .csv or .npy"));
    }
    let channels = traces.iter().map(|t| scale(t)).collect();
    let scales = Scales { rate, start: first.axis.start(), channels };
    let head = head(&scales, whole_rate as u32, first.values.len(), precision)?;
    out.write_all(&head).map_err(failed)?;
    let mut bytes = Vec::new();
    for block in 0..first.values.len().div_ceil(BLOCK) {
        bytes.clear();
        for i in block * BLOCK..((block + 1) * BLOCK).min(first.values.len()) {
            for (trace, scale) in traces.iter().zip(&scales.channels) {
                let value = trace.values[i] / scale.factor;
                match precision {
                    Precision::Single => bytes.extend((value as f32).to_le_bytes()),
                    Precision::Double => bytes.extend(value.to_le_bytes()),
                }
            }
        }
        out.write_all(&bytes).map_err(failed)?;
    }
    Ok(())
}

/// Frames that are written at a time.
const BLOCK: usize = 4096;

/// The trace in a record, if a wave file can hold it.
fn checked(record: &Record) -> Result<&Trace> {
    let refuse = |why: &str| {
        Err(Error::refused(format!("{} {why}: a wave file cannot hold it", label(record)))
            .hint("write .csv or .npy"))
    };
    let Record::Trace(trace) = record else { return refuse("is not over time") };
    if trace.axis.kind != AxisKind::Time {
        return refuse("has no time axis");
    }
    if trace.axis.step().is_none_or(|dt| dt.is_nan() || dt <= 0.0) {
        return refuse("is not evenly sampled");
    }
    if trace.values.is_empty() || trace.values.len() != trace.axis.len() {
        return refuse("has no samples");
    }
    match trace.values.iter().position(|v| !v.is_finite()) {
        Some(at) => refuse(&format!("misses its value {}", at + 1)),
        None => Ok(trace),
    }
}

/// Full scale: the power of two at or next above the largest magnitude.
fn scale(trace: &Trace) -> Scale {
    let largest = trace.values.iter().fold(0.0f64, |max, v| max.max(v.abs()));
    let mut factor = 1.0;
    while factor < largest && factor < 2f64.powi(1023) {
        factor *= 2.0;
    }
    while largest > 0.0 && 0.5 * factor >= largest && factor > f64::MIN_POSITIVE {
        factor *= 0.5;
    }
    Scale { factor, unit: trace.meta.unit.symbol().to_owned(), name: trace.meta.name.clone() }
}

/// All bytes of the file before the samples.
fn head(scales: &Scales, rate: u32, frames: usize, precision: Precision) -> Result<Vec<u8>> {
    let channels = scales.channels.len();
    let bytes = if precision == Precision::Single { 4 } else { 8 };
    let frame = channels * bytes;
    let too_large = || {
        Error::refused(format!(
            "{frames} frames of {} are more than a wave file holds (4 GiB)",
            counted(channels, "channel")
        ))
        .hint("write .npy, or fewer channels")
    };
    let short = |value: usize| u16::try_from(value).map_err(|_| too_large());
    let mut format = Vec::new();
    format.extend(3u16.to_le_bytes());
    format.extend(short(channels)?.to_le_bytes());
    format.extend(rate.to_le_bytes());
    format.extend(rate.saturating_mul(frame as u32).to_le_bytes());
    format.extend(short(frame)?.to_le_bytes());
    format.extend((8 * bytes as u16).to_le_bytes());
    format.extend(0u16.to_le_bytes());
    let mut comment = scales.to_string().into_bytes();
    comment.push(0);
    comment.extend(std::iter::repeat_n(0, comment.len() % 2));
    let mut list = b"INFOICMT".to_vec();
    list.extend((comment.len() as u32).to_le_bytes());
    list.extend(comment);
    let mut body = b"WAVE".to_vec();
    for (id, content) in
        [(b"fmt ", format), (b"fact", (frames as u32).to_le_bytes().to_vec()), (b"LIST", list)]
    {
        body.extend(id);
        body.extend((content.len() as u32).to_le_bytes());
        body.extend(content);
    }
    let data = frames.checked_mul(frame).and_then(|n| u32::try_from(n).ok()).ok_or_else(too_large)?;
    body.extend(b"data");
    body.extend(data.to_le_bytes());
    let size = data.checked_add(body.len() as u32).ok_or_else(too_large)?;
    Ok([b"RIFF".as_slice(), &size.to_le_bytes(), &body].concat())
}

#[cfg(test)]
mod tests;
