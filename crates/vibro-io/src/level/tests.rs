use super::*;
use crate::reader::Reader;
use crate::recording::Recording;
use vibro_record::units::Unit;

/// A LabVIEW spectrum of 40 lines, 0.5 Hz apart, labelled as time by its writer: levels of −60 to −21 dB.
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
        // −40 dB re 1 g. Tolerance: a power and a product, each rounded.
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
    // A tenfold power is 10 dB, a tenfold amplitude 20 dB. Tolerance: powers of ten are rounded once.
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
            assert!(found.iter().any(|f| f.code == "levels-in-decibels"), "{head}{axis} {column}: {found:?}");
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
