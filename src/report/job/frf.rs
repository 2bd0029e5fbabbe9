//! Frequency response functions of a campaign: figures and peaks.

use super::{JobOptions, file_name, merge};
use crate::campaign::{Campaign, FrfEntry};
use crate::error::{Error, Result};
use crate::measure::peaks::frf_peaks;
use crate::record::{Frf, FrfKind, Record, Values};
use crate::report::{Figure, pictures};
use serde::Serialize;

/// Peaks of a frequency response function.
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
    /// Frequency in Hz and magnitude of each peak.
    pub peaks: Vec<FrfPeak>,
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// One peak of a frequency response function.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrfPeak {
    /// Frequency in Hz.
    pub frequency: f64,
    /// What the choice of the interpolating curve may cost, in Hz.
    pub frequency_std: f64,
    /// Magnitude.
    pub magnitude: f64,
}

/// A peak of a frequency response function must stand this factor above its valleys.
const FRF_PROMINENCE: f64 = 2.0;

pub(super) fn frfs(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<FrfResult>> {
    let mut results = Vec::new();
    for entry in campaign.frf.iter().map(FrfEntry::record) {
        let recording = campaign.recording(&entry, options.allow_outside)?;
        let path = &recording.path;
        merge(warnings, &file_name(path), &recording.doubts);
        let records = recording.records.into_iter();
        let wanted = records.filter(|r| entry.channel.as_ref().is_none_or(|c| *c == r.meta().name));
        let before = results.len();
        for record in wanted {
            let Some(mut frf) = as_frf(record) else { continue };
            if let Some(factor) = entry.calibration {
                frf.meta.step("calibrate", &[("factor", &factor)]);
                frf.values.iter_mut().for_each(|v| *v *= factor);
            }
            let peaks: Vec<FrfPeak> = frf_peaks(&frf, FRF_PROMINENCE)
                .iter()
                .map(|v| FrfPeak {
                    frequency: v.frequency,
                    frequency_std: v.frequency_std,
                    magnitude: v.height,
                })
                .collect();
            let marks: Vec<(f64, f64)> = peaks.iter().map(|p| (p.frequency, p.magnitude)).collect();
            let name = entry.name.clone().unwrap_or_else(|| file_name(path));
            let number = results.len() + 1;
            figures.push((format!("frf_{number}"), pictures::frf(&name, &frf, &marks)));
            merge(warnings, &name, &frf.meta.doubts);
            results.push(FrfResult {
                name,
                file: file_name(path),
                quantity: frf.meta.quantity.name(),
                unit: frf.meta.unit.symbol().to_owned(),
                peaks,
                warnings: frf.meta.doubts,
            });
        }
        if results.len() == before {
            let what = entry.channel.as_ref().map_or_else(String::new, |c| format!(" named {c:?}"));
            return Err(Error::refused(format!("{}: no frequency response function{what}", path.display()))
                .hint("`vibro info` lists what is in the file"));
        }
    }
    Ok(results)
}

/// A complex spectrum under `[[frf]]` is taken for what the campaign says it is.
fn as_frf(record: Record) -> Option<Frf> {
    match record {
        Record::Frf(frf) => Some(frf),
        Record::Spectrum(s) => match s.values {
            Values::Complex(values) => {
                let kind = FrfKind::of(s.meta.quantity);
                Some(Frf { meta: s.meta, axis: s.axis, values, kind })
            }
            Values::Real(_) => None,
        },
        Record::Trace(_) => None,
    }
}
