//! Frequency response functions of a campaign: figures and modes.

use super::{JobOptions, file_name, merge, or_left_out, spectral};
use crate::campaign::{Campaign, FrfEntry};
use crate::error::Result;
use crate::measure::modal::{Measured, ModalOptions, ModalResult, modal};
use crate::record::{Meta, Record};
use crate::report::{Figure, pictures};
use serde::Serialize;

/// A frequency response function and its modes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrfResult {
    /// Name of the record.
    pub name: String,
    /// File.
    pub file: String,
    /// Receptance, mobility, accelerance, or another ratio.
    pub quantity: &'static str,
    /// Unit.
    pub unit: String,
    /// Its modes.
    #[serde(flatten)]
    pub modal: ModalResult,
}

pub(super) fn frfs(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<FrfResult>> {
    let mut results = Vec::new();
    for own in &campaign.frf {
        let entry = own.record();
        for (name, file, mut meta, mut measured) in functions(campaign, own, options, warnings)? {
            if let Some(factor) = entry.calibration.filter(|_| own.reference.is_none()) {
                meta.step("calibrate", &[("factor", &factor)]);
                measured.values.iter_mut().for_each(|v| *v *= factor);
            }
            let number = results.len() + 1;
            let wanted = ModalOptions {
                band: own.band,
                mass: own.mass,
                least_coherence: own.least_coherence.unwrap_or(ModalOptions::default().least_coherence),
                decay: meta.added_decay(),
                from_blows: meta.from_blows(),
            };
            // A function without a mode is no reason to give up the rest of a campaign.
            let mut found = match modal(&measured, &wanted) {
                Err(error) if error.exit_code() == 1 => {
                    ModalResult { modes: Vec::new(), warnings: vec![format!("No modes: {error}.")] }
                }
                found => found?,
            };
            figures.push((format!("frf_{number}"), pictures::frf(&name, &meta, &measured, &found.modes)));
            if let Some(figure) = pictures::nyquist(&name, &measured, &found.modes) {
                figures.push((format!("nyquist_{number}"), figure));
            }
            found.warnings.splice(0..0, meta.doubts.iter().cloned());
            merge(warnings, &name, &found.warnings);
            results.push(FrfResult {
                name: name.clone(),
                file,
                quantity: meta.quantity.name(),
                unit: meta.unit.symbol().to_owned(),
                modal: found,
            });
        }
    }
    Ok(results)
}

/// Name, file, meta data and lines of a function.
type Function = (String, String, Meta, Measured);

/// The functions of an entry: those of its file, or the one that is taken from two of its channels.
fn functions(
    campaign: &Campaign,
    own: &FrfEntry,
    options: JobOptions,
    warnings: &mut Vec<String>,
) -> Result<Vec<Function>> {
    let entry = own.record();
    if let Some(how) = own.options().map_err(|why| campaign.at(entry.file.span(), why))? {
        let (file, found) = spectral::lines(campaign, &entry, own.reference.as_deref(), &how, options)?;
        let name = entry.name.clone().unwrap_or_else(|| file.clone());
        let Some(found) = or_left_out(found, &name, warnings)? else { return Ok(Vec::new()) };
        merge(warnings, &name, &found.warnings);
        let records = found.records();
        let [Record::Frf(frf), Record::Spectrum(coherence)] = records.as_slice() else {
            return Ok(Vec::new());
        };
        let measured = Measured::complex(frf).with_coherence(coherence)?;
        return Ok(vec![(name, file, frf.meta.clone(), measured)]);
    }
    let recording = campaign.recording(&entry, options.allow_outside)?;
    let file = file_name(&recording.path);
    merge(warnings, &file, &recording.doubts);
    let name = entry.name.clone().unwrap_or_else(|| file.clone());
    let coherence = match &own.coherence {
        Some(file) => {
            Some(entry.reader().from_path(campaign.beside(&entry, file, options.allow_outside)?)?)
        }
        None => None,
    };
    let mut found = Vec::new();
    for (meta, measured) in Measured::all(&recording, entry.channel.as_deref())? {
        let measured = match &coherence {
            Some(recording) => measured.with_coherence_of(recording),
            None => Ok(measured),
        };
        if let Some(measured) = or_left_out(measured, &name, warnings)? {
            found.push((name.clone(), file.clone(), meta, measured));
        }
    }
    Ok(found)
}
