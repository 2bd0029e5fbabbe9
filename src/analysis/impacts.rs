//! Impacts of a trace: `[[impacts]]`, `vibro impacts`.

pub mod figures;

use super::answer::Answer;
use super::headline::headline;
use super::job::Job;
use super::kind::{Analysis, no_file};
use super::source::Source;
use crate::campaign::{Entry, KeyRange, channel};
use crate::error::{Error, Result};
use crate::measure::impacts::{Impacts, ImpactsOptions, REGULAR, impacts};
use crate::read::Reader;
use crate::record::{doubt_with_record, median};
use crate::report::files::Names;
use crate::report::layout::{pair, table};
use crate::report::{Cell, Table};
use crate::units::notation::quantity;
use serde::Deserialize;
use std::path::PathBuf;

/// Memory for the search beside the trace, as a multiple of it. With ten million samples, trace and search
/// together took 3.6 times the trace.
const SEARCH_MEMORY: f64 = 3.0;

/// How impacts are found, and what is known of them.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Frequency of the excitation in Hz
    pub excitation: Option<f64>,
    /// Trigger channel of the same file, one rising edge per excitation cycle, by name or by number from 1
    #[serde(deserialize_with = "channel")]
    pub reference: Option<String>,
    /// Smallest impact counted, as a fraction of the median height [default: 0.125]
    pub threshold: Option<f64>,
    /// Shortest time between two impacts in s: ringing within it counts once [default: found from the trace]
    pub refractory: Option<f64>,
    /// Band in Hz in which the impacts ring: the trace is filtered to it first, without delay
    #[cfg_attr(feature = "cli", arg(value_name = "LO:HI", value_parser = crate::campaign::two::<':'>))]
    pub band: Option<(f64, f64)>,
    /// Detect impacts in the envelope, so that ringing does not split one impact
    pub envelope: bool,
    /// Do not remove mains hum
    pub keep_hum: bool,
    /// Record of one pulse: each impact is matched to its shape
    pub shape: Option<PathBuf>,
    /// Sampling rate of that record in Hz, where its file does not state it
    #[cfg_attr(feature = "cli", arg(requires = "shape"))]
    pub shape_rate: Option<f64>,
    /// No impact is missed or double, however uneven the intervals are
    pub none_missed: bool,
}

impl Keys {
    /// Checks that the keys go together.
    ///
    /// # Errors
    /// The key that does not.
    pub fn usable(&self) -> Result<()> {
        let wrong = |key, found: &str, expected: &str| Err(Error::usage(found, expected).setting(key));
        if self.reference.is_some() && self.excitation.is_some() {
            return wrong("excitation", "both reference and excitation", "one of them");
        }
        Ok(())
    }

    /// The impacts of a record, with their figure and tables.
    ///
    /// # Errors
    /// If the file cannot be read, or its trace allows no answer.
    pub fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        self.usable()?;
        let mut recording = source.channels(self.reference.as_ref(), SEARCH_MEMORY)?;
        let reference = self.reference.as_ref().map(|channel| recording.trace(Some(channel), None));
        let reference = reference.transpose()?;
        let trace = recording.take_trace(source.channel.channel.as_deref(), source.channel.calibration)?;
        let shape = source.further("shape", self.shape.as_ref())?;
        let shape = shape.map(|path| {
            Reader::new().within(source.folder).rate(self.shape_rate).from_path(path)?.trace(None, None)
        });

        let options = ImpactsOptions {
            threshold: self.threshold,
            refractory: self.refractory,
            excitation: self.excitation,
            band: self.band,
            envelope: self.envelope,
            keep_hum: self.keep_hum,
            reference: reference.map(|r| r.values),
            shape: shape.transpose()?,
            complete: self.none_missed,
        };
        let mut found = impacts(&trace, &options)?;
        doubt_with_record(recording.findings.iter().chain(&trace.meta.findings), &mut found);
        let mut answer = Answer::of(&found)?;
        answer.add("", &found.findings);
        answer.add("", &recording.findings);
        answer.add("", &trace.meta.findings);
        answer.evidence.push((&found).into());
        answer.headlines.push(headline(
            "Impacts",
            [&found],
            &[
                ("impacts", "", &|f| f.n.into()),
                ("frequency", "Hz", &|f| Cell::from(&f.frequency)),
                ("impacts/cycles", "", &|f| per_cycle(f)),
            ],
        ));
        answer.tables.push(summary(source.name, &found));
        answer.figure("impacts", figures::impacts(source.name, &trace, &found));
        answer.csv("impacts", &times(&found));
        Ok(answer)
    }
}

