//! Lines and fields after RFC 4180, with any separator and any line end.

use std::borrow::Cow;

/// How long a quoted field may be: a stray quote must not swallow the rest of the file.
const LONGEST_QUOTE: usize = 4096;

/// One line, or several that a quoted field joins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// Counted from 1.
    pub number: u64,
    /// Byte at which it begins.
    pub at: usize,
    pub text: &'a str,
}

impl<'a> Line<'a> {
    pub fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// What a comment line says; `None` for any other line.
    pub fn comment(&self) -> Option<&'a str> {
        let text = self.text.trim_start();
        text.starts_with(['#', '%']).then(|| text.trim_start_matches(['#', '%']).trim())
    }

    /// Column, counted from 1, of a byte of this line.
    pub fn column(&self, byte: usize) -> u64 {
        self.text.char_indices().take_while(|(at, _)| *at < byte).count() as u64 + 1
    }
}

/// The lines of a text that ends them with LF, CR LF or CR.
pub struct Lines<'a> {
    text: &'a str,
    at: usize,
    number: u64,
}

impl<'a> Lines<'a> {
    /// From byte `at` on, which is the start of line `number`.
    pub fn from(text: &'a str, at: usize, number: u64) -> Lines<'a> {
        Lines { text, at, number }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let start = self.at;
        let rest = self.text.get(start..).filter(|r| !r.is_empty())?;
        let bytes = rest.as_bytes();
        let mut line = Line { number: self.number, at: start, text: rest };
        let quotes = line.comment().is_none();
        let (mut end, mut opens) = (0, true);
        while let Some(byte) = bytes.get(end) {
            match byte {
                b'\n' | b'\r' => break,
                b'"' if quotes && opens => {
                    // A quote that is never closed is a character like any other.
                    if let Some(length) = quoted(&bytes[end..]) {
                        self.number += line_ends(&bytes[end..end + length]);
                        end += length - 1;
                    }
                    opens = false;
                }
                b',' | b';' | b'\t' => opens = true,
                b' ' => {}
                _ => opens = false,
            }
            end += 1;
        }
        line.text = rest.get(..end)?;
        let crlf = bytes[end..].starts_with(b"\r\n");
        self.at = start + end + 1 + usize::from(crlf);
        self.number += 1;
        Some(line)
    }
}

/// Length of the quoted text at the start of `bytes`, quotes included.
fn quoted(bytes: &[u8]) -> Option<usize> {
    let bytes = &bytes[..bytes.len().min(LONGEST_QUOTE)];
    let mut at = 1;
    loop {
        at += bytes.get(at..)?.iter().position(|b| *b == b'"')? + 1;
        if bytes.get(at) != Some(&b'"') {
            return Some(at);
        }
        at += 1;
    }
}

fn line_ends(bytes: &[u8]) -> u64 {
    let lone = |at: usize| bytes[at] == b'\n' || (bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    (0..bytes.len()).filter(|at| lone(*at)).count() as u64
}

/// Cuts a line into fields, each with the byte at which it begins; blanks around a field do not count.
///
/// # Errors
/// The byte at which something stands behind a closing quote.
pub fn cut<'a>(line: &'a str, separator: char, fields: &mut Vec<(usize, Cow<'a, str>)>) -> Result<(), usize> {
    fields.clear();
    let mut at = 0;
    loop {
        let rest = &line[at..];
        let blanks = rest.len() - rest.trim_start_matches(' ').len();
        let body = &rest[blanks..];
        let length = if body.starts_with('"') { quoted(body.as_bytes()) } else { None };
        let end = if let Some(length) = length {
            let behind = body[length..].find(separator).unwrap_or(body.len() - length);
            if !body[length..length + behind].trim().is_empty() {
                return Err(at + blanks + length);
            }
            fields.push((at + blanks, body[1..length - 1].replace("\"\"", "\"").into()));
            blanks + length + behind
        } else {
            let end = rest.find(separator).unwrap_or(rest.len());
            let field = &rest[..end];
            let trimmed = field.trim_start();
            fields.push((at + field.len() - trimmed.len(), trimmed.trim_end().into()));
            end
        };
        if at + end >= line.len() {
            return Ok(());
        }
        at += end + separator.len_utf8();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines(text: &str) -> Vec<(u64, &str)> {
        Lines::from(text, 0, 1).map(|l| (l.number, l.text)).collect()
    }

    fn fields(line: &str, separator: char) -> Vec<String> {
        let mut out = Vec::new();
        cut(line, separator, &mut out).unwrap();
        out.into_iter().map(|(_, f)| f.into_owned()).collect()
    }

    #[test]
    fn every_line_end() {
        let expected = vec![(1, "a"), (2, ""), (3, "b")];
        for text in ["a\n\nb", "a\r\n\r\nb\r\n", "a\r\rb\r"] {
            assert_eq!(lines(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_quoted_field_joins_lines() {
        assert_eq!(lines("\"a\nb\",c\nd"), [(1, "\"a\nb\",c"), (3, "d")]);
        assert_eq!(lines("x;\"a\r\nb\"\r\nd"), [(1, "x;\"a\r\nb\""), (3, "d")]);
        // Inches, comments and forgotten quotes do not.
        assert_eq!(lines("5\" pipe\nb \"c\nd"), [(1, "5\" pipe"), (2, "b \"c"), (3, "d")]);
        assert_eq!(lines("# \"open\n1\n\"2\n"), [(1, "# \"open"), (2, "1"), (3, "\"2")]);
    }

    #[test]
    fn fields_and_their_places() {
        assert_eq!(fields("a, b ,,", ','), ["a", "b", "", ""]);
        assert_eq!(fields("", ','), [""]);
        assert_eq!(fields("\"a,b\" ;\"say \"\"x\"\"\"; c", ';'), ["a,b", "say \"x\"", "c"]);
        assert_eq!(fields("1,5\t2", '\t'), ["1,5", "2"]);
        let mut out = Vec::new();
        cut("ab,  cd", ',', &mut out).unwrap();
        assert_eq!(out[1].0, 5);
        assert_eq!(cut("\"a\"b,c", ',', &mut out), Err(3));
    }

    proptest! {
        #[test]
        fn never_panics(text in "[a-z0-9,;\t\"\r\n #µ]{0,60}") {
            let mut out = Vec::new();
            let mut total = 0;
            for line in Lines::from(&text, 0, 1) {
                total += line.text.len();
                for separator in [',', ';', '\t'] {
                    let _ = cut(line.text, separator, &mut out);
                }
            }
            prop_assert!(total <= text.len());
        }

        /// What is quoted by the rule of RFC 4180 comes back.
        #[test]
        fn quoting_is_undone(fields_in in prop::collection::vec("[a-z,;\"\r\n ]{0,8}", 1..5)) {
            let quoted: Vec<String> = fields_in.iter().map(|f| format!("\"{}\"", f.replace('"', "\"\""))).collect();
            let text = quoted.join(",");
            let all: Vec<Line> = Lines::from(&text, 0, 1).collect();
            prop_assert_eq!(all.len(), 1);
            prop_assert_eq!(fields(all[0].text, ','), fields_in);
        }
    }
}
