//! Wave files, MAT-files and tables written by other programs.

use super::sentences;
use crate::others_files;
use std::path::PathBuf;
use vibroimpact::read::{Format, Reader, Recording};
use vibroimpact::record::{Axis, AxisKind, Record, Values};

fn fixture(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "fixtures", name].iter().collect()
}

fn read(name: &str) -> Recording {
    Reader::new().from_path(fixture(name)).unwrap()
}

fn record<'a>(recording: &'a Recording, name: &str) -> &'a Record {
    recording.records.iter().find(|r| r.meta().name == name).unwrap_or_else(|| panic!("no {name}"))
}

fn values(recording: &Recording, name: &str) -> Vec<f64> {
    match record(recording, name) {
        Record::Trace(t) => t.values.clone(),
        other => panic!("{other:?}"),
    }
}

fn says(recording: &Recording, word: &str) -> bool {
    sentences(&recording.all_findings()).iter().any(|d| d.contains(word))
}

#[test]
fn mat_every_class() {
    let recording = read("mat/kinds.mat");
    assert_eq!((recording.format, recording.records.len()), (Format::Mat, 10));
    for kind in ["int8", "int16", "int32", "int64", "float32", "float64"] {
        assert_eq!(values(&recording, &format!("x_{kind}")), [-1.0, 0.0, 1.0, 2.0, 100.0], "{kind}");
    }
    for kind in ["uint8", "uint16", "uint32", "uint64"] {
        assert_eq!(values(&recording, &format!("x_{kind}")), [0.0, 1.0, 2.0, 100.0, 200.0], "{kind}");
    }
}

