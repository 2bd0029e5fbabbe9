//! Universal files of other people's instruments, against the statements of their makers and other readers.
//!
//! Expected values are those of `../shared/data/README.md` in SI units. If a file is in g or inches, the
//! test contains the factor.

use super::sentences;
use std::path::{Path, PathBuf};
use vibroimpact::read::{Format, Header, Reader, Recording};
use vibroimpact::record::{Axis, Frf, Record, Scaling, Spectrum, Trace};
use vibroimpact::units::Quantity;

/// Standard acceleration of gravity in m/s².
const G: f64 = 9.806_65;

fn folder() -> Option<PathBuf> {
    crate::others_files::folder("uff")
}

/// Reads a file, and checks that a survey agrees with its records.
fn read(path: &Path) -> Recording {
    let recording = Reader::new().from_path(path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(recording.format, Format::Uff);
    let (format, headers, doubts) = Reader::new().survey(path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((format, doubts), (Format::Uff, recording.findings.clone()));
    assert_eq!(headers.len(), recording.records.len());
    for (record, header) in recording.records.iter().zip(headers) {
        let full = Header::of(record);
        // A survey scales the maximum, reading scales each value: the maxima may differ in their last bits.
        let ulps = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() <= 4.0 * f64::EPSILON * a.abs(),
            (a, b) => a == b,
        };
        assert!(ulps(full.max_abs, header.max_abs), "{full:?} against {header:?}");
        assert_eq!(Header { max_abs: None, ..full }, Header { max_abs: None, ..header });
    }
    recording
}

/// The only record of a file.
fn only(name: &str) -> Option<Record> {
    let mut records = read(&folder()?.join(name)).records;
    assert_eq!(records.len(), 1, "{name}");
    records.pop()
}

fn trace(record: Record) -> Trace {
    match record {
        Record::Trace(trace) => trace,
        other => panic!("{} is no trace", other.kind()),
    }
}

fn spectrum(record: Record) -> Spectrum {
    match record {
        Record::Spectrum(spectrum) => spectrum,
        other => panic!("{} is no spectrum", other.kind()),
    }
}

fn frf(record: Record) -> Frf {
    match record {
        Record::Frf(frf) => frf,
        other => panic!("{} is no frequency response", other.kind()),
    }
}

fn step(axis: &Axis) -> f64 {
    axis.step().expect("an even axis")
}

/// Whether `value` agrees with `expected`, printed with `digits` significant digits.
fn printed(value: f64, expected: f64, digits: i32) -> bool {
    let unit = 10f64.powi(expected.abs().log10().floor() as i32 + 1 - digits);
    (value - expected).abs() <= 0.5 * unit * (1.0 + 1e-9)
}

fn peak(record: &Record) -> (f64, f64) {
    let (i, value) = record.extremes().largest().expect("values");
    (record.axis().at(i), value)
}

#[test]
fn a_microphone_record_in_both_encodings() {
    let Some(text) = only("Sample_UFF58_ascii.uff") else { return };
    let binary = only("Sample_UFF58b_bin.uff").unwrap();
    for record in [&text, &binary] {
        assert_eq!(record.len(), 79_292);
        assert_eq!(record.meta().declared_n, Some(79_292));
        assert_eq!(record.meta().unit.symbol(), "Pa");
        assert_eq!(sentences(&record.meta().findings), Vec::<String>::new());
        assert!(printed(peak(record).1, 0.141_304, 6), "{:?}", peak(record));
        assert_eq!(step(record.axis()), 1.52588e-5);
    }
    let (text, binary) = (trace(text), trace(binary));
    for (i, (a, b)) in text.values.iter().zip(&binary.values).enumerate() {
        // Six printed digits: half a unit of 1e-6, where values reach 0.14.
        assert!((a - b).abs() <= 1e-6, "value {i}: {a} against {b}");
    }
}

#[test]
fn double_precision_in_binary() {
    let Some(record) = only("binary8byte.uff") else { return };
    let trace = trace(record);
    assert_eq!(trace.values.len(), 250);
    assert_eq!(step(&trace.axis), 0.01);
    // The unit is g. The record is named "sine 5 Hz" and has an amplitude of 1 g.
    assert_eq!(trace.meta.unit.symbol(), "m/s²");
    for (i, value) in trace.values.iter().enumerate() {
        let sine = G * (std::f64::consts::TAU * 5.0 * 0.01 * i as f64).sin();
        // The program that wrote the file summed the phase in single precision. An independent reader finds
        // deviations of up to 7.5e-6.
        assert!((value - sine).abs() <= 7.5e-6 * G, "sample {i}: {value} against {sine}");
    }
}

#[test]
fn a_density_with_a_latin1_superscript() {
    let Some(record) = only("sample_dataset58_psd.uff") else { return };
    let spectrum = spectrum(record.clone());
    assert_eq!(spectrum.scaling, Scaling::Psd);
    assert_eq!(spectrum.values.len(), 3201);
    assert!(record.is_complex());
    assert_eq!(spectrum.axis.step(), None, "the abscissa is stored as uneven");
    assert_eq!(spectrum.axis.at(3200), 3200.0);
    // The file is in g²/Hz, the record in (m/s²)²/Hz. The file prints the largest value as 4.457989E-04, the
    // reference table has 4.457988e-4.
    let (at, value) = peak(&record);
    assert!(printed(value / (G * G), 4.457_989e-4, 7), "{value} at {at} Hz");
    assert_eq!(
        spectrum.meta.unit.dimension(),
        vibroimpact::units::Unit::parse("(m/s^2)^2/Hz").unwrap().dimension()
    );
    assert_eq!(spectrum.meta.name, "Pilot 1");
}

#[test]
fn a_last_line_that_is_not_filled() {
    let Some(record) = only("time-history-not-all-columns-filled.uff") else { return };
    let trace = trace(record);
    assert_eq!(trace.values.len(), 13);
    assert_eq!(trace.values[12], -5.840_96);
    assert_eq!(step(&trace.axis), 5e-5);
    assert_eq!(trace.meta.unit.symbol(), "m/s²");
    assert_eq!(sentences(&trace.meta.findings), Vec::<String>::new());
}

#[test]
fn a_latin1_byte_in_the_unit_of_a_frequency_response() {
    let Some(record) = only("non_ascii_header.uff") else { return };
    let frf = frf(record);
    assert_eq!((frf.values.len(), step(&frf.axis)), (6, 0.195_313));
    assert_eq!(frf.meta.quantity, Quantity::Accelerance);
    assert_eq!((frf.values[1].re, frf.values[1].im), (-5.999_24e-2, -5.532_60e-2));
}

#[test]
fn a_header_line_that_ends_in_minus_one_and_a_file_cut_short() {
    let Some(record) = only("dataset_milestone_in_header.uff") else { return };
    assert_eq!(record.len(), 42);
    assert_eq!(record.meta().declared_n, Some(2_508_876));
    let doubts = sentences(&record.meta().findings).join(" ");
    assert!(doubts.contains("2508876") && doubts.contains("42"), "{doubts}");
    assert_eq!(record.axis().start(), 1.118_58e-5);
    assert!(record.meta().notes.iter().any(|(_, line)| line.ends_with("1/1 :1]")));
}

#[test]
fn wrong_line_ends_behind_binary_values() {
    let Some(folder) = folder() else { return };
    let wrong = read(&folder.join("commercial_58b_wrong_crlf.uff"));
    let repaired = read(&folder.join("commercial_58b_repaired.uff"));
    assert_eq!(wrong.records, rename(repaired.records));
    assert_eq!(sentences(&wrong.all_findings()), Vec::<String>::new());
    assert_eq!(wrong.records.len(), 4);
    for (record, max) in wrong.records.iter().zip([0.345_068, 0.436_714, 0.212_302, 0.273_485]) {
        assert_eq!(record.len(), 222_400);
        assert_eq!(step(record.axis()), 3.125e-4);
        assert_eq!(record.meta().unit.symbol(), "m/s²");
        // The second maximum is 0.43671378 by an independent reader of the bytes; the reference table has
        // 0.436734.
        assert!(printed(peak(record).1, max, 6), "{:?} against {max}", peak(record));
    }
}

/// The same records with the name of the other file in their history.
fn rename(mut records: Vec<Record>) -> Vec<Record> {
    for record in &mut records {
        for step in &mut record.meta_mut().history {
            for (key, value) in &mut step.arguments {
                if key == "file" {
                    "commercial_58b_wrong_crlf.uff".clone_into(value);
                }
            }
        }
    }
    records
}

#[test]
fn the_eight_cases_agree_in_text_and_binary() {
    let Some(folder) = folder() else { return };
    for case in 1..=8 {
        let file = |kind: &str| {
            let mut records = read(&folder.join(format!("dataset58_case{case}_{kind}.unv"))).records;
            assert_eq!(records.len(), 1);
            records.remove(0)
        };
        let (text, binary) = (file("ascii"), file("binary"));
        let (complex, double, even) = (matches!(case, 3 | 4 | 7 | 8), case > 4, case % 2 == 1);
        let n = if complex { 801 } else { 1602 };
        // Relative rounding of the text, with six or thirteen digits.
        let digits = if double { 0.5e-12 } else { 0.5e-5 };
        for record in [&text, &binary] {
            assert_eq!((record.len(), record.is_complex()), (n, complex), "case {case}");
            assert_eq!(record.axis().step(), even.then_some(0.25), "case {case}");
            assert_eq!(record.meta().unit.symbol(), "(m/s²)/N");
            let history = &record.meta().history[0].arguments;
            assert!(history.iter().any(|(k, v)| k == "case" && *v == case.to_string()), "{history:?}");
        }
        let (at, max) = peak(&text);
        if complex {
            assert!(printed(max, 5.816_975e-4, 7), "case {case}: {max} at {at}");
        }
        let numbers = |record: &Record| -> Vec<(f64, f64)> {
            match record {
                Record::Frf(frf) => frf.values.iter().map(|v| (v.re, v.im)).collect(),
                Record::Spectrum(s) => s.values.magnitudes().iter().map(|m| (*m, 0.0)).collect(),
                Record::Trace(_) => panic!("case {case} is a trace"),
            }
        };
        for (i, (a, b)) in numbers(&text).into_iter().zip(numbers(&binary)).enumerate() {
            for (a, b) in [(a.0, b.0), (a.1, b.1)] {
                // A number with the mantissa m ≥ 1 is rounded by `digits`/m of its value.
                assert!((a - b).abs() <= digits * b.abs() * 1.001, "case {case}, value {i}: {a} against {b}");
            }
            let (x, y) = (text.axis().at(i), binary.axis().at(i));
            // The abscissa has six digits in each case, and single precision in binary files.
            assert!((x - y).abs() <= (0.5e-5 + 1e-7) * y.abs(), "case {case}, abscissa {i}: {x} against {y}");
        }
    }
}

#[test]
fn a_hammer_test() {
    let Some(record) = only("dataset58_FRF.unv") else { return };
    let response = frf(record);
    assert_eq!((response.values.len(), step(&response.axis)), (1600, 0.5));
    // The file states (m/s)/N under the label "Receptance". Only its mangled copy shows that it is an
    // acceleration.
    assert_eq!(response.meta.quantity, Quantity::Mobility);
    let doubts = sentences(&response.meta.findings).join(" ");
    assert!(doubts.contains("Receptance") && doubts.contains("(m/s)/N"), "{doubts}");
    for resonance in [41.0, 62.0, 81.5, 96.5, 125.0, 140.5, 175.0] {
        let line = (resonance / 0.5) as usize;
        let at = |i: usize| response.values[i].norm();
        assert!(at(line) > at(line - 1) && at(line) > at(line + 1), "no peak at {resonance} Hz");
    }
    assert!(response.values[1599].norm() > 0.0, "zeros behind the last value are not data");

    let coherence = spectrum(only("dataset58_coh.unv").unwrap());
    assert_eq!((coherence.values.len(), step(&coherence.axis)), (1600, 0.5));
    assert_eq!(coherence.scaling, Scaling::Coherence);
    assert!(coherence.values.magnitudes().iter().all(|c| (0.0..=1.0).contains(c)));
    assert_eq!(coherence.meta.unit.symbol(), "1");

    let record = only("dataset58_time.unv").unwrap();
    let (at, value) = peak(&record);
    assert!(printed(value, 114.833, 6) && printed(at, 0.060_06, 4), "{value} N at {at} s");
    let force = trace(record);
    assert_eq!(force.values.len(), 4096);
    assert_eq!(force.meta.unit.symbol(), "N");
    assert_ne!(force.values[4095], 0.0, "zeros behind the last value are not data");
}

#[test]
fn a_mangled_superscript() {
    let Some(mangled) = only("dataset58_FRF_UTF.unv") else { return };
    let mangled = frf(mangled);
    let clean = frf(only("dataset58_FRF.unv").unwrap());
    assert_eq!((&mangled.values, &mangled.axis), (&clean.values, &clean.axis));
    assert_eq!(mangled.meta.quantity, Quantity::Accelerance);
    assert!(
        sentences(&mangled.meta.findings).iter().any(|d| d.contains("(m/s²)/N") && d.contains("mangled"))
    );
}

#[test]
fn a_spectrum_that_does_not_start_at_zero() {
    let Some(record) = only("dataset58_spectrum.unv") else { return };
    assert_eq!((record.len(), record.axis().start(), step(record.axis())), (6400, 1.25, 1.25));
    let (at, value) = peak(&record);
    assert!(printed(value, 5.177_69e-7, 6) && at == 202.5, "{value} m at {at} Hz");
    let spectrum = spectrum(record);
    assert_eq!(spectrum.meta.unit.symbol(), "m");
    assert_eq!(spectrum.scaling, Scaling::Unknown);
    assert!(sentences(&spectrum.meta.findings).iter().any(|d| d.contains("peak or RMS")));
}

#[test]
fn numbers_that_touch() {
    let Some(record) = only("dataset58_nospacing.uff") else { return };
    let trace = trace(record);
    assert_eq!((trace.values.len(), step(&trace.axis)), (66, 4.999_42e-4));
    assert_eq!(trace.values[..3], [-3.099_44e-4, -2.741_81e-4, -0.001_156_33]);
    assert_eq!(trace.values[65], -5.483_63e-4);
    assert_eq!(trace.meta.unit.symbol(), "(V^2)");
}

#[test]
fn other_data_sets_are_named() {
    let Some(folder) = folder() else { return };
    for (file, records, sets) in [
        ("dataset151_164_58_55.unv", 1, &["151 header", "164 units", "55 data at nodes"][..]),
        ("dataset58_ufb.ufb", 2, &[]),
        (
            "groups_test.uff",
            0,
            &["164 units", "2420 coordinate systems", "2411 nodes", "2412 elements", "2467 groups"],
        ),
        (
            "heat_engine_housing.uff",
            0,
            &["151 header", "164 units", "2411 nodes", "2412 elements", "2414 analysis data"],
        ),
        (
            "TestLab_161_164_18_15_82.uff",
            0,
            &["151 header", "164 units", "18 coordinate systems", "15 nodes", "3 × 82 trace lines"],
        ),
        ("dataset1858.unv", 0, &["1858 qualifiers of data set 58"]),
    ] {
        let recording = read(&folder.join(file));
        assert_eq!(recording.records.len(), records, "{file}");
        let doubts = sentences(&recording.findings).join(" ");
        for set in sets {
            assert!(doubts.contains(set), "{file}: {set:?} is not in {doubts:?}");
        }
        assert_eq!(doubts.contains("no data set 58"), records == 0, "{file}: {doubts}");
    }
}

#[test]
fn inches_and_pounds_force_become_si() {
    let Some(folder) = folder() else { return };
    let recording = read(&folder.join("dataset151_164_58_55.unv"));
    let frf = frf(recording.records[0].clone());
    assert_eq!((frf.values.len(), step(&frf.axis)), (10, 0.25));
    assert_eq!(frf.meta.quantity, Quantity::Accelerance);
    // in/s² over lbf, with the factors that the file prints.
    let factor = 0.224_808_943_099_710_5 / 39.370_078_740_157_48;
    assert!((frf.values[0].re / (1.733_31e-4 * factor) - 1.0).abs() < 1e-12, "{}", frf.values[0]);
}

#[test]
fn binary_records_under_their_points() {
    let Some(folder) = folder() else { return };
    let recording = read(&folder.join("dataset58_ufb.ufb"));
    let names: Vec<&str> = recording.records.iter().map(|r| r.meta().name.as_str()).collect();
    assert_eq!(names, ["1+X / 22+X", "1+Y / 22+X"]);
    assert!(printed(peak(&recording.records[0]).1, 5.816_975e-4, 7));
}

#[test]
fn every_file_can_be_read() {
    let Some(folder) = folder() else { return };
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| ["uff", "unv", "ufb"].iter().any(|k| e == *k)) {
            read(&path);
            files += 1;
        }
    }
    assert!(files >= 37, "only {files} files: is ../shared/data whole?");
}
