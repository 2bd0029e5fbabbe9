//! Impacts of a trace: `[[impacts]]`, `vibro impacts`.

pub mod figures;
pub mod tables;

use super::job::Marks;
use super::{Analysis, Answer, Job, Source, no_file};
use crate::campaign::{Entry, above_zero, channel};
use crate::error::{Error, Result};
use crate::measure::impacts::{ImpactsOptions, Scatter, Shape, impacts, typed};
use crate::read::Reader;
use serde::{Deserialize, Deserializer};
use std::path::PathBuf;

/// How impacts are found, and what is known of them.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Frequency of the excitation in Hz
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", value_parser = Frequency::typed))]
    pub excitation: Option<Frequency>,
    /// Its standard uncertainty in Hz [default: that of the digits typed]
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ"))]
    pub excitation_std: Option<f64>,
    /// Record of the same file that rises once a cycle of the excitation, by name or by number from 1
    #[serde(deserialize_with = "channel")]
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    pub reference: Option<String>,
    /// Lowest impact, as part of the median one [default: 0.125]
    #[cfg_attr(feature = "cli", arg(long, value_name = "PART"))]
    pub threshold: Option<f64>,
    /// Pause in s that parts two impacts [default: found from the trace]
    #[cfg_attr(feature = "cli", arg(long, value_name = "S"))]
    pub refractory: Option<f64>,
    /// Leave mains hum in the trace
    #[cfg_attr(feature = "cli", arg(long))]
    pub keep_hum: bool,
    /// Record of one pulse of the shape that all have: each impact is matched to it
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub shape: Option<PathBuf>,
    /// Sampling rate of that record in Hz, where its file does not say
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", allow_negative_numbers = true))]
    pub shape_rate: Option<f64>,
    /// What is known to scatter: the onsets about even times, the intervals, each on its own, or unknown [default: unknown]
    #[cfg_attr(feature = "cli", arg(long, value_parser = crate::campaign::word::<Scatter>, default_value = "unknown", hide_default_value = true))]
    pub scatter: Scatter,
    /// No impact is missed and none is too many, however uneven the intervals
    #[cfg_attr(feature = "cli", arg(long))]
    pub none_missed: bool,
}

/// A frequency as sure as the digits it is typed with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequency {
    /// Hz.
    pub value: f64,
    /// Its standard uncertainty in Hz; `None` for that of its shortest digits.
    pub std: Option<f64>,
}

impl Frequency {
    /// A frequency as it is typed: zeros at its end are digits.
    ///
    /// # Errors
    /// If it is no number.
    pub fn typed(text: &str) -> std::result::Result<Frequency, String> {
        let number = typed(text).ok_or_else(|| "expected a number".to_owned())?;
        Ok(Frequency { value: number.0, std: Some(number.1) })
    }
}

impl<'de> Deserialize<'de> for Frequency {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Frequency, D::Error> {
        Ok(Frequency { value: f64::deserialize(from)?, std: None })
    }
}

impl Keys {
    /// Whether the keys go together.
    ///
    /// # Errors
    /// With the key that does not.
    pub fn usable(&self) -> Result<()> {
        let wrong = |key, found: &str, expected: &str| Err(Error::usage(found, expected).setting(key));
        if self.reference.is_some() && self.excitation.is_some() {
            return wrong("excitation", "both reference and excitation", "one of them");
        }
        if self.excitation_std.is_some() && self.excitation.is_none() {
            return wrong("excitation_std", "excitation_std without excitation", "both, or none");
        }
        if self.shape_rate.is_some() && self.shape.is_none() {
            return wrong("shape_rate", "shape_rate without shape", "both, or none");
        }
        above_zero("shape_rate", self.shape_rate)
    }

    /// The impacts of a record, with their figure and tables.
    ///
    /// # Errors
    /// If the file cannot be read, or its trace allows no answer.
    pub fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        self.usable()?;
        let recording = source.recording()?;
        let trace = source.trace(&recording)?;
        let reference = match &self.reference {
            Some(channel) => Some(recording.trace(Some(channel), None)?.values),
            None => None,
        };
        let shape = match source.further("shape", self.shape.as_ref())? {
            Some(path) => {
                let pulse = Reader::new().rate(self.shape_rate).from_path(path)?.trace(None, None)?;
                Some(Shape::of(&pulse, &trace)?)
            }
            None => None,
        };
        let default = ImpactsOptions::default();
        let options = ImpactsOptions {
            threshold: self.threshold.unwrap_or(default.threshold),
            refractory: self.refractory,
            excitation: self.excitation.map(|f| f.value),
            excitation_std: self.excitation_std.or(self.excitation.and_then(|f| f.std)),
            hum: !self.keep_hum,
            reference,
            shape,
            scatter: self.scatter,
            complete: self.none_missed,
        };
        let found = impacts(&trace, &options)?;
        let mut answer = Answer::of(&found)?;
        answer.tell("", &found.findings);
        answer.tell("", &recording.findings);
        answer.tell("", &trace.meta.findings);
        answer.tables.push(tables::impacts(source.name, &found));
        answer.figure("impacts", figures::impacts(source.name, &trace, &found));
        answer.csv("impacts", &tables::impact_times(&found));
        Ok(answer)
    }
}

impl Analysis for Keys {
    const SECTION: &'static str = "impacts";

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.file.as_ref().ok_or_else(no_file)?;
        entry.keys.usable()
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("impacts", entries, Marks::Numbers, |entry, source| Ok(vec![entry.keys.measure(source)?]))
    }
}
