//! Drops: `[[drop]]`, `vibro restitution`.

use super::answer::Answer;
use super::evidence::Evidence;
use super::headline::headline;
use super::impacts;
use super::job::AnsweredRecord;
use super::job::Job;
use super::kind::{Analysis, name_of};
use super::source::Source;
use super::source::file_name;
use crate::campaign::{Entry, KeyRange};
use crate::error::{Error, Hint, Result};
use crate::measure::impacts::ImpactsOptions;
use crate::measure::restitution::{Drop, GRAVITY, Measured, Restitution, Train, Velocities, restitution};
use crate::record::{Doubt, Finding, Trace, doubt_with_record, shown};
use crate::report::files::Names;
use crate::report::layout::{Shown, table};
use crate::report::words::{About, Voice};
use crate::report::{Cell, Plot, Table};
use crate::units::notation::significant;
use serde::Deserialize;
use std::path::Path;

/// Known quantities of the drops of one series, beside their records.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Drop height in m; not needed for a train of bounces
    pub height: Option<f64>,
    /// Its standard uncertainty in m
    pub height_std: Option<f64>,
    /// Time from first to second impact in s
    pub interval: Option<f64>,
    /// Standard uncertainty of the interval in s
    pub interval_std: Option<f64>,
    /// Times between successive impacts of one train of bounces, in s
    #[cfg_attr(feature = "cli", arg(long, value_name = "A,B,C", value_delimiter = ','))]
    pub intervals: Vec<f64>,
    /// How long an impact lasts, in s: taken off each interval, which runs from beginning to beginning
    /// [default: as a force shows it, else 0]
    pub contact_time: Option<f64>,
    /// Standard uncertainty of the contact time in s
    pub contact_time_std: Option<f64>,
    /// Acceleration of free fall in m/s² [default: 9.80665]
    pub gravity: Option<f64>,
    /// Its standard uncertainty in m/s²
    pub gravity_std: Option<f64>,
    /// Smallest impact counted, as a fraction of the median height [default: 0.02]
    pub threshold: Option<f64>,
    /// Shortest time between two impacts in s: ringing within it counts once [default: found from the trace]
    pub refractory: Option<f64>,
    /// Do not remove mains hum
    pub keep_hum: bool,
    /// Masses in kg: the striking and the struck one
    #[cfg_attr(feature = "cli", arg(value_name = "M1,M2", value_parser = crate::campaign::two::<','>))]
    pub masses: Option<(f64, f64)>,
    /// Velocities of both masses before the impact, in m/s
    #[cfg_attr(feature = "cli", arg(value_name = "V1,V2", allow_hyphen_values = true, value_parser = crate::campaign::two::<','>))]
    pub before: Option<(f64, f64)>,
    /// Velocities of both masses after it, in m/s; of mass 1 alone where masses are given
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "V1,V2", allow_hyphen_values = true, value_delimiter = ',')
    )]
    pub after: Vec<f64>,
    /// Velocity of mass 2 after it, in m/s, where that of mass 1 is not known and masses are given
    pub after2: Option<f64>,
    /// Standard uncertainty of each velocity, in m/s
    pub velocity_std: Option<f64>,
}

