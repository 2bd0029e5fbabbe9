//! One file, read line by line and in binary blocks, and the lines that open and close its data sets.

use vibro_record::Place;

/// Byte order mark of UTF-8, which some editors add at the start.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// One file from its first to its last byte.
pub struct Stream<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Byte at which the last line read begins.
    start: usize,
    /// Lines read so far; `None` after a binary block, after which line numbers have no meaning.
    lines: Option<u64>,
}

impl<'a> Stream<'a> {
    /// Starts at the first byte, after a byte order mark.
    pub fn new(bytes: &'a [u8]) -> Stream<'a> {
        let at = if bytes.starts_with(MARK) { MARK.len() } else { 0 };
        Stream { bytes, at, start: at, lines: Some(0) }
    }

    /// Reads the next line, without its line feed; `None` at the end of the file.
    pub fn next_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        if rest.is_empty() {
            return None;
        }
        self.take_line((end + 1).min(rest.len()));
        Some(&rest[..end])
    }

    /// Reads the next line of a data set; `None` at the end of the file and before a delimiter, which is
    /// not read.
    pub fn line_within(&mut self) -> Option<&'a [u8]> {
        let before = Stream { ..*self };
        let line = self.next_line()?;
        if is_delimiter(line) {
            *self = before;
            return None;
        }
        Some(line)
    }

    /// Skips `bytes`, which are one line with its end.
    pub fn take_line(&mut self, bytes: usize) {
        self.start = self.at;
        self.at += bytes;
        self.lines = self.lines.map(|lines| lines + 1);
    }

    /// Reads a binary block.
    pub fn take_block(&mut self, bytes: usize) -> &'a [u8] {
        let block = &self.rest()[..bytes];
        self.at += bytes;
        self.lines = None;
        block
    }

    /// Skips everything up to and including the next delimiter. Returns the number of non-blank lines
    /// before it, and whether there is a delimiter.
    pub fn pass_set(&mut self) -> (usize, bool) {
        let mut lines = 0;
        while let Some(line) = self.line_within() {
            lines += usize::from(!line.trim_ascii().is_empty());
        }
        (lines, self.next_line().is_some())
    }

    /// The bytes not read yet.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Whether the last line read ended with a line feed, and not with the file.
    pub fn terminated(&self) -> bool {
        self.bytes[..self.at].ends_with(b"\n")
    }

    /// Place of the last line read: its number, or its byte after a binary block.
    pub fn place(&self) -> Place {
        let byte = if self.lines.is_none() { Some(self.start as u64) } else { None };
        Place { line: self.lines, byte, ..Place::default() }
    }

    /// Place of the byte `back` bytes before the first unread one.
    pub fn byte_place(&self, back: usize) -> Place {
        Place { byte: Some((self.at - back) as u64), ..Place::default() }
    }
}

/// Whether a line opens or closes a data set: `-1` within the first six columns, and nothing else.
///
/// A `-1` further to the right is a value: some writers print whole numbers without a decimal point.
pub fn is_delimiter(line: &[u8]) -> bool {
    let blanks = line.iter().take_while(|b| **b == b' ').count();
    blanks <= 4 && line.trim_ascii() == b"-1"
}

/// The number on the line after an opening `-1`, in its first six columns, and whether a `b` for binary
/// values follows it; `None` for any other line.
pub fn set_number(line: &[u8]) -> Option<(u32, bool)> {
    let start = line.iter().position(|b| *b != b' ')?;
    let end = start + line[start..].iter().take_while(|b| b.is_ascii_digit()).count();
    let (binary, rest) = match &line[end..] {
        [b'b' | b'B', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace) && (binary || rest.trim_ascii().is_empty());
    let number = std::str::from_utf8(&line[start..end]).ok()?.parse().ok()?;
    (ends && end <= 6).then_some((number, binary))
}

/// Whether `bytes`, which follow binary values, begin with a closing `-1`, alone or after one line end.
///
/// It must be in its exact columns: values are searched for it, and a looser form would also match values.
pub fn closes(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\r").unwrap_or(bytes);
    let bytes = bytes.strip_prefix(b"\n").unwrap_or(bytes);
    let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
    bytes[..end].strip_prefix(b"    -1").is_some_and(|rest| rest.trim_ascii().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_line_of_its_own_ends_a_set() {
        for line in ["    -1", "    -1   \r", "-1", "   -1 \t"] {
            assert!(is_delimiter(line.as_bytes()), "{line:?}");
        }
        for line in ["", "Test run -1", "    -1    0", "           -1", "    -1.0", "   -10", "    1"] {
            assert!(!is_delimiter(line.as_bytes()), "{line:?}");
        }
    }

    #[test]
    fn set_numbers() {
        let number = |text: &str| set_number(text.as_bytes());
        assert_eq!(number("    58"), Some((58, false)));
        assert_eq!(number("    58   \r"), Some((58, false)));
        assert_eq!(number("  2411"), Some((2411, false)));
        assert_eq!(number("58"), Some((58, false)));
        assert_eq!(number("    58b     1     2          11        6408"), Some((58, true)));
        for text in ["", "    -1", "        58", "    58  7", "    58bx", "  1.5", "    b", "1234567"] {
            assert_eq!(number(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_closing_line_may_stand_behind_a_line_end_that_should_not_be_there() {
        assert!(closes(b"    -1\r\n    -1"));
        assert!(closes(b"\r\n    -1"));
        assert!(closes(b"\n    -1  \n"));
        assert!(!closes(b"\n\n    -1"));
        assert!(!closes(b"\x00    -1"));
        assert!(!closes(b"   -1\n"));
        assert!(!closes(b""));
    }
}
