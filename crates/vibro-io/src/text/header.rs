//! What header lines state: lines, base band, sampling rate, unit, window, date.

use crate::number;
use crate::options::POSSIBLE;
use vibro_record::Window;

/// Statements of a header that are understood; the rest stays as notes.
///
/// Every number here is finite, positive and so far from the ends of what a double holds that its inverse and
/// its quotients are too.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stated {
    /// Number of spectral lines, not counting 0 Hz.
    pub lines: Option<f64>,
    /// Upper end of the spectrum in Hz.
    pub base_band: Option<f64>,
    /// Sampling rate in Hz.
    pub rate: Option<f64>,
    /// What may be the sampling rate in Hz, for the comma in it may group its digits, and how it is written.
    pub perhaps_rate: Option<(String, f64)>,
    /// Number of values of a series.
    pub values: Option<usize>,
    /// Whether it is a step that is stated, as above the values of one series, and no rate.
    pub of_one_series: bool,
    /// That step, in s or Hz.
    step: Option<f64>,
    /// Key that states that step without a unit, which is taken for s.
    pub assumed: Option<&'static str>,
    /// First instant in s.
    pub start: Option<f64>,
    /// Whether values are said to be complex.
    pub complex: bool,
    /// Distance of spectral lines in Hz.
    pub line_width: Option<f64>,
    /// Unit as written.
    pub unit: Option<String>,
    /// Factors of the values, other than 1, as written.
    pub scale: Option<String>,
    /// Window.
    pub window: Option<Window>,
    /// Channel name or title.
    pub name: Option<String>,
    /// Header lines as key and value; the key is empty where a line has none.
    pub notes: Vec<(String, String)>,
}

/// Keys of a sampling rate, and of the step of time.
const RATE: &str = "sampling rate|sample rate|sampling frequency|sample frequency|samplerate|samp freq|sampling freq|data rate|fs|rate|abtastrate|\
                    abtastfrequenz|fréquence d'échantillonnage|samples per second|scan rate|update rate|messrate|\
                    messfrequenz|samplingrate|samples/sec|samples/s|sampling speed|output data rate|odr|acquisition rate|logging rate|\
                    frequenza di campionamento|frecuencia de muestreo|frequência de amostragem";
const STEP: &str = "dt|delta t|sampling interval|sample interval|sampling period|time step|delta time|increment|clock|\
                    interval|time interval|tinc|sample period|scan interval|logging interval|abtastzeit|messintervall|x increment|xinc|x axis delta|hresolution|horizontal interval|delta|dx|sampling cycle|\
                    x delta|xdelta|sampling|abtastintervall";
/// Keys of what the abscissa is, or of its unit.
const AXIS: &str = "x-axis|x axis|x-axis unit|x axis unit|xunit|xunits|x unit|hunit|horizontal units";

/// `mHz`, apart from megahertz in lower case.
const MILLIHERTZ: &str = "millihertz";

/// More lines than any analyser has.
const MOST_LINES: f64 = 1e9;

impl Stated {
    /// Reads header lines.
    pub fn of<'a>(lines: impl Iterator<Item = &'a str>) -> Stated {
        let mut stated = Stated::default();
        let mut lines_apart = false;
        for line in lines {
            // `NPTS= 6000, DT= .01 SEC` are two statements.
            let several = line.split(',').all(|part| part.contains('='));
            for line in line.split(',').filter(|_| several).chain((!several).then_some(line)) {
                let line = line.trim().trim_matches('"').trim_start_matches([';', ' ']);
                let line = line.strip_prefix("//").map_or(line, str::trim_start);
                let (key, value) = split(line);
                stated.notes.push((key.to_owned(), value.to_owned()));
                let (key, value) = if key.is_empty() { behind_key(line) } else { (key, value) };
                let key = key.replace("mHz", MILLIHERTZ).to_lowercase();
                let said = value.to_lowercase();
                stated.complex |= said == "complex" || said.contains("real and imaginary");
                let hertz = matches!(said.as_str(), "hz" | "hertz") || said.starts_with("frequency");
                lines_apart |= AXIS.split('|').any(|known| known == key) && hertz;
                if key.is_empty() {
                    free_text(line, &mut stated);
                } else {
                    keyed(&key, value, &mut stated);
                }
            }
        }
        if lines_apart && stated.of_one_series {
            stated.rate = None;
            let step = stated.step.filter(|_| stated.start.is_none_or(|start| start == 0.0));
            stated.line_width = stated.line_width.or(step);
        }
        stated
    }

    /// Whether `n` values are all lines of the base band: then they are a spectrum, whatever else is stated,
    /// since analysers print the sampling rate too.
    pub(crate) fn all_lines(&self, n: usize) -> bool {
        self.base_band.is_some() && self.lines.is_some_and(|lines| lines as usize + 1 == n)
    }

    /// Distance of `n` lines in Hz, as the header states it.
    pub fn spacing(&self, n: usize) -> Option<f64> {
        let band = self.base_band.map(|band| band / self.lines_of(n));
        if self.all_lines(n) { band } else { self.line_width.or(band) }
    }

    /// Number of lines, by the header or else by the number of values.
    pub(crate) fn lines_of(&self, n: usize) -> f64 {
        self.lines.unwrap_or_else(|| n.saturating_sub(1).max(1) as f64)
    }
}

