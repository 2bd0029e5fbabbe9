//! Reads what header lines state: spectral lines, base band, sampling rate, unit, window and others.

use super::head_number::{
    HERTZ, MILLIHERTZ, SECONDS, checked, doubtful_mark, hertz, hertz_with, is_bare, other_mark, quantity,
    scaled, step_rate, without_blanks,
};
use super::names::Name;
use super::stated_scale::StatedScale;
use vibro_record::Window;

/// Statements of a header that are understood; all lines stay as notes.
///
/// Every number here except `start` is positive, and far enough from the limits of a double that its
/// inverse and quotients are finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stated {
    /// Number of spectral lines, not counting 0 Hz.
    pub lines: Option<f64>,
    /// Upper end of the spectrum in Hz.
    pub base_band: Option<f64>,
    /// Sampling rate in Hz.
    pub rate: Option<f64>,
    /// A second sampling rate in Hz that the header states.
    pub other_rate: Option<f64>,
    /// Rate not used because `1.000` or `1,000` is ambiguous: decimal mark or thousands separator.
    pub perhaps_rate: Option<PerhapsRate>,
    /// Header line, as written, which says that fewer values were kept than were sampled.
    pub decimation: Option<String>,
    /// Decimal mark of the rows, if they show it.
    pub mark: Option<u8>,
    /// Number of values that the header states.
    pub values: Option<usize>,
    /// True if a step is stated: the file may hold one evenly sampled series.
    pub of_one_series: bool,
    /// The stated step in s, or in Hz if the abscissa is a frequency.
    step: Option<f64>,
    /// Key of a step that has no unit and is assumed to be in s.
    pub assumed: Option<String>,
    /// Whether the header states that the abscissa is a frequency.
    pub lines_apart: bool,
    /// Time of the first sample in s.
    pub start: Option<f64>,
    /// Whether the header states that values are complex.
    pub complex: bool,
    /// Spacing of spectral lines in Hz.
    pub line_width: Option<f64>,
    /// Unit of the values, as written.
    pub unit: Option<String>,
    /// Scale factors of the values other than 1.
    pub scales: Vec<StatedScale>,
    /// Window of the spectrum.
    pub window: Option<Window>,
    /// Channel name or title.
    pub name: Option<String>,
    /// Header lines as key and value; the key is empty where a line has none.
    pub notes: Vec<(String, String)>,
}

/// A sampling rate with a mark before its last three digits, such as `1.000 Hz`: 1 Hz or 1000 Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct PerhapsRate {
    /// As written.
    pub said: String,
    /// Rate in Hz if the mark is a decimal mark.
    pub decimal: f64,
    /// Rate in Hz if the mark separates thousands.
    pub grouped: f64,
}

/// Keys of a sampling rate (`RATE`) and of a time step (`STEP`), separated by `|`.
const RATE: &str = "sampling rate|sample rate|sampling frequency|sample frequency|samplerate|samp freq|sampling freq|data rate|fs|rate|abtastrate|\
                    abtastfrequenz|fréquence d'échantillonnage|samples per second|scan rate|update rate|messrate|\
                    messfrequenz|samplingrate|samples/sec|samples/s|sampling speed|output data rate|odr|acquisition rate|logging rate|\
                    frequenza di campionamento|frecuencia de muestreo|frequência de amostragem|taux|échantillonnage|\
                    taux d'échantillonnage|muestreo|sampling|abtastung";
const STEP: &str = "dt|delta t|sampling interval|sample interval|sampling period|time step|delta time|increment|clock|\
                    interval|time interval|tinc|sample period|scan interval|logging interval|abtastzeit|messintervall|x increment|xinc|x axis delta|hresolution|horizontal interval|delta|dx|sampling cycle|\
                    x delta|xdelta|abtastintervall|サンプリング周期";
/// Keys of the quantity or unit of the abscissa.
const AXIS: &str = "x-axis|x axis|x-axis unit|x axis unit|xunit|xunits|x unit|hunit|horizontal units";

