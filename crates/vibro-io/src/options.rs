//! What the user states about a file.

use crate::limit::Limit;
use std::path::Path;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Meta, Result, find_channel};

/// Accepted range in Hz of rates, bands and line widths. All instruments lie far inside it, and every step
/// computed from it is finite and positive.
pub const POSSIBLE: std::ops::RangeInclusive<f64> = 1e-12..=1e15;

/// Bytes of a value in memory.
const VALUE: f64 = 8.0;

/// What the user states about a file. A statement that contradicts the file is used, and a finding in the
/// record reports that.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Keep NaN, Inf, over-range and blank values as missing (NaN) instead of refusing them.
    pub allow_missing: bool,
    /// Sampling rate in Hz: the values are a time trace.
    pub rate: Option<f64>,
    /// The base band in Hz from which `rate` was computed, if any.
    pub rate_of_band: Option<f64>,
    /// Base band in Hz: the values are a spectrum from 0 to it.
    pub base_band: Option<f64>,
    /// Unit of the values.
    pub unit: Option<Unit>,
    /// Units of single channels, each by its name or by its number from 1; they take precedence.
    pub channel_units: Vec<(String, Unit)>,
    /// Unit of the times or frequencies of a text's column that names none.
    pub axis_unit: Option<String>,
    /// Whether a comma is the decimal mark; `None`: detected.
    pub decimal_comma: Option<bool>,
    /// Whether two value columns are the real and the imaginary part.
    pub complex: bool,
    /// Whether each row continues the row above as one series of values; `None`: detected.
    pub wrapped: Option<bool>,
    /// Part of the time traces that is read, in s: from the first time (included) to the second (excluded).
    pub span: Option<(f64, f64)>,
    /// Which of the stretches between lost samples is kept, counted from 1.
    pub stretch: Option<usize>,
    /// Rate in Hz to which traces are resampled by interpolation.
    pub resample: Option<f64>,
    /// Limit of the memory for values and results.
    pub limit: Limit,
    /// Memory for results computed from the values, as a multiple of the values' own size.
    pub beside: f64,
    /// Channels whose values are needed, by name or by number from 1; empty: all.
    pub only: Vec<String>,
}

impl Options {
    /// Whether the unit of any channel is stated.
    pub(crate) fn states_units(&self) -> bool {
        self.unit.is_some() || !self.channel_units.is_empty()
    }

    /// Index and unit of each of these channels whose own unit is stated.
    ///
    /// # Errors
    /// If there is no such channel, or two units are stated for one.
    pub(crate) fn stated_units<'a>(
        &self,
        path: &Path,
        all: impl Iterator<Item = &'a Meta>,
    ) -> Result<Vec<(usize, &Unit)>> {
        let all: Vec<(&str, &str)> = all.map(Meta::called).collect();
        let mut found: Vec<(usize, &Unit)> = Vec::new();
        for (name, unit) in &self.channel_units {
            let of = find_channel(path, name, all.iter().copied()).map_err(|e| e.setting("unit"))?;
            if let Some((_, other)) = found.iter().find(|(channel, _)| *channel == of) {
                let two = format!("two units of channel {name:?}, {other} and {unit}");
                return Err(Error::usage(two, "one").hint("leave one out").setting("unit"));
            }
            found.push((of, unit));
        }
        Ok(found)
    }

    /// Checks that this many values fit into memory, with the results computed from them.
    ///
    /// # Errors
    /// As [`Limit::hold`].
    pub(crate) fn hold(&self, values: f64) -> Result<()> {
        self.limit.hold(VALUE * values * (1.0 + self.beside))
    }

    /// As [`Options::hold`], for this many channels over `time`; the error suggests a span that fits.
    ///
    /// # Errors
    /// As [`Limit::hold`].
    pub(crate) fn hold_traces(&self, channels: usize, time: &Axis) -> Result<()> {
        let sample = VALUE * channels as f64 * (1.0 + self.beside);
        self.limit.hold_or(sample * time.len() as f64, |error| {
            let seconds = (self.limit.0 / sample).floor() * time.step().unwrap_or(1.0);
            let (start, decimals) = (time.start(), 10f64.powf(1.0 - seconds.log10().floor()));
            error.set("span", format!("[{start}, {}]", start + (seconds * decimals).floor() / decimals))
        })
    }
}

/// Indices of the named channels; of all channels where none is named.
pub fn named<'a>(
    path: &Path,
    named: &[impl AsRef<str>],
    all: impl Iterator<Item = &'a Meta> + Clone,
) -> Result<Vec<usize>> {
    if named.is_empty() {
        return Ok((0..all.count()).collect());
    }
    named.iter().map(|name| find_channel(path, name.as_ref(), all.clone().map(Meta::called))).collect()
}
