//! Reads the heading of a column: its name and unit, and whether it is an abscissa, a counter, a phase or a
//! part of complex values.

use super::unit_words::{COUNTERS, DAY, HOUR, amplitude, bare_unit, is_angular, is_decibel, symbol};
use crate::assemble::{self, domain, kind_of};
use vibro_record::code;
use vibro_record::units::{Quantity, Unit, spelled};
use vibro_record::{AxisKind, Error, Finding, Result};

/// Name and unit of a column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Name {
    /// Name without the unit.
    pub name: String,
    /// Unit as the heading spells it; `None` if it states none.
    pub unit: Option<String>,
}

/// Part of complex values that a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComplexPart {
    Real,
    Imaginary,
}

/// The name of a column; `column` and its number `at`, from 1, if it has none.
pub fn label(name: &str, at: usize) -> String {
    if name.is_empty() { format!("column {at}") } else { name.to_owned() }
}

impl Name {
    /// Reads `velocity [mm/s]`, `velocity (mm/s)`, `velocity / mm/s`, `velocity, mm/s`, `velocity in mm/s`,
    /// `velocity mm/s` and `velocity_mm/s`.
    ///
    /// Text in square brackets is the unit, known or not. In every other spelling it must be a known unit;
    /// after a blank or an underscore it must also be one that cannot be part of a name.
    pub fn parse(text: &str) -> Name {
        let text = text.trim();
        // In `Y[0]` the bracket holds a channel number, not a unit.
        let numbered = |(name, unit): &(&str, &str)| {
            unit.bytes().all(|b| b.is_ascii_digit())
                && name.ends_with(|c: char| c.is_alphanumeric())
                && !unit.is_empty()
        };
        if let Some((name, unit)) = bracketed(text, '[', ']').filter(|found| !numbered(found)) {
            let unit = long(name, unit).unwrap_or(symbol(unit.trim()));
            let unit = Some(unit.to_owned()).filter(|u| !u.is_empty());
            return Name { name: name.trim_end().to_owned(), unit };
        }
        let known = |name: &str, unit: &str| {
            let (name, unit) = (name.trim_end(), symbol(unit.trim()));
            let unit = long(name, unit).unwrap_or(unit);
            // In `X (100g)` the bracket holds the range of the sensor, not a unit.
            let multiple = unit.starts_with(|c: char| c.is_ascii_digit()) && !unit.starts_with("1/");
            let known = || Unit::parse_or_opaque(amplitude(unit).0);
            (!name.is_empty()
                && !multiple
                && (known().is_known() || known().is_level() || matches!(unit, HOUR | DAY)))
            .then(|| Name { name: name.to_owned(), unit: Some(unit.to_owned()) })
        };
        text.split_once(" / ")
            .and_then(|(name, unit)| known(name, unit))
            .or_else(|| bracketed(text, '(', ')').and_then(|(name, unit)| known(name, unit)))
            // `Force (N) Run #1`
            .or_else(|| {
                let (name, behind) = text.split_once(" (")?;
                let (unit, behind) = behind.split_once(") ")?;
                known(name, unit).map(|found| Name { name: format!("{} {behind}", found.name), ..found })
            })
            .or_else(|| text.split_once(", ").and_then(|(name, unit)| known(name, unit)))
            // `Acceleration, g (CFC 60)`
            .or_else(|| {
                let (name, behind) = text.split_once(", ")?;
                let (unit, behind) = behind.split_once(" (")?;
                known(name, unit).map(|found| Name { name: format!("{} ({behind}", found.name), ..found })
            })
            .or_else(|| text.rsplit_once(" in ").and_then(|(name, unit)| known(name, unit)))
            .or_else(|| {
                let whole = WHOLE.iter().find(|(said, _)| text.eq_ignore_ascii_case(said));
                whole.map(|(_, unit)| Name { name: "time".to_owned(), unit: Some((*unit).to_owned()) })
            })
            .or_else(|| {
                let (name, unit) = text.rsplit_once([' ', '_'])?;
                known(name, unit).filter(|_| cannot_be_name(name, symbol(unit)))
            })
            .unwrap_or_else(|| Name { name: text.to_owned(), unit: None })
    }

