//! Values of a channel in memory: all of them, or in a survey only a summary (extremes and first values).

use crate::assemble::{self, NOMINAL, Spectral};
use crate::options::Options;
use std::path::Path;
use vibro_record::code;
use vibro_record::lanes::{Extremes, FIRST_VALUES};
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Record, Result, Values, units};

/// A channel's values, or, in a survey, only their summary. Three kinds are always kept in full: complex
/// values, rising values (they may be an abscissa), and values with gaps (they need a finding).
#[derive(Debug, Clone, PartialEq)]
pub enum Held {
    Values(Values),
    Summary(Extremes),
}

impl From<Values> for Held {
    fn from(values: Values) -> Held {
        Held::Values(values)
    }
}

impl Held {
    pub fn len(&self) -> usize {
        match self {
            Held::Values(values) => values.len(),
            Held::Summary(summary) => summary.len(),
        }
    }

    pub fn is_complex(&self) -> bool {
        matches!(self, Held::Values(Values::Complex(_)))
    }

    /// The values, if there are at least two and each lies above the one before it.
    pub fn rising(&self) -> Option<&[f64]> {
        match self {
            Held::Values(Values::Real(values)) if values.len() > 1 && rises(values) => Some(values),
            _ => None,
        }
    }

    /// All real values; empty for a summary and for complex values.
    pub fn reals(&self) -> &[f64] {
        match self {
            Held::Values(Values::Real(values)) => values,
            _ => &[],
        }
    }

    /// The first real values, at most [`FIRST_VALUES`]: a summary keeps these, too, so a survey reports the
    /// same relations between channels as a full reading.
    pub fn first_values(&self) -> &[f64] {
        match self {
            Held::Summary(summary) => summary.first_values(),
            all @ Held::Values(_) => first_values(all.reals()),
        }
    }

    /// The values, if kept in full. A summary has no missing values, so nothing needs repair there.
    pub fn values_mut(&mut self) -> Option<&mut Values> {
        if let Held::Values(values) = self { Some(values) } else { None }
    }

    /// Multiplies values or summary by the factor of a unit to SI.
    ///
    /// # Errors
    /// If a value overflows a double.
    pub fn scale(&mut self, factor: f64) -> Result<()> {
        match self {
            Held::Values(values) => assemble::to_si(values, factor),
            Held::Summary(summary) => {
                summary.values_mut().into_iter().try_for_each(|v| units::scale(v, factor))
            }
        }
    }

    /// Builds the record of these values by [`assemble::record`]. For a summary the record has no values; the
    /// summary is returned beside it.
    ///
    /// # Errors
    /// As [`assemble::record`].
    pub fn record(self, meta: Meta, axis: Axis, said: Spectral) -> Result<(Record, Option<Extremes>)> {
        let (values, summary) = match self {
            Held::Values(values) => (values, None),
            Held::Summary(summary) => (Values::Real(Vec::new()), Some(summary)),
        };
        Ok((assemble::record(meta, axis, values, said)?, summary))
    }
}

/// The first of these values, at most [`FIRST_VALUES`].
pub fn first_values(values: &[f64]) -> &[f64] {
    &values[..values.len().min(FIRST_VALUES)]
}

/// Whether each value lies above the one before it.
pub fn rises(values: &[f64]) -> bool {
    values.is_sorted_by(|a, b| a < b)
}

/// Findings on gaps between samples. They no longer hold once a single stretch is kept.
const GAP_FINDINGS: [&str; 2] = [code::SAMPLES_LOST, code::AXIS_BACKWARDS];

/// Multiplies the values of a record.
///
/// # Errors
/// If a value overflows a double.
pub fn scale(record: &mut Record, factor: f64) -> Result<()> {
    match record {
        Record::Trace(trace) => units::scale(&mut trace.values, factor),
        Record::Spectrum(spectrum) => assemble::to_si(&mut spectrum.values, factor),
        Record::Frf(frf) => units::scale(frf.values.iter_mut().flat_map(|v| [&mut v.re, &mut v.im]), factor),
    }
}