/// Largest relative difference of two stated rates that rounding explains: a step of two digits, such as
/// 1.0, is rounded by up to 5 %.
const ROUNDED_RATE: f64 = 0.05;

/// Largest number of spectral lines accepted from a header; any analyser has far fewer.
const MOST_LINES: f64 = 1e9;

impl Stated {
    /// Reads the header lines above rows with the decimal `mark`, if it is known.
    pub fn of<'a>(lines: impl Iterator<Item = &'a str>, mark: Option<u8>) -> Stated {
        let mut stated = Stated { mark, ..Stated::default() };
        for line in lines {
            // `NPTS= 6000, DT= .01 SEC` are two statements. In `fs=1,6 kHz; N=4096` the comma does not
            // separate statements, since no key begins with a digit.
            let between = [(';', ['=', ':']), ('|', ['=', ':']), (',', ['=', '=']), ('\t', ['=', ':'])];
            let several = |(mark, ends): &(char, [char; 2])| {
                let has_key = |part: &str| {
                    part.contains(*ends) && !part.trim_start().starts_with(|c: char| c.is_ascii_digit())
                };
                line.contains(*mark) && line.split(*mark).all(has_key)
            };
            let mark = between.into_iter().find(several).map(|(mark, _)| mark);
            for line in line.split(|c| Some(c) == mark) {
                let line = line.trim().trim_matches('"').trim_start_matches([';', ' ']);
                let line = line.strip_prefix("//").map_or(line, str::trim_start);
                let (key, value) = split(line);
                if stated.decimation.is_none() && is_decimated(line) {
                    stated.decimation = Some(line.to_owned());
                }
                stated.notes.push((key.to_owned(), value.to_owned()));
                let (key, value) = if key.is_empty() { behind_key(line) } else { (key, value) };
                let key = key.replace("mHz", MILLIHERTZ).to_lowercase();
                let said = value.to_lowercase();
                stated.complex |= said == "complex" || said.contains("real and imaginary");
                let hertz = matches!(said.as_str(), "hz" | "hertz") || said.starts_with("frequency");
                stated.lines_apart |= AXIS.split('|').any(|known| known == key) && hertz;
                if key.is_empty() {
                    free_text(line, &mut stated);
                } else {
                    keyed(&key, value, &mut stated);
                }
            }
        }
        if stated.lines_apart && stated.of_one_series {
            stated.rate = None;
            let step = stated.step.filter(|_| stated.start.is_none_or(|start| start == 0.0));
            stated.line_width = stated.line_width.or(step);
        }
        stated
    }

    /// Takes the value of a sampling rate: in Hz, or a time step with its unit.
    fn take_rate(&mut self, value: &str, unit_in_key: &str) {
        let (mark, before) = (self.mark, self.rate);
        let step = || step_rate(value, unit_in_key, mark).filter(|_| !is_bare(value, unit_in_key));
        self.rate = hertz(value, unit_in_key, mark).or_else(step).or(self.rate);
        let with = |mark| hertz_with(value, unit_in_key, mark);
        self.perhaps_rate = if self.rate.is_none() { perhaps(value, &with) } else { None };
        self.keeps_other(before);
    }

    /// Takes the value of a time step under a `key`.
    fn take_step(&mut self, key: &str, value: &str, unit_in_key: &str) {
        let rate = step_rate(value, unit_in_key, self.mark);
        let with = |mark| step_rate(value, unit_in_key, mark);
        self.perhaps_rate = self.perhaps_rate.take().or_else(|| perhaps(value, &with));
        self.of_one_series |= rate.is_some();
        self.step = rate.map(|rate| 1.0 / rate).or(self.step);
        // A step above 1 s without a unit is more likely in ms or µs.
        let unlikely = is_bare(value, unit_in_key) && rate.is_some_and(|rate| rate < 1.0);
        self.assumed = self.assumed.take().or(unlikely.then(|| key.to_owned()));
        self.rate = self.rate.or(rate);
        self.keeps_other(rate);
    }

    /// Keeps a `rate` that differs from the used one by more than rounding explains.
    fn keeps_other(&mut self, rate: Option<f64>) {
        let differs = |rate: &f64| self.rate.is_some_and(|used| (rate / used - 1.0).abs() > ROUNDED_RATE);
        self.other_rate = rate.filter(differs).or(self.other_rate);
    }

    /// Whether `n` values are the lines of the base band plus the one at 0 Hz. They are then a spectrum
    /// even if a sampling rate is stated, since analysers print it in spectra, too.
    pub(crate) fn all_lines(&self, n: usize) -> bool {
        self.base_band.is_some() && self.lines.is_some_and(|lines| lines as usize + 1 == n)
    }

    /// Whether a sampling rate is stated, including one with an ambiguous mark.
    pub fn states_rate(&self) -> bool {
        self.rate.is_some() || self.perhaps_rate.is_some()
    }

    /// Spacing in Hz of `n` spectral lines, from the header.
    pub fn spacing(&self, n: usize) -> Option<f64> {
        let band = self.base_band.map(|band| band / self.lines_of(n));
        if self.all_lines(n) { band } else { self.line_width.or(band) }
    }

    /// Number of spectral lines without 0 Hz: from the header, else `n` − 1.
    pub(crate) fn lines_of(&self, n: usize) -> f64 {
        self.lines.unwrap_or_else(|| n.saturating_sub(1).max(1) as f64)
    }
}

