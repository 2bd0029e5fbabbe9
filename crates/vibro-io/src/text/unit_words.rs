//! Reads units as column headers spell them.

use crate::number;
use vibro_record::Scaling;
use vibro_record::units::{Quantity, Unit};

/// Words that a counter has instead of a unit.
pub(super) const COUNTERS: [&str; 6] = ["sequence", "samples", "points", "no.", "rn", "#"];

/// Name of the unit hour, which has no symbol among the units of values.
pub(super) const HOUR: &str = "hour";

pub(super) const DAY: &str = "day";

/// The symbol of a unit that is written as a word; any other text unchanged.
pub(super) fn symbol(text: &str) -> &str {
    let lower = text.to_lowercase();
    match lower.strip_suffix('s').filter(|t| t.len() > 2).unwrap_or(&lower) {
        "second" | "sec" | "sekunde" | "sekunden" | "с" | "秒" => "s",
        "millisecond" | "msec" => "ms",
        "microsecond" | "usec" | "µsec" => "µs",
        "minute" => "min",
        "hour" => HOUR,
        "hertz" | "гц" => "Hz",
        "kilohertz" => "kHz",
        "vdc" => "V",
        _ => text,
    }
}

/// Splits a unit into the bare unit and the scaling in its ending, RMS or peak: `Vrms`, `mm/s RMS`, `g pk`.
pub(crate) fn amplitude(unit: &str) -> (&str, Option<Scaling>) {
    const SAID: [(&str, Scaling); 4] =
        [("rms", Scaling::Rms), ("peak", Scaling::Peak), ("pk", Scaling::Peak), ("eff", Scaling::Rms)];
    let without = |(word, scaling)| {
        let at = unit.len().checked_sub(str::len(word)).filter(|at| unit.is_char_boundary(*at))?;
        let bare = unit[..at].trim_end_matches([' ', '_', '(']);
        let said = unit[at..].eq_ignore_ascii_case(word) && Unit::parse(bare).is_some() && !bare.is_empty();
        said.then_some((bare, Some(scaling)))
    };
    SAID.into_iter().find_map(without).unwrap_or((unit, None))
}

/// Whether the unit is an angle per time: the factor 1/(2π) converts rad/s to Hz.
pub(super) fn is_angular(unit: &str) -> bool {
    Unit::parse(unit).is_some_and(|u| u.quantity() == Quantity::AngularVelocity)
}

/// Whether a row of fields holds only units. Either each is a known unit or in brackets. Or the first and
/// at least half are known units, and all others are short and not numbers: `EU` may be a unit,
/// `Samples,1000` is no row of units. Blank fields do not count.
pub(crate) fn is_unit_row<'a>(fields: impl Iterator<Item = &'a str>) -> bool {
    let (mut total, mut known, mut sure, mut short, mut first) = (0, 0, 0, 0, None);
    for field in fields.filter(|f| !f.trim().is_empty()) {
        let unit = symbol(bare_unit(field));
        let understood = Unit::parse(amplitude(unit).0).is_some()
            || matches!(unit, "h" | "d" | HOUR)
            || is_decibel(unit)
            || COUNTERS.contains(&unit.to_lowercase().as_str());
        total += 1;
        known += usize::from(understood);
        sure += usize::from(understood || bare_unit(field).len() < field.trim().len());
        short +=
            usize::from(understood || unit.chars().count() <= 4 && number::either(unit.as_bytes()).is_none());
        first.get_or_insert(understood);
    }
    known > 0 && (sure == total || (first == Some(true) && short == total && 2 * known >= total))
}

/// Whether the unit is a level: `dB`, `dBA`, `dB(A)`, `dBV`, but not `dbl`.
pub(super) fn is_decibel(unit: &str) -> bool {
    unit.strip_prefix("dB").is_some_and(|of| of.chars().all(|c| c.is_ascii_uppercase() || "()".contains(c)))
}

pub(super) fn bare_unit(field: &str) -> &str {
    let field = field.trim();
    let field = field.strip_prefix("Unit:").unwrap_or(field).trim_start();
    let inner = |open, close| field.strip_prefix(open).and_then(|f| f.strip_suffix(close));
    match inner('[', ']').or(inner('(', ')')) {
        // `(m/s²)/(N)` also begins and ends with a bracket, but is not a unit in brackets.
        Some(unit) if !unit.contains(['[', ']', '(', ')']) => unit.trim(),
        _ => field,
    }
}