    /// A column whose heading is a unit instead of a name: `Second`, `Volts`; `None` for other words.
    pub(crate) fn of_unit(field: &str) -> Option<Name> {
        let unit = symbol(field.trim());
        let word = unit != field.trim() || spelled(unit).is_some();
        word.then(|| Name { name: String::new(), unit: Some(unit.to_owned()) })
    }

    /// The column named `text`, with the unit from a second header row.
    pub(crate) fn with_unit_row(text: &str, unit: &str) -> Name {
        match bare_unit(unit) {
            "" => Name::parse(text),
            unit => {
                let unit = long(text, unit).unwrap_or(symbol(unit)).to_owned();
                let own = Name::parse(text);
                // A unit that both rows state is removed from the name.
                let name = if own.unit.as_deref() == Some(unit.as_str()) { &own.name } else { text.trim() };
                Name { name: name.to_owned(), unit: Some(unit) }
            }
        }
    }

    /// Finding if the name states another unit than the row of units below it: `Acc [m/s²]` above `g`.
    /// `axis`: whether the column is one.
    pub(crate) fn unit_differs(&self, axis: bool) -> Option<Finding> {
        let used = self.unit.as_deref()?;
        let own = Name::parse(&self.name).unit?;
        let known = |unit: &str| Unit::parse(amplitude(unit).0);
        let (of_name, of_row) = (known(&own)?, known(used)?);
        let found = match of_name.dimension() == of_row.dimension() {
            _ if axis => Finding::doubt("axis-row-differs"),
            true => Finding::doubt("unit-row-differs"),
            false => Finding::doubt("quantity-row-differs"),
        };
        let found = found.name("head", own).name("used", used).name("column", self.name.as_str());
        (of_name != of_row).then(|| found.without_estimate())
    }

    /// Reads a quantity divided by its unit, `t/s` or `a/(m/s²)`; `None` for other text.
    pub(crate) fn over_unit(text: &str) -> Option<Name> {
        let (name, unit) = text.split_once('/')?;
        let unit = bare_unit(unit);
        let known = Unit::parse(unit).is_some() && !name.trim().is_empty();
        known.then(|| Name { name: name.trim().to_owned(), unit: Some(unit.to_owned()) })
    }

    /// Factor from the unit of this abscissa to s or Hz, and a finding if the unit is assumed or angular.
    ///
    /// # Errors
    /// If the unit is unknown.
    pub(crate) fn to_axis(&self, kind: &AxisKind) -> Result<(f64, Option<Finding>)> {
        let Some(text) = &self.unit else {
            let assumed = match bracketed(&self.name, '(', ')') {
                Some((_, unit)) => Finding::caution("axis-unit-unknown").name("said", unit),
                None => Finding::caution(code::AXIS_UNIT_ASSUMED),
            };
            return Ok((1.0, Some(assumed.name("unit", domain(kind).1))));
        };
        if let Some((_, factor)) =
            [(HOUR, 3600.0), (DAY, assemble::DAY)].iter().find(|(long, _)| text == long)
        {
            return Ok((*factor, None));
        }
        let unit = Unit::parse(text).ok_or_else(|| {
            let found = format!("the unit {text:?} of the abscissa {:?}", self.name);
            Error::usage(found, "s, ms, Hz, kHz, …")
                .hint("name another unit in its header, e.g. time [s], or [d] for days")
        })?;
        let angular = is_angular(text).then(|| Finding::note("axis-angular"));
        Ok((unit.hertz().unwrap_or(unit.factor()), angular))
    }

