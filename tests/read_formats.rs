//! Wave files, MAT-files and tables that other programs wrote.

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
    recording.all_doubts().iter().any(|d| d.contains(word))
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
    for word in [
        "\"s\" is a struct",
        "\"c\" is a cell",
        "\"flag\" is a logical",
        "\"cube\" has 3",
        "\"none\" is empty",
    ] {
        assert!(says(&recording, word), "{word}: {:?}", recording.all_doubts());
    }
}

#[test]
fn mat_zeros_and_the_older_level() {
    let zeros = read("mat/zeros.mat");
    assert_eq!((zeros.records[0].len(), zeros.records[0].max_abs()), (131_072, Some((0, 0.0))));
    let error = Reader::new().from_path(fixture("mat/level4.mat")).unwrap_err().to_string();
    assert!(error.contains("version 4") && error.contains("-v7"), "{error}");
}