/// `key: value` or `key = value`; an empty key where the line is neither. A time of day is no key.
pub fn split(line: &str) -> (&str, &str) {
    let at = line.find([':', '=']).filter(|at| {
        let key = line[..*at].trim();
        let time = line[*at..].starts_with(':') && key.ends_with(|c: char| c.is_ascii_digit());
        !key.is_empty() && !time && key.len() <= 40
    });
    at.map_or(("", line.trim()), |at| (line[..at].trim(), line[at + 1..].trim()))
}

/// `Sampling Freq(Hz) 100Hz`, `Sample rate 1200 Hz`: a key that ends with its unit in brackets, or is that of
/// a rate, and a value that begins with a digit; else an empty key.
fn behind_key(line: &str) -> (&str, &str) {
    let digit = |c: char| c.is_ascii_digit();
    let unit = line
        .split_once(')')
        .filter(|(key, value)| key.contains('(') && value.trim_start().starts_with(digit));
    let rate = || {
        let (key, value) = line.split_at(line.find(digit)?);
        let key = key.trim_end_matches([' ', '\t', ',', ';']);
        let lower = key.to_lowercase();
        RATE.split('|').any(|known| known == lower).then_some((key, value))
    };
    unit.or_else(rate).map_or(("", line), |(key, value)| (key, value.trim()))
}

