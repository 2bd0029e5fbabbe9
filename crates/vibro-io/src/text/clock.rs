//! Dates and times of day as an abscissa, in seconds since the first row.
//!
//! ```text
//! 2020-01-24T12:00:00.001Z   2020/01/24 12:00:00   24.01.2020 12:00:00,001   1/24/2020 12:00:00.001 PM
//! 12:00:00.001   12:00:00:001   00:01.5   0.5 sec   and date, time and milliseconds in adjacent cells
//! ```

use crate::assemble::DAY;
use crate::number;
use std::borrow::Cow;
use std::ops::Range;

const MONTHS: [&str; 12] =
    ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

/// One word of a clock: the parts of a date, a time of day in s, or AM (`false`) or PM (`true`).
enum ClockField<'a> {
    Date(Vec<&'a str>),
    Time(f64),
    Half(bool),
}

/// The adjacent cells that hold date and time; `None` if none of them holds a time of day.
pub fn columns(fields: &[(usize, Cow<str>)]) -> Option<Range<usize>> {
    let start = fields.iter().position(|(_, field)| is_clock(field))?;
    let end = start + fields[start..].iter().take_while(|(_, field)| is_clock(field)).count();
    parse(&joined(&fields[start..end])).map(|_| start..end)
}

/// Whether a text is a date, a time of day, both, or a duration.
pub fn is_clock(text: &str) -> bool {
    if duration(text).is_some() {
        return true;
    }
    let unsigned = text.strip_prefix('-').unwrap_or(text);
    unsigned.starts_with(|c: char| c.is_ascii_alphanumeric()) && words(text).all(|word| part(word).is_some())
}

/// Joins adjacent cells with blanks.
pub fn joined(fields: &[(usize, Cow<str>)]) -> String {
    fields.iter().map(|(_, field)| field.as_ref()).collect::<Vec<&str>>().join(" ")
}

/// The seconds of a clock as printed, such as `01.123`, so that their digits show the resolution.
pub fn printed_seconds(text: &str) -> String {
    if let Some(seconds) = text.strip_suffix(" sec") {
        return seconds.to_owned();
    }
    let mut words = words(text).skip_while(|word| !word.contains(':'));
    let time = words.next().unwrap_or_default().replace(',', ".");
    // The time zone also has digits: 12:00:05.1+02:00.
    let zone = time.find(':').and_then(|at| Some(at + time[at..].find(['+', '-', '−'])?));
    let time = &time[..zone.unwrap_or(time.len())];
    let mut cells = time.split(':').skip(1 + usize::from(time.matches(':').count() > 1));
    let seconds = cells.next().unwrap_or_default().trim_end_matches('Z').to_owned();
    let thousandths = cells.next().or(words.find(|word| word.starts_with(|c: char| c.is_ascii_digit())));
    thousandths.map_or(seconds.clone(), |ms| format!("{seconds}.{}", ms.replace(['.', ','], "")))
}

/// Converts times to seconds since the first time it was given.
#[derive(Debug, Default)]
pub struct Stopwatch {
    first: Option<(f64, f64)>,
    last: f64,
    /// Midnights passed, in times without a date.
    days: f64,
}

impl Stopwatch {
    pub fn seconds(&mut self, text: &str) -> Option<f64> {
        let (day, seconds) = parse(text)?;
        let (first_day, first) = *self.first.get_or_insert((day.unwrap_or(0.0), seconds));
        let since = |days: f64| (day.unwrap_or(first_day) - first_day + days) * DAY + (seconds - first);
        if day.is_none() && since(self.days) < self.last - DAY / 2.0 {
            self.days += 1.0;
        }
        self.last = since(self.days);
        Some(self.last)
    }
}

/// Words of a clock without its time zone. ISO 8601 joins date and time with a `T`.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let iso =
        text.as_bytes().windows(3).any(|w| w[0].is_ascii_digit() && w[1] == b'T' && w[2].is_ascii_digit());
    let words =
        text.split(move |c: char| c.is_whitespace() || (iso && c == 'T')).filter(|word| !word.is_empty());
    words.enumerate().filter(|(at, word)| *at == 0 || !is_zone(word)).map(|(_, word)| word)
}

