//! Where the samples of a wave file are, and of what kind.
//!
//! Sources: Microsoft, "Multiple channel audio data and WAVE files" (`WAVE_FORMAT_EXTENSIBLE`); EBU Tech 3306 (RF64) and
//! ITU-R BS.2088 (BW64) for the `ds64` chunk.

use super::scales::Scales;
use crate::Source;
use crate::source::ReadSeek;
use crate::text::encoding;
use std::fmt;
use std::io::{Read, SeekFrom};
use vibro_record::{Error, Finding, Place, Result};

/// How many chunks are looked at: real files have a dozen.
const MOST_CHUNKS: usize = 10_000;
/// How many bytes of texts are looked at in one chunk.
const MOST_TEXT: u64 = 64 * 1024;
/// How many texts are kept, and how many bytes of them: real files have ten, of a line each.
const MOST_NOTES: usize = 64;
const MOST_NOTE_BYTES: usize = 64 * 1024;
/// Most channels of any recorder; more are a damaged header.
const MOST_CHANNELS: usize = 1024;
/// A size that was never filled in.
const UNSAID: u64 = 0xffff_ffff;
/// Behind the format tag in a sub-format: {xxxx0000-0000-0010-8000-00AA00389B71}.
const GUID: [u8; 14] = [0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71];

/// What the chunks say.
#[derive(Debug)]
pub struct Layout {
    pub sample: Sample,
    pub channels: usize,
    pub rate: f64,
    pub data_at: u64,
    pub frames: u64,
    pub declared_frames: Option<u64>,
    pub scales: Option<Scales>,
    pub notes: Vec<(String, String)>,
    pub findings: Vec<Finding>,
}

/// Kind of a sample; integers are left-justified in their bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// Of 1 (unsigned), 2, 3 or 4 bytes.
    Integer(usize),
    /// Of 4 or 8 bytes.
    Float(usize),
}

impl Sample {
    pub fn bytes(self) -> usize {
        match self {
            Sample::Integer(n) | Sample::Float(n) => n,
        }
    }

    /// Fraction of full scale; `bytes` has the length [`Sample::bytes`].
    pub fn value(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Sample::Integer(_), [a]) => (f64::from(*a) - 128.0) / 128.0,
            (Sample::Integer(_), [a, b]) => f64::from(i16::from_le_bytes([*a, *b])) / 32_768.0,
            // Three bytes as the upper ones of four.
            (Sample::Integer(_), [a, b, c]) => {
                f64::from(i32::from_le_bytes([0, *a, *b, *c])) / 2_147_483_648.0
            }
            (Sample::Integer(_), [a, b, c, d]) => {
                f64::from(i32::from_le_bytes([*a, *b, *c, *d])) / 2_147_483_648.0
            }
            (Sample::Float(_), [a, b, c, d]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            (Sample::Float(_), [a, b, c, d, e, f, g, h]) => {
                f64::from_le_bytes([*a, *b, *c, *d, *e, *f, *g, *h])
            }
            _ => f64::NAN,
        }
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if matches!(self, Sample::Integer(_)) { "integer" } else { "float" };
        write!(f, "{}-bit {kind}", 8 * self.bytes())
    }
}

