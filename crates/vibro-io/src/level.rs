//! Detects spectra that look like something else: levels in decibels among amplitudes, spectral lines among
//! samples over time.

use crate::assemble::{short, to_si};
use crate::format::Format;
use crate::held::Contents;
use crate::options::Options;
use vibro_record::code;
use vibro_record::units::{Unit, is_level};
use vibro_record::{AxisKind, Error, Meta, Record, Result, Spectrum, Trace, Values};

/// Words in a channel's name that mean a spectrum.
const SPECTRAL: [&str; 7] = ["fft", "psd", "asd", "spectrum", "spectra", "spectral", "autospectrum"];

/// Level in dB of ten times the reference amplitude: L = 20 lg(a/a₀).
const DB_PER_DECADE_OF_AMPLITUDE: f64 = 20.0;
/// Level in dB of ten times the reference power density: L = 10 lg(p/p₀).
const DB_PER_DECADE_OF_POWER: f64 = 10.0;

/// Fewest values of a spectrum, none above 0, that count as levels in dB. With fewer values the signs may
/// be chance.
const LEAST_LEVELS: usize = 8;

/// Converts dB levels whose unit states the reference (dB re 1 g) to amplitudes, or to power densities if the
/// reference is per Hz. Refuses levels without a reference, and spectra over time.
///
/// # Errors
/// If values are probably levels and no reference is stated, or a channel over time is named as a spectrum.
pub fn levels_to_amplitudes(mut contents: Contents, format: Format, options: &Options) -> Result<Contents> {
    // Tables are exempt: their time axis is explicit. Other formats may label a spectrum's axis as time.
    let table = matches!(format, Format::Csv | Format::Ascii);
    for (record, _) in &mut contents.records {
        match record {
            Record::Trace(trace) if !table => refuse_spectrum_over_time(trace, options)?,
            Record::Trace(trace) => refuse_linear_unit(&trace.meta)?,
            Record::Spectrum(spectrum) => convert_levels(spectrum)?,
            Record::Frf(_) => {}
        }
    }
    Ok(contents)
}

/// Whether a survey, which keeps only summaries, must read the file's values in full for
/// [`levels_to_amplitudes`].
pub fn needs_values(contents: &Contents) -> bool {
    let may_be_levels = |meta: &Meta| meta.unit.reference().is_some() || is_spectral(&meta.name);
    let spectrum =
        |record: &Record| matches!(record, Record::Spectrum(Spectrum { meta, .. }) if may_be_levels(meta));
    contents.records.iter().any(|(record, summary)| summary.is_some() && spectrum(record))
}

/// Refuses a channel over time that is named as a spectrum, unless the user states its sampling rate.
fn refuse_spectrum_over_time(trace: &Trace, options: &Options) -> Result<()> {
    let stated = options.rate.is_some() && options.rate_of_band.is_none();
    if stated || !is_spectral(&trace.meta.name) || trace.axis.kind != AxisKind::Time || trace.axis.is_empty()
    {
        return Ok(());
    }
    let end = short(trace.axis.at(trace.axis.len() - 1));
    let found = format!("{:?} calls itself a spectrum, its axis is time", trace.meta.name);
    Err(Error::usage(found, "a frequency axis")
        .hint(format!("if its lines end at {end} Hz, state that base band; of a time record, state the rate"))
        .setting("base_band")
        .setting("rate"))
}

/// Whether a channel is named as a spectrum.
fn is_spectral(name: &str) -> bool {
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| SPECTRAL.contains(&word))
}

/// Converts the values of a spectrum if its unit is dB over a reference; else refuses values that are
/// probably levels.
fn convert_levels(spectrum: &mut Spectrum) -> Result<()> {
    let Values::Real(values) = &mut spectrum.values else { return Ok(()) };
    let meta = &mut spectrum.meta;
    if let Some(reference) = meta.unit.reference() {
        for level in values.iter_mut() {
            *level = above(&reference, *level);
        }
        meta.findings.retain(|found| found.code != code::LEVELS_IN_DECIBELS);
        meta.step("from_levels", &[("unit", &meta.unit.symbol().to_owned())]);
        let factor = meta.adopt_unit(reference.symbol());
        return to_si(&mut spectrum.values, factor);
    }
    refuse_linear_unit(meta)?;
    let never_positive = values.len() >= LEAST_LEVELS
        && values.iter().all(|value| *value <= 0.0)
        && values.iter().any(|v| *v < 0.0);
    if never_positive && !meta.unit.is_level() && is_spectral(&meta.name) {
        return Err(error_levels_without_reference(format!(
            "no value of {:?} is above 0: they may be levels in decibels",
            meta.name
        )));
    }
    Ok(())
}

/// Amplitude, or power density for a reference per Hz, of a level in dB over a reference of 1.
pub fn above(reference: &Unit, level: f64) -> f64 {
    let is_density = reference.symbol().ends_with("/Hz");
    10f64.powf(level / if is_density { DB_PER_DECADE_OF_POWER } else { DB_PER_DECADE_OF_AMPLITUDE })
}

/// Refuses values that the file calls levels while their unit is linear, such as m/s².
fn refuse_linear_unit(meta: &Meta) -> Result<()> {
    let words = decibels(meta).filter(|_| !meta.unit.is_level() && meta.unit.is_known());
    let Some(words) = words else { return Ok(()) };
    let found = format!("{:?} has levels ({words:?}) in the linear unit {}", meta.name, meta.unit);
    Err(error_levels_without_reference(found))
}

/// Error for levels whose reference is not stated; `found` names the channel.
fn error_levels_without_reference(found: String) -> Error {
    let hint = "state the unit with its reference, such as \"dB re 1 g\"";
    Error::usage(found, "amplitudes, or levels with their reference").hint(hint).setting("unit")
}

/// Words in a file by which its values are levels in dB: the unit, the channel's name, the line above the
/// values, or a header line about unit, scale or level. `None` if there are none.
pub fn decibels(meta: &Meta) -> Option<String> {
    if meta.unit.is_level() {
        return Some(meta.unit.symbol().to_owned());
    }
    // The line right above the values names their column.
    let above = meta.notes.last().filter(|(key, _)| key.is_empty()).map(|(_, line)| line);
    let bracketed = |name: &&String| name.split(['[', '(']).skip(1).any(is_level);
    if let Some(name) = [Some(&meta.name), above].into_iter().flatten().find(bracketed) {
        return Some(name.clone());
    }
    // dB after a number is a setting, as in `level: -20 dB`, not a unit of the values.
    let names_unit = |value: &str| {
        let words: Vec<&str> = value.split_whitespace().collect();
        let at = words.iter().position(|word| is_level(word));
        at.is_some_and(|at| at == 0 || words[at - 1].parse::<f64>().is_err())
    };
    let about = |key: &str| {
        let key = key.to_lowercase();
        !key.contains(['[', '('])
            && ["unit", "scal", "level", "axis", "amplitude", "magnitude"]
                .iter()
                .any(|word| key.contains(word))
    };
    let note = meta.notes.iter().find(|(key, value)| about(key) && names_unit(value));
    note.map(|(key, value)| format!("{key}: {value}"))
}

#[cfg(test)]
mod tests;