/// Takes what stands under a key that is understood, where it is a possible value.
fn keyed(key: &str, value: &str, stated: &mut Stated) {
    let (key, unit_in_key) = match key.find(['[', '(']) {
        Some(at) => (key[..at].trim(), key[at + 1..].trim_end_matches([']', ')'])),
        None => (key, ""),
    };
    let key: String = key.chars().map(|c| if matches!(c, '_' | '-' | '.') { ' ' } else { c }).collect();
    // `sample_rate_hz`
    let behind = key.rsplit_once(' ').filter(|(key, unit)| {
        let of = |keys: &str, units: &[(&str, f64)]| {
            keys.split('|').any(|known| known == *key) && units.iter().any(|(known, _)| known == unit)
        };
        unit_in_key.is_empty() && (of(RATE, &HERTZ) || of(STEP, &SECONDS))
    });
    let (key, unit_in_key) = behind.unwrap_or((key.as_str(), unit_in_key));
    let hertz_of = |value: &str| {
        let value = value.replace("mHz", MILLIHERTZ);
        quantity(&samples_a_second(&value), &samples_a_second(unit_in_key), &HERTZ)
    };
    let hertz = || hertz_of(value);
    let bare = unit_in_key.is_empty() && value.ends_with(|c: char| c.is_ascii_digit());
    // `bandwidth`, `span` and `resolution` are no keys: they also stand over time traces, and for other
    // things.
    match key.trim() {
        // Without a unit these may be anything, but for an increment beside a start.
        // SAC and its kin: a step in s, which is none above 1.
        "delta" if bare && quantity(value, "", &[("", 1.0)]).is_some_and(|step| step < 1.0) => {
            let step = quantity(value, "", &[("", 1.0)]);
            stated.rate = stated.rate.or(step.and_then(|step| checked(1.0 / step)));
            stated.assumed = Some("DELTA");
            (stated.step, stated.of_one_series) = (step, true);
        }
        "rate" | "data rate" | "clock" | "delta" | "dx" | "x delta" | "xdelta" | "interval"
        | "time interval" | "odr" | "scan interval" | "logging interval" | "messintervall" | "sampling"
            if bare => {}
        "increment" if bare && stated.start.is_none() => {}
        "lines" | "spectral lines" | "number of lines" | "no of lines" | "fft lines" => {
            stated.lines = quantity(value, "", &[("", 1.0), ("lines", 1.0)]).and_then(line_count);
        }
        "base band" | "baseband" | "frequency range" | "frequency span" | "fmax" | "f max" => {
            stated.base_band = hertz();
        }
        key if RATE.split('|').any(|known| known == key) => {
            stated.rate = hertz().or(stated.rate);
            let ungrouped = || Some((value.to_owned(), hertz_of(&value.replace(',', ""))?));
            stated.perhaps_rate = if stated.rate.is_none() { ungrouped() } else { None };
        }
        key if STEP.split('|').any(|known| known == key) => {
            let rate = quantity(value, unit_in_key, &SECONDS).and_then(|dt| checked(1.0 / dt));
            stated.of_one_series |= rate.is_some();
            stated.step = rate.map(|rate| 1.0 / rate).or(stated.step);
            stated.rate = stated.rate.or(rate);
        }
        "npts" | "number of points" | "number of samples" | "record length" | "memory length"
        | "blocksize" | "total data points" => {
            stated.values = quantity(value, "", &[("", 1.0)]).and_then(line_count).map(|n| n as usize);
        }
        "start" | "t0" | "time of first sample" | "start time s" | "x origin" | "xorg" | "hoffset" => {
            let parsed = scaled(value, unit_in_key, &SECONDS);
            stated.start = parsed.filter(|start| *start == 0.0 || checked(start.abs()).is_some());
        }
        "pre trigger length" | "pre trigger" | "pretrigger" | "pre trigger time" => {
            let before = quantity(value.trim_start_matches('-'), unit_in_key, &SECONDS);
            stated.start = before.filter(|_| !bare).map(|before| -before).or(stated.start);
        }
        "df" | "delta f" | "line width" | "frequency resolution" | "line spacing" => {
            stated.line_width = hertz();
        }
        "unit" | "units" | "y unit" | "yunit" | "y axis unit" | "einheit" | "amplitude unit"
        | "engineering unit" => {
            let unit = Some(value.trim_matches(['[', ']']).to_owned());
            // One for each of several channels belongs to none.
            stated.unit = unit.filter(|v| !v.is_empty() && !v.contains([';', '\t']) && !v.contains(" and "));
        }
        "slope" | "scale factor" | "scaling factor" => {
            let other = |factor: &str| factor.parse::<f64>().is_ok_and(|factor| factor != 1.0);
            stated.scale =
                Some(value.to_owned()).filter(|all| all.split([';', ' ']).any(|f| other(f.trim())));
        }
        "window" | "weighting" | "window type" => {
            stated.window = Window::from_name(value.split([' ', '(']).next().unwrap_or(""))
                .or_else(|| Window::from_name(value));
        }
        "channel" | "name" | "name of the channel" | "title" | "channel name" | "signal" | "source" => {
            stated.name = Some(value.trim_matches('"').to_owned()).filter(|v| !v.is_empty());
        }
        _ => {}
    }
}

/// Samples a second, as they are written, in Hz: `2 kS/s`, `100 samples/s`.
fn samples_a_second(text: &str) -> String {
    let words = ["samples per second", "samples/second", "samples/sec", "samples/s", "sa/s", "sps", "s/s"];
    words.iter().fold(text.to_lowercase(), |text, word| text.replace(word, "hz"))
}