    /// Kind of abscissa that the column holds, by its name; the `first` column may be an abscissa by its
    /// unit alone.
    pub fn axis(&self, first: bool) -> Option<AxisKind> {
        let unit = self.unit.as_deref().map(Unit::parse_or_opaque);
        let by_unit = unit.as_ref().and_then(kind_of);
        let key = self.run().map_or(self.name.as_str(), |(name, _)| name).to_lowercase();
        let word = match key.as_str() {
            "time" | "timestamp" | "time stamp" | "zeit" | "temps" | "elapsed time" | "relative time"
            | "relative zeit" | "running time" | "time since start" | "время" | "时间" | "時間" => {
                Some(AxisKind::Time)
            }
            "frequency" | "freq" | "freq." | "frequenz" | "fréquence" | "частота" | "频率" | "周波数" => {
                Some(AxisKind::Frequency)
            }
            _ if first && begins(&key, "time") => Some(AxisKind::Time),
            _ if first && self.is_vague() && !self.counts() => Some(AxisKind::Time),
            _ if first && begins(&key, "freq") => Some(AxisKind::Frequency),
            _ if self.name == "t" && (first || by_unit.is_some()) => Some(AxisKind::Time),
            _ if self.name == "f" && (first || by_unit.is_some()) => Some(AxisKind::Frequency),
            _ => None,
        };
        if first && self.unit.as_deref().is_some_and(is_angular) {
            let omega = matches!(key.as_str(), "omega" | "ω" | "w" | "angular frequency" | "kreisfrequenz");
            return Some(AxisKind::Frequency).filter(|kind| omega || word.as_ref() == Some(kind));
        }
        let known = unit.as_ref().is_some_and(Unit::is_known);
        // Revolutions per minute are a frequency if the name says so.
        let is_frequency = unit.is_some_and(|unit| unit.quantity() == Quantity::Frequency);
        let fits = |word: &AxisKind| {
            !known || by_unit.as_ref() == Some(word) || is_frequency && *word == AxisKind::Frequency
        };
        word.filter(fits).or(by_unit.filter(|_| first))
    }

    /// Splits off the run of a measurement: `Time Run #1` is `Time` of `Run #1`, `Run 1: Time` is `Time` of
    /// `Run 1`.
    pub fn run(&self) -> Option<(&str, &str)> {
        let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let behind = || {
            let (before, _) = self.name.rsplit_once('#').filter(|(_, behind)| number(behind))?;
            let (name, _) = before.trim_end().rsplit_once(' ')?;
            Some((name.trim_end(), self.name[name.len()..].trim_start()))
        };
        let before = || {
            let (run, name) = self.name.split_once(": ")?;
            run.rsplit_once(' ').filter(|(_, behind)| number(behind)).map(|_| (name, run))
        };
        behind().or_else(before)
    }

    /// An unknown unit in round brackets after the name: one to three letters that are neither a word such
    /// as `rms` or `max` nor a direction.
    pub fn unknown_unit(&self) -> Option<&str> {
        let (name, unit) = bracketed(&self.name, '(', ')')?;
        let short = (1..=3).contains(&unit.chars().count()) && unit.chars().all(char::is_alphabetic);
        let word =
            ["x", "y", "z", "rms", "avg", "raw", "max", "min", "abs"].contains(&unit.to_lowercase().as_str());
        (self.unit.is_none() && short && !word && name.ends_with(' ')).then_some(unit)
    }

    /// Whether the name or unit is one of a counter, which numbers rows or samples.
    pub fn counts(&self) -> bool {
        let key = self.name.to_lowercase();
        let key = key.trim_end_matches('.');
        let named = COUNTS.split('|').any(|known| known == key);
        self.unit.as_ref().map_or(named, |unit| COUNTERS.contains(&unit.to_lowercase().as_str()))
    }

    /// Whether the name may be one of a counter, such as `loggingSample(N)`. The column is a counter only
    /// if its values also count.
    pub fn may_count(&self) -> bool {
        let plain = self.unit.as_deref().is_none_or(|unit| unit == NATURAL);
        self.counts() || plain && COUNT_WORDS.contains(&self.last_word().as_str())
    }

    /// Factor of the unit to s, if it is a unit of time.
    pub fn seconds(&self) -> Option<f64> {
        let unit = Unit::parse(self.unit.as_deref()?)?;
        (unit.quantity() == Quantity::Time).then_some(unit.factor())
    }

