//! Whether a text of numbers ends in the middle of its last number.

use super::Source;
use std::io::{Read, SeekFrom};
use vibro_record::{Error, Result};

/// Bytes at the end that are looked at.
const LOOK: usize = 4096;
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
    // One byte more than is looked at tells whether the tail begins in the middle of a row.
    let look = LOOK as u64 + 1;
    input.seek(SeekFrom::Start(source.len().saturating_sub(look))).map_err(failed)?;
    input.take(look).read_to_end(&mut tail).map_err(failed)?;
    Ok(doubt(&tail, separator, decimal))
}

/// A doubt where `text` lacks its line end and its last number has fewer digits than the same column has in all rows above
/// that are looked at.
pub(super) fn doubt(text: &[u8], separator: u8, decimal: u8) -> Option<String> {
    let line_end = |b: &u8| matches!(b, b'\n' | b'\r');
    let ended = text.last().is_none_or(|b| line_end(b) || *b == 0x1a);
    if ended {
        return None;
    }
    let tail = match text.len().checked_sub(LOOK) {
        None | Some(0) => text,
        // Half a row has fewer digits, too.
        Some(from) => &text[from + text[from..].iter().position(line_end)?..],
    };
    let mut rows = tail
        .rsplit(line_end)
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
    fn a_long_file_is_judged_wherever_its_tail_begins() {
        for end in ["\n", "\r\n", "\r"] {
            let rows = format!("1.234567E-03{end}").repeat(2 * LOOK / 12);
            // A first line of every length moves the start of the tail through all bytes of a row.
            for phase in 0..=15 {
                let text = format!("{}{end}{rows}1.234", "x".repeat(phase));
                assert!(said(&text), "phase {phase}, {end:?}");
                let source = Source::memory("x.txt", text.as_bytes()).unwrap();
                assert!(doubt_of(&source, b' ', b'.').unwrap().is_some(), "phase {phase}, {end:?}");
                assert!(!said(&format!("{text}567E-03")), "phase {phase}, {end:?}");
            }
        }
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
