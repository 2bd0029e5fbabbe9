//! Frequency response functions of a campaign: figures and modes.

use super::{JobOptions, Progress, file_name, merge, or_left_out, spectral};
use crate::campaign::{Campaign, FrfEntry};
use crate::error::Result;
use crate::measure::modal::{Measured, ModalOptions, ModalResult, modal};
use crate::record::{Meta, Record};
use crate::report::words::{self, Voice};
use crate::report::{Figure, Output, files, pictures, tables};
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

/// Lines that were computed, with the number of their function.
pub(super) struct Computed {
    number: usize,
    records: Vec<Record>,
}

pub(super) fn frfs(
    campaign: &Campaign,
    options: JobOptions,
    progress: &dyn Progress,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<(Vec<FrfResult>, Vec<Computed>)> {
    let (mut results, mut computed) = (Vec::new(), Vec::new());
    for own in &campaign.frf {
        let entry = own.record();
        for Function { name, file, mut meta, mut measured, records } in
            functions(campaign, own, options, progress, warnings)?
        {
            if let Some(factor) = entry.calibration.filter(|_| own.reference.is_none()) {
                meta.step("calibrate", &[("factor", &factor)]);
                measured.values.iter_mut().for_each(|v| *v *= factor);
            }
            let number = results.len() + 1;
            computed.extend(records.map(|records| Computed { number, records }));
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
            found.warnings.splice(0..0, words::sentences(&meta.findings, Voice::Campaign));
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
    Ok((results, computed))
}

/// Writes the modes of each function, and the lines of those that were computed.
pub(super) fn tables(
    results: &[FrfResult],
    computed: &[Computed],
    output: &mut Output,
    warnings: &mut Vec<String>,
) -> Result<()> {
    for (i, found) in results.iter().enumerate() {
        output.write(&format!("modes_{}.csv", i + 1), tables::modes([("", &found.modal)]).csv())?;
    }
    for lines in computed {
        warnings.extend(files::records(output, &format!("frf_{}", lines.number), &lines.records)?);
    }
    Ok(())
}

/// A function before its modes are known.
struct Function {
    name: String,
    file: String,
    meta: Meta,
    measured: Measured,
    /// Its lines and their coherence, where it was computed.
    records: Option<Vec<Record>>,
}

/// The functions of an entry: those of its file, or the one that is taken from two of its channels.
fn functions(
    campaign: &Campaign,
    own: &FrfEntry,
    options: JobOptions,
    progress: &dyn Progress,
    warnings: &mut Vec<String>,
) -> Result<Vec<Function>> {
    let entry = own.record();
    if let Some(how) = own.options().map_err(|why| campaign.at(entry.file.span(), why))? {
        let reference = own.reference.as_deref();
        let (file, found) = spectral::lines(campaign, &entry, reference, &how, options, progress)?;
        let name = entry.name.clone().unwrap_or_else(|| file.clone());
        let Some(found) = or_left_out(found, &name, warnings)? else { return Ok(Vec::new()) };
        merge(warnings, &name, &words::sentences(&found.findings, Voice::Campaign));
        merge(warnings, &name, &found.warnings);
        let records = found.records();
        let [Record::Frf(frf), Record::Spectrum(coherence)] = records.as_slice() else {
            return Ok(Vec::new());
        };
        let measured = Measured::complex(frf).with_coherence(coherence)?;
        let meta = frf.meta.clone();
        return Ok(vec![Function { name, file, meta, measured, records: Some(records) }]);
    }
    let recording = campaign.recording(&entry, options.allow_outside)?;
    let file = file_name(&recording.path);
    merge(warnings, &file, &words::sentences(&recording.findings, Voice::Campaign));
    let name = entry.name.clone().unwrap_or_else(|| file.clone());
    let coherence = match &own.coherence {
        Some(file) => {
            Some(entry.reader().from_path(campaign.beside(&entry, file, options.allow_outside)?)?)
        }
        None => None,
    };
    let all = Measured::all(&recording.records, entry.channel.as_deref())
        .map_err(|e| e.of_record(&recording.path.display().to_string()).in_file(&recording.path))?;
    let mut found = Vec::new();
    for (meta, measured) in all {
        let measured = match &coherence {
            Some(recording) => {
                measured.with_coherence_of(&recording.records).map_err(|e| e.in_file(&recording.path))
            }
            None => Ok(measured),
        };
        if let Some(measured) = or_left_out(measured, &name, warnings)? {
            let (name, file) = (name.clone(), file.clone());
            found.push(Function { name, file, meta, measured, records: None });
        }
    }
    Ok(found)
}