    /// The quantity in the name if it contradicts the unit: a count in newtons, or a temperature in degrees
    /// of an angle. `naturals`: a counter of the table has the unit N, for natural numbers; N is then
    /// newton only in a column whose name says force. A column is a count only if all its values are
    /// `whole`.
    pub fn against_unit(&self, naturals: bool, whole: impl Fn() -> bool) -> Option<&'static str> {
        let unit = self.unit.as_deref()?;
        let quantity = Unit::parse(unit)?.quantity();
        let force = || FORCES.iter().any(|word| self.name.to_lowercase().contains(word));
        let count = unit == NATURAL && !force() && (self.may_count() || naturals) && whole();
        let warm = self.name == "T" || TEMPERATURES.contains(&self.last_word().as_str());
        if count { Some("count") } else { (warm && quantity == Quantity::Angle).then_some("temperature") }
    }

    /// Finding if the name says another motion than the unit: `Acceleration [mm/s]`.
    pub fn motion_differs(&self) -> Option<Finding> {
        let used = self.unit.as_deref()?;
        let name = self.name.to_lowercase();
        let mut said = MOTIONS.iter().filter(|(word, _)| name.contains(word)).map(|(_, motion)| *motion);
        let (motion, quantity) = (said.next()?, Unit::parse(amplitude(used).0)?.quantity());
        let moves = MOTIONS.iter().any(|(_, motion)| *motion == quantity);
        // A name with several motions tells none.
        let derived = DERIVED.iter().any(|word| name.contains(word));
        let differs = moves && !derived && motion != quantity && said.all(|other| other == motion);
        let found = Finding::doubt("quantity-name-differs").name("column", self.name.as_str());
        let found = found.name("word", motion.name()).name("used", used).name("quantity", quantity.name());
        differs.then(|| found.without_estimate())
    }

    /// Factor to rad of a phase column, which follows its magnitude; `None` for other columns.
    pub fn phase(&self) -> Option<f64> {
        let key = self.name.to_lowercase();
        let named =
            PHASES.iter().any(|word| begins(&key, word)) || PHASES.contains(&self.last_word().as_str());
        let unit = Unit::parse(self.unit.as_deref()?).filter(|unit| unit.quantity() == Quantity::Angle);
        unit.filter(|_| named).map(|unit| unit.factor())
    }

    /// The last word of the name in lower case: `sample` in `loggingSample`, `loop_sample` and `Sample`.
    pub fn last_word(&self) -> String {
        let name = self.name.trim_end_matches(|c: char| !c.is_alphanumeric());
        let begins = |(at, c): &(usize, char)| {
            !c.is_alphanumeric() || c.is_uppercase() && name[..*at].ends_with(char::is_lowercase)
        };
        let begin = name.char_indices().rev().find(begins).map_or(0, |(at, _)| at);
        name[begin..].trim_start_matches(|c: char| !c.is_alphanumeric()).to_lowercase()
    }

    /// Whether the name may be one of an abscissa as well as of values, such as `x`.
    pub(crate) fn is_vague(&self) -> bool {
        ABSCISSAE.contains(&self.name.to_lowercase().as_str())
    }

    /// Which part of complex values the column holds, and the name without that word: `H_re`, `H (imag)`,
    /// `re(H)`, …
    pub fn part(&self) -> Option<(ComplexPart, String)> {
        let joints = [' ', '_', '.', ':'];
        let of = |word: &str| match word.to_lowercase().as_str() {
            "re" | "real" => Some(ComplexPart::Real),
            "im" | "imag" | "imaginary" => Some(ComplexPart::Imaginary),
            _ => None,
        };
        let found = |word, rest: &str| Some((of(word)?, rest.trim().to_owned()));
        let name = self.name.as_str();
        let brackets = bracketed(name, '(', ')');
        found(name, "")
            .or_else(|| brackets.and_then(|(rest, word)| found(word, rest)))
            .or_else(|| brackets.and_then(|(word, rest)| found(word.trim(), rest)))
            .or_else(|| name.rsplit_once(joints).and_then(|(rest, word)| found(word, rest)))
            .or_else(|| name.split_once(joints).and_then(|(word, rest)| found(word, rest)))
    }
}

/// Names that may be those of an abscissa, of values or of dates. Such a column must rise to be the
/// abscissa.
const ABSCISSAE: [&str; 12] = [
    "x",
    "x-axis",
    "x axis",
    "datum",
    "date",
    "datetime",
    "date time",
    "zeitstempel",
    "ts",
    "epoch",
    "tempo",
    "tiempo",
];

/// Headings that are only the unit of a time column, and that unit.
const WHOLE: [(&str, &str); 6] = [
    ("in s", "s"),
    ("seconds_elapsed", "s"),
    ("millis", "ms"),
    ("millis()", "ms"),
    ("micros", "µs"),
    ("micros()", "µs"),
];

/// Names of a counter, separated by `|`; the first one is the empty name.
const COUNTS: &str =
    "|#|index|i|n|no|nr|number|record|row|scan|sample|samples|sample no|point|frame|store no";

