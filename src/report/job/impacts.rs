//! Impacts and drops of a campaign.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::{Campaign, DropEntry, RecordEntry};
use crate::error::Result;
use crate::measure::impacts::{Impacts, ImpactsOptions, impacts as find};
use crate::measure::restitution::{Bounces, Drop, GRAVITY, Restitution, restitution};
use crate::read::Recording;
use crate::record::Trace;
use crate::report::{Figure, pictures};
use serde::Serialize;

/// Impacts of one trace.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImpactsResult {
    /// Name in the campaign, else the file's.
    pub name: String,
    /// File.
    pub file: String,
    /// What was found.
    #[serde(flatten)]
    pub impacts: Impacts,
}

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

/// A trace of an entry, with its name and file.
fn read(
    campaign: &Campaign,
    entry: &RecordEntry,
    options: JobOptions,
    warnings: &mut Vec<String>,
) -> Result<(String, String, Recording, Trace)> {
    let path = campaign.record_path(entry, options.allow_outside)?;
    let recording = entry.reader().rate_of_base_band().from_path(&path)?;
    let file = file_name(&path);
    merge(warnings, &file, &recording.doubts);
    let trace = recording.trace(entry.channel.as_deref(), entry.calibration)?;
    let name = entry.name.clone().unwrap_or_else(|| file.clone());
    merge(warnings, &name, &trace.meta.doubts);
    Ok((name, file, recording, trace))
}

pub(super) fn impacts(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<ImpactsResult>> {
    let mut results = Vec::new();
    for entry in &campaign.impacts {
        let (name, file, recording, trace) = read(campaign, &entry.record(), options, warnings)?;
        let reference = match &entry.reference {
            Some(channel) => Some(recording.trace(Some(channel), None)?.values),
            None => None,
        };
        let default = ImpactsOptions::default();
        let how = ImpactsOptions {
            threshold: entry.threshold.unwrap_or(default.threshold),
            refractory: entry.refractory,
            excitation: entry.excitation,
            reference,
            ..default
        };
        let Some(found) = or_left_out(find(&trace, &how), &name, warnings)? else { continue };
        merge(warnings, &name, &found.warnings);
        figures.push((format!("impacts_{}", results.len() + 1), pictures::impacts(&name, &trace, &found)));
        results.push(ImpactsResult { name, file, impacts: found });
    }
    Ok(results)
}

/// The first key of which two drops of one series have different values.
fn differing(a: &DropEntry, b: &DropEntry) -> Option<&'static str> {
    let keys = |e: &DropEntry| {
        [
            ("height", e.height),
            ("height_std", e.height_std),
            ("gravity", e.gravity),
            ("gravity_std", e.gravity_std),
            ("threshold", e.threshold),
            ("refractory", e.refractory),
        ]
    };
    keys(a).iter().zip(keys(b)).find(|(a, b)| a.1 != b.1).map(|(a, _)| a.0)
}

/// Entries of one name are drops of one series.
pub(super) fn drops(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<DropResult>> {
    let mut series: Vec<(&DropEntry, String, Vec<String>, Drop, Bounces)> = Vec::new();
    for (i, entry) in campaign.drop.iter().enumerate() {
        let of = |e: &DropEntry| e.record().name;
        // Files without a name are no series, even where one folder has the same file name as another.
        let place = series.iter().position(|s| of(entry).is_some() && of(s.0) == of(entry));
        if let Some((first, name, ..)) = place.and_then(|p| series.get(p))
            && let Some(key) = differing(first, entry)
        {
            let found = format!("this drop of {name:?} has another {key} than the first of that name");
            return Err(campaign
                .at(entry.record().file.span(), found)
                .hint("drops of one series have equal keys: give this one another name, or the same value"));
        }
        let (name, file, _, trace) = read(campaign, &entry.record(), options, warnings)?;
        let how = ImpactsOptions {
            threshold: entry.threshold.unwrap_or(Bounces::THRESHOLD),
            refractory: entry.refractory,
            ..ImpactsOptions::default()
        };
        let place = place.unwrap_or_else(|| {
            let drop = Drop {
                height: entry.height.unwrap_or(f64::NAN),
                height_std: entry.height_std,
                gravity: entry.gravity.unwrap_or(GRAVITY),
                gravity_std: entry.gravity_std,
                ..Drop::default()
            };
            series.push((entry, name.clone(), Vec::new(), drop, Bounces::default()));
            series.len() - 1
        });
        if let Some((_, _, files, _, bounces)) = series.get_mut(place) {
            let Some(found) = or_left_out(bounces.add(&trace, &how), &file, warnings)? else { continue };
            merge(warnings, &file, &found.warnings);
            files.push(file);
            figures.push((format!("drop_{}", i + 1), pictures::drop(&name, &trace, &found)));
        }
    }
    let mut results = Vec::new();
    for (entry, name, files, drop, bounces) in series.into_iter().filter(|s| !s.2.is_empty()) {
        let found = restitution(&bounces.measured(drop, entry.height.is_some()));
        let Some(found) = or_left_out(found, &name, warnings)? else { continue };
        merge(warnings, &name, &found.warnings);
        results.push(DropResult { name, files, restitution: found });
    }
    Ok(results)
}
