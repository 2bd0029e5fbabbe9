//! Ranges of numbers, for the options of the command line and the keys of a campaign. A kind of record states
//! those of its own keys; the keys that several kinds share are here. The model checks the values of a rig,
//! of its excitation and of the settings of a model: [`crate::model::Parameter`].

use crate::error::{Error, Result};
use toml::de::DeValue;

/// Largest magnitude of a quantity. Estimators multiply at most six stated values, so products stay below
/// 1e308.
const LARGEST: f64 = 1e50;
/// Smallest magnitude of a quantity that is not 0: products of six stay above 1e-308.
const LEAST: f64 = 1e-50;
/// Longest time in s: thirty years.
const LONGEST: f64 = 1e9;
/// Shortest time in s: shorter than any contact or sampling interval.
const SHORTEST: f64 = 1e-12;

/// Range of the numbers that some keys take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KeyRange {
    /// Lower bound.
    low: f64,
    /// What an error expects of a number that is below it or not finite.
    expected: &'static str,
    /// Smallest magnitude that is not 0, and largest magnitude.
    magnitude: (f64, f64),
    unit: &'static str,
    pub(crate) keys: &'static [&'static str],
}

impl KeyRange {
    /// Numbers above 0.
    pub(crate) const fn above_zero(unit: &'static str, keys: &'static [&'static str]) -> KeyRange {
        let expected = "a finite number above 0";
        KeyRange { low: f64::MIN_POSITIVE, expected, magnitude: (LEAST, LARGEST), unit, keys }
    }

    /// Numbers of 0 or more.
    pub(crate) const fn from_zero(unit: &'static str, keys: &'static [&'static str]) -> KeyRange {
        let expected = "a finite number of 0 or more";
        KeyRange { low: 0.0, expected, magnitude: (LEAST, LARGEST), unit, keys }
    }

    /// Numbers of either sign.
    pub(crate) const fn any(unit: &'static str, keys: &'static [&'static str]) -> KeyRange {
        let expected = "a finite number";
        KeyRange { low: f64::NEG_INFINITY, expected, magnitude: (LEAST, LARGEST), unit, keys }
    }

    /// Counts from 0 to `most`.
    pub(crate) const fn count(most: f64, keys: &'static [&'static str]) -> KeyRange {
        KeyRange::from_zero("", keys).within(1.0, most)
    }

    /// Of times in s.
    pub(crate) const fn times(self) -> KeyRange {
        self.within(SHORTEST, LONGEST)
    }

    /// With a smallest magnitude that is not 0, and a largest magnitude.
    pub(crate) const fn within(self, least: f64, most: f64) -> KeyRange {
        KeyRange { magnitude: (least, most), ..self }
    }

    /// With another largest magnitude.
    pub(crate) const fn at_most(self, most: f64) -> KeyRange {
        KeyRange { magnitude: (self.magnitude.0, most), ..self }
    }

    /// Range of a key, among those of kinds of records and those of all.
    pub(crate) fn of<'a>(
        key: &str,
        of_kinds: impl IntoIterator<Item = &'a KeyRange>,
    ) -> Option<&'a KeyRange> {
        of_kinds.into_iter().chain(SHARED).find(|range| range.keys.contains(&key))
    }

    /// Unit of the numbers; empty where it differs between keys.
    #[cfg(test)]
    pub(crate) fn unit(&self) -> &'static str {
        self.unit
    }

    /// Checks a number of a key.
    ///
    /// # Errors
    /// With the key and its range, if the number lies outside.
    pub(crate) fn check(&self, key: &str, value: f64) -> Result<()> {
        let (least, most) = self.magnitude;
        if value >= self.low && (value == 0.0 || (least..=most).contains(&value.abs())) {
            return Ok(());
        }
        let of_sign = value >= self.low && value.is_finite();
        let expected =
            if of_sign { format!("{least:e} to {most:e} {}", self.unit) } else { self.expected.to_owned() };
        let key = self.keys.iter().find(|known| **known == key).unwrap_or(&"");
        Err(Error::usage(format!("{key} is {value:?}"), expected.trim_end()).setting(key))
    }

    /// Checks every number of a key's value in a campaign.
    ///
    /// # Errors
    /// As [`KeyRange::check`].
    pub(super) fn check_all(&self, key: &str, value: &DeValue<'_>) -> Result<()> {
        let number = |text: &str| text.parse().map_or(Ok(()), |number| self.check(key, number));
        match value {
            DeValue::Float(value) => number(value.as_str()),
            DeValue::Integer(value) => number(value.as_str()),
            DeValue::Array(all) => all.iter().try_for_each(|one| self.check_all(key, one.get_ref())),
            _ => Ok(()),
        }
    }
}

/// Ranges of keys that several kinds of records have, of the keys about reading a file, and of the options of
/// commands that no campaign has.
pub(crate) const SHARED: &[KeyRange] = &[
    KeyRange::above_zero("Hz", &["rate", "base_band", "excitation", "low_pass", "high_pass", "fmin", "fmax"]),
    KeyRange::above_zero("Hz", &["resample", "speed"]),
    KeyRange::from_zero("Hz", &["band"]),
    KeyRange::above_zero("Hz/s", &["sweep_rate"]),
    KeyRange::above_zero("s", &["force_window"]).times(),
    KeyRange::from_zero("s", &["refractory"]).times(),
    KeyRange::any("s", &["delay"]).times(),
    // Times since 1970, even if written in ns.
    KeyRange::any("s", &["span"]).times().at_most(4e18),
    KeyRange::above_zero("kg", &["mass"]),
    KeyRange::above_zero("", &["grazing"]),
    KeyRange::any("", &["calibration", "initial", "phase"]),
    KeyRange::above_zero("", &["threshold"]).within(1e-9, 1e3),
    KeyRange::from_zero("", &["overlap", "left_at_end", "scatter"]).within(1e-9, 1.0),
    KeyRange::count(1e3, &["order", "peak_lines", "starts"]),
    KeyRange::count(1e9, &["segment", "points", "impacts", "cycles", "turns", "settle", "measure", "steps"]),
    KeyRange::above_zero("", &["stretch"]).within(1.0, 1e9),
    KeyRange::any("", &["integrate"]).within(1.0, 1e3),
];