/// Lines without a key: `20 Hz 400 lines`, `64 samples, 2000 sps`.
fn free_text(line: &str, stated: &mut Stated) {
    let words: Vec<String> = line.split_whitespace().map(str::to_lowercase).collect();
    let before = |name: &str| {
        let pair = words.windows(2).find(|w| w[1].trim_end_matches(',') == name)?;
        pair[0].parse::<f64>().ok()
    };
    if let Some([.., unit]) =
        words.windows(3).find(|w| matches!(w[0].as_str(), "units" | "unit") && w[1] == "of")
    {
        stated.unit = Some(unit.trim_end_matches(['.', ',', ';']).to_owned());
    }
    if let Some(rate) = before("sps").and_then(checked) {
        stated.rate = Some(rate);
        stated.values = before("samples").and_then(line_count).map(|n| n as usize);
    }
    let (band, lines) = (before("hz").and_then(checked), before("lines").and_then(line_count));
    if band.is_some() && lines.is_some() {
        (stated.base_band, stated.lines) = (band, lines);
    }
}

const HERTZ: [(&str, f64); 6] =
    [(MILLIHERTZ, 1e-3), ("mhz", 1e6), ("khz", 1e3), ("hz", 1.0), ("1/s", 1.0), ("", 1.0)];

const SECONDS: [(&str, f64); 7] =
    [("ns", 1e-9), ("us", 1e-6), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0), ("sec", 1.0), ("", 1.0)];

/// A number with one of `units` behind it (or the unit from the key), checked.
fn quantity(value: &str, unit_in_key: &str, units: &[(&str, f64)]) -> Option<f64> {
    scaled(value, unit_in_key, units).and_then(checked)
}

fn scaled(value: &str, unit_in_key: &str, units: &[(&str, f64)]) -> Option<f64> {
    let value = value.trim();
    let printed = value.split(|c: char| !c.is_ascii_digit() && !"+-.,".contains(c)).next()?;
    // `51,200` may be 51 200.
    let comma =
        printed.contains(',') && !printed.contains('.') && !number::may_be_grouped(printed.as_bytes());
    let (number, used) = number::prefix(value.as_bytes(), if comma { b',' } else { b'.' })?;
    // `44100 Hz.  Linear scale.`
    let rest = value.get(used..)?.trim();
    let first = rest.split_whitespace().next().filter(|word| word.ends_with(['.', ',', ';'])).unwrap_or(rest);
    let rest = first.trim_end_matches(['.', ',', ';']).trim_matches(['[', ']']).to_lowercase();
    let unit = if rest.is_empty() { unit_in_key.to_lowercase() } else { rest };
    let factor = units.iter().find(|u| u.0 == unit)?.1;
    Some(number * factor)
}

fn checked(value: f64) -> Option<f64> {
    POSSIBLE.contains(&value).then_some(value)
}

fn line_count(lines: f64) -> Option<f64> {
    ((1.0..=MOST_LINES).contains(&lines) && lines.fract() == 0.0).then_some(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &[&str]) -> Stated {
        Stated::of(lines.iter().copied())
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

    /// It may be 51.2 Hz or 51 200 Hz: the second is said, and none is used.
    #[test]
    fn a_rate_in_groups_of_digits_is_a_question() {
        for text in ["Sampling rate: 51,200", "Sample rate [Hz]: 51,200", "fs = 51,200 Hz"] {
            let s = of(&[text]);
            assert_eq!((s.rate, s.perhaps_rate.map(|(_, rate)| rate)), (None, Some(51_200.0)), "{text}");
        }
        assert_eq!(of(&["Sampling rate: 51,2 kHz"]).perhaps_rate, None);
    }

    #[test]
    fn nonsense_states_nothing() {
        let lines = [
            "Lines: many",
            "Base band: -3 Hz",
            "rate: 5 apples",
            "dt: 0 s",
            "Lines: 1e30",
            "Lines: 2.5",
            "dt: 1e-320",
            "df: 1e-300 Hz",
            "20 Hz inf lines",
            "20 Hz 0 lines",
            "20 Hz -400 lines",
            "nan Hz 400 lines",
        ];
        for line in lines {
            let s = of(&[line]);
            assert_eq!((s.lines, s.base_band, s.rate, s.line_width), (None, None, None, None), "{line}");
        }
    }

    #[test]
    fn keys_with_other_meanings_state_nothing() {
        let s = of(&["Resolution: 16", "Bandwidth: 20 kHz", "Span: 20 Hz"]);
        assert_eq!((s.base_band, s.line_width), (None, None));
    }
}
