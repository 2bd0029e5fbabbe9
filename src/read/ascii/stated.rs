//! What header lines state: lines, base band, sampling rate, unit, window, date, names.

use crate::record::Window;

/// Statements of a header that are understood; the rest stays as notes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stated {
    /// Number of spectral lines, not counting 0 Hz.
    pub lines: Option<f64>,
    /// Upper end of the spectrum in Hz.
    pub base_band: Option<f64>,
    /// Sampling rate in Hz.
    pub rate: Option<f64>,
    /// Distance of spectral lines in Hz.
    pub line_width: Option<f64>,
    /// Unit as written.
    pub unit: Option<String>,
    /// Window.
    pub window: Option<Window>,
    /// Channel name or title.
    pub name: Option<String>,
    /// The columns are said to be real and imaginary part.
    pub complex: bool,
    /// The first column is said to be a frequency (`Some(true)`) or a time (`Some(false)`).
    pub frequency: Option<bool>,
    /// Header lines as key and value; the key is empty where a line has none.
    pub notes: Vec<(String, String)>,
}

/// Reads header lines.
pub fn read(header: &[(u64, String)]) -> Stated {
    let mut stated = Stated::default();
    for (_, line) in header {
        let (key, value) = split(line);
        stated.notes.push((key.to_owned(), value.to_owned()));
        if key.is_empty() {
            free_text(line, &mut stated);
        } else {
            keyed(&key.to_lowercase(), value, &mut stated);
        }
    }
    stated
}

/// `key: value` or `key = value`; an empty key where the line is neither. A time of day is no key.
fn split(line: &str) -> (&str, &str) {
    let at = line.find([':', '=']).filter(|at| {
        let key = line[..*at].trim();
        !key.is_empty() && !key.ends_with(|c: char| c.is_ascii_digit()) && key.len() <= 40
    });
    at.map_or(("", line.trim()), |at| (line[..at].trim(), line[at + 1..].trim()))
}

fn keyed(key: &str, value: &str, stated: &mut Stated) {
    let (key, unit_in_key) = match key.find(['[', '(']) {
        Some(at) => (key[..at].trim(), key[at + 1..].trim_end_matches([']', ')'])),
        None => (key, ""),
    };
    let key: String = key.chars().map(|c| if matches!(c, '_' | '-' | '.') { ' ' } else { c }).collect();
    let hertz =
        || quantity(value, unit_in_key, &[("mhz", 1e6), ("khz", 1e3), ("hz", 1.0), ("1/s", 1.0), ("", 1.0)]);
    match key.trim() {
        "lines" | "spectral lines" | "number of lines" | "no of lines" | "fft lines" => {
            stated.lines = quantity(value, "", &[("", 1.0), ("lines", 1.0)]);
        }
        "base band" | "baseband" | "frequency range" | "frequency span" | "span" | "bandwidth" | "fmax"
        | "f max" => {
            stated.base_band = hertz();
        }
        "sampling rate" | "sample rate" | "sampling frequency" | "sample frequency" | "samplerate" | "fs"
        | "rate" => {
            stated.rate = hertz();
        }
        "dt" | "delta t" | "sampling interval" | "sample interval" | "time step" | "delta time" => {
            stated.rate = quantity(
                value,
                unit_in_key,
                &[("us", 1e-6), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0), ("", 1.0)],
            )
            .map(|dt| 1.0 / dt);
        }
        "df" | "delta f" | "line width" | "resolution" | "frequency resolution" | "line spacing" => {
            stated.line_width = hertz();
        }
        "unit" | "units" | "y unit" | "yunit" | "amplitude unit" | "engineering unit" => {
            stated.unit = Some(value.trim_matches(['[', ']']).to_owned()).filter(|v| !v.is_empty());
        }
        "window" | "weighting" | "window type" => {
            stated.window = Window::from_name(value.split([' ', '(']).next().unwrap_or(""))
                .or_else(|| Window::from_name(value));
        }
        "channel" | "name" | "title" | "channel name" | "signal" => {
            stated.name = Some(value.to_owned()).filter(|v| !v.is_empty());
        }
        _ => {}
    }
}

/// Lines without a key: `20 Hz 400 lines`, or names of columns.
fn free_text(line: &str, stated: &mut Stated) {
    let words: Vec<String> = line.split_whitespace().map(str::to_lowercase).collect();
    let before = |name: &[&str]| {
        words.windows(2).find(|w| name.contains(&w[1].trim_end_matches(','))).and_then(|w| w[0].parse().ok())
    };
    if let (Some(hz), Some(lines)) = (before(&["hz"]), before(&["lines"])) {
        stated.base_band = Some(hz);
        stated.lines = Some(lines);
        return;
    }
    let lower = line.to_lowercase();
    if lower.contains("real") && lower.contains("imag") {
        stated.complex = true;
    }
    if lower.starts_with("freq")
        || lower.starts_with("f ")
        || lower.contains("[hz]")
        || lower.contains("(hz)")
    {
        stated.frequency = Some(true);
    } else if lower.starts_with("time")
        || lower.starts_with("t ")
        || lower.contains("[s]")
        || lower.contains("(s)")
    {
        stated.frequency = Some(false);
    }
}

/// A positive number with one of `units` behind it (or the unit from the key).
fn quantity(value: &str, unit_in_key: &str, units: &[(&str, f64)]) -> Option<f64> {
    let value = value.trim();
    let (number, used) = crate::read::number::prefix(value.as_bytes(), b'.')?;
    let rest = value.get(used..)?.trim().trim_matches(['[', ']']).to_lowercase();
    let unit = if rest.is_empty() { unit_in_key.to_lowercase() } else { rest };
    let factor = units.iter().find(|u| u.0 == unit)?.1;
    Some(number * factor).filter(|v| v.is_finite() && *v > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &[&str]) -> Stated {
        let header: Vec<_> = lines.iter().enumerate().map(|(i, l)| (i as u64 + 1, (*l).to_owned())).collect();
        read(&header)
    }

    #[test]
    fn keys_in_the_usual_spellings() {
        let s = of(&[
            "Lines: 400",
            "Base band: 0.02 kHz",
            "Window = Hanning",
            "Unit: [m/s²]",
            "Date: 12.03.1999 14:05",
        ]);
        assert_eq!((s.lines, s.base_band, s.window), (Some(400.0), Some(20.0), Some(Window::Hann)));
        assert_eq!(s.unit.as_deref(), Some("m/s²"));
        assert_eq!(s.notes[4], ("Date".to_owned(), "12.03.1999 14:05".to_owned()));
        assert_eq!(of(&["Sampling rate [kHz]: 51.2"]).rate, Some(51_200.0));
        assert!((of(&["dt = 0.5 ms"]).rate.unwrap() - 2000.0).abs() < 1e-9);
    }

    #[test]
    fn an_analyser_line_without_keys() {
        let s = of(&["SPS390 SPECTRUM", "20 Hz 400 lines"]);
        assert_eq!((s.lines, s.base_band), (Some(400.0), Some(20.0)));
    }

    #[test]
    fn nonsense_states_nothing() {
        let s = of(&["Lines: many", "Base band: -3 Hz", "rate: 5 apples", "dt: 0 s"]);
        assert_eq!((s.lines, s.base_band, s.rate), (None, None, None));
    }
}
