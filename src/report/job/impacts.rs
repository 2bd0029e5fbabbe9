//! Impacts of a campaign.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::{Campaign, RecordEntry};
use crate::error::Result;
use crate::measure::impacts::{Impacts, ImpactsOptions, Shape, impacts as find};
use crate::read::{Reader, Recording};
use crate::record::Trace;
use crate::report::words::{self, Voice};
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

/// A trace of an entry, with its name and file.
pub(super) fn read(
    campaign: &Campaign,
    entry: &RecordEntry,
    options: JobOptions,
    warnings: &mut Vec<String>,
) -> Result<(String, String, Recording, Trace)> {
    let path = campaign.record_path(entry, options.allow_outside)?;
    let recording = entry.reader().rate_of_base_band().from_path(&path)?;
    let file = file_name(&path);
    merge(warnings, &file, &words::sentences(&recording.findings, Voice::Campaign));
    let trace = recording.trace(entry.channel.as_deref(), entry.calibration)?;
    let name = entry.name.clone().unwrap_or_else(|| file.clone());
    merge(warnings, &name, &words::sentences(&trace.meta.findings, Voice::Campaign));
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
        let shape = match &entry.shape {
            Some(file) => {
                let path = campaign.beside(&entry.record(), file, options.allow_outside)?;
                let pulse = Reader::new().rate(entry.shape_rate).from_path(path)?;
                let shape = pulse.trace(None, None).and_then(|pulse| Shape::of(&pulse, &trace));
                let Some(shape) = or_left_out(shape, &name, warnings)? else { continue };
                Some(shape)
            }
            None => None,
        };
        let default = ImpactsOptions::default();
        let how = ImpactsOptions {
            threshold: entry.threshold.unwrap_or(default.threshold),
            refractory: entry.refractory,
            excitation: entry.excitation,
            excitation_std: entry.excitation_std,
            hum: !entry.keep_hum,
            reference,
            shape,
            scatter: entry.scatter,
            complete: entry.none_missed,
        };
        let Some(found) = or_left_out(find(&trace, &how), &name, warnings)? else { continue };
        merge(warnings, &name, &found.warnings);
        figures.push((format!("impacts_{}", results.len() + 1), pictures::impacts(&name, &trace, &found)));
        results.push(ImpactsResult { name, file, impacts: found });
    }
    Ok(results)
}