/// Whether a word after a time is its time zone: `+0100`, `-05:00`.
fn is_zone(word: &str) -> bool {
    let digits = word.strip_prefix(['+', '-']).map(|digits| digits.replace(':', ""));
    digits.is_some_and(|digits| digits.len() == 4 && digits.bytes().all(|b| b.is_ascii_digit()))
}

/// Number of the day, if there is a date, and seconds of that day.
fn parse(text: &str) -> Option<(Option<f64>, f64)> {
    if let Some(seconds) = duration(text) {
        return Some((None, seconds));
    }
    let (mut date, mut time, mut half) = (None, None, None);
    for word in words(text) {
        match part(word) {
            Some(ClockField::Date(cells)) => date = Some(cells),
            Some(ClockField::Time(seconds)) => time = Some(seconds),
            Some(ClockField::Half(second)) => half = Some(second),
            // Milliseconds in a cell of their own.
            None => time = Some(time? + 1e-3 * number(word).filter(|ms| (0.0..1000.0).contains(ms))?),
        }
    }
    let seconds = match half {
        Some(second) => time? % (DAY / 2.0) + if second { DAY / 2.0 } else { 0.0 },
        None => time?,
    };
    let date = date.map(|cells| day(&cells, half.is_some()));
    Some((if let Some(day) = date { Some(day?) } else { None }, seconds))
}

/// Seconds of a duration as MATLAB writes it, `0.5 sec`.
fn duration(text: &str) -> Option<f64> {
    number(text.strip_suffix(" sec")?)
}

fn part(word: &str) -> Option<ClockField<'_>> {
    match word.to_ascii_lowercase().as_str() {
        "am" => return Some(ClockField::Half(false)),
        "pm" => return Some(ClockField::Half(true)),
        _ => {}
    }
    if word.contains(':') {
        return seconds(word).map(ClockField::Time);
    }
    let cells: Vec<&str> = word.split(['-', '/', '.']).collect();
    day(&cells, false).map(|_| ClockField::Date(cells))
}

fn number(text: &str) -> Option<f64> {
    number::either(text.as_bytes())
}

/// Seconds of `h:m`, `h:m:s`, `d.h:m:s`, `h:m:s:ms`, and of `m:s` if the last part has decimals. A time
/// zone after them is ignored: it is the same in a whole file.
fn seconds(word: &str) -> Option<f64> {
    // A negative time is before a trigger.
    if let Some(before) = word.strip_prefix('-') {
        return seconds(before).map(|seconds| -seconds);
    }
    let word = word.trim_end_matches('Z').split(['+', '-']).next()?;
    let cells: Vec<f64> =
        word.split(':').map(|cell| number(cell).filter(|n| *n >= 0.0)).collect::<Option<_>>()?;
    if let Some((days, time)) =
        word.split_once('.').filter(|(days, time)| !days.contains(':') && time.contains(':'))
    {
        return Some(number(days)? * DAY + seconds(time)?);
    }
    if word.split(':').rev().skip(1).any(|cell| !cell.bytes().all(|b| b.is_ascii_digit())) {
        return None;
    }
    let of = |h: f64, m: f64, s: f64| (m < 60.0 && s < 61.0).then_some((h * 60.0 + m) * 60.0 + s);
    // Two last digits, as in `10:11:12:05`, may be hundredths of a second or film frames.
    let thousandths = word.rsplit(':').next().is_some_and(|cell| cell.len() == 3);
    match *cells {
        [m, s] if word.contains(['.', ',']) => of(0.0, m, s),
        [h, m] => of(h, m, 0.0),
        [h, m, s] => of(h, m, s),
        [h, m, s, ms] if thousandths => of(h, m, s + 1e-3 * ms),
        _ => None,
    }
}

