//! How a text of numbers ends: with a whole row, with words, or in the middle of its last number.

use super::Source;
use crate::error::{Error, Result};
use std::io::{Read, SeekFrom};

/// Bytes at the end that are looked at.
pub(super) const LOOK: usize = 4096;
/// Rows above the last one that must agree before it can be called short.
const ROWS: usize = 3;

/// What to try where the last row of a file cannot be read.
pub(super) const CUT_OFF: &str =
    "the file ends within this row, so the export was cut off: export it again, or remove the row";

/// A doubt about the last number of a source; see [`doubt`].
pub(super) fn doubt_of(source: &Source, separator: u8, decimal: u8) -> Result<Option<String>> {
    let failed = |e| Error::io("read", source.path(), e);
    let mut tail = Vec::new();
    let mut input = source.open()?;
    input.seek(SeekFrom::Start(source.len().saturating_sub(LOOK as u64))).map_err(failed)?;
    input.take(LOOK as u64).read_to_end(&mut tail).map_err(failed)?;
    Ok(doubt(&tail, separator, decimal))
}

/// A doubt where `tail`, the end of a file, lacks its line end and its last number has fewer digits than the same column
/// has in all rows above.
pub(super) fn doubt(tail: &[u8], separator: u8, decimal: u8) -> Option<String> {
    let ended = tail.last().is_none_or(|b| matches!(b, b'\n' | b'\r' | 0x1a));
    if ended {
        return None;
    }
    let mut rows = tail
        .rsplit(|b| matches!(b, b'\n' | b'\r'))
        .map(<[u8]>::trim_ascii)
        .filter(|row| !row.is_empty())
        .map(|row| row.rsplit(|b| *b == separator || b.is_ascii_whitespace()).next().unwrap_or(row));
    let last = rows.next()?;
    let found = digits(last, decimal)?;
    // Up to the names: they are no numbers.
    let above: Vec<(usize, usize)> = rows.map_while(|cell| digits(cell, decimal)).collect();
    let usual = *above.first()?;
    let agree = above.len() >= ROWS && above.iter().all(|d| *d == usual);
    let short = found.0 < usual.0 || found.1 < usual.1;
    (short && agree).then(|| {
        format!(
            "The file ends without a line end, and its last number {:?} has fewer digits than those above: it may be cut off.",
            String::from_utf8_lossy(last)
        )
    })
}

/// Fewer rows may be the head of a list of files.
const FEW: usize = 4;
/// How many lines may stand behind the values.
const FOOTER: usize = 16;

/// A doubt that quotes `rest`, the last lines of a file with `rows` rows of numbers, where they are nothing but words;
/// `None` where they may hold values.
pub(super) fn footer<'a>(rows: usize, rest: impl Iterator<Item = &'a [u8]>) -> Option<String> {
    let mut lines = Vec::new();
    for line in rest.map(<[u8]>::trim_ascii).filter(|l| !matches!(l, [] | [0x1a])) {
        if lines.len() == FOOTER || !is_words(line) {
            return None;
        }
        lines.push(format!("{:?}", super::ascii::shorten(&String::from_utf8_lossy(line))));
    }
    (rows >= FEW && !lines.is_empty()).then(|| {
        format!(
            "Behind the values stand {} line(s) without any, passed over: {}.",
            lines.len(),
            lines.join(", ")
        )
    })
}

/// Whether a line begins with a word: what begins like a number may be one that is cut off, and a word beside numbers may
/// stand for a value.
pub(super) fn is_words(line: &[u8]) -> bool {
    let begin = line.iter().find(|b| !b"+-.,( ".contains(b));
    let mut fields = line.split(|b| b" \t,;".contains(b)).filter(|f| !f.is_empty());
    begin.is_some_and(|b| !b.is_ascii_digit())
        && line.iter().filter(|b| b.is_ascii_alphabetic() || !b.is_ascii()).count() > 2
        && fields.next().is_some_and(|first| !super::number::is_missing(first))
        && !fields.any(|field| super::number::parse_with(field, b'.').is_some())
}

/// Digits behind the decimal mark and digits of the exponent; `None` for what is no number.
fn digits(cell: &[u8], decimal: u8) -> Option<(usize, usize)> {
    super::number::parse_with(cell, decimal)?;
    let end = cell.iter().position(u8::is_ascii_alphabetic).unwrap_or(cell.len());
    let (mantissa, exponent) = cell.split_at(end);
    let behind = mantissa.iter().position(|b| *b == decimal).map_or(0, |at| mantissa.len() - at - 1);
    Some((behind, exponent.iter().filter(|b| b.is_ascii_digit()).count()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> bool {
        doubt(text.as_bytes(), b',', b'.').is_some()
    }

    #[test]
    fn a_number_shorter_than_all_above_may_be_cut() {
        let above = "0.1,1.250E-03\n0.2,-1.350E-03\n0.3,1.450E-03\n";
        for (last, short) in [
            ("0.4,1.550E-03\n", false),
            ("0.4,1.550E-03", false),
            ("0.4,1.550E-0", true),
            ("0.4,1.55", true),
            ("0.4,1", true),
            ("0.4,1.5\n", false),
        ] {
            assert_eq!(said(&format!("{above}{last}")), short, "{last:?}");
        }
        assert!(said("1.25\r1.35\r1.45\r1.5"));
        assert!(doubt(b"a;b\n1;1,25\n2;1,35\n3;1,45\n4;1,5", b';', b',').is_some());
    }

    #[test]
    fn a_footer_is_words_and_nothing_else() {
        let of = |rows, text: &str| footer(rows, text.lines().map(str::as_bytes));
        let doubt = of(4, "End of data\n\n-- SPS390 --\n\u{1a}").unwrap();
        assert!(
            doubt.contains("2 line(s)") && doubt.contains("\"End of data\", \"-- SPS390 --\""),
            "{doubt}"
        );
        for text in [
            "1.096639e",
            "-1.2x",
            ".5x",
            "(-1.5e-2+j",
            "x",
            "End\n1.5",
            "sum 12",
            "NaN x",
            "---",
            "",
            "a;1,5;2",
        ] {
            assert_eq!(of(9, text), None, "{text:?}");
        }
        // Three numbers and a name are a list of files.
        assert_eq!(of(3, "F1.DAT"), None);
        assert_eq!(of(99, &"end\n".repeat(17)), None);
    }

    #[test]
    fn numbers_of_any_length_tell_nothing() {
        for text in [
            "1.25\n1.5\n1.75\n2",
            "1\n2\n3\n4",
            "1.25\n1.5",
            "",
            "x",
            "1.5\nx\n1.5\n1.5\n1",
            "1.25,2\n1.35,3\n1.45,4\n1.5,5",
        ] {
            assert!(!said(text), "{text:?}");
        }
    }
}
