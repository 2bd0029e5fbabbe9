//! Contact pulses of a campaign.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::Campaign;
use crate::error::Result;
use crate::measure::pulse::{PulseOptions, PulseResult, pulse, two_times};
use crate::report::words::{self, Voice};
use crate::report::{Figure, pictures};
use serde::Serialize;

/// A contact pulse of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedPulse {
    /// Name of the record.
    pub name: String,
    /// File; empty for two times.
    pub file: String,
    /// What it says.
    #[serde(flatten)]
    pub result: PulseResult,
}

pub(super) fn pulses(
    campaign: &Campaign,
    options: JobOptions,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<NamedPulse>> {
    let mut found = Vec::new();
    for (i, own) in campaign.pulse.iter().enumerate() {
        let number = i + 1;
        let called = own.name.clone().unwrap_or_else(|| format!("pulse {number}"));
        let times = own.time_to_peak.zip(own.duration);
        let (name, file, result) = match (own.record(), times) {
            (None, times) => {
                let (peak, duration) = times.unwrap_or((f64::NAN, f64::NAN));
                (called, String::new(), two_times(peak, duration, own.std, own.mass))
            }
            (Some(entry), _) => {
                let path = campaign.record_path(&entry, options.allow_outside)?;
                let recording = entry.reader().rate_of_base_band().from_path(path)?;
                let file = file_name(&recording.path);
                merge(warnings, &file, &words::sentences(&recording.findings, Voice::Campaign));
                let trace = recording.trace(entry.channel.as_deref(), entry.calibration)?;
                let name = entry.name.unwrap_or_else(|| file.clone());
                let instrument = own.instrument()?;
                merge(warnings, &name, &words::sentences(&trace.meta.findings, Voice::Campaign));
                (name, file, pulse(&trace, &PulseOptions { instrument, mass: own.mass }))
            }
        };
        let Some(result) = or_left_out(result, &name, warnings)? else { continue };
        if let Some(figure) = pictures::pulse(&name, &result) {
            figures.push((format!("pulse_{}", found.len() + 1), figure));
        }
        merge(warnings, &name, &result.warnings);
        found.push(NamedPulse { name, file, result });
    }
    Ok(found)
}
