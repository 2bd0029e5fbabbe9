//! Spectra that are mistaken for something else: levels in decibels for amplitudes, spectral lines for
//! samples over time.

use crate::assemble::{short, to_si};
use crate::format::Format;
use crate::held::Contents;
use crate::options::Options;
use vibro_record::code;
use vibro_record::units::is_level;
use vibro_record::{AxisKind, Error, Meta, Record, Result, Spectrum, Trace, Values};

/// Words by which a channel calls itself a spectrum.
const SPECTRAL: [&str; 7] = ["fft", "psd", "asd", "spectrum", "spectra", "spectral", "autospectrum"];

/// Level difference in dB of ten times the amplitude, and of ten times the power density.
const AMPLITUDE: f64 = 20.0;
const POWER: f64 = 10.0;

/// Fewest values, none above 0, that are taken for levels in dB: fewer may be chance.
const FEW: usize = 8;

/// Converts levels over the reference that their unit states to amplitudes, or to densities where the
/// reference is per Hz.
///
/// # Errors
/// If a channel calls itself a spectrum over time, or levels have a linear unit.
pub fn settle(mut contents: Contents, format: Format, options: &Options) -> Result<Contents> {
    // A table has a column of times, or the user states its rate.
    let table = matches!(format, Format::Csv | Format::Ascii);
    for (record, _) in &mut contents.records {
        match record {
            Record::Trace(trace) if !table => no_spectrum(trace, options)?,
            Record::Trace(trace) => linear(&trace.meta)?,
            Record::Spectrum(spectrum) => amplitudes(spectrum)?,
            Record::Frf(_) => {}
        }
    }
    Ok(contents)
}

/// Whether [`settle`] needs values that were not kept.
pub fn needs_values(contents: &Contents) -> bool {
    let counts = |meta: &Meta| meta.unit.reference().is_some() || is_spectral(&meta.name);
    let spectrum =
        |record: &Record| matches!(record, Record::Spectrum(Spectrum { meta, .. }) if counts(meta));
    contents.records.iter().any(|(record, ends)| ends.is_some() && spectrum(record))
}

/// Refuses a channel named as a spectrum over time, unless the user states its sampling rate.
fn no_spectrum(trace: &Trace, options: &Options) -> Result<()> {
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

fn is_spectral(name: &str) -> bool {
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| SPECTRAL.contains(&word))
}

fn amplitudes(spectrum: &mut Spectrum) -> Result<()> {
    let Values::Real(values) = &mut spectrum.values else { return Ok(()) };
    let meta = &mut spectrum.meta;
    if let Some(reference) = meta.unit.reference() {
        let tenfold = if reference.symbol().ends_with("/Hz") { POWER } else { AMPLITUDE };
        for level in values.iter_mut() {
            *level = 10f64.powf(*level / tenfold);
        }
        meta.findings.retain(|found| found.code != code::LEVELS_IN_DECIBELS);
        meta.step("from_levels", &[("unit", &meta.unit.symbol().to_owned())]);
        let factor = meta.adopt_unit(reference.symbol());
        return to_si(&mut spectrum.values, factor);
    }
    linear(meta)?;
    let below =
        values.len() >= FEW && values.iter().all(|value| *value <= 0.0) && values.iter().any(|v| *v < 0.0);
    if below && !meta.unit.is_level() && is_spectral(&meta.name) {
        return Err(levels(format!(
            "no value of {:?} is above 0: they may be levels in decibels",
            meta.name
        )));
    }
    Ok(())
}

/// Refuses levels in a linear unit.
fn linear(meta: &Meta) -> Result<()> {
    let words = decibels(meta).filter(|_| !meta.unit.is_level() && meta.unit.is_known());
    let Some(words) = words else { return Ok(()) };
    Err(levels(format!("{:?} has levels ({words:?}) in the linear unit {}", meta.name, meta.unit)))
}

fn levels(found: String) -> Error {
    let hint = "state the unit with its reference, such as \"dB re 1 g\"";
    Error::usage(found, "amplitudes, or levels with their reference").hint(hint).setting("unit")
}

/// The words by which a file says that its values are levels: their unit, or a header line about unit, scale
/// or level.
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
    // A number before the word makes it a setting, as in `level: -20 dB`.
    let states = |value: &str| {
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
    let note = meta.notes.iter().find(|(key, value)| about(key) && states(value));
    note.map(|(key, value)| format!("{key}: {value}"))
}

#[cfg(test)]
mod tests;
