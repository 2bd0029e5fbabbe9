//! Settings for reading a file, where the file does not state them: keys of a campaign and options of the
//! command line.

use super::value::{channel, one_or_list, one_or_more};
use crate::error::{Error, Result};
use crate::read::{Format, Reader};
use crate::units::Unit;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How a measurement file is to be read, where it does not say itself.
#[derive(Debug, Clone, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
#[cfg_attr(feature = "cli", derive(clap::Args), command(next_help_heading = "Reading of files"))]
pub struct Reading {
    /// File format, instead of detecting it
    pub format: Option<String>,
    /// Keep NaN, Inf and blank values as missing, instead of refusing them
    pub allow_missing: bool,
    /// Sampling rate in Hz: the values are a time trace
    #[cfg_attr(feature = "cli", arg(conflicts_with = "base_band"))]
    pub rate: Option<f64>,
    /// Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56 times it
    pub base_band: Option<f64>,
    /// Unit of the values, such as mm/s; of one channel NAME=UNIT
    #[serde(deserialize_with = "one_or_more", serialize_with = "one_or_list")]
    pub unit: Vec<String>,
    /// Unit of times or frequencies whose column names none, such as ms
    pub axis_unit: Option<String>,
    /// Decimal mark, where the file leaves it open: comma or point
    #[cfg_attr(feature = "cli", arg(value_name = "MARK", value_parser = crate::campaign::word::<Decimal>))]
    pub decimal: Option<Decimal>,
    /// Two columns of values are real and imaginary part
    pub complex: bool,
    /// Rows of several columns continue each other as one series
    #[cfg_attr(feature = "cli", arg(conflicts_with = "columns"))]
    pub wrapped: bool,
    /// Each column is a channel, however much the rows look like one series
    pub columns: bool,
    /// Only this part of a time trace, from and to in s; 600: is to its end
    #[cfg_attr(feature = "cli", arg(value_name = "FROM:TO", allow_hyphen_values = true, value_parser = crate::record::kind::part))]
    pub span: Option<(f64, f64)>,
    /// Stretch between lost samples that is used, by its number from 1
    #[cfg_attr(feature = "cli", arg(value_name = "N"))]
    pub stretch: Option<usize>,
    /// Rate in Hz at which samples of uneven times are interpolated
    pub resample: Option<f64>,
}

/// Name or number of a channel, and its unit.
type ChannelUnit = (String, Unit);

/// Which record of a file is meant, and its calibration.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args), command(next_help_heading = "Channel"))]
pub struct Channel {
    /// Record of the file, by name or by number from 1 [default: the only one]
    #[serde(deserialize_with = "channel")]
    pub channel: Option<String>,
    /// Factor on the stored values; with a unit, to that unit
    pub calibration: Option<f64>,
}

/// Decimal mark of a text file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Decimal {
    /// 1,5
    Comma,
    /// 1.5
    Point,
}

/// Checks a setting that must be a finite number above 0.
///
/// # Errors
/// If it is not finite, or not above 0.
pub fn above_zero(key: &'static str, value: Option<f64>) -> Result<()> {
    match value {
        Some(v) if !(v.is_finite() && v > 0.0) => {
            Err(Error::usage(format!("{key} is {v}"), "a finite number above 0").setting(key))
        }
        _ => Ok(()),
    }
}

impl Reading {
    /// Names of its keys.
    pub const KEYS: [&str; 13] = [
        "format",
        "allow_missing",
        "rate",
        "base_band",
        "unit",
        "axis_unit",
        "decimal",
        "complex",
        "wrapped",
        "columns",
        "span",
        "stretch",
        "resample",
    ];

    /// Keys that are stated, with their values.
    pub fn stated(&self) -> Vec<(&'static str, Value)> {
        let Ok(Value::Object(mut all)) = serde_json::to_value(self) else { return Vec::new() };
        let unset =
            |v: &Value| v.is_null() || *v == Value::Bool(false) || v.as_array().is_some_and(Vec::is_empty);
        let stated = |key| Some((key, all.remove(key).filter(|v| !unset(v))?));
        Reading::KEYS.into_iter().filter_map(stated).collect()
    }

