//! Checks the end of a text of numbers for a row cut off, and determines the resolution of the printed
//! abscissa.

use super::clock;
use super::decoded::Text;
use super::dialect::Dialect;
use super::lines::{Line, Lines, Separator};
use crate::number;
use crate::source::Source;
use std::borrow::Cow;
use std::io::{Read, Seek, SeekFrom};
use vibro_record::{Error, Finding, Result};

/// Bytes at the end of the file that are examined.
const LOOK: u64 = 4096;
/// Fewest rows above the last one, all with equal digits, before the last one can be called short.
const ROWS: usize = 3;

/// Hint for a last row that cannot be read.
pub(crate) const CUT_OFF: &str =
    "the file ends within this row, so the export was cut off: export it again, or remove the row";

/// The last whole rows: a first row cut by the tail's start would look short, too.
pub fn of(source: &Source) -> Result<Cow<'_, [u8]>> {
    let from = source.len().saturating_sub(LOOK);
    let rows = |bytes: &[u8]| bytes.iter().position(|b| *b == b'\n').filter(|_| from > 0).unwrap_or(0);
    if let Some(bytes) = source.in_memory() {
        let tail = &bytes[from as usize..];
        return Ok(tail[rows(tail)..].into());
    }
    let (mut tail, mut input) = (Vec::new(), source.open()?);
    let read = input.seek(SeekFrom::Start(from)).and_then(|_| input.read_to_end(&mut tail));
    read.map_err(|e| Error::io("read", source.path(), e))?;
    Ok(tail.split_off(rows(&tail)).into())
}

/// Doubt that the last number is cut off: `text` does not end with a line end, and the number has fewer
/// digits than its column in all rows above, which agree.
pub(crate) fn cut_off(text: &[u8], separator: Separator, decimal: u8) -> Option<Finding> {
    if text.last().is_none_or(|b| matches!(b, b'\n' | b'\r' | 0x1a)) {
        return None;
    }
    let mark = if let Separator::Char(mark) = separator { mark } else { b' ' };
    let mut rows = text
        .rsplit(|b| *b == b'\n')
        .map(<[u8]>::trim_ascii)
        .filter(|row| !row.is_empty())
        .map(|row| row.rsplit(|b| *b == mark || b.is_ascii_whitespace()).next().unwrap_or(row));
    let last = rows.next()?;
    let found = digits(last, decimal)?;
    // The rows end upwards at the line of names, which are not numbers.
    let above: Vec<(usize, usize)> = rows.map_while(|cell| digits(cell, decimal)).collect();
    let usual = *above.first()?;
    let agree = above.len() >= ROWS && above.iter().all(|d| *d == usual);
    let short = found.0 < usual.0 || found.1 < usual.1;
    let cut = Finding::doubt("last-number-cut-off").name("found", String::from_utf8_lossy(last).as_ref());
    (short && agree).then(|| cut.without_estimate())
}

/// Number of digits after the decimal mark and in the exponent; `None` for text that is not a number.
fn digits(cell: &[u8], decimal: u8) -> Option<(usize, usize)> {
    number::parse_with(cell, decimal)?;
    let end = cell.iter().position(u8::is_ascii_alphabetic).unwrap_or(cell.len());
    let (mantissa, exponent) = cell.split_at(end);
    let behind = mantissa.iter().position(|b| *b == decimal).map_or(0, |at| mantissa.len() - at - 1);
    Some((behind, exponent.iter().filter(|b| b.is_ascii_digit()).count()))
}

/// Half a unit in the last digit of a printed column, in the column's unit. Reads the rows in the head and
/// at the end of the text: the largest values, at the end of a rising column, have the most digits.
pub fn resolution(text: &Text, tail: &[u8], dialect: &Dialect, column: usize) -> f64 {
    let mut digits = Digits::default();
    let mut take = |line: Line| {
        let fields = dialect.cut(&line).unwrap_or_default();
        let Some((_, field)) = fields.get(column).filter(|_| line.remark.is_none()) else { return };
        let (field, decimal) = if dialect.clock_at() == Some(column) {
            (clock::printed_seconds(field).into(), b'.')
        } else {
            (field.clone(), dialect.decimal)
        };
        if let Some(value) = number::parse_with(field.as_bytes(), decimal) {
            digits.take(field.as_bytes(), decimal, value);
        }
    };
    dialect.rows(&text.head).for_each(&mut take);
    if text.head.len() > tail.len() {
        Lines::new(&String::from_utf8_lossy(tail), 0, 1, dialect.remarks).for_each(take);
    }
    digits.resolution()
}

