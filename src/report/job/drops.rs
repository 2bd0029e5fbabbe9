//! Drops of a campaign.

use super::impacts::read;
use super::{JobOptions, merge, or_left_out};
use crate::campaign::{Campaign, DropEntry};
use crate::error::Result;
use crate::measure::impacts::ImpactsOptions;
use crate::measure::restitution::{Bounces, Drop, GRAVITY, Restitution, Train, Velocities, restitution};
use crate::report::words::{Voice, sentences};
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
        // Files without a name are no series, even where one folder has the same file name as another.
        let place = all.iter().position(|s| entry.name.is_some() && entry.name == s.entry.name);
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
                merge(warnings, &file, &sentences(&found.findings, Voice::Campaign));
                series.files.push(file);
                figures.push((format!("drop_{}", i + 1), pictures::drop(&name, &trace, &found.times)));
            }
        }
        series.drop.intervals.extend(entry.interval.or(entry.intervals.first().copied()));
        if !entry.intervals.is_empty() {
            let onset_std = entry.interval_std.map(|s| s / 2f64.sqrt());
            series.trains.push(Train { intervals: entry.intervals.clone(), onset_std });
        }
        series.velocities = series.velocities.take().or_else(|| entry.velocities());
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
        merge(warnings, &name, &sentences(&found.findings, Voice::Campaign));
        results.push(DropResult { name, files, restitution: found });
    }
    Ok(results)
}
