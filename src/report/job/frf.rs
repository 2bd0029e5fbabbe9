//! Frequency response functions of a campaign: figures and modes.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::Campaign;
use crate::error::Result;
use crate::measure::modal::{Measured, ModalOptions, ModalResult, modal};
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
        let recording = campaign.recording(&entry, options.allow_outside)?;
        let path = &recording.path;
        merge(warnings, &file_name(path), &recording.doubts);
        let name = entry.name.clone().unwrap_or_else(|| file_name(path));
        let coherence = match &own.coherence {
            Some(file) => {
                Some(entry.reader().from_path(campaign.beside(&entry, file, options.allow_outside)?)?)
            }
            None => None,
        };
        for (mut meta, measured) in Measured::all(&recording, entry.channel.as_deref())? {
            let measured = match &coherence {
                Some(recording) => measured.with_coherence_of(recording),
                None => Ok(measured),
            };
            let Some(mut measured) = or_left_out(measured, &name, warnings)? else { continue };
            if let Some(factor) = entry.calibration {
                meta.step("calibrate", &[("factor", &factor)]);
                measured.values.iter_mut().for_each(|v| *v *= factor);
            }
            let number = results.len() + 1;
            let wanted = ModalOptions {
                band: own.band,
                mass: own.mass,
                decay: meta.added_decay(),
                ..ModalOptions::default()
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
                file: file_name(path),
                quantity: meta.quantity.name(),
                unit: meta.unit.symbol().to_owned(),
                modal: found,
            });
        }
    }
    Ok(results)
}