#[test]
fn mat_packed_or_not() {
    let (plain, packed) = (read("mat/plain.mat"), read("mat/packed.mat"));
    for recording in [&plain, &packed] {
        let names: Vec<&str> = recording.records.iter().map(|r| r.meta().name.as_str()).collect();
        assert_eq!(names, ["velocity", "pair(:,1)", "pair(:,2)", "frf"]);
        assert_eq!(values(recording, "velocity"), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
        assert_eq!(values(recording, "pair(:,2)"), [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0]);
        assert_eq!(record(recording, "velocity").axis(), &Axis::time(0.0, 1e-3, 6));
        assert!(recording.records[0].meta().notes.contains(&("rig".into(), "two masses".into())));
        let Record::Spectrum(frf) = record(recording, "frf") else { panic!() };
        let Values::Complex(frf) = &frf.values else { panic!() };
        let parts: Vec<(f64, f64)> = frf.iter().map(|v| (v.re, v.im)).collect();
        assert_eq!(parts, [(1.0, 2.0), (3.0, -4.0), (0.0, 0.5)]);
    }
}

#[test]
fn mat_time_vector_and_rows_as_channels() {
    let recording = read("mat/time.mat");
    assert_eq!(recording.records.len(), 3);
    assert_eq!(record(&recording, "a").axis(), &Axis::time(1.0, 1.0 / 512.0, 6));
    assert_eq!(values(&recording, "lying(2,:)"), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
}

#[test]
fn mat_what_is_passed_over_is_named() {
    let recording = read("mat/passed_over.mat");
    assert_eq!(recording.records.len(), 1);
    assert_eq!(recording.records[0].axis().kind, AxisKind::Index);
    // The contents of the struct and of the cell array.
    let notes =
        [("s.a", "1"), ("c{1}", "a"), ("c{2}", "1")].map(|(of, said)| (of.to_owned(), said.to_owned()));
    assert_eq!(recording.records[0].meta().notes, notes);
    for word in ["\"flag\" is a logical", "\"cube\" has 3", "\"none\" is empty"] {
        assert!(says(&recording, word), "{word}: {:?}", sentences(&recording.all_findings()));
    }
}

#[test]
fn mat_zeros_and_the_older_level() {
    let zeros = read("mat/zeros.mat");
    assert_eq!((zeros.records[0].len(), zeros.records[0].extremes().largest()), (131_072, Some((0, 0.0))));
    let level4 = read("mat/level4.mat");
    assert_eq!((level4.format, values(&level4, "x")), (Format::Mat, vec![1.0, 2.0]));
}

#[test]
fn wav_from_another_program() {
    let float = read("wav/float64.wav");
    assert_eq!((float.format, float.records.len()), (Format::Wav, 2));
    let sixteenths: Vec<f64> = (0..16).map(|k| f64::from(k) / 16.0).collect();
    assert_eq!(values(&float, "channel 1"), sixteenths);
    assert_eq!(values(&float, "channel 2")[15], -15.0 / 32.0);
    assert_eq!(float.records[0].axis(), &Axis::time(0.0, 1.0 / 51_200.0, 16));
    assert!(says(&float, "No calibration is known"));
    let bytes = read("wav/uint8.wav");
    // Stored values are 0, 16, …, 240 around 128.
    assert_eq!(values(&bytes, "channel 1")[..2], [-1.0, -0.875]);
}

#[test]
fn wav_that_declares_more_than_it_holds() {
    let cut = read("wav/rf64_cut_off_int24.wav");
    let expected: Vec<f64> = (0..16).map(|k| f64::from(k) / 8_388_608.0).collect();
    assert_eq!(values(&cut, "channel 1"), expected);
    assert_eq!(cut.records[0].meta().declared_n, Some(3_333_333_333));
    assert!(
        says(&cut, "declares 3333333333 values") && says(&cut, "holds 16"),
        "{:?}",
        sentences(&cut.all_findings())
    );
}

/// Eight values of a quarter of the row number times `scale`.
fn quarters(scale: f64) -> Vec<f64> {
    (0..8).map(|k| f64::from(k) * 0.25 * scale).collect()
}

#[test]
fn csv_in_every_encoding_and_line_end() {
    for (name, column, unit, scale) in [
        ("csv/german_spreadsheet_utf16.csv", "Weg", "m", 1e-6),
        ("csv/units_in_second_row_latin1.csv", "Channel B", "m/s²", -1.0),
        ("csv/units_in_second_row_latin1.csv", "Channel A", "V", 1e-3),
        ("csv/old_mac_line_ends.csv", "x", "m", 1e-3),
    ] {
        let recording = read(name);
        assert_eq!(recording.format, Format::Csv, "{name}");
        let found = values(&recording, column);
        for (a, b) in found.iter().zip(quarters(scale)) {
            // The product may be rounded before or after the conversion.
            assert!((a - b).abs() <= f64::EPSILON * b.abs(), "{name}: {a} {b}");
        }
        assert_eq!(found.len(), 8);
        let record = record(&recording, column);
        assert_eq!(record.meta().unit.symbol(), unit);
        let step = record.axis().step().unwrap();
        assert!((step / 1e-3 - 1.0).abs() < 4.0 * f64::EPSILON, "{name}: {step}");
        assert!(
            sentences(&recording.all_findings()).is_empty(),
            "{name}: {:?}",
            sentences(&recording.all_findings())
        );
    }
    let german = read("csv/german_spreadsheet_utf16.csv");
    assert_eq!(german.records[0].meta().notes[0], ("Messung".to_owned(), "Prüfstand 2".to_owned()));
}

#[test]
fn csv_times_with_too_few_digits() {
    let recording = read("csv/times_with_too_few_digits.tsv");
    let step = recording.records[0].axis().step().unwrap();
    // Both ends are rounded by at most half a millisecond.
    assert!((step - 1.0 / 1024.0).abs() <= 1e-3 / 99.0, "{step}");
    assert!(says(&recording, "too few digits"), "{:?}", sentences(&recording.all_findings()));
}

#[test]
fn csv_complex_columns() {
    let recording = read("csv/complex_trailing_commas.csv");
    let [Record::Frf(frf)] = recording.records.as_slice() else { panic!("{:?}", recording.records) };
    assert_eq!((frf.meta.name.as_str(), frf.meta.unit.symbol()), ("H", "(m/s²)/N"));
    assert_eq!(frf.axis, Axis::frequency(0.0, 0.5, 3));
    let parts: Vec<(f64, f64)> = frf.values.iter().map(|v| (v.re, v.im)).collect();
    assert_eq!(parts, [(1.0, 0.0), (2.0, -1.0), (3.0, -2.5)]);
}

#[test]
fn csv_faults_are_named_with_their_lines() {
    let error = |name: &str| Reader::new().from_path(fixture(name)).unwrap_err().to_string();
    let missing = error("csv/missing_values.csv");
    assert!(missing.contains("line 3: 3 missing values"), "{missing}");
    assert!(
        missing.contains("3 (\"a\"), 4 (\"a\"), 5 (\"b\")") && missing.contains("allow_missing"),
        "{missing}"
    );
    let cut = error("csv/row_cut_off.csv");
    assert!(cut.contains("line 4, column 3: 1 field in") && cut.contains("cut off"), "{cut}");
    let kept = Reader::new().allow_missing(true).from_path(fixture("csv/missing_values.csv")).unwrap();
    assert_eq!(values(&kept, "a").iter().filter(|v| v.is_nan()).count(), 2);
    assert_eq!(kept.records[1].extremes().largest(), Some((4, 6.0 * 9.806_65)));
}

#[test]
fn csv_quoted_names_and_numbers() {
    let recording = read("csv/quoted.csv");
    assert_eq!(values(&recording, "speed \"laser\""), [1.5 * 1e-3, 2.5 * 1e-3]);
    assert_eq!(recording.records[0].axis(), &Axis::time(0.0, 0.1, 2));
    let recording = read("csv/quoted_scientific.csv");
    assert!(sentences(&recording.findings).is_empty(), "{:?}", sentences(&recording.findings));
    let expected: Vec<f64> = (0..24).map(|k| -f64::from(k) / 4.0 * 1e-3).collect();
    assert_eq!(values(&recording, "v"), expected);
}

/// Plain numbers exported by analysers are not taken for named columns.
#[test]
fn plain_exports_stay_plain() {
    let Some(folder) = others_files::folder("analyser") else { return };
    for k in 1..=3 {
        let recording = Reader::new().from_path(folder.join(format!("accelerance_point_{k}.txt"))).unwrap();
        assert_eq!(recording.format, Format::Ascii);
    }
}
