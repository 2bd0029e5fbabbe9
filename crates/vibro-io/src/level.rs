//! Spectra that pass for something else: levels in decibels that pass for amplitudes, lines that pass for
//! samples over time.

use crate::assemble::{short, to_si};
use crate::held::Contents;
use crate::{Format, Options};
use vibro_record::code;
use vibro_record::units::is_level;
use vibro_record::{AxisKind, Error, Meta, Record, Result, Spectrum, Trace, Values};

/// Words by which a channel calls itself a spectrum.
const SPECTRAL: [&str; 7] = ["fft", "psd", "asd", "spectrum", "spectra", "spectral", "autospectrum"];

/// Levels in dB that make a factor of ten: of an amplitude, and of a density of power.
const AMPLITUDE: f64 = 20.0;
const POWER: f64 = 10.0;

/// Fewest values of which none is above 0 that are no chance.
const FEW: usize = 8;

/// Levels over a reference that the unit states become amplitudes, or densities where it is one.
///
/// # Errors
/// If a channel calls itself a spectrum over time, or levels have a linear unit.
pub fn settle(mut contents: Contents, format: Format, options: &Options) -> Result<Contents> {
    // A table has a column of times, or a person says its rate.
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

/// Whether values that were not kept are needed to settle it.
pub fn needs_values(contents: &Contents) -> bool {
    let counts = |meta: &Meta| meta.unit.reference().is_some() || is_spectral(&meta.name);
    let spectrum =
        |record: &Record| matches!(record, Record::Spectrum(Spectrum { meta, .. }) if counts(meta));
    contents.records.iter().any(|(record, ends)| ends.is_some() && spectrum(record))
}

/// Refuses a spectrum over "time", unless a person states its sampling rate.
fn no_spectrum(trace: &Trace, options: &Options) -> Result<()> {
    let stated = options.rate.is_some() && !options.rate_of_band;
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

/// The words by which a file says that its values are levels: their unit, or a header line that states unit,
/// scale or level.
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
mod tests {
    use super::*;
    use crate::{Reader, Recording};
    use vibro_record::units::Unit;

    /// A LabVIEW spectrum of 40 lines, 0.5 Hz apart, which its writer calls a time: levels of −60 to −21 dB.
    fn labview(name: &str) -> String {
        let rows = (0..40).map(|i| format!("\t{}\n", i - 60)).collect::<Vec<_>>().concat();
        let head = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\nChannels\t1\n";
        let axis = "Y_Unit_Label\tg\nX_Dimension\tTime\nX0\t0\nDelta_X\t0.5\n***End_of_Header***\n";
        format!("{head}{axis}X_Value\t{name}\tComment\n{rows}")
    }

    fn read(reader: &Reader, name: &str) -> Result<Recording> {
        reader.from_reader("x.lvm", labview(name).as_bytes())
    }

    #[test]
    fn a_spectrum_over_time_in_decibels_is_read_when_both_are_stated() {
        let name = "Acceleration (FFT - (RMS))";
        let said = read(&Reader::new(), name).unwrap_err();
        assert!(said.settings().eq(["base_band", "rate"]), "{said}");
        let said = read(&Reader::new().base_band(Some(19.5)), name).unwrap_err();
        assert!(said.settings().eq(["unit"]), "{said}");
        let unit = Unit::parse_or_level("dB re 1 g");
        for band in [19.5, 20.0] {
            let read = read(&Reader::new().base_band(Some(band)).unit(unit.clone()), name).unwrap();
            let Record::Spectrum(spectrum) = &read.records[0] else { panic!("{read:?}") };
            let Values::Real(values) = &spectrum.values else { panic!("{spectrum:?}") };
            assert_eq!((spectrum.meta.unit.symbol(), spectrum.axis.step()), ("m/s²", Some(0.5)));
            // −40 dB re 1 g; a power and a product, each rounded.
            assert!((values[20] / 0.098_066_5 - 1.0).abs() < 1e-14, "{}", values[20]);
            assert!(spectrum.meta.findings.iter().all(|found| found.code != "levels-in-decibels"));
        }
    }

    #[test]
    fn a_base_band_is_used_or_said_not_to_be() {
        let read = read(&Reader::new().base_band(Some(50.0)), "Acceleration").unwrap();
        assert!(matches!(read.records[0], Record::Trace(_)));
        assert!(read.all_findings().iter().any(|found| found.code == "band-unused"));
    }

    #[test]
    fn a_stated_rate_makes_any_name_a_trace() {
        let read = read(&Reader::new().rate(Some(2.0)), "PSD sensor").unwrap();
        assert!(matches!(read.records[0], Record::Trace(_)));
    }

    #[test]
    fn densities_of_power_and_levels_in_linear_units() {
        let text = |unit: &str| format!("frequency [Hz],a [{unit}]\n1,-20\n2,-10\n3,10\n");
        let read = |unit: &str| Reader::new().from_reader("x.csv", text(unit).as_bytes());
        let values = |unit: &str| match read(unit).unwrap().records.remove(0) {
            Record::Spectrum(Spectrum { values: Values::Real(values), .. }) => values,
            other => panic!("{other:?}"),
        };
        // A tenfold power is 10 dB, a tenfold amplitude 20 dB; powers of ten are rounded once.
        for (found, expected) in values("dB re 1 (m/s²)²/Hz").iter().zip([0.01, 0.1, 10.0]) {
            assert!((found / expected - 1.0).abs() < 1e-15, "{found}");
        }
        for (found, expected) in values("dB re 1 m/s").iter().zip([0.1, 0.1f64.sqrt(), 10f64.sqrt()]) {
            assert!((found / expected - 1.0).abs() < 1e-15, "{found}");
        }
        assert_eq!(values("dB"), [-20.0, -10.0, 10.0]);
    }

    #[test]
    fn levels_of_names_and_of_the_head_are_levels() {
        let rows =
            (0..30).map(|i| format!("{},{}\n", 0.1 * f64::from(i), 60 + i % 7)).collect::<Vec<_>>().concat();
        for (head, column) in
            [("magnitude scale: dB\n", "level"), ("", "Lp_dB"), ("", "Lp (dB)"), ("", "LAeq_dBA")]
        {
            for axis in ["time (s)", "frequency (Hz)"] {
                let text = format!("{head}{axis},{column}\n{rows}");
                let read = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
                let found = read.all_findings();
                assert!(
                    found.iter().any(|f| f.code == "levels-in-decibels"),
                    "{head}{axis} {column}: {found:?}"
                );
            }
        }
        let text = format!("magnitude scale: dB\ntime (s),level (Pa)\n{rows}");
        let why = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap_err().to_string();
        assert!(why.contains("levels") && why.contains("linear unit"), "{why}");
    }

    fn of(unit: &str, name: &str, key: &str, value: &str) -> Option<String> {
        let mut meta = Meta::new(name, Unit::parse_or_opaque(unit));
        meta.notes.push((key.to_owned(), value.to_owned()));
        decibels(&meta)
    }

    #[test]
    fn units_and_statements_of_levels() {
        for (unit, name, key, value) in [
            ("dB", "", "", ""),
            ("dBV", "", "", ""),
            ("", "amplitude [dB re 1 m/s]", "", ""),
            ("m/s", "v (dB)", "", ""),
            ("", "", "", "Level (dB)"),
            ("", "", "Y axis", "dB"),
            ("", "", "scale", "log dB"),
            ("", "", "Y_unit", "dB re 1e-9 m/s"),
            ("", "", "LEVEL", "Decibels"),
        ] {
            let said = of(unit, name, key, value);
            assert!(said.is_some(), "{unit} {name} {key} {value}: {said:?}");
        }
    }

    #[test]
    fn settings_in_decibels_and_paths_are_no_levels() {
        for (key, value) in [
            ("gain", "20 dB"),
            ("gain [dB]", "20"),
            ("Level", "-20 dB"),
            ("Window", "flat top (-93 dB)"),
            ("File", "/data/db/run1.dat"),
            ("Filter slope", "dB/octave, 12"),
            ("", "adb"),
            ("", "range dB = 10"),
        ] {
            assert_eq!(of("m/s", "v", key, value), None, "{key}: {value}");
        }
    }
}