    /// These settings without those of the axis, for files that state their sampling rate or frequencies.
    pub fn untimed(&self) -> Reading {
        Reading { rate: None, base_band: None, span: None, stretch: None, resample: None, ..self.clone() }
    }

    /// The unit for all values, and those of single channels, each with the channel's name or number.
    fn units(&self) -> Result<(Option<Unit>, Vec<ChannelUnit>)> {
        let parsed = |text: &str| {
            let expected = "a unit such as m, mm/s, g, m/s², V, (m/s²)/N, dB re 1 g";
            let unknown =
                || Error::usage(format!("the unit {text:?} is not known"), expected).setting("unit");
            Unit::parse_or_level(text).ok_or_else(unknown)
        };
        let (mut of_channels, mut of_all) = (Vec::new(), None);
        for text in &self.unit {
            if let Some((channel, unit)) = text.rsplit_once('=') {
                of_channels.push((channel.to_owned(), parsed(unit)?));
            } else if let Some(other) = of_all.replace(parsed(text)?) {
                let found = format!("two units for all channels, {other} and {text}");
                return Err(Error::usage(found, "one, or one a channel").hint("NAME=UNIT").setting("unit"));
            }
        }
        Ok((of_all, of_channels))
    }

    /// The unit of a file of one channel.
    ///
    /// # Errors
    /// If the unit of a channel is stated by its name, or several units are.
    #[cfg(feature = "cli")]
    pub fn only_unit(&self) -> Result<Option<String>> {
        match self.unit.as_slice() {
            [] => Ok(None),
            [unit] if !unit.contains('=') => Ok(Some(unit.clone())),
            all => Err(Error::usage(format!("the unit {}", all.join(", ")), "one unit for all values")
                .setting("unit")),
        }
    }

    /// A reader with these settings.
    ///
    /// # Errors
    /// On an unknown format or unit.
    pub fn reader(&self) -> Result<Reader> {
        let unknown = |key: &'static str, name: &str, expected: &str| {
            Error::usage(format!("the {key} {name:?} is not known"), expected).setting(key)
        };
        let format = |name: &String| {
            Format::from_name(name).ok_or_else(|| unknown("format", name, &Format::names().join(", ")))
        };
        let (of_all, of_channels) = self.units()?;
        Ok(Reader::new()
            .format(self.format.as_ref().map(format).transpose()?)
            .allow_missing(self.allow_missing)
            .rate(self.rate)
            .base_band(self.base_band)
            .unit(of_all)
            .channel_units(of_channels)
            .axis_unit(self.axis_unit.as_deref())?
            .decimal_comma(self.decimal.map(|d| d == Decimal::Comma))
            .complex(self.complex)
            .span(self.span)
            .stretch(self.stretch)
            .resample(self.resample)
            .wrapped((self.wrapped || self.columns).then_some(self.wrapped)))
    }
}

impl Channel {
    /// Names of its keys.
    pub const KEYS: [&str; 2] = ["channel", "calibration"];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Written;

    #[test]
    fn the_keys_are_those_that_can_be_read() {
        let stated = |text| Written { text, ..Written::default() };
        let of = |error: Error| {
            error.advice().split_once(": ").unwrap().1.split(", ").map(str::to_owned).collect()
        };
        let keys = |found: Result<()>| -> Vec<String> { of(found.unwrap_err()) };
        let text = stated("x = 1");
        let table = || text.parse().unwrap();
        assert_eq!(keys(text.read::<Reading>(&table(), 0..0).map(drop)), Reading::KEYS);
        assert_eq!(keys(text.read::<Channel>(&table(), 0..0).map(drop)), Channel::KEYS);
    }
}
