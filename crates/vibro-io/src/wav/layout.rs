//! Finds the samples of a wave file and their kind.
//!
//! Sources: Microsoft, "Multiple channel audio data and WAVE files" (`WAVE_FORMAT_EXTENSIBLE`); EBU Tech 3306
//! (RF64) and ITU-R BS.2088 (BW64) for the `ds64` chunk.

use super::scales::Scales;
use crate::assemble::fewer;
use crate::binary::NumberType;
use crate::source::ReadSeek;
use crate::source::Source;
use crate::text::encoding;
use std::io::{Read, SeekFrom};
use vibro_record::units::notation::counted;
use vibro_record::{Error, Finding, Place, Result};

/// Largest number of bytes of text that is read from one chunk.
const MOST_TEXT: u64 = 64 * 1024;
/// Stored size that was never filled in.
const UNSAID: u64 = 0xffff_ffff;
/// End of the identifier of a sub-format, after its format tag: {xxxx0000-0000-0010-8000-00AA00389B71}.
const GUID: [u8; 14] = [0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71];

pub(crate) fn sniff(head: &[u8], _: &Source) -> bool {
    [b"RIFF", b"RF64", b"BW64"].iter().any(|form| head.starts_with(*form)) && head.get(8..12) == Some(b"WAVE")
}

/// Hint for a file without samples.
const CUT: &str = "the recording may have been cut off before its first sample";

/// Kind, place and number of the samples, as the chunks state them.
#[derive(Debug)]
pub struct WavHeader {
    pub sample: NumberType,
    pub channels: usize,
    pub rate: f64,
    pub data_at: u64,
    pub frames: u64,
    pub declared_frames: Option<u64>,
    pub scales: Option<Scales>,
    pub notes: Vec<(String, String)>,
    pub findings: Vec<Finding>,
}

/// The chunks that are read, each with the byte at which its body begins.
#[derive(Default)]
struct Chunks {
    format: Option<(u64, Vec<u8>)>,
    /// First byte and number of bytes of the samples.
    data: Option<(u64, u64)>,
    notes: Vec<(String, String)>,
}

/// Reads the chunks of a file, without its samples.
fn chunks(source: &Source, reader: &mut dyn ReadSeek) -> Result<Chunks> {
    // At most `most` bytes from `at` on; fewer at the end of the file.
    let mut bytes = |at: u64, most: u64| {
        let mut bytes = Vec::new();
        reader
            .seek(SeekFrom::Start(at))
            .and_then(|_| reader.take(most).read_to_end(&mut bytes))
            .map_err(|e| Error::io("read", source.path(), e))?;
        Ok::<_, Error>(bytes)
    };
    let (mut found, mut wide, mut at) = (Chunks::default(), None, 12);
    while at < source.len() {
        let tag = bytes(at, 8)?;
        let Some((id, size)) = chunk(&tag) else { break };
        let body = at + 8;
        let mut size = u64::from(size);
        match id {
            b"ds64" => wide = field(&bytes(body, 16)?, 8).map(u64::from_le_bytes),
            b"fmt " => found.format = Some((body, bytes(body, size.min(40))?)),
            b"data" if found.data.is_none() => {
                if size == UNSAID {
                    size = wide.unwrap_or(UNSAID);
                }
                if size == 0 && chunk(&bytes(body, 8)?).is_none() {
                    size = UNSAID;
                }
                found.data = Some((body, size));
            }
            b"LIST" => found.notes.extend(info(&bytes(body, size.min(MOST_TEXT))?)),
            _ => {}
        }
        at = body.saturating_add(size);
        if size % 2 == 1 && at < source.len() {
            // Some writers forget the zero byte after a chunk of odd size.
            let next = bytes(at, 8)?;
            at += u64::from(next.first() == Some(&0) || chunk(&next).is_none());
        }
    }
    Ok(found)
}

