//! Kinds of values that a person types, such as a number or a name, and the correction of a mistyped value of
//! a known kind.

use crate::nearest;
use std::fmt;

/// Kind of a value that a person types. As an error it means that the typed value is of another kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number between two others, both included.
    Whole(i64, i64),
    /// True or false.
    Truth,
    /// Text.
    Text,
    /// One of these names.
    Names(&'static [&'static str]),
    /// A number of this quantity, or this word instead of a number.
    NumberOr(&'static str, &'static str),
    /// Two numbers with this character between them.
    Pair(char),
    /// Two times in s with a colon between them; one of them may be missing.
    Part,
    /// This number of values in a list.
    Values(usize),
    /// A list of values, or of tables.
    List,
    /// Keys with their values.
    Table,
    /// Any other, described in words.
    Other(String),
}

impl Kind {
    /// The kind in words, with `quote` around names.
    pub fn words(&self, quote: &str) -> String {
        let quoted = |name: &&str| format!("{quote}{name}{quote}");
        match self {
            Kind::Number => "a number, such as 0.5 or 1e-3".to_owned(),
            Kind::Whole(0, most) if *most >= u32::MAX.into() => "a whole number, 0 or more".to_owned(),
            Kind::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Kind::Truth => "true or false".to_owned(),
            Kind::Text => "text between quotes".to_owned(),
            Kind::Names([name]) => quoted(name),
            Kind::Names([a, b]) => format!("{} or {}", quoted(a), quoted(b)),
            Kind::Names(all) => format!("one of {}", all.iter().map(quoted).collect::<Vec<_>>().join(", ")),
            Kind::NumberOr(quantity, name) => format!("{quantity}, or {}", quoted(name)),
            Kind::Pair(mark) => format!("two numbers with {mark:?} between them"),
            Kind::Part => "two times in s with ':' between them, or one of them and ':'".to_owned(),
            Kind::Values(2) => "two values between square brackets".to_owned(),
            Kind::Values(n) => format!("{n} values between square brackets"),
            Kind::List => "a list between square brackets, or tables with double brackets".to_owned(),
            Kind::Table => "a table".to_owned(),
            Kind::Other(words) => words.clone(),
        }
    }

    /// The likeliest correction of `text`, typed without quotes as the value of `key`: a text that is a value
    /// of this kind. `None` if there is none.
    pub fn meant(&self, key: &str, text: &str) -> Option<String> {
        match self {
            Kind::Number => meant_number(key, text),
            Kind::Whole(least, most) => {
                let text = ungrouped(text).map_or(text.to_owned(), |(whole, _)| whole);
                let number: f64 = meant_number(key, &text).as_deref().unwrap_or(&text).parse().ok()?;
                let whole = number.fract() == 0.0 && number >= *least as f64 && number <= *most as f64;
                whole.then(|| format!("{number:.0}"))
            }
            Kind::Names(names) => nearest(text, names.iter().copied()).map(str::to_owned),
            Kind::NumberOr(_, name) => {
                let off = nearest(text, [*name, "no", "off", "false"]).map(|_| (*name).to_owned());
                off.or_else(|| meant_number(key, text))
            }
            Kind::Pair(mark) => respelt(text, *mark, pair),
            Kind::Part => respelt(text, ':', |text, _| part(text)),
            _ => None,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(""))
    }
}

impl std::error::Error for Kind {}

/// A number.
///
/// # Errors
/// If the text is no number.
pub fn number(text: &str) -> Result<f64, Kind> {
    text.trim().parse().map_err(|_| Kind::Number)
}

/// A whole number from `LEAST` to `MOST`.
///
/// # Errors
/// If the text is no whole number, or the number is out of range.
pub fn whole<T: TryFrom<i64>, const LEAST: i64, const MOST: i64>(text: &str) -> Result<T, Kind> {
    let number = text.parse().ok().filter(|number| (LEAST..=MOST).contains(number));
    number.and_then(|number| T::try_from(number).ok()).ok_or(Kind::Whole(LEAST, MOST))
}

/// Two numbers with `mark` between them.
///
/// # Errors
/// If the text is anything else.
pub fn pair(text: &str, mark: char) -> Result<(f64, f64), Kind> {
    let two = text.split_once(mark).and_then(|(a, b)| Some((number(a).ok()?, number(b).ok()?)));
    two.ok_or(Kind::Pair(mark))
}

/// A part of a record between two times in s, `FROM:TO`; without FROM from its beginning, without TO to its
/// end.
///
/// # Errors
/// If the text is anything else.
pub fn part(text: &str) -> Result<(f64, f64), Kind> {
    let end = |text: &str, open: f64| if text.trim().is_empty() { Ok(open) } else { number(text) };
    let (from, to) = text.split_once(':').ok_or(Kind::Part)?;
    let ends = (end(from, f64::NEG_INFINITY), end(to, f64::INFINITY));
    let (Ok(from_time), Ok(to_time)) = ends else { return Err(Kind::Part) };
    if (from.to_owned() + to).trim().is_empty() { Err(Kind::Part) } else { Ok((from_time, to_time)) }
}

/// The text with `mark` in place of another separator between its two numbers, if `read` then accepts it.
fn respelt<T>(text: &str, mark: char, read: impl Fn(&str, char) -> Result<T, Kind>) -> Option<String> {
    // The first character may be the sign of the first number.
    let marks = text.char_indices().filter(|(at, c)| *at > 0 && [',', ';', ':', '-'].contains(c));
    let mut meant = marks.map(|(at, c)| format!("{}{mark}{}", &text[..at], &text[at + c.len_utf8()..]));
    meant.find(|meant| read(meant, mark).is_ok())
}

