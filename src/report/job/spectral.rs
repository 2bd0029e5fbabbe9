//! Spectra of a campaign.

use super::{JobOptions, PARTS, Progress, file_name, merge, or_left_out, slugs};
use crate::campaign::{Campaign, RecordEntry};
use crate::error::Result;
use crate::measure::spectral::{SpectralOptions, SpectralResult, spectral};
use crate::record::Traces;
use crate::report::words::{self, Voice};
use crate::report::{Figure, Output, files, pictures};
use serde::Serialize;

/// A spectrum of a campaign, or a frequency response function that was taken from two channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumResult {
    /// Channel, or both of a frequency response function.
    pub channel: String,
    /// File.
    pub file: String,
    /// Its lines; their name is that in the campaign, else the file's.
    #[serde(flatten)]
    pub result: SpectralResult,
}

/// The channels of an entry: that of the excitation first, where there is one.
pub(super) fn channels(
    campaign: &Campaign,
    entry: &RecordEntry,
    reference: Option<&str>,
    options: JobOptions,
) -> Result<Traces> {
    let path = campaign.record_path(entry, options.allow_outside)?;
    let reader = entry.reader().rate_of_base_band();
    reader.stream_chosen(path, reference, entry.channel.as_deref(), entry.calibration)
}

/// The lines of an entry; the name of its file.
pub(super) fn lines(
    campaign: &Campaign,
    entry: &RecordEntry,
    reference: Option<&str>,
    how: &SpectralOptions,
    options: JobOptions,
    progress: &dyn Progress,
) -> Result<(String, Result<SpectralResult>)> {
    let mut traces = channels(campaign, entry, reference, options)?;
    let file = file_name(traces.path());
    progress.start(&format!("spectrum {}", entry.name.as_ref().unwrap_or(&file)), PARTS);
    let (all, mut told) = (traces.frames(), 0);
    let found = spectral(&mut traces, how, |done| {
        let parts = (PARTS * done).checked_div(all).unwrap_or(0).min(PARTS);
        (told..parts).for_each(|_| progress.step());
        told = told.max(parts);
    });
    Ok((file, found))
}

pub(super) fn spectra(
    campaign: &Campaign,
    options: JobOptions,
    progress: &dyn Progress,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<SpectrumResult>> {
    let mut results = Vec::new();
    for own in &campaign.spectrum {
        let entry = own.record();
        let how = own.options().map_err(|why| campaign.at(entry.file.span(), why))?;
        let (file, found) = lines(campaign, &entry, own.reference.as_deref(), &how, options, progress)?;
        let name = entry.name.clone().unwrap_or_else(|| file.clone());
        let Some(result) = or_left_out(found, &name, warnings)? else { continue };
        merge(warnings, &name, &words::sentences(&result.findings, Voice::Campaign));
        merge(warnings, &name, &result.warnings);
        let channel = result.name.clone();
        results.push(SpectrumResult { channel, file, result: SpectralResult { name, ..result } });
    }
    for (slug, found) in slugs(results.iter().map(|r| r.result.name.as_str())).iter().zip(&results) {
        figures.push((format!("spectrum_{slug}"), pictures::lines(&found.result.name, &found.result)));
    }
    Ok(results)
}

/// Writes the lines of each record.
pub(super) fn tables(
    results: &[SpectrumResult],
    output: &mut Output,
    warnings: &mut Vec<String>,
) -> Result<()> {
    for (slug, found) in slugs(results.iter().map(|r| r.result.name.as_str())).iter().zip(results) {
        warnings.extend(files::records(output, &format!("spectrum_{slug}"), &found.result.records())?);
    }
    Ok(())
}
