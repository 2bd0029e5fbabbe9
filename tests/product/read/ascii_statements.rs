//! What a header or the user states about analyser text: abscissa, unit, names.

use super::ascii_rows::{complaint, read, values};
use super::sentences;
use crate::others_files;
use proptest::prelude::*;
use vibroimpact::read::{Format, Reader, Recording};
use vibroimpact::record::{AxisKind, Record};
use vibroimpact::units::Unit;

fn told(reader: &Reader, text: &str) -> Recording {
    reader.from_reader("x.txt", text.as_bytes()).unwrap_or_else(|e| panic!("{text:?}: {e}"))
}

fn says(recording: &Recording, words: &[&str]) -> bool {
    sentences(&recording.all_findings()).iter().any(|d| words.iter().all(|w| d.contains(w)))
}

/// Kind of the axis and its step.
fn axis(recording: &Recording) -> (&AxisKind, Option<f64>) {
    let axis = recording.records[0].axis();
    (&axis.kind, axis.step())
}

#[test]
fn impossible_statements_are_passed_over() {
    for header in [
        "Base band: 20 Hz\nLines: 1e30",
        "20 Hz inf lines",
        "20 Hz 0 lines",
        "20 Hz -400 lines",
        "dt: 1e-320",
        "df: nan",
    ] {
        let recording = read(format!("{header}\n1\n2\n3\n").as_bytes());
        let step = recording.records[0].axis().step().unwrap();
        assert!(step.is_finite() && step > 0.0, "{header}: {step}");
    }
}

#[test]
fn what_else_a_header_names_makes_no_spectrum() {
    let band = read(b"Sample rate: 50 kHz\nBandwidth: 20 kHz\nResolution: 16\n1\n2\n3\n");
    assert_eq!(axis(&band), (&AxisKind::Time, Some(1.0 / 50e3)));
    // The header states both domains: the values are a time trace, and a finding reports it.
    let both = read(b"Sampling rate: 100 Hz\nBase band: 20 Hz\n1\n2\n3\n");
    assert_eq!(axis(&both), (&AxisKind::Time, Some(0.01)));
    assert!(says(&both, &["100 Hz", "time trace"]), "{:?}", sentences(&both.all_findings()));
    // One value more than lines (0 Hz included): the values are a spectrum.
    let lines = read(b"Sampling rate: 51.2 Hz\nBase band: 20 Hz\nLines: 4\n1\n2\n3\n4\n5\n");
    assert_eq!(axis(&lines), (&AxisKind::Frequency, Some(5.0)));
    let named = read(b"Base band: 20 Hz\nTime [s]  Force [N]\n0.0 1\n0.5 2\n1.0 3\n");
    assert_eq!(axis(&named), (&AxisKind::Time, Some(0.5)));
    // A survey gives the same result.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.txt");
    std::fs::write(&path, "Sampling rate: 51.2 Hz\nBase band: 20 Hz\nLines: 4\n1\n2\n3\n4\n5\n").unwrap();
    let (_, headers, _) = Reader::new().survey(&path).unwrap();
    assert_eq!((headers[0].kind, headers[0].dx), ("spectrum", Some(5.0)));
}

#[test]
fn a_clock_is_no_name_of_a_column() {
    let clock = read(b"Time 14:22:05\nBase band: 20 Hz\n1\n2\n3\n");
    assert_eq!(axis(&clock).0, &AxisKind::Frequency);
    let columns = read(b"Base band: 20 Hz\nTime 14:22:05\n0 5\n10 6\n20 4\n");
    assert_eq!(axis(&columns), (&AxisKind::Frequency, Some(10.0)));
    let wide = read(b"Base band: 20 Hz\nTime  14:22:05\n0 5\n10 6\n20 4\n");
    assert_eq!(axis(&wide), (&AxisKind::Frequency, Some(10.0)));
    // Free text above the last header line names no columns either.
    let above = read(b"freq [Hz] real imag\nsome remark\n1 5 6\n2 7 8\n3 9 1\n");
    assert!(!above.records[0].is_complex());
}