/// Units with which numbers are typed, and the power of ten that converts each to the unit of its key.
const UNITS: [(&str, i32); 17] = [
    ("k", 3),
    ("Hz", 0),
    ("kHz", 3),
    ("s", 0),
    ("ms", -3),
    ("us", -6),
    ("µs", -6),
    ("m", 0),
    ("cm", -2),
    ("mm", -3),
    ("N", 0),
    ("kN", 3),
    ("kg", 0),
    ("°", 0),
    ("deg", 0),
    ("%", -2),
    ("m/s", 0),
];

/// The value, in the unit of `key`, of a number that was typed with its unit.
pub fn without_unit(key: &str, text: &str) -> Option<f64> {
    let meant = |(unit, decimals): &(&str, i32)| {
        // The power of ten is appended to the text, so that no digit is lost by a multiplication.
        format!("{}e{decimals}", text.trim().strip_suffix(unit)?.trim_end()).parse().ok()
    };
    // For other keys g may be the acceleration of gravity.
    let grams = key.trim_start_matches('-').contains("mass") || ["m1", "m2"].contains(&key);
    UNITS.iter().find_map(meant).or_else(|| meant(&("g", -3)).filter(|_| grams))
}

/// Keys in Hz whose numbers are usually thousands: a comma before three digits then groups digits.
const THOUSANDS: [&str; 2] = ["rate", "base_band"];

/// A text without the commas that group digits in threes, `1,000,000` or `1,000.5`, and whether they are
/// surely group marks: a single comma may also be a decimal comma. `None` where no commas group digits.
fn ungrouped(text: &str) -> Option<(String, bool)> {
    let text = text.trim();
    let is_digit = |c: char| c.is_ascii_digit() || c == ',';
    let (whole, behind) = text.split_at(text.find(|c| !is_digit(c)).unwrap_or(text.len()));
    let mut groups = whole.split(',');
    groups.next().filter(|first| (1..=3).contains(&first.len()) && *first != "0")?;
    let groups: Vec<&str> = groups.collect();
    let threes = !groups.is_empty() && groups.iter().all(|group| group.len() == 3);
    threes.then(|| (whole.replace(',', "") + behind, groups.len() > 1 || behind.starts_with('.')))
}

/// Corrects a number that was typed with a decimal comma, with grouped digits, with a unit, or without a
/// digit on one side of its point.
pub(crate) fn meant_number(key: &str, text: &str) -> Option<String> {
    let in_thousands = THOUSANDS.contains(&key.replace('-', "_").as_str());
    let grouped = ungrouped(text).filter(|(_, sure)| *sure || in_thousands);
    let point = grouped.map_or_else(|| text.trim().replacen(',', ".", 1), |(whole, _)| whole);
    let number: Option<f64> = point.parse().ok().filter(|number: &f64| number.is_finite());
    match number {
        Some(_) if point.starts_with('.') => Some(format!("0{point}")),
        Some(_) if point.ends_with('.') => Some(format!("{point}0")),
        Some(_) => Some(point),
        None => without_unit(key, &point).map(|number| number.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_meant_is_of_the_kind() {
        for (kind, text, expected) in [
            (Kind::Number, "0,57", Some("0.57")),
            (Kind::Number, "35 kHz", Some("35000")),
            (Kind::Number, "3,5 ms", Some("0.0035")),
            (Kind::Number, ",5", Some("0.5")),
            (Kind::Number, "51,200", Some("51200")),
            (Kind::Number, "51,200 Hz", Some("51200")),
            (Kind::Number, "51,2", Some("51.2")),
            (Kind::Number, "51,200.5", Some("51200.5")),
            (Kind::Number, "1,000,000", Some("1000000")),
            (Kind::Number, "0,512", Some("0.512")),
            (Kind::Whole(0, 9999), "1,024", Some("1024")),
            (Kind::Number, "x", None),
            (Kind::Number, "inf", None),
            (Kind::Whole(0, 9), "2.0", Some("2")),
            (Kind::Whole(0, 9), "1e1", None),
            (Kind::Whole(0, 9), "-1", None),
            (Kind::Names(&["rising", "falling"]), "risin", Some("rising")),
            (Kind::Names(&["rising", "falling"]), "up", None),
            (Kind::NumberOr("a corner in Hz", "none"), "off", Some("none")),
            (Kind::NumberOr("a corner in Hz", "none"), "5kHz", Some("5000")),
            (Kind::Pair(':'), "10-20", Some("10:20")),
            (Kind::Pair(','), "-1;-2", Some("-1,-2")),
            (Kind::Pair(':'), "10", None),
            (Kind::Part, "-1--0.5", Some("-1:-0.5")),
        ] {
            assert_eq!(kind.meant("rate", text).as_deref(), expected, "{kind:?} {text}");
        }
        // A height in metres is rarely in thousands: the comma is decimal.
        assert_eq!(Kind::Number.meant("height", "1,234").as_deref(), Some("1.234"));
        assert_eq!(Kind::Number.meant("base-band", "1,600").as_deref(), Some("1600"));
        assert_eq!(part("600:"), Ok((600.0, f64::INFINITY)));
        assert_eq!([part(":"), part("5")], [Err(Kind::Part), Err(Kind::Part)]);
        assert_eq!(whole::<u8, 0, 2>("3"), Err(Kind::Whole(0, 2)));
    }
}