/// Goes from chunk to chunk.
pub fn read(source: &Source, reader: &mut dyn ReadSeek) -> Result<Layout> {
    let mut file = Chunks { source, reader };
    let head = file.bytes(0, 12)?;
    if head.starts_with(b"RIFX") {
        return Err(fault(source, 0, "a big-endian wave file (RIFX)", "RIFF, RF64 or BW64")
            .hint("convert it to a little-endian wave file"));
    }
    if !super::sniff(&head, source) {
        return Err(fault(source, 0, "no wave file", "RIFF, RF64 or BW64, then a size and WAVE"));
    }
    let (mut wide, mut format, mut data) = (None, None, None);
    let (mut notes, mut scales, mut dropped) = (Vec::new(), None, 0);
    let mut at = 12;
    for _ in 0..MOST_CHUNKS {
        let tag = file.bytes(at, 8)?;
        let Some((id, size)) = chunk(&tag) else { break };
        let body = at + 8;
        let mut size = u64::from(size);
        match id {
            b"ds64" => wide = field(&file.bytes(body, 16)?, 8).map(u64::from_le_bytes),
            b"fmt " => format = Some((body, file.bytes(body, size.min(40))?)),
            b"data" if data.is_none() => {
                if size == UNSAID {
                    size = wide.unwrap_or(UNSAID);
                }
                if size == 0 && chunk(&file.bytes(body, 8)?).is_none() {
                    size = UNSAID;
                }
                data = Some((body, size));
            }
            b"LIST" => info(&file.bytes(body, size.min(MOST_TEXT))?, &mut notes, &mut scales, &mut dropped),
            _ => {}
        }
        at = body.saturating_add(size);
        if size % 2 == 1 && at < source.len() {
            // Some writers forget the zero byte behind an odd chunk.
            let next = file.bytes(at, 8)?;
            at += u64::from(next.first() == Some(&0) || chunk(&next).is_none());
        }
    }
    let Some((format_at, format)) = format else {
        return Err(fault(source, 12, "no fmt chunk", "a chunk that says the kind of samples"));
    };
    let Some((data_at, size)) = data else {
        return Err(fault(source, 12, "no data chunk", "a chunk with samples")
            .hint("the recording may have been cut off before its first sample"));
    };
    let mut findings = Vec::new();
    if dropped > 0 {
        let kept = notes.len();
        findings.push(Finding::note("remarks-dropped").count("n", kept + dropped).count("kept", kept));
    }
    let Format { sample, channels, rate } = kind(source, format_at, &format, &mut findings)?;
    let frame = (sample.bytes() * channels) as u64;
    let room = source.len().saturating_sub(data_at);
    let present = size.min(room);
    let frames = present / frame;
    if frames == 0 {
        let found = format!("{present} bytes of samples");
        return Err(fault(source, data_at, found, format!("at least one frame of {frame} bytes"))
            .hint("the recording may have been cut off before its first sample"));
    }
    let declared_frames = (size != UNSAID && size != u64::MAX).then_some(size / frame);
    match declared_frames {
        None => findings.push(Finding::caution("length-open").number("frames", frames as f64)),
        Some(declared) if size > room => {
            let fewer = Finding::caution("fewer-values").number("declared", declared as f64);
            findings.push(fewer.number("n", frames as f64));
        }
        Some(_) => {}
    }
    if present % frame != 0 {
        findings.push(Finding::note("part-of-frame").number("bytes", (present % frame) as f64));
    }
    let mut layout =
        Layout { sample, channels, rate, data_at, frames, declared_frames, scales, notes, findings };
    // A comment that does not fit the samples is from another file.
    layout.scales = layout.scales.filter(|s| s.rate.round() == rate && s.channels.len() == channels);
    layout.rate = layout.scales.as_ref().map_or(rate, |s| s.rate);
    if layout.rate == 0.0 {
        return Err(fault(source, format_at + 4, "a sampling rate of 0 Hz", "a sampling rate"));
    }
    Ok(layout)
}

struct Chunks<'a> {
    source: &'a Source,
    reader: &'a mut dyn ReadSeek,
}

impl Chunks<'_> {
    /// At most `most` bytes from `at` on: fewer where the file ends.
    fn bytes(&mut self, at: u64, most: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        if at >= self.source.len() {
            return Ok(bytes);
        }
        self.reader
            .seek(SeekFrom::Start(at))
            .and_then(|_| (&mut *self.reader).take(most).read_to_end(&mut bytes))
            .map_err(|e| Error::io("read", self.source.path(), e))?;
        Ok(bytes)
    }
}

/// Name and size of a chunk; `None` where no chunk begins.
fn chunk(tag: &[u8]) -> Option<(&[u8; 4], u32)> {
    let id = tag.first_chunk::<4>().filter(|id| id.iter().all(|b| (0x20..0x7f).contains(b)))?;
    Some((id, u32::from_le_bytes(field(tag, 4)?)))
}

