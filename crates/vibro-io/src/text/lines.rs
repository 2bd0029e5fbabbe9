//! Cuts text into lines and fields as in RFC 4180, with any separator.
//!
//! The crate `csv` is not used: it reads `"2"3` as 23, a stray quote makes it read the rest of a file as
//! one field, and it does not return the column at which a field begins.

use super::clock;
use super::unit_words::is_unit_row;
use crate::number;
use std::borrow::Cow;

/// Separator between two values of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// Any run of spaces and tabs.
    Blank,
    /// One character: `,`, `;` or tab. Fields may be quoted.
    Char(u8),
}

/// Fields of a line, each with the byte offset at which it begins.
pub type Fields<'a> = Vec<(usize, Cow<'a, str>)>;

/// One line, or two lines joined by a quoted field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// Number of the line in the file, from 1.
    pub number: u64,
    /// Byte offset at which the line begins.
    pub at: usize,
    pub text: &'a str,
    /// Text of a remark after its mark; `None` for other lines.
    pub remark: Option<&'a str>,
}

impl Line<'_> {
    pub(crate) fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// Column, counted from 1 in characters, of a byte of this line.
    pub fn column(&self, byte: usize) -> u64 {
        self.text.char_indices().take_while(|(at, _)| *at < byte).count() as u64 + 1
    }
}

/// Iterates over lines that end with LF or CR LF.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    text: &'a str,
    at: usize,
    number: u64,
    remarks: &'static [&'static str],
}

impl<'a> Lines<'a> {
    /// Lines from byte `at` on, which is the start of line `number`. A line that begins with one of
    /// `remarks` is a remark.
    pub fn new(text: &'a str, at: usize, number: u64, remarks: &'static [&'static str]) -> Lines<'a> {
        Lines { text, at, number, remarks }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let (start, number) = (self.at, self.number);
        let rest = self.text.get(start..).filter(|r| !r.is_empty())?;
        let end = |from: usize| rest[from..].find('\n').map_or(rest.len(), |end| from + end);
        let mut text = &rest[..end(0)];
        let remark = remark(text, self.remarks);
        // A quoted field may contain one line end: its quote opens on this line and closes on the next.
        let open = |text: &str| text.matches('"').count() % 2 == 1;
        let both = &rest[..end((text.len() + 1).min(rest.len()))];
        if remark.is_none() && open(text) && !open(both) {
            text = both;
            self.number += 1;
        }
        self.at = start + text.len() + 1;
        self.number += 1;
        Some(Line { number, at: start, text: text.trim_end_matches('\r'), remark })
    }
}

/// Text of a remark after its mark; `None` if the line is not a remark.
fn remark<'a>(line: &'a str, marks: &[&str]) -> Option<&'a str> {
    let line = line.trim();
    // Fortran prints `*****` for a number that does not fit into its field: a missing value, not a remark.
    let stars = line.len() > 1 && line.bytes().all(|b| b == b'*');
    let mark = marks.iter().find(|mark| line.starts_with(**mark) && !stars)?;
    // `#` alone in the first cell names a column of row numbers.
    if line.strip_prefix('#').is_some_and(|cells| cells.starts_with([',', ';'])) {
        return None;
    }
    Some(line.trim_start_matches(mark).trim())
}

/// Length in bytes of the quoted text at the start of `bytes`, including the quotes.
fn quoted(bytes: &[u8]) -> Option<usize> {
    let mut at = 1;
    loop {
        at += bytes.get(at..)?.iter().position(|b| *b == b'"')? + 1;
        if bytes.get(at) != Some(&b'"') {
            return Some(at);
        }
        at += 1;
    }
}

/// Mark that serial monitors print after the computer's clock.
const ARROW: &str = " -> ";

/// Cuts a line into fields without the blanks around them.
///
/// # Errors
/// The byte offset of text after a closing quote.
pub fn fields(line: &str, separator: Separator) -> Result<Fields<'_>, usize> {
    let Separator::Char(mark) = separator else {
        let words = line.split([' ', '\t', '\r']).filter(|w| !w.is_empty() && *w != ARROW.trim());
        return Ok(words.map(|w| (w.as_ptr() as usize - line.as_ptr() as usize, w.into())).collect());
    };
    let mark = char::from(mark);
    let mut fields = Vec::new();
    let mut at = 0;
    loop {
        let rest = &line[at..];
        let blanks = rest.len() - rest.trim_start_matches(' ').len();
        let body = &rest[blanks..];
        let length = if body.starts_with('"') { quoted(body.as_bytes()) } else { None };
        let end = if let Some(length) = length {
            let behind = body[length..].find(mark).unwrap_or(body.len() - length);
            if !body[length..length + behind].trim().is_empty() {
                return Err(at + blanks + length);
            }
            fields.push((at + blanks, body[1..length - 1].replace("\"\"", "\"").into()));
            blanks + length + behind
        } else {
            let end = rest.find(mark).unwrap_or(rest.len());
            let arrow = if rest.as_bytes()[..end].contains(&b'>') { rest[..end].find(ARROW) } else { None };
            let arrow = arrow.filter(|arrow| clock::is_clock(rest[..*arrow].trim()));
            let field = &rest[..arrow.unwrap_or(end)];
            let trimmed = field.trim_start();
            fields.push((at + field.len() - trimmed.len(), trimmed.trim_end().into()));
            arrow.map_or(end, |arrow| arrow + ARROW.len() - 1)
        };
        if at + end >= line.len() {
            return Ok(fields);
        }
        at += end + 1;
    }
}