/// Days since a fixed date. The order is year first if the first number has four digits; month first with
/// AM or PM, or if the second number is above 12; otherwise day first.
fn day(cells: &[&str], american: bool) -> Option<f64> {
    let &[a, b, c] = cells else { return None };
    let whole = |cell: &str| cell.parse::<u16>().ok().map(f64::from);
    let month = |cell: &str| {
        let named = MONTHS.iter().position(|name| cell.to_ascii_lowercase().starts_with(name));
        named.map(|at| at as f64 + 1.0).or_else(|| whole(cell)).filter(|m| (1.0..=12.0).contains(m))
    };
    let (year, month, day) = match (a.len(), whole(b)) {
        (4, _) => (whole(a)?, month(b)?, whole(c)?),
        (_, Some(number)) if american || number > 12.0 => (whole(c)?, month(a)?, number),
        _ => (whole(c)?, month(b)?, whole(a)?),
    };
    let year = if year < 100.0 { year + 2000.0 } else { year };
    // Years are counted from March, so that the leap day is the last day of a year.
    let (year, months) = if month > 2.0 { (year, month - 3.0) } else { (year - 1.0, month + 9.0) };
    let leaps = (year / 4.0).floor() - (year / 100.0).floor() + (year / 400.0).floor();
    (1.0..=31.0).contains(&day).then_some(365.0 * year + leaps + ((153.0 * months + 2.0) / 5.0).floor() + day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_instant() {
        let instant = parse("2020-01-24 13:00:01.5").unwrap();
        for text in [
            "2020-01-24T13:00:01.5Z",
            "2020-01-24T13:00:01.500+01:00",
            "2020-01-24 13:00:01.5 +0100",
            "2020/01/24 13:00:01 500",
            "24.01.2020 13:00:01,5",
            "24-Jan-2020 13:00:01.5",
            "1/24/2020 1:00:01.5 PM",
            "01/24/20 13:00:01:500",
        ] {
            assert_eq!(parse(text), Some(instant), "{text}");
        }
        assert_eq!(parse("12:00:00 AM"), Some((None, 0.0)));
        assert_eq!(parse("01:02.5"), Some((None, 62.5)));
        assert_eq!(parse("01:02"), Some((None, 3720.0)));
    }

    #[test]
    fn what_is_no_clock() {
        for text in [
            "",
            "12",
            "1.5",
            "1:x",
            "12:61:00",
            "2020-01-24",
            "32.01.2020 12:00",
            "a 12:00",
            "12:00 b",
            "1.2.3",
        ] {
            assert_eq!(parse(text), None, "{text:?}");
        }
    }

    #[test]
    fn days_follow_each_other() {
        let days = ["28.02.2020", "29.02.2020", "01.03.2020", "31.12.2020", "01.01.2021"]
            .map(|text| parse(&format!("{text} 0:00")).unwrap().0.unwrap());
        assert_eq!(days.map(|day| day - days[0]), [0.0, 1.0, 2.0, 307.0, 308.0]);
    }

    #[test]
    fn a_clock_passes_midnight() {
        let mut clock = Stopwatch::default();
        let of = ["23:59:59", "0:00:01", "13:00:00", "0:00:00"].map(|text| clock.seconds(text).unwrap());
        assert_eq!(of, [0.0, 2.0, 46801.0, 86401.0]);
    }

    #[test]
    fn digits_of_seconds() {
        for (text, seconds) in [
            ("2020-01-24 12:00:01.123", "01.123"),
            ("24.01.2020 12:00:01,5", "01.5"),
            ("12:00:01:123", "01.123"),
            ("01:02.5", "02.5"),
            ("2020/01/24 12:00:00 000.5", "00.0005"),
            ("1:00:01.5 PM", "01.5"),
            ("2020-01-24T12:00:01.123+02:00", "01.123"),
            ("2020-01-24 12:00:01.5-05:00", "01.5"),
        ] {
            assert_eq!(printed_seconds(text), seconds, "{text}");
        }
    }
}
