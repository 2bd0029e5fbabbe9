//! Lines and binary blocks of one file, read once through a buffer of fixed size.

use super::delimiter::is_delimiter;
use crate::Source;
use crate::source::ReadSeek;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use vibro_record::{Error, Place, Result};

/// Bytes read at a time: few enough to stay in the cache, and that the allocator hands out the same memory for each file.
const BLOCK: usize = 64 * 1024;

/// Bytes of one line that are kept. Standard lines have 80; binary data that is searched for the next data set may have
/// "lines" of any length.
const LONGEST: usize = 1 << 20;

/// Byte order mark of UTF-8, which some editors put first.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// One file from its first to its last byte, in text lines and binary blocks.
pub struct Stream<'a> {
    input: BufReader<Box<dyn ReadSeek>>,
    path: &'a Path,
    len: u64,
    position: u64,
    /// Lines taken; `None` behind a binary block, where counting lines means nothing.
    lines: Option<u64>,
    text: Vec<u8>,
    line_start: u64,
    terminated: bool,
    too_long: bool,
    held: bool,
}

/// How a data set ends.
pub struct End {
    /// Lines that are not blank before the delimiter.
    pub lines: u64,
    /// Whether there is a delimiter.
    pub closed: bool,
}

impl<'a> Stream<'a> {
    /// Opens a source at its first byte.
    pub fn open(source: &'a Source) -> Result<Stream<'a>> {
        let room = BLOCK.min(source.len() as usize + 1);
        let mut stream = Stream {
            input: BufReader::with_capacity(room, source.open()?),
            path: source.path(),
            len: source.len(),
            position: 0,
            lines: Some(0),
            text: Vec::with_capacity(128),
            line_start: 0,
            terminated: false,
            too_long: false,
            held: false,
        };
        if stream.buffer()?.starts_with(MARK) {
            stream.consume_lines(MARK.len(), 0);
        }
        Ok(stream)
    }

    /// Takes the next line into [`Stream::text`]; false at the end of the file.
    pub(crate) fn next_line(&mut self) -> Result<bool> {
        if std::mem::take(&mut self.held) {
            return Ok(true);
        }
        self.text.clear();
        self.line_start = self.position;
        self.terminated = false;
        self.too_long = false;
        while !self.terminated {
            let buffer = self.input.fill_buf().map_err(|e| Error::io("read", self.path, e))?;
            if buffer.is_empty() {
                break;
            }
            let end = buffer.iter().position(|b| *b == b'\n');
            let content = &buffer[..end.unwrap_or(buffer.len())];
            let room = LONGEST.saturating_sub(self.text.len());
            self.text.extend_from_slice(&content[..content.len().min(room)]);
            self.too_long |= content.len() > room;
            let used = content.len() + usize::from(end.is_some());
            self.terminated = end.is_some();
            self.input.consume(used);
            self.position += used as u64;
        }
        if self.position == self.line_start {
            return Ok(false);
        }
        if let Some(lines) = &mut self.lines {
            *lines += 1;
        }
        Ok(true)
    }

    /// Gives the same line again at the next call of [`Stream::next_line`].
    pub fn hold(&mut self) {
        self.held = true;
    }

    /// The line taken last, without its line feed.
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// Whether the line taken last ended with a line feed, and not with the file.
    pub(crate) fn terminated(&self) -> bool {
        self.terminated
    }

    /// Whether the line taken last is longer than what is kept of it.
    pub(crate) fn too_long(&self) -> bool {
        self.too_long
    }

    /// Passes over everything up to and with the next delimiter.
    pub(crate) fn pass_set(&mut self) -> Result<End> {
        let mut lines = 0;
        while self.next_line()? {
            if is_delimiter(&self.text) {
                return Ok(End { lines, closed: true });
            }
            lines += u64::from(!self.text.trim_ascii().is_empty());
        }
        Ok(End { lines, closed: false })
    }

    /// Bytes that are buffered; none at the end of the file.
    pub fn buffer(&mut self) -> Result<&[u8]> {
        self.input.fill_buf().map_err(|e| Error::io("read", self.path, e))
    }

    /// Takes bytes of the buffer that hold whole lines.
    pub(crate) fn consume_lines(&mut self, bytes: usize, lines: u64) {
        self.input.consume(bytes);
        self.position += bytes as u64;
        if let Some(count) = &mut self.lines {
            *count += lines;
        }
    }

    /// Takes binary bytes of the buffer.
    pub(crate) fn consume_binary(&mut self, bytes: usize) {
        self.input.consume(bytes);
        self.position += bytes as u64;
        self.lines = None;
    }

    /// Fills `target` with binary bytes; false where the file ends before.
    pub(crate) fn take_binary(&mut self, target: &mut [u8]) -> Result<bool> {
        if self.remaining() < target.len() as u64 {
            return Ok(false);
        }
        self.lines = None;
        self.input.read_exact(target).map_err(|e| Error::io("read", self.path, e))?;
        self.position += target.len() as u64;
        Ok(true)
    }

    /// Up to 128 bytes that stand `ahead` of the position, which stays where it is.
    pub fn peek(&mut self, ahead: u64) -> Result<Vec<u8>> {
        let Ok(offset) = i64::try_from(ahead) else { return Ok(Vec::new()) };
        let mut bytes = Vec::new();
        if ahead < self.remaining() {
            let failed = |e| Error::io("read", self.path, e);
            self.input.seek_relative(offset).map_err(failed)?;
            (&mut self.input).take(128).read_to_end(&mut bytes).map_err(failed)?;
            self.input.seek_relative(-offset - bytes.len() as i64).map_err(failed)?;
        }
        Ok(bytes)
    }

    /// Bytes not taken yet. A file that shrank while it was read has none left.
    pub fn remaining(&self) -> u64 {
        self.len.saturating_sub(self.position)
    }

    /// Number of the line taken last, from 1; `None` behind a binary block.
    pub fn line(&self) -> Option<u64> {
        self.lines
    }

    /// Place of the line taken last.
    pub fn place(&self) -> Place {
        match self.lines {
            Some(line) => Place::line(self.path, line),
            None => Place::byte(self.path, self.line_start),
        }
    }

    /// Bytes taken.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// A byte of this file, for complaints.
    pub(crate) fn byte_place(&self, byte: u64) -> Place {
        Place::byte(self.path, byte)
    }
}
