//! Drops of a campaign.

use super::impacts::read;
use super::{JobOptions, merge, or_left_out};
use crate::campaign::{Campaign, DropEntry};
use crate::error::{Error, Result};
use crate::measure::impacts::ImpactsOptions;
use crate::measure::restitution::{Bounces, Drop, GRAVITY, Restitution, Train, Velocities, restitution};
use crate::report::{Figure, pictures};
use serde::Serialize;

/// Restitution from one or several drops of one name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DropResult {
    /// Name in the campaign, else the file's.
    pub name: String,
    /// Files, one a drop.
    pub files: Vec<String>,
    /// What was found.
    #[serde(flatten)]
    pub restitution: Restitution,
}

/// Entries of one name.
struct Series<'a> {
    entry: &'a DropEntry,
    name: String,
    files: Vec<String>,
    drop: Drop,
    bounces: Bounces,
    trains: Vec<Train>,
    velocities: Option<Velocities>,
}

/// The first key of which two drops of one series have different values.
fn differing(a: &DropEntry, b: &DropEntry) -> Option<&'static str> {
    let keys = |e: &DropEntry| {
        [
            ("height", e.height),
            ("height_std", e.height_std),
            ("interval_std", e.interval_std),
            ("gravity", e.gravity),
            ("gravity_std", e.gravity_std),
            ("threshold", e.threshold),
            ("refractory", e.refractory),
            ("keep_hum", Some(f64::from(u8::from(e.keep_hum)))),
            ("masses", e.masses.map(|m| m.0)),
            ("masses", e.masses.map(|m| m.1)),
        ]
    };
    keys(a).iter().zip(keys(b)).find(|(a, b)| a.1 != b.1).map(|(a, _)| a.0)
}

/// Checks what an entry must have, or may not have together.
fn check(campaign: &Campaign, entry: &DropEntry, name: &str) -> Result<()> {
    let typed = entry.interval.is_some() || !entry.intervals.is_empty();
    let moving = !entry.after.is_empty() || entry.after2.is_some() || entry.velocity_std.is_some();
    let rules = [
        (
            entry.interval.is_some() && !entry.intervals.is_empty(),
            "interval and intervals",
            "one of them: the first of intervals is that after the fall",
        ),
        (entry.record().is_some() && typed, "a file and an interval", "one of them"),
        (
            entry.interval.is_some() && entry.height.is_none(),
            "interval without a height",
            "both, or flight times as intervals",
        ),
        (moving && entry.before.is_none(), "after, after2 or velocity_std without before", "both"),
        (
            entry.record().is_none() && !typed && entry.before.is_none(),
            "nothing that was measured",
            "file, interval, intervals, or before and after",
        ),
    ];
    match rules.into_iter().find(|r| r.0) {
        Some((_, found, expected)) => {
            let found = format!("[[drop]] {name:?} has {found}");
            Err(match entry.record() {
                Some(record) => campaign.at(record.file.span(), found).hint(expected),
                None => Error::usage(found, expected).in_file(campaign.path()),
            })
        }
        None => Ok(()),
    }
}

/// Entries of one name are drops of one series.
pub(super) fn drops(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<DropResult>> {
    let mut all: Vec<Series> = Vec::new();
    for (i, entry) in campaign.drop.iter().enumerate() {
        let called = entry.name.clone().unwrap_or_else(|| format!("drop {}", i + 1));
        check(campaign, entry, &called)?;
        // Files without a name are no series, even where one folder has the same file name as another.
        let place = all.iter().position(|s| entry.name.is_some() && entry.name == s.entry.name);
        if let Some(first) = place.and_then(|p| all.get(p))
            && let Some(key) = differing(first.entry, entry)
        {
            let found = format!("a drop of {called:?} has another {key} than the first of that name");
            let error = match entry.record() {
                Some(record) => campaign.at(record.file.span(), found),
                None => Error::usage(found, "equal keys").in_file(campaign.path()),
            };
            return Err(error
                .hint("drops of one series have equal keys: give this one another name, or the same value"));
        }
        let trace = match entry.record() {
            Some(record) => Some(read(campaign, &record, options, warnings)?),
            None => None,
        };
        let place = place.unwrap_or_else(|| {
            let drop = Drop {
                height: entry.height.unwrap_or(f64::NAN),
                height_std: entry.height_std,
                interval_std: entry.interval_std,
                gravity: entry.gravity.unwrap_or(GRAVITY),
                gravity_std: entry.gravity_std,
                masses: entry.masses,
                ..Drop::default()
            };
            all.push(Series {
                entry,
                name: trace.as_ref().map_or_else(|| called.clone(), |t| t.0.clone()),
                files: Vec::new(),
                drop,
                bounces: Bounces::default(),
                trains: Vec::new(),
                velocities: None,
            });
            all.len() - 1
        });
        let Some(series) = all.get_mut(place) else { continue };
        if let Some((name, file, _, trace)) = trace {
            let how = ImpactsOptions {
                threshold: entry.threshold.unwrap_or(Bounces::THRESHOLD),
                refractory: entry.refractory,
                hum: !entry.keep_hum,
                ..ImpactsOptions::default()
            };
            if let Some(found) = or_left_out(series.bounces.add(&trace, &how), &file, warnings)? {
                merge(warnings, &file, &found.warnings);
                series.files.push(file);
                figures.push((format!("drop_{}", i + 1), pictures::drop(&name, &trace, &found)));
            }
        }
        series.drop.intervals.extend(entry.interval.or(entry.intervals.first().copied()));
        if !entry.intervals.is_empty() {
            let onset_std = entry.interval_std.map(|s| s / 2f64.sqrt());
            series.trains.push(Train { intervals: entry.intervals.clone(), onset_std, after: None });
        }
        if let Some(found) = velocities(entry, &called)? {
            if series.velocities.is_some() {
                return Err(Error::usage(
                    format!("two drops of {called:?} have velocities"),
                    "one impact with velocities a name",
                )
                .in_file(campaign.path()));
            }
            series.velocities = Some(found);
        }
    }
    let mut results = Vec::new();
    for series in all {
        let Series { entry, name, files, drop, bounces, trains, velocities } = series;
        let known = !drop.intervals.is_empty() || !trains.is_empty() || velocities.is_some();
        if files.is_empty() && !known {
            continue;
        }
        let mut measured = bounces.measured(drop, entry.height.is_some());
        measured.trains.extend(trains);
        measured.velocities = velocities;
        let Some(found) = or_left_out(restitution(&measured), &name, warnings)? else { continue };
        merge(warnings, &name, &found.warnings);
        results.push(DropResult { name, files, restitution: found });
    }
    Ok(results)
}

fn velocities(entry: &DropEntry, name: &str) -> Result<Option<Velocities>> {
    let Some(before) = entry.before else { return Ok(None) };
    let (after1, after2) = match (entry.after.as_slice(), entry.after2) {
        ([one], two) => (Some(*one), two),
        ([one, two], None) => (Some(*one), Some(*two)),
        ([], Some(two)) => (None, Some(two)),
        (other, _) => {
            return Err(Error::usage(
                format!("[[drop]] {name:?} has {} velocities after the impact", other.len()),
                "after = [V1, V2], or after = [V1] or after2 = V2 with masses",
            ));
        }
    };
    Ok(Some(Velocities { before, after1, after2, masses: entry.masses, std: entry.velocity_std }))
}