/// Last words of names of counters, such as `loopSample`.
const COUNT_WORDS: [&str; 12] = [
    "sample", "samples", "index", "count", "counter", "number", "record", "row", "frame", "packet", "seq",
    "sequence",
];

/// Unit of a counter in files of telephone apps: the natural numbers ℕ, not newton.
pub(super) const NATURAL: &str = "N";

/// Words that begin or end the name of a phase.
const PHASES: [&str; 5] = ["phase", "phasenwinkel", "fase", "angle", "фаза"];

/// Words in the names of columns, and the motion that they say.
const MOTIONS: [(&str, Quantity); 6] = [
    ("acceleration", Quantity::Acceleration),
    ("beschleunigung", Quantity::Acceleration),
    ("velocity", Quantity::Velocity),
    ("geschwindigkeit", Quantity::Velocity),
    ("displacement", Quantity::Displacement),
    ("auslenkung", Quantity::Displacement),
];

/// Words in a name of what was computed of the motion that it says: `integrated acceleration` is a velocity.
const DERIVED: [&str; 7] = ["integr", "rate", "deriv", "diff", " of ", " from ", "abgeleitet"];

/// Words in the name of a force: the unit N is then newton.
const FORCES: [&str; 3] = ["force", "load", "kraft"];

/// Last words of a temperature's name. Degrees are then a temperature of unknown scale, not an angle.
const TEMPERATURES: [&str; 4] = ["temperature", "temp", "temperatur", "température"];

/// Words that begin the name of an acceleration: the unit `G` is then standard gravity, not gauss.
const ACCELERATIONS: [&str; 3] = ["acc", "beschl", "shock"];

/// Unit whose spelling is clear only with the name: `d`, `H`, `Min` or `MS` of a time, `G` of an
/// acceleration. `None` for all other units.
fn long(name: &str, unit: &str) -> Option<&'static str> {
    if unit.trim() == "G" {
        return ACCELERATIONS.iter().any(|word| name.to_lowercase().starts_with(word)).then_some("g");
    }
    let found = match unit.trim().to_lowercase().as_str() {
        "h" | "hr" | "hrs" | "std" => HOUR,
        "d" | "day" | "days" | "ole" => DAY,
        "min" => "min",
        "s" => "s",
        "ms" => "ms",
        "us" => "µs",
        _ => return None,
    };
    let named = Name { name: name.trim().to_owned(), unit: None };
    (named.axis(true) == Some(AxisKind::Time) && !named.is_vague()).then_some(found)
}

/// Splits a text that ends with a bracket into the text before the bracket and its content.
fn bracketed(text: &str, open: char, close: char) -> Option<(&str, &str)> {
    let inner = text.strip_suffix(close)?;
    let mut depth = 1;
    for (at, c) in inner.char_indices().rev() {
        if c == close {
            depth += 1;
        } else if c == open {
            depth -= 1;
            if depth == 0 {
                return Some((&inner[..at], &inner[at + open.len_utf8()..]));
            }
        }
    }
    None
}

/// Whether `text` begins with `word` and no letter follows: `time_abs` begins with `time`, `timeout` does
/// not.
fn begins(text: &str, word: &str) -> bool {
    text.strip_prefix(word).is_some_and(|rest| !rest.starts_with(char::is_alphabetic))
}

/// Whether a unit without brackets cannot be part of the name: a quotient, hertz, a level, or a unit of the
/// quantity in the name. `force_N` ends with a unit; `x_m` may be a name.
fn cannot_be_name(name: &str, unit: &str) -> bool {
    let quantity = Unit::parse(unit).map(|u| u.quantity());
    let key = name.to_lowercase();
    let named =
        |quantity: Quantity| key.contains(quantity.name()) || (quantity == Quantity::Time && key == "t");
    unit.contains('/') || unit.ends_with("Hz") || is_decibel(unit) || quantity.is_some_and(named)
}

#[cfg(test)]
mod tests {
    use super::super::unit_words::is_unit_row;
    use super::*;

    fn split(text: &str) -> (String, Option<String>) {
        let n = Name::parse(text);
        (n.name, n.unit)
    }