fn field<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

fn fault(source: &Source, at: u64, found: impl Into<String>, expected: impl Into<String>) -> Error {
    Error::input(Place::byte(source.path(), at), found, expected)
}

struct Format {
    sample: Sample,
    channels: usize,
    rate: f64,
}

/// Reads the `fmt ` chunk.
fn kind(source: &Source, at: u64, format: &[u8], findings: &mut Vec<Finding>) -> Result<Format> {
    let word = |at| field(format, at).map(u16::from_le_bytes);
    let (Some(mut tag), Some(channels), Some(rate), Some(frame), Some(mut bits)) =
        (word(0), word(2), field(format, 4).map(u32::from_le_bytes), word(12), word(14))
    else {
        return Err(fault(source, at, format!("a fmt chunk of {} bytes", format.len()), "at least 16"));
    };
    if tag == 0xfffe {
        // The extensible form: the true tag opens the sub-format, the true number of bits stands before it.
        tag = word(24).filter(|_| format.get(26..40) == Some(&GUID)).unwrap_or(tag);
        bits = word(18).filter(|valid| *valid > 0).unwrap_or(bits);
    }
    let channels = usize::from(channels);
    let bytes = usize::from(frame).checked_div(channels).unwrap_or(0);
    let sample = match (tag, bytes) {
        (1, 1..=4) if channels <= MOST_CHANNELS => Sample::Integer(bytes),
        (3, 4 | 8) if channels <= MOST_CHANNELS => Sample::Float(bytes),
        _ => {
            let found = format!("{} of {bits} bits, {channels} channel(s), {frame} bytes a frame", name(tag));
            let expected =
                "integers of 8, 16, 24 or 32 bits or floats of 32 or 64 bits in 1 to 1024 channels";
            return Err(fault(source, at, found, expected).hint("convert it to one of these"));
        }
    };
    if bytes * channels != usize::from(frame) || usize::from(bits) > 8 * bytes {
        let found = format!("{channels} channel(s) of {bits} bits in {frame} bytes a frame");
        return Err(fault(source, at, found, "a whole number of bytes a channel that holds its bits"));
    }
    // 12 bits in two bytes fill them from the top, so says the format; some writers fill them from the bottom.
    if usize::from(bits) < 8 * bytes && tag == 1 {
        let wide = Finding::caution("bits-left-justified").number("bits", f64::from(bits));
        findings.push(wide.count("bytes", bytes));
    }
    Ok(Format { sample, channels, rate: f64::from(rate) })
}

fn name(tag: u16) -> String {
    match tag {
        1 => "integers".into(),
        3 => "floats".into(),
        2 | 0x11 => "ADPCM".into(),
        6 => "A-law".into(),
        7 => "µ-law".into(),
        0x50 | 0x55 => "MPEG audio".into(),
        other => format!("samples of format tag {other:#06x}"),
    }
}

/// Keeps the texts of a LIST chunk of type INFO.
fn info(list: &[u8], notes: &mut Vec<(String, String)>, scales: &mut Option<Scales>, dropped: &mut usize) {
    let Some(mut rest) = list.strip_prefix(b"INFO") else { return };
    let mut bytes: usize = notes.iter().map(|(_, text)| text.len()).sum();
    while let Some((id, size)) = chunk(rest) {
        let body = &rest[8..];
        let size = (size as usize).min(body.len());
        let end = body[..size].iter().position(|b| *b == 0).unwrap_or(size);
        let value = encoding::decode(&body[..end]).into_owned();
        if id == b"ICMT" && scales.is_none() {
            *scales = Scales::parse(&value);
        }
        bytes = bytes.saturating_add(value.len());
        if notes.len() < MOST_NOTES && bytes <= MOST_NOTE_BYTES && *dropped == 0 {
            notes.push((String::from_utf8_lossy(id).into_owned(), value));
        } else {
            *dropped += 1;
        }
        rest = body.get(size + size % 2..).unwrap_or_default();
    }
}
