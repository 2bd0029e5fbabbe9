//! From what was typed to what is meant: checked options.

use super::args::{Channel, Decimal, Finding, Reading, Sweep, Taking};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::impacts::ImpactsOptions;
use crate::measure::response::{ResponseOptions, to_displacement};
use crate::read::{Format, Reader, SweepList, SweepReader};
use crate::record::Traces;
use crate::record::{Scaling, Trace, Window};
use crate::report::words::{self, Voice};
use crate::units::{Quantity, Unit};
use std::path::Path;

/// A reader with the options of a file.
///
/// # Errors
/// On an unknown format or unit, and on rates that are not above 0.
pub fn reader(typed: &Reading) -> Result<Reader> {
    let format = typed.format.as_deref().map(format).transpose()?;
    let unit = typed.unit.as_deref().map(unit).transpose()?;
    let decimal_comma = typed.decimal.map(|d| d == Decimal::Comma);
    above_zero("--rate", typed.rate)?;
    above_zero("--base-band", typed.base_band)?;
    Ok(Reader::new()
        .format(format)
        .allow_missing(typed.allow_missing)
        .rate(typed.rate)
        .base_band(typed.base_band)
        .unit(unit)
        .decimal_comma(decimal_comma)
        .complex(typed.complex))
}

/// A reader of time records, of which `--base-band` gives the sampling rate.
///
/// # Errors
/// As [`reader`].
pub fn time_reader(typed: &Reading) -> Result<Reader> {
    Ok(reader(typed)?.rate_of_base_band())
}

/// How impacts are found; `threshold` where none was typed.
pub fn finding(typed: &Finding, threshold: Option<f64>) -> ImpactsOptions {
    let default = ImpactsOptions::default();
    ImpactsOptions {
        threshold: typed.threshold.or(threshold).unwrap_or(default.threshold),
        refractory: typed.refractory,
        hum: !typed.keep_hum,
        ..default
    }
}

/// The trace that is meant, and the sentences about it and its file.
///
/// # Errors
/// As [`reader`]; if the file cannot be read or has no such trace.
pub fn trace(file: &Path, reading: &Reading, chosen: &Channel) -> Result<(Trace, Vec<String>)> {
    let recording = time_reader(reading)?.from_path(file)?;
    let trace = recording.trace(chosen.channel.as_deref(), chosen.calibration)?;
    let findings = [recording.findings.as_slice(), &trace.meta.findings].concat();
    Ok((trace, words::sentences(&findings, Voice::Command)))
}

/// The channel that is meant, block by block, behind the channel `reference` where there is one.
///
/// # Errors
/// As [`reader`]; if there is no such channel, or several and none was chosen.
pub fn traces(file: &Path, reading: &Reading, chosen: &Channel, reference: Option<&str>) -> Result<Traces> {
    time_reader(reading)?.stream_chosen(file, reference, chosen.channel.as_deref(), chosen.calibration)
}

fn format(name: &str) -> Result<Format> {
    Format::from_name(name)
        .ok_or_else(|| Error::usage(format!("--format {name:?} is not known"), Format::names().join(", ")))
}

fn unit(text: &str) -> Result<Unit> {
    Unit::parse(text).ok_or_else(|| {
        Error::usage(
            format!("--unit {text:?} is not understood"),
            "a unit such as m, mm/s, g, m/s², V, (m/s²)/N",
        )
    })
}

/// Checks a number that must be finite and above 0.
///
/// # Errors
/// If it is not.
pub fn above_zero(name: &str, value: Option<f64>) -> Result<()> {
    match value {
        Some(v) if !(v.is_finite() && v > 0.0) => {
            Err(Error::usage(format!("{name} is {v}"), "a finite number above 0"))
        }
        _ => Ok(()),
    }
}

/// The list of a sweep, how to read it, and how to take its response to displacement.
///
/// # Errors
/// On options that contradict each other, an unknown name, or a list that cannot be read.
pub fn sweep(typed: &Sweep) -> Result<(SweepList, SweepReader)> {
    let (path, name) = match typed.source.rsplit_once('#') {
        Some((path, name)) if path.to_lowercase().ends_with(".toml") => (path, Some(name)),
        _ => (typed.source.as_str(), None),
    };
    let (list, mut how) = if path.to_lowercase().ends_with(".toml") {
        let campaign = Campaign::from_path(path)?;
        campaign.sweep(name, typed.allow_outside)?
    } else {
        (SweepList::from_path(path, typed.allow_outside)?, SweepReader::default())
    };
    if how.name.is_empty() {
        how.name = Path::new(path).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    }
    above_zero("--fmin", typed.fmin)?;
    if let Some(text) = &typed.unit {
        let unit = unit(text)?;
        let motion = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration];
        if !motion.contains(&unit.quantity()) {
            let found = format!("--unit {text:?} is a unit of {}", unit.quantity());
            return Err(Error::usage(found, "a unit of displacement, velocity or acceleration"));
        }
        let stated = how.quantity.or(how.unit.as_ref().map(Unit::quantity));
        if let Some(stated) = stated.filter(|s| *s != unit.quantity()) {
            let found = format!("--unit {text:?}, but the campaign says {stated}");
            return Err(Error::usage(found, "a unit of the same quantity"));
        }
        how.unit = Some(unit);
    }
    if let Some(factor) = typed.calibration {
        above_zero("--calibration", Some(factor))?;
        how.calibration = Some(factor);
    }
    if let Some(name) = &typed.window {
        how.window = Some(window(name)?);
    }
    if let Some(name) = &typed.scaling {
        how.scaling = Some(scaling(name)?);
    }
    how.analyser_integrated = typed.analyser_integrated.or(how.analyser_integrated);
    Ok((list, how))
}

/// A window by name, `None` for `unknown`.
///
/// # Errors
/// On any other name.
pub fn window(name: &str) -> Result<Option<Window>> {
    if name.eq_ignore_ascii_case("unknown") {
        return Ok(None);
    }
    Window::from_name(name).map(Some).ok_or_else(|| {
        let names: Vec<_> = Window::ALL.iter().map(|w| w.name()).collect();
        Error::usage(format!("window {name:?} is not known"), format!("{} or unknown", names.join(", ")))
    })
}

pub fn scaling(name: &str) -> Result<Scaling> {
    match name.to_lowercase().as_str() {
        "peak" => Ok(Scaling::Peak),
        "rms" => Ok(Scaling::Rms),
        _ => Err(Error::usage(format!("--scaling {name:?} is not known"), "peak or rms")),
    }
}

/// How responses are taken; the stored quantity decides how often to integrate where that was not typed.
pub fn taking(typed: &Taking, fmin: Option<f64>, stored: Quantity) -> ResponseOptions {
    ResponseOptions {
        band: usize::from(typed.band),
        integrate: typed.integrate.unwrap_or_else(|| to_displacement(stored)),
        fmin,
    }
}