/// Whether a line is a row with faults. It has as many cells as there are columns, and either all non-blank
/// cells are missing values; or the first cell begins with a digit, at least one cell is a number and one
/// is a word, and the line is not a row of units.
pub fn is_torn(line: &str, separator: Separator, columns: usize) -> bool {
    let cells = fields(line, separator).unwrap_or_default();
    let cells: Vec<&str> = cells.iter().map(|(_, cell)| cell.as_ref()).collect();
    let number = |cell: &&str| number::either(cell.as_bytes()).is_some();
    let word = |c: &&str| !number(c) && !number::is_missing(c.as_bytes()) && !clock::is_clock(c);
    let digit =
        |cell: &&str| cell.trim_start_matches(['-', '+', '<', '>']).starts_with(|c: char| c.is_ascii_digit());
    let missing = |cell: &&str| number::is_missing(cell.as_bytes());
    if cells.len() == columns && cells.iter().all(|c| c.is_empty() || missing(c)) && cells.iter().any(missing)
    {
        return true;
    }
    let torn = cells.len() == columns && cells.first().is_some_and(digit);
    torn && cells.iter().any(number) && cells.iter().any(word) && !is_unit_row(cells.into_iter())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines(text: &str) -> Vec<(u64, &str)> {
        Lines::new(text, 0, 1, &["#", "%"]).map(|l| (l.number, l.text)).collect()
    }

    fn cut(line: &str, separator: char) -> Result<Fields<'_>, usize> {
        fields(line, Separator::Char(separator as u8))
    }

    fn texts(line: &str, separator: char) -> Vec<String> {
        cut(line, separator).unwrap().into_iter().map(|(_, f)| f.into_owned()).collect()
    }

    #[test]
    fn every_line_end() {
        let expected = vec![(1, "a"), (2, ""), (3, "b")];
        for text in ["a\n\nb", "a\r\n\r\nb\r\n", "a\r\r\n\nb\n"] {
            assert_eq!(lines(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_quoted_field_joins_two_lines() {
        assert_eq!(lines("\"a\nb\",c\nd"), [(1, "\"a\nb\",c"), (3, "d")]);
        assert_eq!(lines("x;\"a\r\nb\"\r\nd"), [(1, "x;\"a\r\nb\""), (3, "d")]);
        // A mark of inches and a remark do not join lines.
        assert_eq!(lines("5\" pipe\nb\nd"), [(1, "5\" pipe"), (2, "b"), (3, "d")]);
        assert_eq!(lines("# \"open\n1\n\"2\n"), [(1, "# \"open"), (2, "1"), (3, "\"2")]);
    }

    #[test]
    fn fields_and_their_places() {
        assert_eq!(texts("a, b ,,", ','), ["a", "b", "", ""]);
        assert_eq!(texts("", ','), [""]);
        assert_eq!(texts("\"a,b\" ;\"say \"\"x\"\"\"; c", ';'), ["a,b", "say \"x\"", "c"]);
        assert_eq!(texts("1,5\t2", '\t'), ["1,5", "2"]);
        assert_eq!(cut("ab,  cd", ',').unwrap()[1].0, 5);
        assert_eq!(cut("\"a\"b,c", ','), Err(3));
    }

    proptest! {
        #[test]
        fn never_panics(text in "[a-z0-9,;\t\"\r\n #µ]{0,60}") {
            let mut total = 0;
            for line in Lines::new(&text, 0, 1, &["#", "%"]) {
                total += line.text.len();
                for separator in [',', ';', '\t'] {
                    let _ = cut(line.text, separator);
                }
            }
            prop_assert!(total <= text.len());
        }

        /// Fields quoted as in RFC 4180 are read back unchanged.
        #[test]
        fn quoting_is_undone(fields_in in prop::collection::vec("[a-z,;\"]{0,8}", 1..5)) {
            let quoted: Vec<String> = fields_in.iter().map(|f| format!("\"{}\"", f.replace('"', "\"\""))).collect();
            let text = quoted.join(",");
            let all: Vec<Line> = Lines::new(&text, 0, 1, &["#", "%"]).collect();
            prop_assert_eq!(all.len(), 1);
            prop_assert_eq!(texts(all[0].text, ','), fields_in);
        }
    }
}
