//! Values in memory: all of them, or only their extremes where a survey needs no more.

use crate::assemble::{self, NOMINAL, Spectral};
use crate::options::Options;
use vibro_record::code;
use vibro_record::lanes::{Extremes, OPENING};
use vibro_record::{Axis, AxisKind, Error, Finding, Meta, Record, Result, Values, units};

/// Values, or only the extremes of real values that do not all rise and of which none is missing: such values
/// are no abscissa and need no finding.
#[derive(Debug, Clone, PartialEq)]
pub enum Held {
    Values(Values),
    Ends(Extremes),
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
            Held::Ends(ends) => ends.len(),
        }
    }

    pub fn is_complex(&self) -> bool {
        matches!(self, Held::Values(Values::Complex(_)))
    }

    /// The values, if there are several and they rise.
    pub fn rising(&self) -> Option<&[f64]> {
        match self {
            Held::Values(Values::Real(values)) if values.len() > 1 && rises(values) => Some(values),
            _ => None,
        }
    }

    /// All real values; none where they were not kept, or are complex.
    pub fn reals(&self) -> &[f64] {
        match self {
            Held::Values(Values::Real(values)) => values,
            _ => &[],
        }
    }

    /// The first real values, as many as a survey keeps.
    pub fn opening(&self) -> &[f64] {
        match self {
            Held::Ends(ends) => ends.opening(),
            held @ Held::Values(_) => opening(held.reals()),
        }
    }

    /// All values, where they were kept: only these can have missing ones.
    pub fn values_mut(&mut self) -> Option<&mut Values> {
        if let Held::Values(values) = self { Some(values) } else { None }
    }

    /// Multiplies values or extremes by the factor of a unit.
    ///
    /// # Errors
    /// If a value overflows a double.
    pub fn scale(&mut self, factor: f64) -> Result<()> {
        match self {
            Held::Values(values) => assemble::to_si(values, factor),
            Held::Ends(ends) => ends.values_mut().into_iter().try_for_each(|v| units::scale(v, factor)),
        }
    }

    /// The record of these values, see [`assemble::record`].
    ///
    /// # Errors
    /// As [`assemble::record`].
    pub fn record(self, meta: Meta, axis: Axis, said: Spectral) -> Result<(Record, Option<Extremes>)> {
        let (values, ends) = match self {
            Held::Values(values) => (values, None),
            Held::Ends(ends) => (Values::Real(Vec::new()), Some(ends)),
        };
        Ok((assemble::record(meta, axis, values, said)?, ends))
    }
}

/// The first of these values, as many as a survey keeps.
pub fn opening(values: &[f64]) -> &[f64] {
    &values[..values.len().min(OPENING)]
}

/// Whether each value lies above the one before it.
pub fn rises(values: &[f64]) -> bool {
    values.is_sorted_by(|a, b| a < b)
}

/// Findings on gaps between samples: dropped once a single stretch is kept.
const GAPS: [&str; 2] = [code::SAMPLES_LOST, code::AXIS_BACKWARDS];

/// Records of a file, with the extremes of those whose values were not kept, and findings on the file.
#[derive(Debug, Default)]
pub struct Contents {
    pub records: Vec<(Record, Option<Extremes>)>,
    pub findings: Vec<Finding>,
}

impl Contents {
    /// Contents of a file with all values kept.
    pub fn of(records: impl IntoIterator<Item = Record>, findings: Vec<Finding>) -> Contents {
        Contents { records: records.into_iter().map(|record| (record, None)).collect(), findings }
    }

    /// Makes traces even as the user states: keeps one stretch of each, or resamples them.
    ///
    /// # Errors
    /// If there is no such stretch, or a trace cannot be interpolated.
    pub fn evened(mut self, options: &Options) -> Result<Contents> {
        let mut left_out: Vec<(usize, Error)> = Vec::new();
        for (number, (record, ends)) in self.records.iter_mut().enumerate() {
            let Record::Trace(trace) = record else { continue };
            if ends.is_some() {
                continue;
            }
            options.stretch.map_or(Ok(()), |number| trace.keep_stretch(number))?;
            let steps = trace.axis.len().saturating_sub(1);
            let duration = || trace.axis.at(steps) - trace.axis.start();
            let made = options.stretch.is_some() || options.resample.is_some();
            let own = trace.rate().or_else(|| (steps > 0).then(|| steps as f64 / duration()));
            let own = own.zip(options.rate).filter(|_| made && trace.axis.kind == AxisKind::Time);
            if let Some((own, stated)) = own.filter(|(own, stated)| (own / stated - 1.0).abs() > NOMINAL) {
                let found =
                    format!("a sampling rate of {stated} Hz was stated, and the samples come at {own:.6} Hz");
                return Err(Error::usage(found, "").hint("leave the rate out").setting("rate"));
            }
            if let Some(rate) = options.resample {
                options.hold(duration() * rate)?;
                if let Err(error) = trace.resample(rate) {
                    left_out.push((number, error));
                }
            }
        }
        // The stretch that is kept has no gaps.
        let kept = |found: &Finding| options.stretch.is_none() || !GAPS.contains(&&*found.code);
        self.findings.retain(kept);
        self.records.iter_mut().for_each(|(record, _)| record.meta_mut().findings.retain(kept));
        // A channel that cannot be resampled is only reported, unless the user asked for it or no channel can
        // be.
        let all = left_out.len() == self.records.len();
        for (number, error) in left_out {
            let meta = self.records[number].0.meta_mut();
            if all || options.only.iter().any(|only| *only == meta.name || only.parse() == Ok(number + 1)) {
                return Err(error);
            }
            meta.found(Finding::caution("not-resampled").name("why", error.why()));
        }
        Ok(self)
    }
}