impl Keys {
    /// Checks that the keys go together, with or without a file.
    ///
    /// # Errors
    /// The key that does not.
    pub fn usable(&self, file: bool) -> Result<()> {
        let (interval, intervals) = (self.interval.is_some(), !self.intervals.is_empty());
        let (before, after) = (self.before.is_some(), !self.after.is_empty() || self.after2.is_some());
        let one_of = "one of them: the first of intervals is that after the fall";
        let velocities = "after = V1 and V2, or with masses after = V1 or after2 = V2";
        let wrong: [(bool, &[&'static str], &str, &str); 10] = [
            (interval && intervals, &["intervals"], "both interval and intervals", one_of),
            (file && interval, &["interval"], "a file and an interval", "one of them"),
            (file && intervals, &["intervals"], "a file and intervals", "one of them"),
            (
                interval && self.height.is_none(),
                &["height"],
                "interval without a height",
                "both, or flight times as intervals",
            ),
            (
                self.contact_time_std.is_some() && self.contact_time.is_none(),
                &["contact_time"],
                "contact_time_std without contact_time",
                "the contact time, too",
            ),
            (after && !before, &["after"], "velocities after the impact without before", "both"),
            (
                self.velocity_std.is_some() && !before,
                &["velocity_std"],
                "velocity_std without before",
                "both",
            ),
            (
                !file && !interval && !intervals && !before && self.height.is_some(),
                &["interval", "height"],
                "a height and no time",
                "the time from first to second impact, or the trace files of the drops",
            ),
            (
                !file && !interval && !intervals && !before,
                &["height"],
                "no recording and no numbers",
                "recordings of drops, height and interval, intervals, or velocities before and after",
            ),
            (before && !after, &["before"], "before without velocities after the impact", velocities),
        ];
        if let Some((_, keys, found, expected)) = wrong.into_iter().find(|w| w.0) {
            return Err(keys.iter().fold(Error::usage(found, expected), |error, key| error.setting(key)));
        }
        let given = self.after.len() + usize::from(self.after2.is_some());
        if given > 2 {
            let found = format!("{given} velocities after the impact");
            return Err(Error::usage(found, velocities).setting("before"));
        }
        Ok(())
    }

    /// Velocities before and after the impact in m/s, in the order of the masses.
    fn velocities(&self) -> Option<Velocities> {
        let mut after = self.after.iter().copied();
        Some(Velocities {
            before: self.before?,
            after1: after.next(),
            after2: self.after2.or(after.next()),
            masses: self.masses,
            std: self.velocity_std,
        })
    }

    /// The first key whose values differ between two drops of one series.
    fn differing(&self, other: &Keys) -> Option<&'static str> {
        let equal = [
            ("height", self.height == other.height),
            ("height_std", self.height_std == other.height_std),
            ("interval_std", self.interval_std == other.interval_std),
            ("contact_time", self.contact_time == other.contact_time),
            ("contact_time_std", self.contact_time_std == other.contact_time_std),
            ("gravity", self.gravity == other.gravity),
            ("gravity_std", self.gravity_std == other.gravity_std),
            ("threshold", self.threshold == other.threshold),
            ("refractory", self.refractory == other.refractory),
            ("keep_hum", self.keep_hum == other.keep_hum),
        ];
        equal.into_iter().find(|(_, equal)| !equal).map(|(key, _)| key)
    }
}

/// Drops of one name, evaluated together.
pub struct Series {
    /// Height and first intervals.
    drop: Drop,
    /// Bounces of each drop.
    trains: Vec<Train>,
    velocities: Option<Velocities>,
    contact_time: Option<f64>,
    contact_time_std: Option<f64>,
    /// File and trace of each drop with a record.
    records: Vec<(String, Plot)>,
    /// Times in s of the impacts of each of these drops.
    times: Vec<Vec<f64>>,
    findings: Vec<About>,
    /// File and doubt of each record in which impacts may be missing.
    doubts: Vec<(String, Doubt)>,
    /// Records left out, each with the reason why it allows no answer.
    refused: Vec<(String, Error)>,
}

impl Series {
    /// A series without a drop yet.
    pub fn new(keys: &Keys) -> Series {
        let drop = Drop {
            height: keys.height.unwrap_or(f64::NAN),
            height_std: keys.height_std,
            interval_std: keys.interval_std,
            gravity: keys.gravity.unwrap_or(GRAVITY),
            gravity_std: keys.gravity_std,
            ..Drop::default()
        };
        Series {
            drop,
            velocities: None,
            contact_time: keys.contact_time,
            contact_time_std: keys.contact_time_std,
            trains: Vec::new(),
            records: Vec::new(),
            times: Vec::new(),
            findings: Vec::new(),
            doubts: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// Adds the numbers in the keys, for a drop without a record.
    pub(crate) fn add_numbers(&mut self, keys: &Keys) {
        self.drop.intervals.extend(keys.interval);
        if !keys.intervals.is_empty() {
            let onset_std = keys.interval_std.map(|s| s / 2f64.sqrt());
            self.trains.push(Train { intervals: keys.intervals.clone(), onset_std, ..Train::default() });
        }
        self.velocities = self.velocities.take().or_else(|| keys.velocities());
    }

    /// Adds the record of a drop.
    ///
    /// # Errors
    /// If the file cannot be read, or its trace allows no answer.
    pub(crate) fn add_record(&mut self, keys: &Keys, source: &Source<'_>) -> Result<()> {
        let file = file_name(source.path);
        let recording = source.recording()?;
        let trace = source.trace(&recording)?;
        let options = ImpactsOptions {
            threshold: Some(keys.threshold.unwrap_or(Train::THRESHOLD)),
            refractory: keys.refractory,
            keep_hum: keys.keep_hum,
            ..ImpactsOptions::default()
        };
        let (train, found) = Train::of(&trace, &options, self.drop.full_flight())?;
        if let Some(first) = train.intervals.first() {
            self.drop.possible(*first, "the first interval")?;
        }
        self.trains.push(train);
        // Only times matter: a missing calibration is not reported.
        let of_trace = trace.meta.findings.iter().filter(|found| found.code != Trace::UNCALIBRATED);
        let findings = recording.findings.iter().chain(of_trace).chain(&found.findings);
        self.findings.extend(findings.map(|found| (file.clone(), found.clone())));
        self.doubts.extend(found.doubts.into_iter().map(|doubt| (file.clone(), doubt)));
        let plot = impacts::figures::drop(&file, &trace, &found.times);
        self.records.push((file, plot));
        self.times.push(found.times);
        Ok(())
    }

    /// Leaves out a record that allows no answer, with a caution, since other records may allow one.
    ///
    /// # Errors
    /// The error itself, if it does not concern the data of the record.
    pub(crate) fn leave_out(&mut self, file: &Path, error: Error) -> Result<()> {
        if error.exit_code() != 1 {
            return Err(error);
        }
        let why = error.text_with(|key, value| Voice::Command.set(key, value), Hint::to_string);
        let left = Finding::caution("drop-left-out").name("why", why);
        self.findings.push((file_name(file), left));
        self.refused.push((file_name(file), error));
        Ok(())
    }

    /// Whether no drop has given numbers.
    fn is_empty(&self) -> bool {
        self.drop.intervals.is_empty() && self.trains.is_empty() && self.velocities.is_none()
    }

    /// The restitution by every method that the drops allow.
    ///
    /// # Errors
    /// If they allow none.
    pub fn answer(mut self, name: &str) -> Result<Answer> {
        if self.is_empty() && !self.refused.is_empty() {
            let several = self.refused.len() > 1;
            let (file, error) = self.refused.swap_remove(0);
            return Err(if several { error.of_record(&file) } else { error });
        }
        let files = self.records.len();
        let drop = self.drop.beginning(&self.trains);
        let has_fall = drop.height.is_finite() && !drop.intervals.is_empty();
        let drop = has_fall.then_some(drop);
        let mut found = restitution(&Measured {
            drop,
            trains: self.trains,
            velocities: self.velocities,
            contact_time: self.contact_time,
            contact_time_std: self.contact_time_std,
        })?;
        let doubts = self.doubts.into_iter().map(|(file, doubt)| (file, doubt.of(&mut found)));
        self.findings.extend(doubts);
        doubt_with_record(self.findings.iter().map(|(_, found)| found), &mut found);
        let mut answer = Answer::of(&found)?;
        answer.result.insert("times".to_owned(), self.times.into());
        answer.findings = self.findings;
        if !self.records.is_empty() {
            let plots = self.records.into_iter().map(|(_, plot)| plot).collect();
            answer.figure("drop", impacts::figures::drops(name, plots));
        }
        answer.refused = found
            .restitution
            .value
            .is_nan()
            .then(|| Error::refused("the methods disagree, and none is preferred"));
        answer.add("", &found.findings);
        answer.evidence.push(Evidence::of_drops(&found, files));
        answer.headlines.push(headline(
            "Restitution",
            [&found],
            &[("coefficient of restitution", "", &|f| Cell::from(&f.restitution))],
        ));
        answer.table("restitution", by_method(name, &found));
        let columns: [Shown<Restitution>; 3] = [
            ("series", "", &|_| name.into()),
            ("methods", "", &|r| agreement(r).into()),
            ("std of R by bootstrap", "", &|r| r.bootstrap_std.map(|std| significant(std, 2)).into()),
        ];
        if found.by.len() > 1 || found.bootstrap_std.is_some() {
            answer.tables.push(table("Methods compared", [found], &columns));
        }
        Ok(answer)
    }
}

/// Whether the methods agree, in words.
fn agreement(found: &Restitution) -> &'static str {
    match found.agree {
        _ if found.by.len() < 2 => "one method",
        Some(true) => "agree",
        Some(false) => "disagree",
        None => "not compared: one has no uncertainty",
    }
}

/// Restitution by every method, one row a method.
fn by_method(name: &str, found: &Restitution) -> Table {
    table(
        "Coefficient of restitution",
        &found.by,
        &[
            ("series", "", &|_| name.into()),
            ("method", "", &|way| way.method.into()),
            ("R", "", &|way| Cell::from(&way.restitution)),
            ("samples", "", &|way| way.restitution.n.into()),
            ("computed as", "", &|way| way.restitution.method.as_str().into()),
        ],
    )
}

impl Analysis for Keys {
    const SECTION: &'static str = "drop";
    const TITLE: &'static str = "Restitution";
    const FILES: Names = Names::Numbered(&["drop", "restitution"]);
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("s", &["interval", "intervals"]).times(),
        KeyRange::from_zero("s", &["interval_std", "contact_time", "contact_time_std"]).times(),
        KeyRange::above_zero("kg", &["masses"]),
        KeyRange::above_zero("", &["height", "gravity"]),
        KeyRange::from_zero("", &["height_std", "gravity_std", "velocity_std"]),
        KeyRange::any("", &["before", "after", "after2"]),
    ];
    const TOGETHER: bool = true;