/// Splits `key: value` or `key = value`. The key is empty for other lines. The hour of a time of day is not
/// a key.
pub fn split(line: &str) -> (&str, &str) {
    let at = line.find([':', '=']).filter(|at| {
        let key = line[..*at].trim();
        let digit = |c: char| c.is_ascii_digit();
        let time = key.ends_with(digit)
            && line[*at..]
                .strip_prefix(':')
                .is_some_and(|behind| behind.is_empty() || behind.starts_with(digit));
        !key.is_empty() && !time && key.len() <= 40
    });
    at.map_or(("", line.trim()), |at| (line[..at].trim(), line[at + 1..].trim()))
}

/// Splits `Sampling Freq(Hz) 100Hz` and `Sample rate 1200 Hz`, where the value begins with a digit and the
/// key ends with a bracket or is the key of a rate. Otherwise the key is empty.
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

/// Whether a line says that only some of the samples are kept: `decimated by 2`, `resampled to 1 kHz`,
/// `every 8th sample`.
fn is_decimated(line: &str) -> bool {
    let lower = line.to_lowercase();
    let thinned = ["decimat", "dezimat", "dezimiert", "décimat", "downsampl", "resampl"];
    let behind = thinned.iter().find_map(|word| lower.split_once(word)).map(|(_, behind)| behind);
    let every = lower.split_once("every ").map(|(_, behind)| behind).filter(|behind| {
        let word = behind.split_whitespace().next().unwrap_or("");
        ["st", "nd", "rd", "th"].iter().any(|end| word.ends_with(end)) && behind.contains("sample")
    });
    let Some(behind) = behind.or(every) else { return false };
    let factor = behind.split(|c: char| !c.is_ascii_digit()).find(|digits| !digits.is_empty());
    factor.is_some_and(|factor| {
        let several = factor.trim_start_matches('0').parse::<u32>().is_ok_and(|n| n > 1);
        several || behind.contains("hz")
    })
}

/// Splits the unit from a `key`, in brackets or as its last word: `sample_rate_hz`. Punctuation in the key
/// becomes blanks.
fn split_unit(key: &str) -> (String, String) {
    let (key, unit) = match key.find(['[', '(']) {
        Some(at) => (key[..at].trim(), key[at + 1..].trim_end_matches([']', ')'])),
        None => (key, ""),
    };
    let key: String = key.chars().map(|c| if matches!(c, '_' | '-' | '.') { ' ' } else { c }).collect();
    let behind = key.rsplit_once(' ').filter(|(key, last)| {
        let of = |keys: &str, units: &[(&str, f64)]| {
            keys.split('|').any(|known| known == *key) && units.iter().any(|(known, _)| known == last)
        };
        unit.is_empty() && (of(RATE, &HERTZ) || of(STEP, &SECONDS))
    });
    let (key, unit) = behind.unwrap_or((key.as_str(), unit));
    (key.to_owned(), unit.to_owned())
}