    #[test]
    fn units_in_the_usual_spellings() {
        for text in [
            "velocity [mm/s]",
            "velocity[mm/s]",
            "velocity (mm/s)",
            "velocity / mm/s",
            "velocity, mm/s",
            "velocity_mm/s",
            " velocity mm/s ",
        ] {
            assert_eq!(split(text), ("velocity".into(), Some("mm/s".into())), "{text}");
        }
        let nested = "H1 ((m/s²)/N)";
        assert_eq!(split(nested), ("H1".into(), Some("(m/s²)/N".into())));
        assert_eq!(split("v / (m/s)"), ("v".into(), Some("(m/s)".into())));
        assert_eq!(split("Acc, g (CFC 60)"), ("Acc (CFC 60)".into(), Some("g".into())));
        assert_eq!(split("level [EU]"), ("level".into(), Some("EU".into())));
        assert_eq!(split("x (mm) []"), ("x (mm)".into(), None));
        assert_eq!(split("force_N"), ("force".into(), Some("N".into())));
        assert_eq!(split("time_ms"), ("time".into(), Some("ms".into())));
        assert_eq!(split("rate_Hz"), ("rate".into(), Some("Hz".into())));
    }

    #[test]
    fn a_name_is_not_taken_for_a_unit() {
        for text in [
            "channel (left)",
            "x_m",
            "x_1",
            "v_in",
            "x_min",
            "signal g",
            "ch1",
            "m/s",
            "",
            "[",
            "(m",
            "A / B",
        ] {
            assert_eq!(split(text), (text.to_owned(), None));
        }
    }

    #[test]
    fn abscissae() {
        let axis = |text: &str, first| Name::parse(text).axis(first);
        for text in ["time [s]", "Time", "t", "t (ms)", "time_abs", "Zeit [s]", "x [s]", "time [h]"] {
            assert_eq!(axis(text, true), Some(AxisKind::Time), "{text}");
        }
        for text in [
            "f [Hz]",
            "Frequency",
            "freq (kHz)",
            "f",
            "line [Hz]",
            "Frequency (CPM)",
            "Freq. [rpm]",
            "f (RPM)",
        ] {
            assert_eq!(axis(text, true), Some(AxisKind::Frequency), "{text}");
        }
        for text in ["T", "F", "timeout", "t [m]", "f [N]", "speed [rpm]", "time [m]"] {
            assert_eq!(axis(text, true), None, "{text}");
        }
        for text in ["time [ms]", "Time (s) Run #2", "Zeit Versuch #1 (s)", "Run 2: Time (s)"] {
            assert_eq!(axis(text, false), Some(AxisKind::Time), "{text}");
        }
        for text in ["t", "interval [s]", "speed [Hz]", "time of flight [s]"] {
            assert_eq!(axis(text, false), None, "{text}");
        }
    }

    #[test]
    fn parts_of_complex_columns() {
        let part = |text: &str| Name::parse(text).part();
        for text in ["H_re", "H (real)", "re(H)", "Re H", "H.re", "H real [m/N]", "real_H"] {
            assert_eq!(part(text), Some((ComplexPart::Real, "H".into())), "{text}");
        }
        assert_eq!(part("H 1:im [m/N]"), Some((ComplexPart::Imaginary, "H 1".into())));
        assert_eq!(part("Imag"), Some((ComplexPart::Imaginary, String::new())));
        assert_eq!(part("im(H(2))"), Some((ComplexPart::Imaginary, "H(2)".into())));
        assert_eq!(part("H (2) im"), Some((ComplexPart::Imaginary, "H (2)".into())));
        for text in ["area", "impulse", "H", "", "_", "reim"] {
            assert_eq!(part(text), None, "{text}");
        }
    }

    #[test]
    fn rows_of_units() {
        let row = |text: &str| is_unit_row(text.split(','));
        assert!(row("s,mm/s") && row("[s],[EU]") && row("(ms),(V),") && row("s,V,EU"));
        assert!(!row("time,velocity") && !row(",") && !row("a,b") && !row("s,acceleration") && !row("t,N"));
        assert_eq!(Name::with_unit_row("H", "(m/s²)/(N)").unit.as_deref(), Some("(m/s²)/(N)"));
        assert_eq!(Name::with_unit_row("a", " [mm/s] ").unit.as_deref(), Some("mm/s"));
    }
}
