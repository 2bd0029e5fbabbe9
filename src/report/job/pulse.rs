//! Contact pulses of a campaign.

use super::{JobOptions, file_name, merge, or_left_out};
use crate::campaign::{Campaign, LowPass as Stated};
use crate::error::{Error, Result};
use crate::measure::pulse::{Instrument, LowPass, PulseOptions, PulseResult, pulse, two_times};
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
        let wrong = |found: String, expected: &str| Err(Error::usage(found, expected));
        let times = own.time_to_peak.zip(own.duration);
        if own.time_to_peak.is_some() != own.duration.is_some() {
            return wrong(
                format!("only one of time_to_peak and duration is given for {called:?}"),
                "both, or none",
            );
        }
        if matches!(own.low_pass, Some(Stated::Corner(_))) != own.order.is_some() {
            return wrong(
                format!("only one of low_pass (in Hz) and order is given for the pulse {called:?}"),
                "both, or none",
            );
        }
        let (name, file, result) = match (own.record(), times) {
            (Some(_), Some(_)) => return wrong(format!("file and two times for {called:?}"), "one of them"),
            (None, None) => {
                return wrong(
                    format!("neither a file nor two times for {called:?}"),
                    "file, or time_to_peak and duration",
                );
            }
            (None, Some((peak, duration))) => {
                (called, String::new(), two_times(peak, duration, own.std, own.mass))
            }
            (Some(_), None) if own.std.is_some() => {
                return wrong(format!("std without time_to_peak and duration for {called:?}"), "both times");
            }
            (Some(entry), None) => {
                let path = campaign.record_path(&entry, options.allow_outside)?;
                let recording = entry.reader().rate_of_base_band().from_path(path)?;
                let file = file_name(&recording.path);
                merge(warnings, &file, &recording.doubts);
                let trace = recording.trace(entry.channel.as_deref(), entry.calibration)?;
                let name = entry.name.unwrap_or_else(|| file.clone());
                let instrument = match (own.low_pass, own.order) {
                    (Some(Stated::Corner(hz)), Some(order)) => Instrument::LowPass(LowPass::new(hz, order)?),
                    (Some(_), _) => Instrument::Flat,
                    (None, _) => Instrument::Unknown,
                };
                merge(warnings, &name, &trace.meta.doubts);
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