/// Digits of a printed column: largest counts of decimals and of significant digits, and largest magnitude.
#[derive(Debug, Default)]
pub(crate) struct Digits {
    significant: i32,
    decimals: i32,
    largest: f64,
}

impl Digits {
    pub fn take(&mut self, field: &[u8], decimal: u8, value: f64) {
        let end = field.iter().position(u8::is_ascii_alphabetic).unwrap_or(field.len());
        let (mantissa, exponent) = field.split_at(end);
        let exponent =
            exponent.get(1..).and_then(|e| std::str::from_utf8(e).ok()?.parse::<i32>().ok()).unwrap_or(0);
        let count = |bytes: &[u8]| bytes.iter().filter(|b| b.is_ascii_digit()).count() as i32;
        let behind = mantissa.iter().position(|b| *b == decimal).map_or(0, |at| count(&mantissa[at..]));
        let leading = mantissa.iter().position(|b| (b'1'..=b'9').contains(b)).unwrap_or(mantissa.len());
        self.significant = self.significant.max(count(&mantissa[leading..]));
        self.decimals = self.decimals.max(behind.saturating_sub(exponent));
        self.largest = self.largest.max(value.abs());
    }

    /// Half a unit in the last digit, in the unit of the column. Numbers printed with `%.3f` share the
    /// number of decimals, those with `%.6g` the number of significant digits. The format is unknown, so
    /// the coarser bound is used; it also holds for shortest round-trip printing.
    pub fn resolution(&self) -> f64 {
        let leading = if self.largest > 0.0 { self.largest.log10().floor() as i32 + 1 } else { 0 };
        let unit = |exponent: i32| 10f64.powi(exponent);
        0.5 * unit(-self.decimals).max(unit(leading.saturating_sub(self.significant)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_cut_off(text: &str) -> bool {
        cut_off(text.as_bytes(), Separator::Char(b','), b'.').is_some()
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
            assert_eq!(is_cut_off(&format!("{above}{last}")), short, "{last:?}");
        }
        assert!(cut_off(b"a;b\n1;1,25\n2;1,35\n3;1,45\n4;1,5", Separator::Char(b';'), b',').is_some());
    }

    #[test]
    fn a_long_file_is_judged_wherever_its_tail_begins() {
        for end in ["\n", "\r\n"] {
            let rows = format!("1.234567E-03{end}").repeat(2 * LOOK as usize / 12);
            // First lines of 0 to 15 characters move the start of the tail through all bytes of a row.
            for phase in 0..=15 {
                let text = format!("{}{end}{rows}1.234", "x".repeat(phase));
                assert!(is_cut_off(&text), "phase {phase}, {end:?}");
                let source = Source::memory("x.txt", text.as_bytes()).unwrap();
                assert!(
                    cut_off(&of(&source).unwrap(), Separator::Blank, b'.').is_some(),
                    "phase {phase}, {end:?}"
                );
                assert!(!is_cut_off(&format!("{text}567E-03")), "phase {phase}, {end:?}");
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
            assert!(!is_cut_off(text), "{text:?}");
        }
    }

    #[test]
    fn the_resolution_of_printed_digits() {
        let of = |texts: &[&str]| {
            let mut digits = Digits::default();
            for text in texts {
                digits.take(text.as_bytes(), b'.', number::parse(text.as_bytes()).unwrap());
            }
            digits.resolution()
        };
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(of(&["0.000", "0.001", "12.345"]), 0.5e-3));
        assert!(close(of(&["1.000E-03", "1.234E+01"]), 0.5e-2));
        assert!(close(of(&["0.0009765", "10.0001"]), 0.5e-4));
        assert!(close(of(&["0", "1", "2"]), 0.5));
        // Shortest round-trip form: one value with 17 digits shows full double precision for the column.
        assert!(of(&["0", "0.1", "0.30000000000000004", "0.5"]) < 1e-16);
    }
}
