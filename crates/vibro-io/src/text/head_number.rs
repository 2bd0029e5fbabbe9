//! Reads numbers with units from header lines. A mark that may be a decimal mark or a thousands separator
//! (`51,200`) has the meaning that it has in the rows.

use crate::number;
use crate::options::POSSIBLE;

/// Replaces `mHz`, which in lower case would be the same as megahertz.
pub const MILLIHERTZ: &str = "millihertz";

/// Units of a frequency or a rate in lower case, with factors to Hz; without a unit, Hz.
pub const HERTZ: [(&str, f64); 9] = [
    (MILLIHERTZ, 1e-3),
    ("mhz", 1e6),
    ("khz", 1e3),
    ("hz", 1.0),
    ("1/s", 1.0),
    ("samples/min", 1.0 / 60.0),
    ("samples per minute", 1.0 / 60.0),
    ("1/min", 1.0 / 60.0),
    ("", 1.0),
];

/// Units of a time in lower case, with factors to s; without a unit, s.
pub const SECONDS: [(&str, f64); 7] =
    [("ns", 1e-9), ("us", 1e-6), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0), ("sec", 1.0), ("", 1.0)];

/// A number times the factor of its unit, which follows the number or is in the key. `None` if the unit is
/// not one of `units` or the value is outside [`POSSIBLE`].
pub fn quantity(value: &str, unit_in_key: &str, units: &[(&str, f64)], mark: Option<u8>) -> Option<f64> {
    scaled(value, unit_in_key, units, mark).and_then(checked)
}

/// Whether neither the number nor its key has a unit.
pub fn is_bare(value: &str, unit_in_key: &str) -> bool {
    unit_in_key.is_empty() && value.ends_with(|c: char| c.is_ascii_digit())
}

/// A frequency or a rate in Hz; `None` if its mark is ambiguous.
pub fn hertz(value: &str, unit_in_key: &str, mark: Option<u8>) -> Option<f64> {
    // Digits of kHz are not grouped, so their mark must be the decimal mark of the rows. In Hz, a comma
    // above rows with decimal commas is ambiguous, since English headers separate thousands with it.
    let said = format!("{value} {unit_in_key}").to_lowercase();
    let kilohertz = ["khz", "mhz", "ks/s"].iter().any(|unit| said.contains(unit));
    let told = |own: u8| if kilohertz { mark == Some(own) } else { own == b'.' || mark != Some(own) };
    hertz_with(value, unit_in_key, mark).filter(|_| doubtful_mark(value).is_none_or(told))
}

/// A frequency or a rate in Hz; an ambiguous mark is decimal if it equals `mark`.
pub fn hertz_with(value: &str, unit_in_key: &str, mark: Option<u8>) -> Option<f64> {
    let value = value.replace("mHz", MILLIHERTZ);
    quantity(&samples_a_second(&value), &samples_a_second(unit_in_key), &HERTZ, mark)
}

/// The rate in Hz that follows from a step in s.
pub fn step_rate(value: &str, unit_in_key: &str, mark: Option<u8>) -> Option<f64> {
    quantity(value, unit_in_key, &SECONDS, mark).and_then(|dt| checked(1.0 / dt))
}

/// The characters of the number at the start of a text.
fn printed(value: &str) -> &str {
    value.split(|c: char| !c.is_ascii_digit() && !"+-.,".contains(c)).next().unwrap_or_default()
}

/// The mark of the number at the start of a text, if it may be a decimal mark or a thousands separator, as
/// in `51,200`; `None` if the number itself shows which.
pub fn doubtful_mark(value: &str) -> Option<u8> {
    let printed = printed(value.trim()).as_bytes();
    let mut marks = printed.iter().filter(|b| matches!(b, b'.' | b','));
    let mark = marks.next().filter(|_| marks.next().is_none())?;
    number::may_be_grouped(printed).then_some(*mark)
}

/// The other decimal mark: point for comma, comma for point.
pub fn other_mark(mark: u8) -> u8 {
    if mark == b',' { b'.' } else { b',' }
}

/// The decimal mark of a printed number: its last mark, or the other mark if the last two marks are equal,
/// since those separate thousands.
fn decimal_mark(printed: &str) -> u8 {
    let mut marks = printed.bytes().rev().filter(|b| matches!(b, b'.' | b','));
    let last = marks.next().unwrap_or(b'.');
    if marks.next() == Some(last) { other_mark(last) } else { last }
}

/// Removes the blanks between groups of three digits: `1 000 Hz`.
pub fn without_blanks(value: &str) -> String {
    let digits = |word: &str| word.bytes().take_while(u8::is_ascii_digit).count();
    let mut words = value.split([' ', '\u{a0}', '\u{202f}', '\u{2009}']);
    let mut whole = words.next().unwrap_or_default().to_owned();
    let mut groups = (1..=3).contains(&whole.len()) && digits(&whole) == whole.len();
    for word in words {
        groups &= digits(word) == 3 && !whole.ends_with(|c: char| !c.is_ascii_digit());
        whole += if groups { "" } else { " " };
        whole += word;
    }
    whole
}

/// As [`quantity`], but of any sign and size. An ambiguous mark is decimal if it is the decimal `mark` of
/// the rows; if that is unknown, the result is `None`.
pub fn scaled(value: &str, unit_in_key: &str, units: &[(&str, f64)], mark: Option<u8>) -> Option<f64> {
    let value = value.trim();
    let printed = printed(value);
    let exponent = value[printed.len()..].starts_with(['e', 'E']);
    let doubtful = doubtful_mark(value).is_some() && !exponent;
    let decimal = if doubtful { mark? } else { decimal_mark(printed) };
    let (number, used) = match number::parse_stated(printed.as_bytes(), decimal).filter(|_| !exponent) {
        Some(number) => (number, printed.len()),
        None => number::prefix(value.as_bytes(), decimal)?,
    };
    // `44100 Hz.  Linear scale.`, `1.0 kHz / filter 400 Hz`
    let rest = value.get(used..)?.split(" / ").next()?.trim();
    let first = rest.split_whitespace().next().filter(|word| word.ends_with(['.', ',', ';'])).unwrap_or(rest);
    let rest = first.trim_end_matches(['.', ',', ';']).trim_matches(['[', ']']).to_lowercase();
    let unit = if rest.is_empty() { unit_in_key.to_lowercase() } else { rest };
    let factor = units.iter().find(|u| u.0 == unit)?.1;
    Some(number * factor)
}

/// The value, if it is in [`POSSIBLE`].
pub fn checked(value: f64) -> Option<f64> {
    POSSIBLE.contains(&value).then_some(value)
}

/// Replaces the spellings of samples per second by `hz`: `2 kS/s`, `100 samples/s`.
fn samples_a_second(text: &str) -> String {
    let words = ["samples per second", "samples/second", "samples/sec", "samples/s", "sa/s", "sps", "s/s"];
    words.iter().fold(text.to_lowercase(), |text, word| text.replace(word, "hz"))
}