#[test]
fn names_and_units_between_blanks() {
    for header in [
        "Time (ms)  Velocity (mm/s)",
        "Time (ms) Velocity (mm/s)",
        "Time (ms)\tVelocity (mm/s)",
        "Time  Velocity\nms    mm/s",
        "# time [millisecond] Velocity [mm/s]",
    ] {
        let recording = read(format!("{header}\n0.0  0.5\n0.5  1.5\n1.0  -2\n").as_bytes());
        assert_eq!(axis(&recording), (&AxisKind::Time, Some(0.5e-3)), "{header}");
        let meta = recording.records[0].meta();
        assert_eq!((meta.name.as_str(), meta.unit.symbol()), ("Velocity", "m/s"), "{header}");
        assert_eq!(values(&recording), [0.5 * 1e-3, 1.5 * 1e-3, -2.0 * 1e-3], "{header}");
        assert!(
            sentences(&recording.all_findings()).is_empty(),
            "{header}: {:?}",
            sentences(&recording.all_findings())
        );
    }
    assert!(says(&read(b"Time  Velocity\n0.0  0.5\n0.5  1.5\n1.0  -2\n"), &["\"Time\" has no unit: s"]));
    let bare = read(b"Sampling rate: 2 Hz\n0.0  0.5\n0.5  1.5\n1.0  -2\n");
    assert!(says(&bare, &["The first column has no unit: s is assumed."]));
    assert!(says(&bare, &["No unit found"]));
    assert!(complaint(b"Time [moons]  v [m/s]\n0.0 1\n0.5 2\n1.0 3\n").contains("\"moons\""));
    let lone = read(b"v [mm/s]\n1\n2\n");
    assert_eq!((values(&lone), lone.records[0].meta().unit.symbol()), (vec![1e-3, 2e-3], "m/s"));
}

#[test]
fn a_statement_that_a_whole_column_contradicts_is_refused() {
    for text in ["t [s]  v [m/s]\n0.0 1\n0.5 2\n1.0 3\n", "0.0 1\n0.5 2\n1.0 3\n"] {
        let error = Reader::new().rate(Some(1000.0)).from_reader("x.txt", text.as_bytes()).unwrap_err();
        let told = error.to_string();
        assert!(
            told.contains("from 0 to 1 s in steps of 0.5 s") && told.contains("rate of 1000 Hz"),
            "{told}"
        );
        assert_eq!(error.exit_code(), 2);
        told_rate(text, 2.0);
    }
    // A lost sample changes the length by a whole step; scatter of the clock does not.
    let jitter = "t [s]  v [m/s]\n0.000 1\n0.104 2\n0.200 3\n0.301 4\n";
    told_rate(jitter, 10.0);
    let lost = "t [s]  v [m/s]\n0.0 1\n0.1 2\n0.2 3\n0.4 4\n";
    assert!(Reader::new().rate(Some(10.0)).from_reader("x.txt", lost.as_bytes()).is_err());
}

fn told_rate(text: &str, rate: f64) {
    assert_eq!(axis(&told(&Reader::new().rate(Some(rate)), text)), (&AxisKind::Time, Some(1.0 / rate)));
}

#[test]
fn what_a_person_states_wins_with_a_doubt_that_names_both() {
    let counted = told(&Reader::new().rate(Some(1000.0)), "1 0.1\n2 0.5\n3 0.2\n");
    assert_eq!(axis(&counted), (&AxisKind::Time, Some(1e-3)));
    assert!(
        says(&counted, &["first column counts", "stated step of 0.001"]),
        "{:?}",
        sentences(&counted.all_findings())
    );
    let band = told(&Reader::new().base_band(Some(30.0)), "df: 5 Hz\nbase band: 20 Hz\n1\n2\n3\n4\n");
    assert_eq!(axis(&band), (&AxisKind::Frequency, Some(10.0)));
    assert!(
        says(&band, &["20 Hz", "30 Hz"]) && says(&band, &["5 Hz", "10 Hz"]),
        "{:?}",
        sentences(&band.all_findings())
    );
    let unit = told(&Reader::new().unit(Unit::parse("m/s")), "unit: mm/s\n1\n2\n");
    assert_eq!(values(&unit), [1.0, 2.0]);
    assert!(says(&unit, &["\"mm/s\"", "m/s was stated"]), "{:?}", sentences(&unit.all_findings()));
    let other = told(&Reader::new().rate(Some(5.0)), "rate: 100 Hz\n1\n2\n");
    assert_eq!(axis(&other), (&AxisKind::Time, Some(0.2)));
    assert!(says(&other, &["100 Hz", "5 Hz"]), "{:?}", sentences(&other.all_findings()));
    for impossible in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let stated = [Reader::new().rate(Some(impossible)), Reader::new().base_band(Some(impossible))];
        assert!(stated.iter().all(|r| r.from_reader("x.txt", &b"1\n2\n"[..]).is_err()), "{impossible}");
    }
    for text in ["1\n2\n", "1 2 4\n2 1 3\n0 1 5\n"] {
        let error =
            Reader::new().complex(true).from_reader("x.txt", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("where complex values were stated"), "{error}");
    }
    let csv = Reader::new()
        .complex(true)
        .from_reader("x.csv", &b"f [Hz],a\n0,1\n1,2\n"[..])
        .unwrap_err()
        .to_string();
    assert!(csv.contains("1 column of values, where complex"), "{csv}");
}