/// Reads place and kind of the samples from the chunks of a file.
pub fn read(source: &Source, reader: &mut dyn ReadSeek) -> Result<WavHeader> {
    let fault =
        |at, found: &str, expected: &str| Error::input(Place::byte(source.path(), at), found, expected);
    if !sniff(source.head(), source) {
        return Err(fault(0, "no wave file", "RIFF, RF64 or BW64, then a size and WAVE"));
    }
    let Chunks { format, data, notes } = chunks(source, reader)?;
    let Some((format_at, format)) = format else {
        return Err(fault(12, "no fmt chunk", "a chunk that says the kind of samples"));
    };
    let Some((data_at, size)) = data else {
        return Err(fault(12, "no data chunk", "a chunk with samples").hint(CUT));
    };
    let (sample, channels, rate, bits) = kind(&format).map_err(|(found, expected)| {
        fault(format_at, &found, expected).hint("convert it to integers of 16 or floats of 32 bits")
    })?;
    let mut findings = Vec::new();
    let bytes = sample.size() as usize;
    if bits < 8 * bytes {
        // The format puts 12 bits into the upper bits of two bytes; some writers use the lower bits.
        let wide = Finding::caution("bits-left-justified").count("bits", bits);
        findings.push(wide.count("bytes", bytes));
    }
    let frame = (bytes * channels) as u64;
    let room = source.len().saturating_sub(data_at);
    let present = size.min(room);
    let frames = present / frame;
    if frames == 0 {
        let (found, expected) =
            (format!("{present} bytes of samples"), format!("at least one frame of {frame} bytes"));
        return Err(fault(data_at, &found, &expected).hint(CUT));
    }
    let declared_frames = (size != UNSAID && size != u64::MAX).then_some(size / frame);
    match declared_frames {
        None => findings.push(Finding::caution("length-open").number("frames", frames as f64)),
        Some(declared) if size > room => findings.push(fewer(declared as usize, frames as usize)),
        Some(_) => {}
    }
    if present % frame != 0 {
        findings.push(Finding::note("part-of-frame").number("bytes", (present % frame) as f64));
    }
    let comment = notes.iter().find(|(id, _): &&(String, String)| id == "ICMT");
    // A comment that does not fit the samples belongs to another file.
    let scales = comment
        .and_then(|(_, text)| Scales::parse(text))
        .filter(|s| s.rate.round() == rate && s.channels.len() == channels);
    let rate = scales.as_ref().map_or(rate, |s| s.rate);
    if rate == 0.0 {
        return Err(fault(format_at + 4, "a sampling rate of 0 Hz", "a sampling rate"));
    }
    Ok(WavHeader { sample, channels, rate, data_at, frames, declared_frames, scales, notes, findings })
}

/// Name and size of a chunk; `None` if no chunk begins here.
fn chunk(tag: &[u8]) -> Option<(&[u8; 4], u32)> {
    let id = tag.first_chunk::<4>().filter(|id| id.iter().all(|b| (0x20..0x7f).contains(b)))?;
    Some((id, u32::from_le_bytes(field(tag, 4)?)))
}

fn field<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// Kind of sample, number of channels, sampling rate in Hz and bits per sample from a `fmt ` chunk; as an
/// error, the found and the expected form.
fn kind(format: &[u8]) -> std::result::Result<(NumberType, usize, f64, usize), (String, &'static str)> {
    let word = |at| field(format, at).map(u16::from_le_bytes);
    let (Some(mut tag), Some(channels), Some(rate), Some(frame), Some(mut bits)) =
        (word(0), word(2), field(format, 4).map(u32::from_le_bytes), word(12), word(14))
    else {
        return Err((format!("a fmt chunk of {} bytes", format.len()), "at least 16"));
    };
    if tag == 0xfffe {
        // In the extensible form, the sub-format begins with the true tag, and the true number of bits is
        // stored before it.
        tag = word(24).filter(|_| format.get(26..40) == Some(&GUID)).unwrap_or(tag);
        bits = word(18).filter(|valid| *valid > 0).unwrap_or(bits);
    }
    let bytes = usize::from(frame.checked_div(channels).unwrap_or(0));
    let sample = match (tag, bytes) {
        (1, 1) => Some(NumberType::U8),
        (1, 2) => Some(NumberType::I16),
        (1, 3) => Some(NumberType::I24),
        (1, 4) => Some(NumberType::I32),
        (3, 4) => Some(NumberType::F32),
        (3, 8) => Some(NumberType::F64),
        _ => None,
    };
    let whole = bytes * usize::from(channels) == usize::from(frame) && usize::from(bits) <= 8 * bytes;
    if let Some(sample) = sample.filter(|_| whole) {
        return Ok((sample, usize::from(channels), f64::from(rate), usize::from(bits)));
    }
    let kind = match tag {
        1 => "integers".to_owned(),
        3 => "floats".to_owned(),
        other => format!("samples of format tag {other:#06x}"),
    };
    let found =
        format!("{kind} of {bits} bits, {}, {frame} bytes a frame", counted(channels.into(), "channel"));
    Err((found, "integers of 8, 16, 24 or 32 bits or floats of 32 or 64 bits, whole bytes a channel"))
}

/// The texts of a LIST chunk of type INFO.
fn info(list: &[u8]) -> Vec<(String, String)> {
    let mut notes = Vec::new();
    let mut rest = list.strip_prefix(b"INFO").unwrap_or_default();
    while let Some((id, size)) = chunk(rest) {
        let body = &rest[8..];
        let size = (size as usize).min(body.len());
        let end = body[..size].iter().position(|b| *b == 0).unwrap_or(size);
        let value = encoding::decode(&body[..end]).into_owned();
        notes.push((String::from_utf8_lossy(id).into_owned(), value));
        rest = body.get(size + size % 2..).unwrap_or_default();
    }
    notes
}
