//! Contact pulses of a campaign.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::pulse::{LowPass, PulseOptions, PulseResult, pulse};
use crate::report::{Figure, pictures};
use serde::Serialize;

/// A contact pulse of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedPulse {
    /// Name of the record.
    pub name: String,
    /// File.
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
    for own in &campaign.pulse {
        let entry = own.record();
        let recording = campaign.recording(&entry, options.allow_outside)?;
        let file = file_name(&recording.path);
        merge(warnings, &file, &recording.doubts);
        let trace = recording.trace(entry.channel.as_deref(), entry.calibration)?;
        let name = entry.name.clone().unwrap_or_else(|| file.clone());
        if own.low_pass.is_some() != own.order.is_some() {
            let found = format!("only one of low_pass and order is given for the pulse {name:?}");
            return Err(Error::usage(found, "both, or none"));
        }
        let low_pass = own.low_pass.zip(own.order).map(|(hz, n)| LowPass::new(hz, n)).transpose()?;
        let result = pulse(&trace, &PulseOptions { low_pass, mass: own.mass });
        let Some(mut result) = or_left_out(result, &name, warnings)? else { continue };
        result.warnings.splice(0..0, trace.meta.doubts.iter().cloned());
        if let Some(figure) = pictures::pulse(&name, &result) {
            figures.push((format!("pulse_{}", found.len() + 1), figure));
        }
        merge(warnings, &name, &result.warnings);
        found.push(NamedPulse { name, file, result });
    }
    Ok(found)
}