#[test]
fn values_too_large_for_si_are_refused() {
    for (name, text) in [("x.txt", "unit: km\n1\n1e308\n"), ("x.csv", "t [s],v [km]\n0,1\n1,1e308\n")] {
        let error = Reader::new().from_reader(name, text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("the value 1e308 is beyond all numbers"), "{error}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.txt");
    std::fs::write(&path, "unit: km\n1\n1e308\n").unwrap();
    assert!(Reader::new().survey(&path).is_err());
}

#[test]
fn the_measured_accelerances() {
    let Some(folder) = others_files::folder("analyser") else { return };
    // 1001 complex lines, 1 Hz apart. The maximum over the three points has peaks near 52, 142, 279, 460,
    // 687 and 959 Hz.
    let mut largest = vec![0.0f64; 1001];
    for i in 1..=3 {
        let path = folder.join(format!("accelerance_point_{i}.txt"));
        let reader = Reader::new().base_band(Some(1000.0)).unit(Unit::parse("(m/s²)/N"));
        let recording = reader.from_path(&path).unwrap();
        let Record::Frf(frf) = &recording.records[0] else { panic!("{recording:?}") };
        assert_eq!((frf.values.len(), frf.axis.step()), (1001, Some(1.0)));
        for (l, v) in largest.iter_mut().zip(&frf.values) {
            *l = l.max(v.norm());
        }
    }
    for f in [52usize, 142, 279, 460, 687, 959] {
        let around = &largest[f - 20..=f + 20];
        let best = around.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map(|(i, _)| f + i - 20);
        assert_eq!(best, Some(f));
    }
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = Reader::new().format(Some(Format::Ascii)).from_reader("x", bytes.as_slice());
    }

    #[test]
    fn random_text_never_panics(text in "[0-9eE+.,;\t\n ij()-]{0,120}") {
        let _ = Reader::new().format(Some(Format::Ascii)).from_reader("x", text.as_bytes());
        let _ = Reader::new().format(Some(Format::Ascii)).allow_missing(true).from_reader("x", text.as_bytes());
    }

    #[test]
    fn whatever_a_header_states_steps_are_finite_and_positive(
        keys in prop::collection::vec(prop::sample::select(vec![
            "lines: ", "base band: ", "df: ", "dt: ", "dt [us]: ", "rate: ", "fs [MHz]: ", "20 Hz ", "1e-300 Hz ",
        ]), 1..4),
        numbers in prop::collection::vec("-?[0-9]{1,3}(e-?[0-9]{1,3})?|inf|nan|[0-9e. ]{0,6}", 3),
        tail in prop::sample::select(vec!["", " Hz", " lines", " ms"]),
        n in 1usize..6,
    ) {
        let header: Vec<String> = keys.iter().zip(&numbers).map(|(k, v)| format!("{k}{v}{tail}\n")).collect();
        let text = header.concat() + &"7\n".repeat(n);
        if let Ok(recording) = Reader::new().format(Some(Format::Ascii)).from_reader("x", text.as_bytes()) {
            for record in &recording.records {
                let step = record.axis().step();
                prop_assert!(record.len() < 2 || step.is_some_and(|s| s.is_finite() && s > 0.0), "{:?}: {:?}", text, step);
            }
        }
    }

    #[test]
    fn what_is_printed_is_read(values in prop::collection::vec(-1e300f64..1e300, 1..50)) {
        let text: String = values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join("\n");
        let recording = Reader::new().from_reader("x.txt", text.as_bytes()).unwrap();
        let Record::Trace(t) = &recording.records[0] else { panic!() };
        prop_assert_eq!(&t.values, &values);
    }
}