/// The rate with either meaning of an ambiguous mark, for rows that do not show their decimal mark.
fn perhaps(value: &str, rate_with: &dyn Fn(Option<u8>) -> Option<f64>) -> Option<PerhapsRate> {
    let own = doubtful_mark(value)?;
    let (decimal, grouped) = (rate_with(Some(own))?, rate_with(Some(other_mark(own)))?);
    Some(PerhapsRate { said: value.to_owned(), decimal, grouped })
}

/// Stores the value of a known `key` in `stated`, if it is in the accepted range.
fn keyed(key: &str, value: &str, stated: &mut Stated) {
    let (key, unit_in_key) = split_unit(key);
    let (value, unit_in_key) = (without_blanks(value), unit_in_key.as_str());
    let value = value.as_str();
    let mark = stated.mark;
    let hertz = || hertz(value, unit_in_key, mark);
    let plain = || quantity(value, "", &[("", 1.0)], mark);
    let bare = is_bare(value, unit_in_key);
    // `bandwidth`, `span` and `resolution` are not keys: headers of time traces also use them, for other
    // quantities.
    match key.trim() {
        // The keys of the next three arms count only with a unit. Exceptions: `delta` below 1, and
        // `increment` after a start value. SAC and related formats state DELTA, a step in s below 1,
        // without a unit.
        "delta" if bare && plain().is_some_and(|step| step < 1.0) => {
            let step = plain();
            stated.rate = stated.rate.or(step.and_then(|step| checked(1.0 / step)));
            stated.assumed = Some("DELTA".to_owned());
            (stated.step, stated.of_one_series) = (step, true);
        }
        "rate" | "data rate" | "clock" | "delta" | "dx" | "x delta" | "xdelta" | "interval"
        | "time interval" | "odr" | "scan interval" | "logging interval" | "messintervall" | "sampling"
        | "taux" | "échantillonnage" | "muestreo" | "abtastung"
            if bare => {}
        "increment" if bare && stated.start.is_none() => {}
        "lines" | "spectral lines" | "number of lines" | "no of lines" | "fft lines" => {
            stated.lines = quantity(value, "", &[("", 1.0), ("lines", 1.0)], mark).and_then(line_count);
        }
        "base band" | "baseband" | "frequency range" | "frequency span" | "fmax" | "f max" => {
            stated.base_band = hertz();
        }
        key if RATE.split('|').any(|known| known == key) => stated.take_rate(value, unit_in_key),
        key if STEP.split('|').any(|known| known == key) => stated.take_step(key, value, unit_in_key),
        "npts" | "number of points" | "number of samples" | "record length" | "memory length"
        | "blocksize" | "total data points" => {
            stated.values = plain().and_then(line_count).map(|n| n as usize);
        }
        "start" | "t0" | "time of first sample" | "start time s" | "x origin" | "xorg" | "hoffset" => {
            let parsed = scaled(value, unit_in_key, &SECONDS, mark);
            stated.start = parsed.filter(|start| *start == 0.0 || checked(start.abs()).is_some());
        }
        "pre trigger length" | "pre trigger" | "pretrigger" | "pre trigger time" => {
            let before = quantity(value.trim_start_matches('-'), unit_in_key, &SECONDS, mark);
            stated.start = before.filter(|_| !bare).map(|before| -before).or(stated.start);
        }
        "df" | "delta f" | "line width" | "frequency resolution" | "line spacing" => {
            stated.line_width = hertz();
        }
        "unit" | "units" | "y unit" | "yunit" | "y axis unit" | "einheit" | "unidad" | "unidade"
        | "unité" | "unità" | "amplitude unit" | "engineering unit" => {
            let unit = Some(value.trim_matches(['[', ']']).to_owned());
            // A list of units, one for each channel, is not the unit of all channels.
            stated.unit = unit.filter(|v| !v.is_empty() && !v.contains([';', '\t']) && !v.contains(" and "));
        }
        "y axis" if value.ends_with([']', ')']) => {
            stated.unit = stated.unit.take().or(Name::parse(value).unit);
        }
        key if StatedScale::is_key(key) => stated.scales.extend(StatedScale::of(key, value)),
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

/// Reads lines without a key: `20 Hz 400 lines`, `64 samples, 2000 sps`.
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

fn line_count(lines: f64) -> Option<f64> {
    ((1.0..=MOST_LINES).contains(&lines) && lines.fract() == 0.0).then_some(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &[&str]) -> Stated {
        Stated::of(lines.iter().copied(), None)
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

    /// `51,200` may be 51.2 Hz or 51 200 Hz. If the rows do not show which, both are kept and neither is
    /// used.
    #[test]
    fn a_rate_in_groups_of_digits_is_a_question() {
        for text in ["Sampling rate: 51,200", "Sample rate [Hz]: 51,200", "fs = 51,200 Hz", "fs = 51.200 Hz"]
        {
            let s = of(&[text]);
            let perhaps = s.perhaps_rate.map(|perhaps| (perhaps.decimal, perhaps.grouped));
            assert_eq!((s.rate, perhaps), (None, Some((51.2, 51_200.0))), "{text}");
        }
        assert_eq!(of(&["Sampling rate: 51,2 kHz"]).perhaps_rate, None);
    }

    /// `1.000 Hz` is 1000 Hz above rows with decimal commas, and 1 Hz above rows with decimal points.
    #[test]
    fn the_mark_of_the_rows_tells_what_the_mark_of_a_rate_is() {
        let rate = |line: &str, mark| Stated::of(std::iter::once(line), Some(mark)).rate;
        for (line, comma, point) in [
            ("Abtastrate: 1.000 Hz", Some(1000.0), Some(1.0)),
            ("Sampling rate: 1,000 Hz", None, Some(1000.0)),
            ("fs: 1.000,0 Hz", Some(1000.0), Some(1000.0)),
            ("fs: 1,000.0 Hz", Some(1000.0), Some(1000.0)),
            ("fs: 1.000.000 Hz", Some(1e6), Some(1e6)),
            ("Abtastrate: 51,2 kHz", Some(51_200.0), Some(51_200.0)),
            ("fs: 1.000e3 Hz", Some(1000.0), Some(1000.0)),
            ("fs: 0.500 Hz", Some(0.5), Some(0.5)),
            // 1.000 kHz is never 1000 kHz, so it contradicts decimal commas in the rows: no rate is taken.
            ("fs: 1.000 kHz", None, Some(1000.0)),
            ("Abtastintervall: 1,000 ms", Some(1000.0), Some(1.0)),
            ("Taux: 1 000 Hz", Some(1000.0), Some(1000.0)),
            ("Échantillonnage : 1 kHz", Some(1000.0), Some(1000.0)),
            ("Sampling: 2 ms", Some(500.0), Some(500.0)),
            ("Rate: 60000 samples/min", Some(1000.0), Some(1000.0)),
            ("Acquisition rate 1.0 kHz / filter 400 Hz", Some(1000.0), Some(1000.0)),
        ] {
            assert_eq!((rate(line, b','), rate(line, b'.')), (comma, point), "{line}");
        }
        let two = Stated::of(std::iter::once("Abtastrate [Hz]: 1.000\tKanäle: 2"), Some(b','));
        assert_eq!((two.rate, two.notes.len()), (Some(1000.0), 2));
    }

    #[test]
    fn a_head_that_speaks_of_decimation() {
        let said = |line: &str| of(&[line]).decimation.is_some();
        assert!(said("Sampling rate: 2000 Hz, decimated by 2") && said("Decimation: 4"));
        assert!(!said("Decimation: 1") && !said("Decimation: none") && !said("Decimals: 3"));
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
