//! What a person states of a file.

use crate::limit::Limit;
use std::path::Path;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Result, find_channel};

/// Rates, bands and line widths in Hz of any instrument lie far inside; steps made of them are finite and
/// positive.
pub const POSSIBLE: std::ops::RangeInclusive<f64> = 1e-12..=1e15;

/// Bytes of a value in memory.
const VALUE: f64 = 8.0;

/// What a person knows of a file that the file does not say. A statement here that contradicts the file wins,
/// with a finding in the record.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Keep NaN, Inf, over-range and blank values as missing (NaN) instead of refusing them.
    pub allow_missing: bool,
    /// Sampling rate in Hz: the values are a time trace.
    pub rate: Option<f64>,
    /// Whether that rate follows from a base band.
    pub rate_of_band: bool,
    /// Base band in Hz: the values are a spectrum from 0 to it.
    pub base_band: Option<f64>,
    /// Unit of the values.
    pub unit: Option<Unit>,
    /// Whether a comma is the decimal mark; `None` to find out.
    pub decimal_comma: Option<bool>,
    /// Two value columns are real and imaginary part.
    pub complex: bool,
    /// Whether rows continue each other as one series; `None` to find out.
    pub wrapped: Option<bool>,
    /// Part of the time traces in s, from its first value on and before its second.
    pub span: Option<(f64, f64)>,
    /// Which stretch between lost samples is used, from 1.
    pub stretch: Option<usize>,
    /// Rate in Hz at which samples of uneven times are interpolated.
    pub resample: Option<f64>,
    /// Memory that may be filled.
    pub limit: Limit,
    /// What is held beside the values by what is made of them, in their size.
    pub beside: f64,
    /// Channels whose values are asked for; all where none is named.
    pub only: Vec<String>,
}

impl Options {
    /// Whether so many values may be held, with what is made of them.
    ///
    /// # Errors
    /// As [`Limit::hold`].
    pub(crate) fn hold(&self, values: f64) -> Result<()> {
        self.limit.hold(VALUE * values * (1.0 + self.beside))
    }

    /// As [`Options::hold`], of so many channels over `time`: a part of them fits.
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

/// Indices of the channels named; of all where none is.
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
