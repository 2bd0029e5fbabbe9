//! Ranges of numbers, in one table for the options of the command line and the keys of a campaign. The model
//! checks the values of a rig, of its excitation and of the settings of a model:
//! [`crate::model::Parameter`].

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

/// Lower bound of a number, and the expectation named in the error if the number is below it or not finite.
type Sign = (f64, &'static str);
const ABOVE: Sign = (f64::MIN_POSITIVE, "a finite number above 0");
const ZERO: Sign = (0.0, "a finite number of 0 or more");
const ANY: Sign = (f64::NEG_INFINITY, "a finite number");

/// Range of some keys: lower bound, largest magnitude, smallest magnitude that is not 0, unit, and the keys.
type Row = (Sign, f64, f64, &'static str, &'static [&'static str]);

/// Ranges of all keys and options.
const ROWS: &[Row] = &[
    (ABOVE, LARGEST, LEAST, "Hz", &["rate", "base_band", "shape_rate", "excitation", "instrument"]),
    (ABOVE, LARGEST, LEAST, "Hz", &["low_pass", "high_pass", "fmin", "fmax", "resample"]),
    (ZERO, LARGEST, LEAST, "Hz", &["band"]),
    (ABOVE, LARGEST, LEAST, "Hz/s", &["sweep_rate"]),
    (ABOVE, LONGEST, SHORTEST, "s", &["smoothing", "interval", "intervals", "force_window"]),
    (ABOVE, LONGEST, SHORTEST, "s", &["time_to_peak", "duration"]),
    (ZERO, LONGEST, SHORTEST, "s", &["refractory", "interval_std", "contact_time", "longest_dropout", "std"]),
    (ANY, LONGEST, SHORTEST, "s", &["delay"]),
    // Times since 1970, even if written in ns.
    (ANY, 4e18, SHORTEST, "s", &["span"]),
    // The analysis of a drill checks these against the duration of a turn.
    (ABOVE, f64::MAX, SHORTEST, "s", &["contact", "fit_duration"]),
    (ABOVE, LARGEST, LEAST, "kg", &["mass", "struck_mass", "masses"]),
    (ABOVE, LARGEST, LEAST, "", &["height", "gravity", "grazing", "decibel", "force_calibration"]),
    (ZERO, LARGEST, LEAST, "", &["height_std", "gravity_std", "velocity_std"]),
    (ANY, LARGEST, LEAST, "", &["calibration", "sensitivity", "handle_sensitivity", "level"]),
    (ANY, LARGEST, LEAST, "", &["before", "after", "after2", "initial", "phase"]),
    (ANY, 360.0, LEAST, "°", &["beam_angle"]),
    (ANY, 1e3, LEAST, "dB", &["margin"]),
    (ZERO, 24.0, LEAST, "h", &["exposure"]),
    (ABOVE, 1e3, 1e-9, "", &["threshold"]),
    (ZERO, 1.0, 1e-9, "", &["overlap", "least_coherence", "left_at_end", "scatter"]),
    (ZERO, 1e3, 1.0, "", &["modes", "tones", "order", "peak_lines", "starts", "analyser_integrated"]),
    (ZERO, 1e9, 1.0, "", &["segment", "points", "pulses_per_turn", "impacts", "cycles"]),
    (ZERO, 1e9, 1.0, "", &["settle", "measure", "steps", "lines"]),
    (ABOVE, 1e9, 1.0, "", &["stretch"]),
    (ANY, 1e3, 1.0, "", &["integrate"]),
];

/// Checks the value of an option or a key. A key without a row here passes; its own table checks it.
///
/// # Errors
/// With the key and its range, if the value lies outside.
pub fn in_range(key: &str, value: f64) -> Result<()> {
    let row = ROWS.iter().find_map(|row| Some((row, row.4.iter().find(|known| **known == key)?)));
    let Some((((low, sign), most, least, unit, _), key)) = row else { return Ok(()) };
    if value >= *low && (value == 0.0 || (*least..=*most).contains(&value.abs())) {
        return Ok(());
    }
    let of_sign = value >= *low && value.is_finite();
    let expected = if of_sign { format!("{least:e} to {most:e} {unit}") } else { (*sign).to_owned() };
    Err(Error::usage(format!("{key} is {value:?}"), expected.trim_end()).setting(key))
}

/// Checks every number of a key's value in a campaign.
///
/// # Errors
/// As [`in_range`].
pub(super) fn all_in_range(key: &str, value: &DeValue<'_>) -> Result<()> {
    match value {
        DeValue::Float(number) => number.as_str().parse().map_or(Ok(()), |number| in_range(key, number)),
        DeValue::Integer(number) => number.as_str().parse().map_or(Ok(()), |number| in_range(key, number)),
        DeValue::Array(all) => all.iter().try_for_each(|one| all_in_range(key, one.get_ref())),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_stands_once_and_lets_in_no_value_that_is_no_number() {
        let keys: Vec<&str> = ROWS.iter().flat_map(|row| row.4).copied().collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key} stands twice");
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300, -1e300] {
                let said = in_range(key, value).unwrap_err().to_string();
                assert!(said.starts_with(&format!("{key} is ")) && said.contains("expected "), "{said}");
            }
        }
        assert!(in_range("band", 0.0).is_ok() && in_range("delay", -1e-3).is_ok());
        assert!(
            in_range("band", 1e51).is_err()
                && in_range("mass", 0.0).is_err()
                && in_range("overlap", 1.5).is_err()
        );
    }
}