/// Records of a file, each with its summary if its values were not kept in full, and findings on the file.
#[derive(Debug, Default)]
pub struct Contents {
    pub records: Vec<(Record, Option<Extremes>)>,
    pub findings: Vec<Finding>,
}

impl Contents {
    /// Contents of a file whose values are all kept in full.
    pub fn of(records: impl IntoIterator<Item = Record>, findings: Vec<Finding>) -> Contents {
        Contents { records: records.into_iter().map(|record| (record, None)).collect(), findings }
    }

    /// Gives channels the units that are stated for them by name or number.
    ///
    /// # Errors
    /// As [`Options::stated_units`]; if a value overflows a double.
    pub fn with_stated_units(mut self, path: &Path, options: &Options) -> Result<Contents> {
        let stated = options.stated_units(path, self.records.iter().map(|(record, _)| record.meta()))?;
        if !stated.is_empty() && stated.len() == self.records.len() {
            self.findings.retain(|found| !["format-without-units", "unit-for-all"].contains(&&*found.code));
        }
        for (channel, unit) in stated {
            let (record, summary) = &mut self.records[channel];
            let factor = record.meta_mut().restate_unit(unit, options.unit.is_none());
            scale(record, factor)?;
            for values in summary.iter_mut().flat_map(Extremes::values_mut) {
                units::scale(values, factor)?;
            }
        }
        Ok(self)
    }

    /// Gives traces an even axis as the options state:
    /// - keeps one even stretch of each trace, and drops the findings on gaps between stretches;
    /// - resamples each trace;
    /// - after either, refuses a stated sampling rate that differs from that of the samples;
    /// - adds a caution to a trace that cannot be resampled.
    ///
    /// # Errors
    /// If there is no such stretch, if a stated rate differs, or if a trace cannot be resampled that the user
    /// chose by name or number, or no record can.
    pub fn with_even_axes(mut self, options: &Options) -> Result<Contents> {
        let mut not_resampled: Vec<(usize, Error)> = Vec::new();
        for (number, (record, summary)) in self.records.iter_mut().enumerate() {
            let Record::Trace(trace) = record else { continue };
            if summary.is_some() {
                continue;
            }
            options.stretch.map_or(Ok(()), |number| trace.keep_stretch(number))?;
            let steps = trace.axis.len().saturating_sub(1);
            let duration = || trace.axis.at(steps) - trace.axis.start();
            let was_changed = options.stretch.is_some() || options.resample.is_some();
            let measured_rate = trace.rate().or_else(|| (steps > 0).then(|| steps as f64 / duration()));
            let rates = measured_rate.zip(options.rate);
            let rates = rates.filter(|_| was_changed && trace.axis.kind == AxisKind::Time);
            let differ = |(measured, stated): &(f64, f64)| (measured / stated - 1.0).abs() > NOMINAL;
            if let Some((measured, stated)) = rates.filter(differ) {
                let found = format!(
                    "a sampling rate of {stated} Hz was stated, and the samples come at {measured:.6} Hz"
                );
                return Err(Error::usage(found, "").hint("leave the rate out").setting("rate"));
            }
            if let Some(rate) = options.resample {
                options.hold(duration() * rate)?;
                if let Err(error) = trace.resample(rate) {
                    not_resampled.push((number, error));
                }
            }
        }
        // A single stretch has no gaps.
        let still_holds =
            |found: &Finding| options.stretch.is_none() || !GAP_FINDINGS.contains(&&*found.code);
        self.findings.retain(still_holds);
        self.records.iter_mut().for_each(|(record, _)| record.meta_mut().findings.retain(still_holds));
        let none_resampled = not_resampled.len() == self.records.len();
        for (number, error) in not_resampled {
            let meta = self.records[number].0.meta_mut();
            if none_resampled
                || options.only.iter().any(|only| *only == meta.name || only.parse() == Ok(number + 1))
            {
                return Err(error);
            }
            meta.found(Finding::caution("not-resampled").name("why", error.why()));
        }
        Ok(self)
    }
}