    fn check(entry: &Entry<Keys>, earlier: &[Entry<Keys>]) -> Result<()> {
        entry.keys.usable(entry.file.is_some())?;
        let Some(name) = &entry.name else { return Ok(()) };
        // Drops of one name are one series and must have equal keys.
        let mut series = earlier.iter().filter(|e| e.name.as_ref() == Some(name)).peekable();
        if let Some(key) = series.peek().and_then(|first| first.keys.differing(&entry.keys)) {
            return Err(Error::usage(
                format!("a drop of {name:?} has another {key} than the first of that name"),
                "drops of one series have equal keys: give this one another name, or the same value",
            )
            .setting(key));
        }
        let same_record =
            |e: &Entry<Keys>| (&e.file, &e.channel.channel) == (&entry.file, &entry.channel.channel);
        if let Some(file) = &entry.file
            && series.clone().any(same_record)
        {
            let found = format!("{} is in the series {name:?} twice", shown(file));
            return Err(Error::usage(found, "each record once").setting("file"));
        }
        if entry.keys.before.is_some() && series.any(|e| e.keys.before.is_some()) {
            let found = format!("two drops of {name:?} have velocities");
            return Err(Error::usage(found, "velocities in one table of the series only").setting("before"));
        }
        Ok(())
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        let mut all: Vec<(Option<&String>, String, Series)> = Vec::new();
        for entry in entries {
            // Files without a stated name are no series, even if files in two folders share a name.
            let stated = entry.name.as_ref();
            let at = all.iter().position(|s| stated.is_some() && s.0 == stated).unwrap_or_else(|| {
                all.push((stated, name_of(entry), Series::new(&entry.keys)));
                all.len() - 1
            });
            let Some((_, name, series)) = all.get_mut(at) else { continue };
            series.add_numbers(&entry.keys);
            if entry.file.is_some() {
                let keys = &entry.keys;
                let added = job.path(entry).and_then(|path| {
                    job.measured(entry, name, &path, |source| series.add_record(keys, source))
                });
                job.found(&file_name(entry.file.as_deref().unwrap_or(Path::new(""))), added);
            }
        }
        let mut records = Vec::new();
        for (_, name, series) in all.into_iter().filter(|s| !s.2.is_empty()) {
            let files = series.records.iter().map(|(file, _)| file.as_str()).collect();
            let found = series.answer(&name);
            let Some(answer) = job.found(&name, found) else { continue };
            let mark = (records.len() + 1).to_string();
            records.push(AnsweredRecord { name, file: files, mark, answer });
        }
        job.answer("drops", records);
        Ok(())
    }
}