/// Number and rhythm of the impacts of a trace, in one row.
fn summary(name: &str, found: &Impacts) -> Table {
    let needs = found.excitation.map_or("Impacts/cycles needs the excitation frequency. ", |_| "");
    table(
        "Impacts",
        [found],
        &[
            ("trace", "", &|_| name.into()),
            ("impacts", "", &|f| f.n.into()),
            ("interval", "s", &|f| Cell::from(&f.interval)),
            ("frequency", "Hz", &|f| Cell::from(&f.frequency)),
            ("median interval", "s", &|f| pair(f.median_interval, None)),
            ("interval spread", "s", &|f| f.spread.map(|s| pair(s, None)).into()),
            ("missed", "", &|f| f.missed.into()),
            ("double", "", &|f| f.doubled.into()),
            ("impacts/cycles", "", &|f| per_cycle(f)),
            ("rhythm", "", &|f| rhythm(f).into()),
        ],
    )
    .note(
        needs.to_owned()
            + "Missed: intervals of several periods. Double: a second impact within half an interval.",
    )
}

/// Impacts per excitation cycles, such as `2/1`.
fn per_cycle(found: &Impacts) -> Cell {
    found.per_cycle.map(|p| format!("{}/{}", p.impacts, p.cycles)).into()
}

/// How the impacts repeat, in words.
fn rhythm(found: &Impacts) -> String {
    // Length of the pattern of unequal intervals, if no impact is missed or double.
    let pattern = found.pattern.filter(|_| found.missed + found.doubled == 0);
    let even = found.pattern.is_some() || found.spread.is_some_and(|s| s < REGULAR * found.median_interval);
    match (found.regular, pattern) {
        (true, Some(length)) => {
            let steps: Vec<f64> = found.times.windows(2).map(|w| w[1] - w[0]).collect();
            let median_step = |place| median(steps.iter().skip(place).step_by(length));
            let intervals: Vec<String> =
                (0..length).map(|place| quantity(median_step(place), "s", 3)).collect();
            format!("regular, intervals in turn {}", intervals.join(", "))
        }
        (true, None) => "regular".to_owned(),
        _ if found.n == 2 => "unknown (2 impacts)".to_owned(),
        _ if found.beat.is_some() => "drifts against the excitation".to_owned(),
        _ if even => "regular, not with the excitation".to_owned(),
        _ => "irregular".to_owned(),
    }
}

/// Every impact: time, height, phase.
fn times(found: &Impacts) -> Table {
    let phase = |i: usize| found.phase.get(i).copied();
    table(
        "Times of impacts",
        found.times.iter().zip(&found.heights).enumerate(),
        &[
            ("time", "s", &|(_, (time, _))| pair(**time, found.onset_std)),
            ("height", "", &|(_, (_, height))| (**height).into()),
            ("phase", "", &|(i, _)| phase(*i).into()),
        ],
    )
}

impl Analysis for Keys {
    const SECTION: &'static str = "impacts";
    const TITLE: &'static str = "Impacts";
    const FILES: Names = Names::Numbered(&["impacts"]);
    const RANGES: &'static [KeyRange] = &[KeyRange::above_zero("Hz", &["shape_rate"])];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.file.as_ref().ok_or_else(no_file)?;
        entry.keys.usable()
    }

    fn channels(&self) -> Vec<(&'static str, &String)> {
        self.reference.iter().map(|name| ("reference", name)).collect()
    }

    fn beside(&self) -> Option<(&'static str, &PathBuf)> {
        Some(("shape", self.shape.as_ref()?))
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("impacts", entries, |entry, source| Ok(vec![entry.keys.measure(source)?]))
    }
}
