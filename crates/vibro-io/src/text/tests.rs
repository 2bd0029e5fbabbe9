use super::*;
use crate::format::Format;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::tests::has_finding;
use num_complex::Complex64;
use proptest::prelude::*;
use std::fmt::Write as _;
use vibro_record::lanes::Extremes;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{Axis, AxisKind, Finding, Record, Scaling, Spectrum, Values};

fn read_with(reader: &Reader, text: impl AsRef<[u8]>) -> Result<Recording> {
    reader.from_reader("x.csv", text.as_ref())
}

fn of(text: impl AsRef<[u8]>) -> Recording {
    let recording = read_with(&Reader::new(), text).unwrap();
    assert_eq!(recording.format, Format::Csv);
    recording
}

fn values(record: &Record) -> &[f64] {
    match record {
        Record::Trace(t) => &t.values,
        Record::Spectrum(s) => match &s.values {
            Values::Real(v) => v,
            Values::Complex(v) => panic!("{v:?}"),
        },
        Record::Frf(f) => panic!("{f:?}"),
    }
}

#[test]
fn traces_over_a_time_column() {
    let recording = of("time [ms],velocity [mm/s],Force (N)\n0.0,1.5,-2\n0.5,2.5,3e1\n1.0,0,0\n");
    assert_eq!(recording.records.len(), 2);
    assert!(recording.findings.is_empty());
    let Record::Trace(velocity) = &recording.records[0] else { panic!() };
    assert_eq!((velocity.meta.name.as_str(), velocity.meta.quantity), ("velocity", Quantity::Velocity));
    assert_eq!(velocity.values, [1.5 * 1e-3, 2.5 * 1e-3, 0.0]);
    assert_eq!(velocity.axis, Axis::time(0.0, 0.5e-3, 3));
    assert_eq!(values(&recording.records[1]), [-2.0, 30.0, 0.0]);
    assert!(velocity.meta.findings.is_empty(), "{:?}", velocity.meta.findings);
    let (step, arguments) = (&velocity.meta.history[0].name, &velocity.meta.history[0].arguments);
    assert_eq!((step.as_str(), arguments[2].1.as_str()), ("read", "2"));
}

#[test]
fn a_table_from_a_german_spreadsheet() {
    let text = "\u{feff}Messung;7\r\nAbtastrate;1000;Hz\r\nZeit [s];Weg [µm]\r\n0,000;1,5\r\n0,001;-2,5\r\n";
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin1: Vec<u8> =
        text.trim_start_matches('\u{feff}').chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let cr = text.replace("\r\n", "\r");
    for bytes in [text.as_bytes(), &utf16, &latin1, cr.as_bytes()] {
        let recording = of(bytes);
        let Record::Trace(trace) = &recording.records[0] else { panic!() };
        assert_eq!((trace.meta.name.as_str(), trace.meta.unit.symbol()), ("Weg", "m"));
        assert_eq!(trace.values, [1.5 * 1e-6, -2.5 * 1e-6]);
        assert_eq!(trace.axis, Axis::time(0.0, 1e-3, 2));
        assert_eq!(trace.meta.notes[0], ("Messung".to_owned(), "7".to_owned()));
    }
}

#[test]
fn a_rate_in_the_preamble_or_stated() {
    let text = "Sampling rate;2;kHz\n# operator: A\na;b\n1;2\n3;4\n";
    let recording = of(text);
    assert_eq!(recording.records[1].axis(), &Axis::time(0.0, 1.0 / 2000.0, 2));
    assert!(has_finding(&recording.records[0].meta().findings, "unit-unsaid", &[]));
    let stated = read_with(&Reader::new().rate(Some(100.0)).unit(Unit::parse("mm")), text).unwrap();
    assert_eq!(stated.records[0].axis(), &Axis::time(0.0, 0.01, 2));
    assert_eq!(values(&stated.records[0]), [1.0 * 1e-3, 3.0 * 1e-3]);
    let spectrum = read_with(&Reader::new().base_band(Some(100.0)), text).unwrap();
    assert_eq!(spectrum.records[0].axis(), &Axis::frequency(0.0, 100.0, 2));
}

/// A spectrum of 0 to 50 Hz with lines 12.5 Hz apart, printed with one decimal.
#[test]
fn a_base_band_must_go_with_the_frequency_column() {
    let spectrum = |frequencies: &[f64]| {
        let rows: Vec<String> = frequencies.iter().map(|f| format!("{f:.1},1")).collect();
        format!("Frequency [Hz],v [m/s]\n{}\n", rows.join("\n"))
    };
    let whole = spectrum(&[0.0, 12.5, 25.0, 37.5, 50.0]);
    let step = |text: &str, band| {
        read_with(&Reader::new().base_band(Some(band)), text).map(|r| r.records[0].axis().clone())
    };
    assert_eq!(step(&whole, 50.0).unwrap(), Axis::frequency(0.0, 12.5, 5));
    // Half a unit in the last digit, 0.05 Hz, is within the printed resolution.
    assert!(step(&whole, 50.04).is_ok() && step(&whole, 50.2).is_err());
    let error = step(&whole, 100.0).unwrap_err().to_string();
    assert!(error.contains("from 0 to 50 Hz") && error.contains("base band of 100 Hz"), "{error}");
    // Lines without 0 Hz end at the base band. A zoomed spectrum neither begins at 0 Hz nor ends at the
    // base band.
    assert_eq!(step(&spectrum(&[12.5, 25.0, 37.5, 50.0]), 50.0).unwrap(), Axis::frequency(12.5, 12.5, 4));
    assert!(step(&spectrum(&[100.0, 112.5, 125.0, 137.5, 150.0]), 50.0).is_err());
    // A transform of n samples ends one line below the base band: the column is used.
    let half_open = spectrum(&[0.0, 12.5, 25.0, 37.5]);
    assert_eq!(step(&half_open, 50.0).unwrap(), Axis::frequency(0.0, 12.5, 4));
    assert!(step(&half_open, 62.5).is_err() && step(&half_open, 44.0).is_err());
    // The heading states kHz.
    let kilo = "f [kHz],v [m/s]\n0,1\n0.025,1\n0.05,1\n";
    assert_eq!(step(kilo, 50.0).unwrap(), Axis::frequency(0.0, 25.0, 3));
}

#[test]
fn what_is_stated_may_refine_a_column_and_not_contradict_it() {
    let text = "t [s],a [m/s²]\n1.0,1\n1.1,2\n1.2,3\n";
    let same = read_with(&Reader::new().rate(Some(10.0)), text).unwrap();
    assert!(same.findings.is_empty(), "{:?}", same.findings);
    assert_eq!(same.records[0].axis(), &Axis::time(1.0, 0.1, 3));
    let refined = read_with(&Reader::new().rate(Some(9.9)).unit(Unit::parse("g")), text).unwrap();
    assert_eq!(refined.records[0].axis(), &Axis::time(1.0, 1.0 / 9.9, 3));
    assert!(has_finding(
        &refined.records[0].meta().findings,
        "unit-overrides-file",
        &["file=m/s²", "used=g"]
    ));
    let other = read_with(&Reader::new().rate(Some(50.0)), text).unwrap_err().to_string();
    assert!(other.contains("\"t\" holds a time from 1 to 1.2 s in steps of 0.1 s"), "{other}");
    assert!(other.contains("sampling rate of 50 Hz"), "{other}");
    let band = read_with(&Reader::new().base_band(Some(50.0)), text).unwrap_err().to_string();
    assert!(band.contains("a time from 1 to 1.2 s") && band.contains("base band of 50 Hz"), "{band}");
    let contradicted = of("fs: 1000\nt [s],a [g]\n0.0,1\n0.1,2\n");
    assert_eq!(contradicted.records[0].axis().step(), Some(0.1));
    assert!(
        has_finding(&contradicted.findings, "header-step-differs", &["header=0.001", "step=0.1"]),
        "{:?}",
        contradicted.findings
    );
}

#[test]
fn times_with_too_few_digits() {
    let dt = 1.0 / 1024.0;
    let rows: Vec<String> = (0..3000).map(|i| format!("{:.3},{i}", f64::from(i) * dt)).collect();
    let recording = of(format!("t [s],a [g]\n{}\n", rows.join("\n")));
    let axis = recording.records[0].axis();
    // Both ends are rounded by half a millisecond at most, spread over 2999 steps.
    assert!((axis.step().unwrap() - dt).abs() <= 1e-3 / 2999.0);
    assert!(has_finding(&recording.findings, "axis-rounded", &[]), "{:?}", recording.findings);
}

#[test]
fn uneven_times_are_kept_and_said() {
    let recording = of("t [s],a [g]\n0.00,1\n0.10,2\n0.20,3\n0.50,4\n");
    let axis = recording.records[0].axis();
    assert_eq!((axis.step(), axis.at(3)), (None, 0.5));
    assert!(
        has_finding(&recording.findings, "axis-uneven", &["unit=s", "smallest=0.1", "largest=0.3"]),
        "{:?}",
        recording.findings
    );
}

#[test]
fn a_column_of_intervals_is_no_abscissa() {
    let recording = of("flight [ms],height [mm]\n30,2\n20,1\n25,1\n");
    assert_eq!(recording.records.len(), 2);
    assert_eq!(recording.records[0].meta().quantity, Quantity::Time);
    assert_eq!(recording.records[0].axis().kind, AxisKind::Index);
    assert!(has_finding(&recording.findings, "abscissa-unsaid", &[]));
}

#[test]
fn a_column_that_only_counts_is_left_out() {
    let recording = of("Sample,a [g]\n1,5\n2,6\n3,7\n");
    assert_eq!(recording.records.len(), 1);
    assert_eq!(recording.records[0].axis().values(), [1.0, 2.0, 3.0]);
    let with_time = of(",t [s],a [g]\n0,0.0,5\n1,0.1,6\n");
    assert_eq!(with_time.records.len(), 1);
    assert_eq!(with_time.records[0].axis(), &Axis::time(0.0, 0.1, 2));
    assert!(with_time.findings.is_empty(), "{:?}", with_time.findings);
    let between = of("t [s],Counter,a [g],frame\n0.0,7,5,1\n0.1,8,6,2\n");
    assert_eq!(between.records.len(), 1);
    assert!(has_finding(&between.findings, "columns-count", &["columns=Counter, frame"]));
    // Values that do not count the rows: a record.
    assert_eq!(of("n,a [g]\n1,5\n3,6\n").records.len(), 2);
    assert_eq!(of("index\n0\n1\n").records.len(), 1);
}

#[test]
fn spectra_and_frequency_responses() {
    let recording = of("f [Hz],v rms [mm/s],PSD [g²/Hz],H_re [(m/s²)/N],H_im [(m/s²)/N],X_re,X_im\n\
                        0,1,2,3,4,5,6\n0.5,1,2,3,-4,5,6\n");
    let kinds: Vec<&str> = recording.records.iter().map(Record::kind).collect();
    assert_eq!(kinds, ["spectrum", "spectrum", "frf", "spectrum"]);
    let Record::Spectrum(plain) = &recording.records[0] else { panic!() };
    assert_eq!((plain.scaling, plain.axis.clone()), (Scaling::Unknown, Axis::frequency(0.0, 0.5, 2)));
    assert!(has_finding(&plain.meta.findings, "scaling-unsaid", &[]));
    let Record::Spectrum(density) = &recording.records[1] else { panic!() };
    assert_eq!(density.scaling, Scaling::Psd);
    let Record::Frf(frf) = &recording.records[2] else { panic!() };
    assert_eq!((frf.meta.name.as_str(), frf.meta.quantity), ("H", Quantity::Accelerance));
    assert_eq!(frf.values, [Complex64::new(3.0, 4.0), Complex64::new(3.0, -4.0)]);
    let Record::Spectrum(complex) = &recording.records[3] else { panic!() };
    assert_eq!(complex.values, Values::Complex(vec![Complex64::new(5.0, 6.0); 2]));
}

#[test]
fn remarks_about_scaling_hold_for_one_column_or_for_all() {
    let text = "# scaling: peak\n# scaling: rms of b\n# window: hann of b\n# enbw: 1.5 of b\nf [Hz],a [V],b [V]\n0,1,2\n";
    let recording = of(text);
    let [Record::Spectrum(a), Record::Spectrum(b)] = recording.records.as_slice() else { panic!() };
    assert_eq!((a.scaling, b.scaling), (Scaling::Peak, Scaling::Rms));
    assert_eq!((b.window.map(vibro_record::Window::name), b.enbw), (Some("hann"), Some(1.5)));
    assert!(b.meta.findings.is_empty(), "{:?}", b.meta.findings);
}

#[test]
fn parts_must_agree_and_are_apart_over_time() {
    let error = read_with(&Reader::new(), "f [Hz],H_re [m/N],H_im [mm/N]\n0,1,2\n").unwrap_err();
    assert!(error.to_string().contains("\"H_re\" and \"H_im\" have different units"), "{error}");
    assert_eq!(of("t [s],x_re [m],x_im [m]\n0.0,1,2\n0.1,1,2\n").records.len(), 2);
    let stated = read_with(&Reader::new().complex(true), "f [Hz],a,b\n0,1,2\n1,1,2\n").unwrap();
    assert!(stated.records.len() == 1 && stated.records[0].is_complex());
}

#[test]
fn what_is_assumed_is_said() {
    let recording = of("time,a [EU]\n0.0,1\n0.1,2\n");
    assert!(
        has_finding(&recording.findings, "axis-unit-assumed", &["unit=s", "column=column \"time\""]),
        "{:?}",
        recording.findings
    );
    assert!(has_finding(&recording.records[0].meta().findings, "unit-unknown", &["unit=EU"]));
    let lone = read_with(&Reader::new(), "velocity [mm/s]\n1,5\n2,5\n").unwrap();
    assert_eq!(values(&lone.records[0]), [1.5 * 1e-3, 2.5 * 1e-3]);
    assert!(has_finding(&lone.findings, "decimal-comma-assumed", &[]));
    let error = read_with(&Reader::new(), "time [moon],a\n0,1\n1,2\n").unwrap_err().to_string();
    assert!(error.contains("the unit \"moon\" of the abscissa"), "{error}");
    let error = read_with(&Reader::new(), "time [s]\n0\n1\n").unwrap_err().to_string();
    assert!(error.contains("only an abscissa"), "{error}");
}

#[test]
fn a_stated_unit_holds_for_times_that_have_none() {
    let stated = |unit: &str, text: &str| read_with(&Reader::new().axis_unit(Some(unit))?, text);
    for (unit, head, step) in [
        ("ms", "time,a [g]", 1e-3),
        ("Minutes", "time,a [g]", 60.0),
        ("ms", "time [ms],a [g]", 1e-3),
        // Without a name the unit alone tells that these are times.
        ("ms", "", 1e-3),
    ] {
        let recording = stated(unit, &format!("{head}\n0.0,1\n1.0,2\n2.0,3\n")).unwrap();
        let axis = recording.records[0].axis();
        assert_eq!((&axis.kind, axis.step()), (&AxisKind::Time, Some(step)), "{unit}, {head}");
        assert!(!has_finding(&recording.findings, "axis-unit-assumed", &[]), "{:?}", recording.findings);
    }
    let lines = stated("kHz", "frequency,a [g]\n0,1\n1,2\n2,3\n").unwrap();
    assert_eq!(lines.records[0].axis().step(), Some(1e3));
    for (unit, text, why) in [
        ("ms", "time [s],a\n0,1\n1,2\n", "the column names the unit s, and ms was stated"),
        ("mm", "time,a\n0,1\n1,2\n", "the unit \"mm\" of times"),
        ("ms", "a [g]\n5\n1\n2\n", "no column of times or frequencies"),
    ] {
        let error = stated(unit, text).unwrap_err();
        assert!(error.to_string().contains(why), "{error}");
        assert!(error.settings().any(|key| key == "axis_unit"), "{error}");
    }
}

#[test]
fn units_of_an_abscissa_as_words() {
    for (unit, step) in [
        ("second", 1.0),
        ("Seconds", 1.0),
        ("sec", 1.0),
        ("msec", 1e-3),
        ("milliseconds", 1e-3),
        ("microsecond", 1e-6),
        ("minutes", 60.0),
        ("hours", 3600.0),
    ] {
        for text in [format!("time [{unit}],a [g]"), format!("Time ({unit}),a [g]")] {
            let recording = of(format!("{text}\n0,1\n1,2\n2,3\n"));
            let axis = recording.records[0].axis();
            assert_eq!((&axis.kind, axis.step()), (&AxisKind::Time, Some(step)), "{text}");
            assert!(recording.findings.is_empty(), "{text}: {:?}", recording.findings);
        }
    }
    assert_eq!(of("f (Hertz),a [g]\n0,1\n1,2\n").records[0].axis(), &Axis::frequency(0.0, 1.0, 2));
    let unknown = of("Time (moons),a [g]\n0,1\n1,2\n");
    assert!(
        has_finding(&unknown.findings, "axis-unit-unknown", &["said=moons", "unit=s"]),
        "{:?}",
        unknown.findings
    );
}

#[test]
fn angular_frequencies_become_hertz() {
    let recording = of("omega [rad/s],a [g]\n0,1\n1,2\n2,3\n");
    assert_eq!(recording.records.len(), 1);
    let axis = recording.records[0].axis();
    // Exact: one division by 2π.
    assert_eq!((&axis.kind, axis.step()), (&AxisKind::Frequency, Some(1.0 / std::f64::consts::TAU)));
    assert!(has_finding(&recording.findings, "axis-angular", &[]), "{:?}", recording.findings);
}

/// One cycle per minute is 1/60 Hz as a frequency axis; as a speed it stays a channel.
#[test]
fn cycles_a_minute_become_hertz() {
    for unit in ["CPM", "cpm", "RPM", "rpm", "1/min"] {
        for head in
            [format!("Frequency ({unit}),Amplitude (mm/s)"), format!("Frequency,Amplitude\n{unit},mm/s")]
        {
            let recording = of(format!("{head}\n0,1\n60,2\n120,3\n180,4\n"));
            let [Record::Spectrum(spectrum)] = &recording.records[..] else { panic!("{head}") };
            assert_eq!(spectrum.axis.kind, AxisKind::Frequency, "{head}");
            // Tolerance: 60 divided by 60, rounded twice.
            assert!((spectrum.axis.step().unwrap() - 1.0).abs() < 1e-15, "{head}: {:?}", spectrum.axis);
            assert_eq!(spectrum.meta.unit.symbol(), "m/s");
        }
    }
    let channels = of("Speed (RPM),v (mm/s)\n60,1\n120,2\n180,3\n");
    assert_eq!(channels.records.len(), 2);
}

#[test]
fn missing_values_kept_are_counted() {
    let text = "t [s],a [g]\n0.0,1\n0.1,\n0.2,3\n";
    assert!(read_with(&Reader::new(), text).unwrap_err().to_string().contains("line 3"));
    let kept = read_with(&Reader::new().allow_missing(true), text).unwrap();
    assert!(values(&kept.records[0])[1].is_nan());
    assert!(has_finding(&kept.findings, "missing-kept", &["n=1"]));
}

/// Texts that are detected as CSV without an option, in files without an extension.
#[test]
fn plain_columns_are_left_to_the_reader_of_plain_columns() {
    let sniffed = |name: &str, text: &[u8]| {
        is_table(&text[..text.len().min(1 << 16)], &Source::memory(name, text).unwrap())
    };
    assert!(sniffed("x", b"t,a\n0,1\n"));
    assert!(sniffed("x.csv", b"a\n1\n"));
    for text in ["a\n1\n", "0,1\n1,2\n", "header\n0,1\n", "t a\n0 1\n", "t,a\n"] {
        assert!(!sniffed("x", text.as_bytes()), "{text:?}");
    }
    assert!(!sniffed("x.csv", b"t,a\n0,\x001\n"));
    // The head ends within a row.
    let long = format!("t,a\n{}", "0.125,1\n".repeat(10_000));
    assert!(sniffed("x", long.as_bytes()));
}

/// 20 000 rows, more than the head holds: times, a velocity that falls and rises, and a distance that
/// rises.
fn long_text() -> String {
    let row = |i: u32| format!("{},{},{}\n", f64::from(i) / 1024.0, (i * 7919) % 1009, 3 * i);
    "time [s],v [mm/s],x [mm]\n".to_owned() + &(0..20_000).map(row).collect::<String>()
}

#[test]
fn a_text_that_is_read_again_has_the_values_of_one_that_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    std::fs::write(&path, long_text()).unwrap();
    let whole = Reader::new().from_path(&path).unwrap();
    let source = Source::file(&path).unwrap();
    let Streamed { traces, findings, columns } =
        stream(&source, &Options::default(), Format::Csv).unwrap().expect("clean rows on a disk");
    assert_eq!((traces.len(), &findings), (2, &whole.findings));
    let frames = traces[0].axis.len();
    let mut again =
        vibro_record::Traces::of_stream(path, findings, &traces, frames, Box::new(columns)).unwrap();
    again.keep(&[1, 0]);
    let mut all = Vec::new();
    while again.append(&mut all).unwrap() > 0 {}
    for ((record, read), meta) in whole.records.iter().rev().zip(&all).zip(again.channels()) {
        let Record::Trace(trace) = record else { panic!("{record:?}") };
        assert_eq!((&trace.values, &trace.meta), (read, meta));
        assert_eq!((trace.axis.len(), trace.rate()), (again.frames(), Some(again.rate())));
    }
}

/// Settings of a logger in rows of two cells: none is a row of units.
#[test]
fn rows_of_settings_above_the_names() {
    for blank in ["", ",", "\n"] {
        let head = format!("Range,50\nRate (Hz),500\nSamples,1000\nMax,3\n{blank}\nTime (s),Acc (g)\n");
        let rows: Vec<String> = (0..40).map(|i| format!("{},{}\n", f64::from(i) / 500.0, i % 5)).collect();
        let text = head + &rows.concat();
        let read = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
        let Record::Trace(trace) = &read.records[0] else { panic!("{read:?}") };
        assert_eq!((trace.rate(), trace.meta.name.as_str(), read.records.len()), (Some(500.0), "Acc", 1));
    }
}

#[test]
fn a_survey_holds_what_rises() {
    let text = long_text();
    let source = Source::memory("long.csv", text.as_bytes()).unwrap();
    let whole = read_table(&source, &Options::default(), false).unwrap();
    let seen = read_table(&source, &Options::default(), true).unwrap();
    let held = |(record, ends): &(Record, Option<Extremes>)| (record.meta().name.clone(), ends.is_none());
    assert_eq!(seen.records.iter().map(held).collect::<Vec<_>>(), [("v".into(), false), ("x".into(), true)]);
    for ((whole, _), (seen, ends)) in whole.records.iter().zip(&seen.records) {
        assert_eq!(ends.clone().unwrap_or_else(|| seen.extremes()).range(), whole.extremes().range());
        assert_eq!(ends.clone().unwrap_or_else(|| seen.extremes()).largest(), whole.extremes().largest());
        assert_eq!((whole.meta(), whole.axis()), (seen.meta(), seen.axis()));
    }
}

#[test]
fn a_survey_says_what_reading_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.csv");
    std::fs::write(&path, "t [s],a [g],b [mm/s]\n0.0,1,-9\n0.1,2,3\n").unwrap();
    let (format, headers, _) = Reader::new().survey(&path).unwrap();
    assert_eq!((format, headers.len()), (Format::Csv, 2));
    assert_eq!((headers[1].max_abs, headers[1].max_at, headers[1].n), (Some(9.0 * 1e-3), Some(0.0), 2));
}

/// Of other columns a survey holds only the range.
#[test]
fn a_survey_says_what_marks_missing_values() {
    let values = |i: usize| if i % 50 == 9 { -9999.0 } else { (0.37 * i as f64).sin() };
    let rows: Vec<String> = (0..200).map(|i| format!("{},{}\n", i as f64 * 1e-3, values(i))).collect();
    let text = format!("t [s],a [g]\n{}", rows.concat());
    let source = Source::memory("marked.csv", text.as_bytes()).unwrap();
    let seen = read_table(&source, &Options::default(), true).unwrap();
    assert!(has_finding(&seen.findings, "missing-marked", &["mark=-9999", "n=4"]), "{:?}", seen.findings);
}

/// In the formats of PASCO's and Vernier's programs.
#[test]
fn runs_side_by_side_have_times_of_their_own() {
    let rows = "0;1;0;5\n0,5;2;0,25;6\n1;0;0,5;7\n;;0,75;8\n";
    for names in [
        "Zeit Versuch #1 (s);Position Versuch #1 (m);Zeit Versuch #2 (s);Position Versuch #2 (m)",
        "Time (s) Run #1;Position (m) Run #1;Time (s) Run #2;Position (m) Run #2",
        "Time Run #1 (s);Position Run #1 (m);Time Run #2 (s);Position Run #2 (m)",
        "Run 1: Time (s);Run 1: Position (m);Run 2: Time (s);Run 2: Position (m)",
    ] {
        let found = of(format!("{names}\n{rows}"));
        let [Record::Trace(one), Record::Trace(two)] = &found.records[..] else { panic!("{names}") };
        assert!(one.meta.name.contains("Position") && two.meta.name.contains('2'), "{}", two.meta.name);
        assert_eq!((&one.values[..], &one.axis), (&[1.0, 2.0, 0.0][..], &Axis::time(0.0, 0.5, 3)), "{names}");
        assert_eq!(
            (&two.values[..], &two.axis),
            (&[5.0, 6.0, 7.0, 8.0][..], &Axis::time(0.0, 0.25, 4)),
            "{names}"
        );
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        let odd = rows.replace("0,25;6", "0,25;x");
        let why = read_with(&Reader::new(), format!("{names}\n{odd}")).unwrap_err();
        assert_eq!(why.line(), Some(3), "{why}");
    }
    // A time column after its values is also recognised.
    let behind = of("Force Run #1 (N),Time Run #1 (s)\n1,0\n2,0.5\n0,1\n");
    assert_eq!((behind.records.len(), behind.records[0].axis()), (1, &Axis::time(0.0, 0.5, 3)));
}

#[test]
fn two_clocks_in_one_file_are_refused() {
    let text = |step: f64, from: f64| {
        let mut text = "Time A (s),A (V),Time B (s),B (V)\n".to_owned();
        for i in 0..50 {
            let t = f64::from(i);
            let _ = writeln!(text, "{:.4},1,{:.4},{}", 1e-4 * t, from + step * t, 2 * i % 5);
        }
        text
    };
    let read_text = |text: String| {
        read_table(&Source::memory("x.csv", text.into_bytes()).unwrap(), &Options::default(), false)
    };
    let why = read_text(text(2e-4, 0.0)).unwrap_err().to_string();
    assert!(why.contains("\"Time A\" and \"Time B\" run over 0.0049 and 0.0098"), "{why}");
    // A clock that runs 1 % fast drifts apart, here by less than the printed digits of the first clock.
    let row = |i: i32| format!("{:.4},{:.3},{}\n", 1e-4 * f64::from(i), 0.101 * f64::from(i), 2 * i % 5);
    let drifts = read_text("t (s),elapsed (ms),a (g)\n".to_owned() + &(0..50).map(row).collect::<String>());
    assert!(has_finding(&drifts.unwrap().findings, "columns-rise-evenly", &["columns=elapsed"]));
    // The same clock, also with another start, is not a second clock.
    assert!(read_text(text(1e-4, 0.0)).is_ok() && read_text(text(1e-4, 7.0)).is_ok());
}

#[test]
fn rows_of_several_channels_are_refused_and_whole_numbers_are_read() {
    let of = |head: &str, number: fn(i32) -> i32| {
        let row = |i: i32| format!("{:.3},{},{:.4}\n", 1e-3 * f64::from(i), number(i), f64::from(i).sin());
        let text = head.to_owned() + &(0..60).map(row).collect::<String>();
        read_table(&Source::memory("x.csv", text.into_bytes()).unwrap(), &Options::default(), false)
    };
    // In a cycle under any name; also if one sensor is read twice as often, under a name that says sensor.
    for (head, number) in [
        ("t (s),which,a (g)\n", (|i| 1 + i % 2) as fn(i32) -> i32),
        ("t (s),Sensor ID,a (g)\n", |i| if i % 3 == 0 { 7 } else { 9 }),
        ("t (s),Sensor ID,a (g)\n", |i| 7 + i / 10 % 3),
    ] {
        let why = of(head, number).unwrap_err().to_string();
        assert!(why.contains("and back"), "{why}");
    }
    // Accepted: a level in volts, one sensor number, a state that changes now and then, and a count.
    for (head, number) in [
        ("t (s),U (V),a (g)\n", (|i| 1 + i % 2) as fn(i32) -> i32),
        ("t (s),Sensor ID,a (g)\n", |_| 7),
        ("t (s),state,a (g)\n", |i| i / 7 % 2),
        ("t (s),n,a (g)\n", |i| i),
    ] {
        assert!(of(head, number).is_ok(), "{head}");
    }
}

#[test]
fn an_abscissa_by_name_may_stand_behind_an_empty_column() {
    for head in ["note,t [s],a [g]", ",t [s],a [g]"] {
        let found = of(format!("{head}\n,0,5\n,0.5,6\n,1,7\n"));
        assert_eq!((found.records.len(), found.records[0].axis()), (1, &Axis::time(0.0, 0.5, 3)), "{head}");
        assert_eq!(found.records[0].meta().name, "a");
    }
}

#[test]
fn rates_of_a_filter_are_no_sampling_rate() {
    let found = of("Sample rate: 1000 Hz\nforce,acc\nN,g\n100 Hz,100 Hz\n1,2\n2,3\n0,1\n");
    assert_eq!((found.records.len(), found.records[0].axis()), (2, &Axis::time(0.0, 1e-3, 3)));
}

/// `frame` may also be a counter; a load in newtons is a force by its name and by its decimals.
#[test]
fn the_load_on_a_frame_is_a_force() {
    for rows in ["0,1.5\n1,2.5\n2,0.5\n", "0,12\n1,-7\n2,3\n"] {
        let found = of(format!("t (s),Load frame (N)\n{rows}"));
        let meta = found.records[0].meta();
        let against = has_finding(&meta.findings, "unit-against-name", &[]);
        assert_eq!((meta.quantity, against), (Quantity::Force, false), "{rows}");
    }
}

#[test]
fn a_time_that_runs_backwards_is_refused_whatever_the_rate() {
    let mut rows = String::new();
    for i in 0..50 {
        let _ = writeln!(rows, "{:.4},{}", 1e-4 * f64::from(if i < 25 { i } else { i - 10 }), i % 3);
    }
    let source = Source::memory("x.csv", format!("Time (s),U (V)\n{rows}").into_bytes()).unwrap();
    let options = Options { rate: Some(10_000.0), ..Options::default() };
    let why = read_table(&source, &options, false).unwrap_err().to_string();
    assert!(why.contains("runs backwards: value 26 is 0.0015, behind 0.0024"), "{why}");
}

#[test]
fn a_number_that_is_cut_off_is_seen_behind_every_line_end() {
    for end in ["\n", "\r\n", "\r"] {
        let text = ["t [s],a [g]", "0,1.25", "1,1.35", "2,1.45", "3,1.5"].join(end);
        assert!(has_finding(&of(text).findings, "last-number-cut-off", &["found=1.5"]), "{end:?}");
    }
}

/// The printed digits of the abscissa are also found in a table on the fast path: 1024 Hz printed in whole
/// milliseconds.
#[test]
fn the_digits_of_a_long_table_are_those_of_its_first_and_last_rows() {
    let mut text = "t [s],a [g]\n".to_owned();
    for i in 0..20_000 {
        let _ = writeln!(text, "{:.3},{}", f64::from(i) / 1024.0, i % 7);
    }
    let recording = of(text);
    let step = recording.records[0].axis().step().unwrap();
    // Both ends are rounded by at most half a millisecond.
    assert!((step - 1.0 / 1024.0).abs() <= 1e-3 / 19_999.0, "{step}");
}

/// A clock of whole seconds has its milliseconds in the column `ms` beside it. A clock that prints
/// milliseconds does not get them twice.
#[test]
fn milliseconds_beside_a_clock_count_once() {
    for whole in [true, false] {
        let mut rows = String::new();
        for i in 0..2000 {
            let (seconds, ms) = (11 + i / 1000, i % 1000);
            let own = if whole { String::new() } else { format!(".{ms:03}") };
            let _ = writeln!(rows, "10:20:{seconds}{own},{ms},{}", (i * i) % 7);
        }
        let recording = of(format!("time,ms,ax (m/s2)\n{rows}"));
        let rate = recording.records.last().unwrap().axis().step().unwrap().recip();
        assert!((rate - 1000.0).abs() < 1e-6, "{whole}: {rate}");
    }
}

/// The first record of a text without names.
fn plain(text: &str) -> Record {
    Reader::new().from_reader("x.txt", text.as_bytes()).unwrap().records.swap_remove(0)
}

#[test]
fn what_a_head_says_beside_the_values_is_said() {
    let rows = |row: &dyn Fn(usize) -> String| (0..20).map(row).collect::<String>();
    let counted = rows(&|i| format!("{},{}\n", (i * i) % 7, 3 * i));
    let found = of(format!("SLOPE,0.001,1\nRATE,1000 Hz\nforce,turns\n{counted}"));
    assert!(
        has_finding(&found.all_findings(), "scale-in-head", &["scale=0.001"]),
        "{:?}",
        found.all_findings()
    );
    assert!(has_finding(&found.findings, "columns-rise-evenly", &["columns=turns"]), "{:?}", found.findings);
    // A ramp in mm is a measurement, and a factor of 1 changes nothing.
    let found = of(format!("SLOPE,1,1\nRATE,1000 Hz\nforce [N],way [mm]\n{counted}"));
    let own = |found: &Finding| found.code == "rate-from-head";
    assert!(found.all_findings().iter().all(own), "{:?}", found.all_findings());
    // Statements that resemble a rate, or two that contradict each other.
    let rate = |head: &str| match &plain(&format!("{head}\n{}", rows(&|i| format!("{}\n", (i * i) % 7)))) {
        Record::Trace(trace) => trace.rate(),
        _ => panic!(),
    };
    assert_eq!(rate("Sample Rate: 44100 Hz.   Linear scale."), Some(44_100.0));
    assert_eq!(rate("Frequency range: 20 Hz - 20 kHz"), None);
    assert_eq!(rate("X-Axis: Frequency\nSampling rate: 2048 Hz\ndx: 0.5"), Some(2048.0));
    assert_eq!(rate("Sampling rate: 1000 Hz\nDelta t: 10 s"), Some(1000.0));
}

#[test]
fn the_cell_that_is_no_number_is_named() {
    let said = |text: &str| read_with(&Reader::new(), text).unwrap_err().to_string();
    let found = said("time,level\n0,4.2 mm/s\n1,4.3 mm/s\n");
    assert!(found.contains("line 2, column 3") && found.contains("\"4.2 mm/s\""), "{found}");
    let found = said("time,level,state\n0,4.2 mm/s,on\n1,4.3 mm/s,on\n");
    assert!(found.contains("line 2, column 3") && found.contains("\"4.2 mm/s\""), "{found}");
}

/// A unit in the cells is never dropped: a time in ms would be read in s.
#[test]
fn units_in_the_cells_are_those_of_the_values_or_are_refused() {
    for text in [
        "time,unit,force,unit\n0,ms,1,kN\n0.5,ms,-2,kN\n1,ms,0,kN\n",
        "time\tunit\tforce (kN)\n0\tms\t1\n0.5\tms\t-2\n1\tms\t0\n",
        "time force [kN]\n0 ms 1\n0.5 ms -2\n1 ms 0\n",
    ] {
        let found = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
        let [Record::Trace(force)] = &found.records[..] else { panic!("{text}") };
        assert_eq!(
            (force.axis.clone(), force.meta.name.as_str()),
            (Axis::time(0.0, 0.5e-3, 3), "force"),
            "{text}"
        );
        assert_eq!((&force.values[..], force.meta.unit.symbol()), (&[1e3, -2e3, 0.0][..], "N"), "{text}");
        assert!(has_finding(&found.findings, "units-in-cells", &["time (ms)"]), "{:?}", found.findings);
        assert!(!has_finding(&found.findings, "axis-unit-assumed", &[]), "{:?}", found.findings);
    }
    // The unit cells stay a column of words if the name already has a unit.
    let plain = read_with(&Reader::new(), "time (s),unit,x\n0,m,1\n0.5,m,2\n1,m,3\n").unwrap();
    assert_eq!(plain.records[0].axis(), &Axis::time(0.0, 0.5, 3));
    assert!(has_finding(&plain.findings, "columns-of-words", &["columns=unit (m)"]), "{:?}", plain.findings);
    let glued = "time,level\n0ms,4\n0.5ms,5\n1ms,6\n";
    let why = read_with(&Reader::new(), glued).unwrap_err();
    assert!(why.advice().ends_with("name [ms]"), "{}", why.advice());
    // The hint works.
    let mended = glued.replace("ms", "").replacen("time", "time [ms]", 1);
    assert_eq!(of(mended).records[0].axis(), &Axis::time(0.0, 0.5e-3, 3));
}

#[test]
fn columns_of_one_word_are_left_out_and_said() {
    for (text, left_out, names) in [
        (
            "Serial,12\nn,reading,unit,state\n1,0.5,Volt DC,F\n2,0.6,Volt DC,F\n3,0.2,Volt DC,F\n",
            "unit (Volt DC), state (F)",
            vec![("reading", 3)],
        ),
        (
            "% time [s],frame,a [g],b [g]\n0,imu,1,2\n0.5,imu,2,3\n1,imu,0,1\n",
            "frame (imu)",
            vec![("a", 3), ("b", 3)],
        ),
        (
            "X = 1 | Y = 2\nX = 3 | Y = 1\n",
            "column 1 (X), column 5 (Y)",
            vec![("column 1", 2), ("column 2", 2)],
        ),
    ] {
        let found = Reader::new().from_reader("x.txt", text.as_bytes()).unwrap();
        let read: Vec<_> = found.records.iter().map(|r| (r.meta().name.as_str(), r.axis().len())).collect();
        assert_eq!(read, names, "{text}");
        assert!(
            has_finding(&found.findings, "columns-of-words", &[&format!("columns={left_out}")]),
            "{:?}",
            found.findings
        );
    }
    // Changing words may name channels or be the time, so the remaining times must rise.
    for (cell, read) in [
        ((|i| format!("{} / 12", 7 + i / 20)) as fn(u32) -> String, true),
        (|i| format!("2020-01-24 12-00-{i:02}_500"), true),
        (|i| if i < 30 { String::new() } else { "gps".to_owned() }, true),
        (|i| if i < 20 { "ax" } else { "ay" }.to_owned(), true),
        (|i| if i % 2 == 0 { "ax" } else { "ay" }.to_owned(), false),
        (|i| ["ax", "ay", "az"][i as usize / 5 % 3].to_owned(), false),
        (|i| format!("{} / 2", i % 2 + 1), false),
        (|i| if i == 39 { "5".to_owned() } else { "gps".to_owned() }, false),
        (|i| format!("{i}-2j"), false),
        (|i| format!("{i} mm/s"), false),
    ] {
        let rows = |time: fn(u32) -> u32| {
            let row = |i| format!("{},{},{}\n", time(i), cell(i), (7 * i) % 5);
            (0..40).map(row).collect::<String>()
        };
        let told = read_with(&Reader::new(), &("time [s],what,F [N]\n".to_owned() + &rows(|i| i)));
        assert_eq!(told.is_ok(), read, "{}: {told:?}", cell(25));
        let blocks = read_with(&Reader::new(), &("time [s],what,F [N]\n".to_owned() + &rows(|i| i % 20)));
        let one_word = cell(30) == "gps";
        assert!(blocks.is_err() || one_word && read, "{}: {blocks:?}", cell(25));
        let untimed = "no,what,F [N]\n".to_owned() + &rows(|i| i);
        let untimed = read_with(&Reader::new(), &untimed);
        let left_out = untimed.is_ok_and(|found| has_finding(&found.findings, "columns-of-words", &[]));
        assert_eq!(left_out, one_word && read, "{}", cell(25));
    }
    // Rows of several channels below each other are refused.
    let long = "time,name,value\n0,ax,1\n0,ay,2\n1,ax,3\n1,ay,4\n";
    let why = read_with(&Reader::new(), long).unwrap_err().to_string();
    assert!(why.contains("line 3, column 3") && why.contains("\"ay\" below \"ax\""), "{why}");
}

/// A unit that the name contradicts is reported and not applied; all other units are applied.
#[test]
fn a_unit_is_none_where_the_name_says_so() {
    let of = |names: &str, row: &dyn Fn(u32) -> String| {
        let line = |i| format!("0.{i:02},{}\n", row(i));
        let rows: String = (0..20).map(line).collect();
        Reader::new().from_reader("x.csv", format!("time [s],{names}\n{rows}").as_bytes()).unwrap()
    };
    let told = |found: &Recording| -> Vec<String> {
        let told = |r: &Record| has_finding(&r.meta().findings, "unit-against-name", &[]);
        let name = |r: &Record| format!("{} [{}]", r.meta().name, r.meta().unit.symbol());
        found.records.iter().map(|r| name(r) + if told(r) { " told" } else { "" }).collect()
    };
    let (counts, floor) = ("loggingSample(N)", "floors(N)");
    let both = of(&format!("{counts},{floor},push force (N)"), &|i| format!("{},3,{}", i + 5, i % 7));
    assert_eq!(told(&both), ["floors [] told", "push force [N]"]);
    // With a sample lost, the column no longer counts the rows.
    let gap = of(counts, &|i| (i + i / 9).to_string());
    assert_eq!(told(&gap), ["loggingSample [] told"]);
    let newton = of("preload (N),F2 (N)", &|i| format!("{},3", i + 1));
    assert_eq!(told(&newton), ["preload [N]", "F2 [N]"]);
    let degrees = of("T(°),batteryTemperature (deg),heading (°),t_in (°),temp (mV)", &|i| {
        format!("2{i},3{i},4,5,6")
    });
    let right = ["T [] told", "batteryTemperature [] told", "heading [rad]", "t_in [rad]", "temp [V]"];
    assert_eq!(told(&degrees), right);
}

/// Two sampling rates in one table: the slower channel has its own step.
#[test]
fn blank_cells_in_every_second_row_are_a_lower_rate() {
    let found = of("t [s],a [g],F [N]\n0,1,\n0.5,2,5\n1,3,\n1.5,4,6\n2,5,\n2.5,6,7\n3,7,\n");
    assert_eq!(found.records[0].axis(), &Axis::time(0.0, 0.5, 7));
    assert_eq!(
        (found.records[1].axis(), values(&found.records[1])),
        (&Axis::time(0.5, 1.0, 3), &[5.0, 6.0, 7.0][..])
    );
    assert!(has_finding(&found.all_findings(), "column-sparse", &["every=2"]), "{:?}", found.all_findings());
    // One blank cell more or less is a gap.
    for text in [
        "t [s],F [N]\n0,\n0.5,5\n1,\n1.5,\n2,\n2.5,7\n3,\n",
        "t [s],F [N]\n0,\n0.5,5\n1,\n1.5,6\n2,8\n2.5,7\n3,\n",
    ] {
        let why = read_with(&Reader::new(), text).unwrap_err().to_string();
        assert!(why.contains("missing value"), "{why}");
    }
}

#[test]
fn what_stands_behind_the_rows_is_said_or_begins_another_table() {
    let found = of("BEGIN CH1\nf [Hz],a [V]\n0,1\n1,2\n2,1\nEND\n");
    assert_eq!(values(&found.records[0]), [1.0, 2.0, 1.0]);
    let two = "f [Hz],a [V]\n0,1\n1,2\nEND\nf [Hz],b [V]\n0,1\n1,3\n";
    let why = read_with(&Reader::new(), two).unwrap_err().to_string();
    assert!(why.contains("line 4") && why.contains("each table"), "{why}");
}

/// As in files of crash tests, analysers of response functions and loggers of several runs.
#[test]
fn heads_say_where_time_begins_and_whether_values_are_complex() {
    let found = plain("Time of first sample :-2.0E-02\nSampling interval :1.0E-04\n1.5\n2.5\n0.5\n");
    assert_eq!(found.axis(), &Axis::time(-0.02, 1e-4, 3));
    let found = plain(
        "Title:\tFunction (Real and Imaginary)\nSampling frequency:\t2048 Hz\nX-axis unit:\tHz\nX-axis delta:\t4\n1\t0.5\t1.5\n2\t2.5\t0.5\n3\t1.0\t0.0\n",
    );
    let Record::Spectrum(Spectrum { values: Values::Complex(values), axis, .. }) = found else { panic!() };
    assert_eq!((values[1], axis), (Complex64::new(2.5, 0.5), Axis::frequency(0.0, 4.0, 3)));
    let found = of("Run 1: Time (s),Run 1: Force (N)\n0,1.5\n0.5,2.5\n1,0.5\n");
    assert_eq!(
        (found.records[0].meta().name.as_str(), found.records[0].axis().step()),
        ("Run 1: Force", Some(0.5))
    );
}

/// Numbers above the rows that describe the series do not prevent the question.
#[test]
fn a_series_below_a_block_of_numbers_is_asked_about() {
    let mut rows = String::new();
    for k in 0..400 {
        let end = if k % 10 == 9 { "\n" } else { "" };
        let _ = write!(rows, "{:8.1}{end}", 900.0 * (0.05 * f64::from(k)).sin());
    }
    let text = format!(
        "accelerogram\n    2011       2      21      23      51     420    9999       0    2011       2\n{rows}"
    );
    let why = Reader::new().from_reader("x.txt", text.as_bytes()).unwrap_err().to_string();
    assert!(why.contains("10 columns that may continue each other"), "{why}");
}

/// Refused if the time columns disagree, here 5 s per row in `t [ms]` beside 1 s in the clock.
#[test]
fn a_clock_beside_other_times_must_agree_with_them() {
    let rows = |step: f64| {
        (0..5).fold("when,t [ms],F [N]\n".to_owned(), |all, i| {
            all + &format!("2023-03-14 10:27:3{i},{},{}\n", step * f64::from(i), i * i % 3)
        })
    };
    let found = of(rows(1000.0));
    assert_eq!((found.records.len(), found.records[0].axis()), (1, &Axis::time(0.0, 1.0, 5)));
    let why = read_with(&Reader::new(), rows(5000.0)).unwrap_err().to_string();
    assert!(why.contains("one clock"), "{why}");
    // A clock that ends in two digits, hundredths or film frames, is refused.
    assert!(read_with(&Reader::new(), "t,a\n0:00:00:03,1\n0:00:00:06,2\n").is_err());
}

#[test]
fn names_and_units_where_few_look_for_them() {
    for (text, names, rate) in [
        ("; Samplerate: 10 kHz\nV,V\n0,0.4\n1,0.5\n0.5,2\n", vec![("column 1", "V"), ("column 2", "V")], 1e4),
        ("\"Time (s) Run #1\",\"Force (kN) Run #1\"\n0,1\n0.5,2\n1,0\n", vec![("Force Run #1", "N")], 2.0),
    ] {
        let found = of(text);
        let read: Vec<_> =
            found.records.iter().map(|r| (r.meta().name.as_str(), r.meta().unit.symbol())).collect();
        assert_eq!(read, names, "{text}");
        assert!((found.records[0].axis().step().unwrap() * rate - 1.0).abs() < 1e-12, "{text}");
    }
}

#[test]
fn labels_beside_names_and_units() {
    let rows = "0,1,4\n0.5,2,5\n1,3,2\n";
    for text in [
        format!("No.,a,b\nUnit,mm,um\n{}", "1,+000.5,+1.0\n2,+000.6,+2.0\n3,+000.2,+5.0\n"),
        format!(
            "t,a,b\nType: double,Type: double,Type: double\nUnit: s,Unit: mm,Unit: um\nInterp: zoh,Interp: zoh,Interp: zoh\n{rows}"
        ),
        format!(
            "\"version\",\"1.0\"\n\"name\",\"t\",\"a\",\"b\"\n\"unit\",\"s\",\"mm\",\"um\"\n\"remark\",\"\",\"\",\"\"\n\"values\"\n{}",
            rows.lines().fold(String::new(), |all, row| all + "\"\"," + row + "\n")
        ),
    ] {
        let found = of(&text);
        let names: Vec<_> =
            found.records.iter().map(|r| (r.meta().name.as_str(), r.meta().unit.symbol())).collect();
        assert_eq!(names, [("a", "m"), ("b", "m")], "{text}");
        assert!(
            (values(&found.records[1])[1] * 1e6 - if text.starts_with('N') { 2.0 } else { 5.0 }).abs() < 1e-9
        );
    }
}

/// A quantity divided by its unit, as in DIN 1313.
#[test]
fn quantities_over_their_units() {
    let found = of("t/ms;F/N;a/(m/s²)\n0,0;1,5;2\n0,5;2;1\n1,0;3;2\n");
    let read: Vec<_> =
        found.records.iter().map(|r| (r.meta().name.as_str(), r.meta().unit.symbol())).collect();
    assert_eq!(read, [("F", "N"), ("a", "m/s²")]);
    assert_eq!(found.records[0].axis(), &Axis::time(0.0, 5e-4, 3));
}

#[test]
fn units_say_whether_amplitudes_are_rms() {
    let scaling = |unit: &str| {
        let text = format!("f [Hz],a [{unit}]\n0,1\n1,2\n2,1\n");
        let Record::Spectrum(spectrum) = of(text).records.swap_remove(0) else { panic!() };
        (spectrum.scaling, spectrum.meta.unit.symbol().to_owned())
    };
    for (unit, expected) in [
        ("Vrms", (Scaling::Rms, "V")),
        ("mm/s RMS", (Scaling::Rms, "m/s")),
        ("g pk", (Scaling::Peak, "m/s²")),
        ("mm/s", (Scaling::Unknown, "m/s")),
    ] {
        assert_eq!(scaling(unit), (expected.0, expected.1.to_owned()), "{unit}");
    }
}

#[test]
fn levels_and_angles_of_circuit_simulators() {
    let found = plain("Freq.\tV(out)\n1.0e+00\t(-2.0e+01dB,9.0e+01°)\n2.0e+00\t(0.0e+00dB,0.0e+00°)\n");
    let Record::Spectrum(Spectrum { values: Values::Complex(values), .. }) = found else { panic!() };
    assert!((values[0] - Complex64::new(0.0, 0.1)).norm() < 1e-15 && values[1] == Complex64::new(1.0, 0.0));
    let found = plain("Freq.\tV(out)\n1.0e+00\t1.5e+00,-2.0e+00\n2.0e+00\t0.0e+00,1.0e+00\n");
    let Record::Spectrum(Spectrum { values: Values::Complex(values), .. }) = found else { panic!() };
    assert_eq!(values[0], Complex64::new(1.5, -2.0));
}

/// Seconds before the trigger, in a header with several units.
#[test]
fn what_seismographs_say_of_their_trigger() {
    let found = of(
        "\"Pre-trigger Length : -0.250 sec\"\n\"Sample Rate : 1024 sps\"\n\"Units : mm/s and pa.(L)\"\nTran,Mic\n1,2\n3,1\n2,5\n",
    );
    assert_eq!(found.records[0].axis(), &Axis::time(-0.25, 1.0 / 1024.0, 3));
    assert_eq!(found.records[0].meta().unit.symbol(), "");
}

/// Unknown units are recognised as units in a row that begins with `s` below a time.
#[test]
fn units_below_an_axis_need_not_be_known() {
    let found = of("Time,Light,Spread\ns,lux,G²/Hz\n0,1,2\n0.5,3,4\n1,5,7\n");
    let names: Vec<_> =
        found.records.iter().map(|r| (r.meta().name.as_str(), r.meta().unit.symbol())).collect();
    assert_eq!(names, [("Light", "lux"), ("Spread", "G²/Hz")]);
    assert_eq!(found.records[0].axis(), &Axis::time(0.0, 0.5, 3));
    let found = of("Sample;Relative Zeit [ms];Weg [mm]\n0;-200,0;1,5\n1;-196,0;2,5\n2;-192,0;0,5\n");
    let axis = found.records[0].axis();
    // Tolerance: rounding of differences of printed numbers.
    assert!((axis.step().unwrap() - 0.004).abs() < 1e-15 && axis.kind == AxisKind::Time, "{axis:?}");
    assert_eq!((found.records.len(), axis.start()), (1, -0.2));
}

#[test]
fn data_begins_where_it_is_said() {
    let numbers = |text: &str| match plain(text) {
        Record::Trace(trace) => trace.values,
        _ => panic!(),
    };
    assert_eq!(numbers("dt:\n0.5\ndata:\n1.5\n2.5\n"), [1.5, 2.5]);
    let said = read_with(&Reader::new(), "1.0\n2.5\n3.1\nData:\n4.0\n5.5\n").unwrap_err().to_string();
    assert!(said.contains("line 4"), "{said}");
}

proptest! {
    #[test]
    fn never_panics_on_random_tables(text in "[tf \\[\\]Hzms,;\t\"#%:=\r\n0-9.eE+µ-]{0,120}") {
        for head in ["", "t,a\n0,1\n", "f [Hz];H_re;H_im\n0,5;1;2\n"] {
            let bytes = format!("{head}{text}").into_bytes();
            if !bytes.is_empty() {
                let source = Source::memory("x.csv", bytes).unwrap();
                let _ = is_table(source.head(), &source);
                let _ = read_table(&source, &Options::default(), false);
            }
        }
    }

    #[test]
    fn never_panics_on_random_bytes(bytes in prop::collection::vec(any::<u8>(), 1..200)) {
        let source = Source::memory("x.csv", bytes).unwrap();
        let _ = is_table(source.head(), &source);
        let _ = read_table(&source, &Options { allow_missing: true, ..Options::default() }, false);
    }
}

#[test]
fn a_preamble_in_the_first_columns() {
    // As Tektronix oscilloscopes write it; here the last key is beside the last row but one.
    let text = "Record Length,6.0e+00,,-0.002,0.5,\nSample Interval,1.0e-03,,-0.001,1.5,\n,,,0,-0.25,\nSource,CH1,,0.001,0,\n\
                Vertical Units,V,,0.002,2,\nHorizontal Units,s,,0.003,1,\n,,,0.004,7,\n";
    let found = Reader::new().from_reader("F0000CH1.CSV", text.as_bytes()).unwrap();
    let [Record::Trace(trace)] = &found.records[..] else { panic!("{found:?}") };
    assert_eq!((trace.meta.name.as_str(), trace.meta.unit.symbol()), ("CH1", "V"));
    assert_eq!((&trace.values[..3], trace.values.len()), (&[0.5, 1.5, -0.25][..], 7));
    assert_eq!((trace.axis.start(), trace.axis.step()), (-0.002, Some(0.001)));
}

#[test]
fn no_row_is_lost_below_keys() {
    for (head, row) in
        [("Source,CH1,CH2\nVertical Units,V,V\n", ""), ("\"TraceName\",\"CH1\",\"CH2\"\n", ",")]
    {
        let found = of(format!("{head}{row}0.5,0.25\n{row}1.5,0.75\n{row}1.0,0.5\n"));
        let read: Vec<(&str, &[f64])> =
            found.records.iter().map(|r| (r.meta().name.as_str(), values(r))).collect();
        assert_eq!(read, [("CH1", &[0.5, 1.5, 1.0][..]), ("CH2", &[0.25, 0.75, 0.5][..])], "{head}");
    }
}

#[test]
fn names_and_units_of_oscilloscopes() {
    for (text, name, start, step) in [
        ("x-axis,1,2\nsecond,Volt,Volt\n-1.0E-03,-250.0000E-03,1\n-0.5E-03,1,2\n0,2,1\n", "1", -1e-3, 5e-4),
        ("X,CH1,Start,Increment,\nSequence,Volt,-2.0e-03,2.0e-05,\n0,1,\n1,2,\n2,3,\n", "CH1", -2e-3, 2e-5),
        (
            "Record Length,Analog:3\nVertical Units,V\nSource,CH2\nSecond,Volt\n0.0,1\n0.1,2\n0.2,3\n",
            "CH2",
            0.0,
            0.1,
        ),
        (
            "sep=,\n\"Time\",\"A\"\n\"(ms)\",\"(V)\"\n\n\"0.0\",\"1\"\n\"0.5\",\"2\"\n\"1.0\",\"3\"\n",
            "A",
            0.0,
            5e-4,
        ),
    ] {
        let found = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
        let Some(Record::Trace(trace)) = found.records.first() else { panic!("{found:?}") };
        assert_eq!((trace.meta.name.as_str(), trace.meta.unit.symbol()), (name, "V"), "{text}");
        let close = (trace.axis.step().unwrap() / step - 1.0).abs() < 1e-9;
        assert!(close && (trace.axis.start() - start).abs() < 1e-12, "{text}: {:?}", trace.axis);
    }
}

#[test]
fn rows_below_the_names_that_do_not_parse_are_no_names() {
    for word in ["Error", "SAT", "?", "<-10", "no data", "1.2V"] {
        for (separator, file) in [(",", "x.csv"), ("\t", "x.txt"), (";", "x.dat")] {
            let row = |i: u32, cell: &str| [&format!("0.0{i}"), cell, "1.5\n"].join(separator);
            let torn: String = (0..6).map(|i| row(i, word)).collect();
            let text =
                ["Time (s)", "Acc (g)", "F (N)\n"].join(separator) + &torn + &row(6, "0.5") + &row(7, "0.6");
            let error = Reader::new().from_reader(file, text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains("line 2, column 6: found"), "{word} {file}: {error}");
        }
    }
    let error = Reader::new().from_reader("x.txt", "time[s] a[g] b[g]\n0 ? 1\n1 2 3\n2 3 4\n".as_bytes());
    assert!(error.unwrap_err().to_string().contains("line 2, column 3"));
    // Channel numbers under a title are names; a row of units may contain a 1.
    assert_eq!(of("Recorder,a,b\nx-axis,1,2\n0,1.5,2\n1,2.5,3\n").records[0].meta().name, "1");
    assert_eq!(of("No,Time,Acc\n1,s,V\n1,0,2.5\n2,1,3\n3,2,3\n").records.last().unwrap().meta().name, "Acc");
}

#[test]
fn grouped_whole_numbers_are_asked_about_and_read_as_stated() {
    let point = Reader::new().decimal_comma(Some(false));
    for (text, comma) in [
        ("t [s]\tF [N]\n0\t\"998\"\n1\t\"-1,000\"\n", false),
        ("t [s],F [N]\n0,998\n1,\"-1,000\"\n", false),
        ("t [s];F [N]\n0;998\n1;-1.000\n", true),
    ] {
        let error = read_with(&Reader::new(), text).unwrap_err().to_string();
        assert!(error.contains("line 3, column") && error.contains("(decimal)"), "{text}: {error}");
        let stated = read_with(&point.clone().decimal_comma(Some(comma)), text).unwrap();
        assert_eq!(values(&stated.records[0]), [998.0, -1000.0], "{text}");
        let other = read_with(&point.clone().decimal_comma(Some(!comma)), text);
        if let Ok(other) = other.map_err(|why| assert!(text.contains(',') && !comma, "{text}: {why}")) {
            assert_eq!(values(&other.records[0]), [998.0, -1.0], "{text}");
        }
    }
    // A zero before the mark, different numbers of decimals, or decimals in every cell: no thousands
    // separators.
    for text in ["t;a\n0;0,125\n1;1,125\n2;3\n", "t;a\n0;1,125\n1;1,5\n2;3\n", "t;a\n0;1,125\n1;1,500\n"] {
        assert_eq!(values(&of(text).records[0])[1], if text.contains("1,5") { 1.5 } else { 1.125 }, "{text}");
    }
}

#[test]
fn decimal_commas_in_quotes_between_commas() {
    let recording = of("Time (s),A (V)\n\"0,000\",\"-1,5\"\n\"0,001\",\"2,25\"\n");
    assert_eq!(values(&recording.records[0]), [-1.5, 2.25]);
    assert_eq!(*recording.records[0].axis(), Axis::time(0.0, 1e-3, 2));
}

/// Noise in columns below a stated step may be one series or several channels, so the user is asked.
#[test]
fn columns_under_the_step_of_a_series_are_asked_about() {
    let mut noise = vibro_math::Noise::new(7);
    let drawn: Vec<f64> = (0..75).map(|_| (noise.normal() * 1e3).round() / 1e3).collect();
    let row = |row: &[f64]| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n";
    let rows: String = drawn.chunks(5).map(row).collect();
    let with = |head: &str, reader: Reader| reader.from_reader("x.txt", (head.to_owned() + &rows).as_bytes());
    for head in ["dt = 0.001 s\n", "NPTS= 500, DT= .001 SEC\n", "NPTS= 60, DT= .001 SEC\n"] {
        let error = with(head, Reader::new()).unwrap_err().to_string();
        assert!(error.contains("(wrapped, columns)"), "{head}: {error}");
        let series = with(head, Reader::new().wrapped(Some(true))).unwrap();
        assert_eq!(values(&series.records[0]), drawn, "{head}");
        assert_eq!(has_finding(&series.all_findings(), "fewer-values", &[]), head.contains("NPTS"), "{head}");
        assert_eq!(with(head, Reader::new().wrapped(Some(false))).unwrap().records.len(), 5);
    }
    for head in ["Sampling rate: 1000 Hz\n", "NPTS= 15, DT= .001 SEC\n", ""] {
        assert_eq!(with(head, Reader::new()).unwrap().records.len(), 5, "{head}");
    }
    // The first line as Fortran programs write it: the number of values shows that it is one series.
    let series = with("  75  0.001\n", Reader::new()).unwrap();
    assert_eq!((values(&series.records[0]), series.records[0].axis().step()), (&drawn[..], Some(1e-3)));
    let error = with("  80  0.001\n", Reader::new()).unwrap_err().to_string();
    assert!(error.contains("(wrapped, columns)"), "{error}");
}

#[test]
fn clocks_before_a_trigger_and_of_days() {
    let recording = of("Elapsed Time,a\n-00:00:00.2,1\n-00:00:00.1,2\n00:00:00.0,3\n00:00:00.1,4\n");
    let axis = recording.records[0].axis();
    assert!(axis.len() == 4 && axis.step().is_some_and(|step| (step - 0.1).abs() < 1e-12), "{axis:?}");
    let recording = of("Time,a\n0.23:59:58,1\n0.23:59:59,2\n1.00:00:00,3\n1.00:00:01,4\n");
    assert_eq!(recording.records[0].axis(), &Axis::time(0.0, 1.0, 4));
}

#[test]
fn units_of_times_that_mean_something_else_elsewhere() {
    for (unit, factor) in [
        ("h", 3600.0),
        ("H", 3600.0),
        ("days", 86_400.0),
        ("Min", 60.0),
        ("S", 1.0),
        ("MS", 1e-3),
        ("us", 1e-6),
    ] {
        for text in [format!("Time ({unit}),a\n"), format!("Time [{unit}],a\n")] {
            let recording = of(text.clone() + "0,1\n1,2\n2,3\n");
            assert_eq!(recording.records[0].axis(), &Axis::time(0.0, factor, 3), "{text}");
            assert!(!has_finding(&recording.findings, "axis-unit-unknown", &[]), "{text}");
        }
    }
    assert_eq!(of("Time,a\nh,V\n0,1\n1,2\n").records[0].axis().step(), Some(3600.0));
    // Statistics above the names are not units.
    assert_eq!(of("Time,Force\n(s),(N)\nMin,-1\nMax,1\n0,1\n1,2\n").records[0].meta().name, "Force");
    let others = of("Time (s),Drop (d),Acc (Min),AI 2 (Gs),CH1(MV)\n0,1,2,3,4\n1,1,2,3,4\n");
    assert!(others.records.iter().zip([1.0, 2.0, 3.0, 4.0]).all(|(r, v)| values(r) == [v, v]));
}

#[test]
fn a_unit_above_all_is_that_of_those_without_one_and_said_of_several() {
    let one = of("Unit: g\nTime (s),Acc,Speed (rpm)\n0,1,60\n1,1,60\n");
    assert_eq!((values(&one.records[0]), values(&one.records[1])), (&[9.80665; 2][..], &[1.0; 2][..]));
    let two = of("Unit: g\nTime (s),Acc,Force\n0,1,2\n1,1,2\n");
    assert_eq!((values(&two.records[0]), values(&two.records[1])), (&[9.80665; 2][..], &[19.6133; 2][..]));
    assert!(has_finding(&two.all_findings(), "unit-for-all", &["unit=g", "n=2"]));
    assert!(!has_finding(&one.all_findings(), "unit-for-all", &[]));
}

#[test]
fn a_rate_with_a_comma_before_three_digits_is_named_as_what_it_may_be() {
    let found = of("Sampling rate,\"51,200\"\nacc (g),force (N)\n1,2\n3,1\n2,2\n");
    assert!(
        has_finding(&found.findings, "abscissa-unsaid", &["said=51,200", "decimal=51.2", "grouped=51200"]),
        "{:?}",
        found.findings
    );
    assert_eq!(found.records[0].axis().kind, AxisKind::Index);
}

#[test]
fn three_digits_behind_every_mark_are_said_to_be_groups_perhaps() {
    let rows = |rows: &str| of(format!("Time (ms);Force (N)\n{rows}"));
    let said =
        |found: &Recording, facts: &[&str]| has_finding(&found.findings, "digits-may-be-grouped", facts);
    let comma = rows("0;16,166\n1;17,216\n2;18,104\n");
    assert!(said(&comma, &["columns=Force", "cell=16,166", "other=point"]), "{:?}", comma.findings);
    assert!(said(&rows("0;16.166\n1;17.216\n2;18.104\n"), &["other=comma"]));
    let plain = Reader::new().from_reader("x.txt", &b"fs: 1000 Hz\nForce (N)\n16,129\n17,041\n"[..]).unwrap();
    assert!(said(&plain, &["cell=16,129"]), "{:?}", plain.findings);
    // No finding if any column shows that the mark is decimal, or if the user states it.
    assert!(!said(&rows("0;16.166\n1;0.216\n2;18.104\n"), &[]));
    assert!(!said(&of("Time (s);Force (N)\n0.000;16.166\n0.001;17.216\n"), &[]));
    let stated = Reader::new()
        .decimal_comma(Some(true))
        .from_reader("x.csv", &b"a;b\n1;16.166\n3;17.216\n"[..])
        .unwrap();
    assert!(!said(&stated, &[]));
    assert_eq!(values(&stated.records[1]), [16_166.0, 17_216.0]);
}

#[test]
fn a_scale_that_a_head_states_is_said_where_values_may_lack_it() {
    let scale = |head: &str, unit: &str| {
        let found = of(format!("{head}\nTime (s),A ({unit})\n0.0,0.5\n0.1,1.5\n0.2,0.5\n")).all_findings();
        let said = found.iter().find(|found| found.code == "scale-in-head")?.facts.clone();
        Some(format!("{said:?}"))
    };
    for (head, words) in [
        ("Multiplier,0.001", "multiplier: 0.001"),
        ("Gain = 10", "gain: 10"),
        ("# Sensitivity: 10.2 mV/(m/s²)", "10.2 mV/(m/s²)"),
        ("Scale: 1 V/g", "scale: 1 V/g"),
        ("Voltage divider: 10", "10"),
    ] {
        let said = scale(head, "V").unwrap_or_else(|| panic!("{head}"));
        assert!(said.contains(words), "{head}: {said}");
    }
    assert!(scale("Multiplier: 0.001", "m/s²").is_some());
    for (head, unit) in [
        ("Gain: 1", "V"),
        ("Gain: 0 dB", "V"),
        ("Multiplier: 1", "V"),
        ("Scale: linear", "V"),
        // With a unit of motion, the sensitivity is already included in the values.
        ("Sensitivity: 10.2 mV/(m/s²)", "m/s²"),
        ("Gain: 10", "m/s²"),
    ] {
        assert_eq!(scale(head, unit), None, "{head}");
    }
}

#[test]
fn a_row_of_units_that_contradicts_a_name_is_said() {
    let rows = "0.0,0.5\n0.1,1.5\n0.2,0.5\n";
    let found = of(format!("Time [s],Acc [m/s²]\ns,g\n{rows}"));
    assert!(has_finding(&found.all_findings(), "unit-row-differs", &["head=m/s²", "used=g"]));
    let times = of(format!("Time [s],Acc [g]\nms,g\n{rows}"));
    assert!(has_finding(&times.all_findings(), "axis-row-differs", &["head=s", "used=ms"]));
    let other = of(format!("Time [s],Acc [m/s²]\ns,mm/s\n{rows}"));
    assert!(has_finding(&other.all_findings(), "quantity-row-differs", &["head=m/s²", "used=mm/s"]));
    let motion = of(format!("Time [s],Acceleration [mm/s]\n{rows}"));
    let said = ["word=acceleration", "used=mm/s", "quantity=velocity"];
    assert!(
        has_finding(&motion.all_findings(), "quantity-name-differs", &said),
        "{:?}",
        motion.all_findings()
    );
    for name in ["Velocity [mm/s]", "Integrated acceleration [mm/s]", "Force at acceleration [N]"] {
        let found = of(format!("Time [s],{name}\n{rows}"));
        assert!(!has_finding(&found.all_findings(), "quantity-name-differs", &[]), "{name}");
    }
    let same = of(format!("Time [s],Acc [m/s²]\ns,m/s²\n{rows}"));
    assert!(same.all_findings().is_empty(), "{:?}", same.all_findings());
    assert_eq!(same.records[0].meta().name, "Acc");
}

#[test]
fn values_that_stand_several_times_each_are_said() {
    let sine = |i: usize| (0.7 * i as f64).sin();
    let said = |value: &dyn Fn(usize) -> f64| {
        let rows: String =
            (0..400).fold(String::new(), |all, i| all + &format!("{i},{:.4},{}\n", value(i), sine(i)));
        let found = of(format!("Time (ms),A (g),B (g)\n{rows}")).findings;
        found.into_iter().find(|found| found.code == "values-held").map(|found| format!("{:?}", found.facts))
    };
    for n in [2, 4] {
        let found = said(&|i| sine(i / n)).unwrap_or_else(|| panic!("{n}"));
        assert!(found.contains(&format!("Number({n}.0)")) && found.contains("\"A\""), "{found}");
    }
    // Not reported: a coarsely quantised signal, a switch, even steps, a rest before a motion, and a sine.
    let others: [&dyn Fn(usize) -> f64; 5] = [
        &|i| (4.0 * (0.05 * i as f64).sin()).round(),
        &|i| f64::from((i / 4).is_multiple_of(2)),
        &|i| (i / 4) as f64,
        &|i| if i < 200 { 0.0 } else { sine(i) },
        &sine,
    ];
    for (at, value) in others.iter().enumerate() {
        assert_eq!(said(*value), None, "{at}");
    }
}

#[test]
fn a_minus_of_any_kind_is_one_and_brackets_are_asked_about() {
    let text = |cell: &str| format!("Time (s);Acc (g)\n0.0;0.5\n0.1;{cell}\n0.2;0.5\n");
    for cell in ["-1.5", "−1.5", "–1.5", "1.5-"] {
        assert_eq!(values(&of(text(cell)).records[0])[1], -1.5 * 9.806_65, "{cell}");
    }
    let brackets = Reader::new().from_reader("x.csv", text("(1.5)").as_bytes()).unwrap_err().to_string();
    assert!(brackets.contains("write -1.5"), "{brackets}");
    assert!(Reader::new().from_reader("x.csv", text("--1.5").as_bytes()).is_err());
}

#[test]
fn rows_with_names_in_quotes_below_a_shorter_line_of_names() {
    let rows = "\"1\" 0 0.5 1\n\"2\" 0.001 1.5 3\n\"3\" 0.002 2.5 5\n";
    let text = format!("\"time\" \"acc.mps2\" \"force (N)\"\n{rows}");
    let found = Reader::new().from_reader("x.txt", text.as_bytes()).unwrap();
    let names: Vec<&str> = found.records.iter().map(|record| record.meta().name.as_str()).collect();
    assert_eq!((names, values(&found.records[1])), (vec!["acc.mps2", "force"], &[1.0, 3.0, 5.0][..]));
    assert_eq!(found.records[0].axis(), &Axis::time(0.0, 1e-3, 3));
}

#[test]
fn magnitude_and_phase_of_a_function_are_one_complex_record() {
    let table = |names: &str| of(format!("{names}\n1.0,2.0,90\n2.0,4.0,180\n3.0,1.0,-90\n4.0,1.0,0\n"));
    let function = table("Frequency (Hz),Magnitude (g/N),Phase (deg)");
    let [Record::Frf(record)] = function.records.as_slice() else { panic!("{:?}", function.records) };
    let values = &record.values;
    assert!((values[0] - Complex64::new(0.0, 2.0 * 9.806_65)).norm() < 1e-12, "{values:?}");
    assert!((values[1] - Complex64::new(-4.0 * 9.806_65, 0.0)).norm() < 1e-12, "{values:?}");
    // 20 dB are a factor of ten of the reference, which may be any multiple of the unit.
    for (names, one) in
        [("Frequency (Hz),Level (dB re 1 m/N),Phase (deg)", 1.0), ("f (Hz),H (dB re 1 µm/N),Phase (°)", 1e-6)]
    {
        let function = table(names);
        let [Record::Frf(record)] = function.records.as_slice() else { panic!("{:?}", function.records) };
        let expected = [2.0, 4.0, 1.0, 1.0].map(|level| one * 10f64.powf(level / 20.0));
        for (value, size) in record.values.iter().zip(expected) {
            assert!((value.norm() / size - 1.0).abs() < 1e-12, "{names}: {value} {size}");
        }
        assert!((record.values[0].arg().to_degrees() - 90.0).abs() < 1e-9, "{names}");
    }
    // A response beside its force is not a function, and an angle beside a function is not its phase.
    for names in ["Frequency (Hz),Amp (µm),Phase (deg)", "Frequency (Hz),Magnitude (g/N),Tilt (deg)"] {
        assert_eq!(table(names).records.len(), 2, "{names}");
    }
}

#[test]
fn what_is_said_of_a_table_that_cannot_be_read_as_it_is() {
    let why = |text: &str| Reader::new().from_reader("x.csv", text.as_bytes()).unwrap_err().to_string();
    let commas = why("Time (s),Acc (m/s²)\n0,000,1,16602\n0,001,2,24792\n");
    assert!(commas.contains("cannot separate cells, too"), "{commas}");
    let rows: String = (0..40)
        .map(|i| format!("{i},{},0.{}\n", if i % 2 == 0 { "A" } else { "B" }, i * i % 7))
        .collect::<Vec<_>>()
        .concat();
    let words = why(&format!("Time (ms),sensor,acc (g)\n{rows}"));
    assert!(words.contains("keep the rows of one word") && !words.contains("take out"), "{words}");
    let numbers = why(&format!("Time (ms),id,acc (g)\n{}", rows.replace('A', "1").replace('B', "2")));
    assert!(numbers.contains("keep the rows of one number") && !numbers.contains("take out"), "{numbers}");
    let batch = |rate: f64, lost: bool| {
        let kept = (0..200).filter(|i| !lost || !(50..100).contains(i));
        let rows: String =
            kept.map(|i| format!("{},{}\n", (i / 10) * 20, i * i % 7)).collect::<Vec<_>>().concat();
        Reader::new()
            .rate(Some(rate))
            .from_reader("x.csv", format!("timestamp_ms,acc (g)\n{rows}").as_bytes())
    };
    let even = batch(500.0, false).unwrap();
    assert_eq!(even.records[0].axis(), &Axis::time(0.0, 2e-3, 200));
    let lost = batch(500.0, true).unwrap_err().to_string();
    assert!(lost.contains("where samples are missing") && !lost.contains("--rate"), "{lost}");
}

#[test]
fn days_of_a_sheet_with_decimal_commas_and_epochs_in_microseconds() {
    let rows: String = (0..100)
        .map(|i| format!("45413,{:010};1,{}\n", 5_000_000_000_u64 + 1157 * i, i * i % 7))
        .collect::<Vec<_>>()
        .concat();
    let days = of(format!("Datum;Schwinggeschw. [mm/s]\n{rows}"));
    assert_eq!(days.records[0].axis().kind, AxisKind::Time);
    assert!((1.0 / days.records[0].axis().step().unwrap() - 100.0).abs() < 0.1);
    let rows: String = (0..100)
        .map(|i| format!("{},1.{}\n", 1_714_556_000_123_456_u64 + 500 * i, i * i % 7))
        .collect::<Vec<_>>()
        .concat();
    let epoch = of(format!("ts,\"Accel, m/s²\"\n{rows}"));
    assert!((epoch.records[0].axis().step().unwrap() - 5e-4).abs() < 1e-9);
    // A date printed as a number is in a column beside its clock.
    let rows: String =
        (0..20).map(|i| format!("20240501,12:00:{i:02}.000,{}\n", i * i % 7)).collect::<Vec<_>>().concat();
    let dated = of(format!("Date,Time,acc (g)\n{rows}"));
    assert!(dated.records.iter().all(|record| record.axis().kind == AxisKind::Time));
}

#[test]
fn seconds_and_their_parts_in_two_columns() {
    for (names, unit) in [("tv_sec,tv_usec", 1000), ("header.stamp.secs,header.stamp.nsecs", 1_000_000)] {
        let row = |i: usize| {
            format!("{},{},{}.5\n", 1_714_556_000 + (i + 950) / 1000, (i + 950) % 1000 * unit, i * i % 7)
        };
        let found = of(format!("{names},acc (g)\n{}", (0..200).map(row).collect::<String>()));
        assert_eq!(found.records.len(), 1, "{names}");
        let step = found.records[0].axis().step().unwrap();
        assert!((step - 1e-3).abs() < 1e-9, "{names}: {step}");
    }
    // A cell that is not a whole number: the columns are not joined.
    let odd = of("sec,usec,acc (g)\n1.5,3,2.5\n2.5,4,3.5\n3.5,9,4.5\n");
    assert_eq!((odd.records.len(), odd.records[0].axis().start()), (2, 1.5));
}

#[test]
fn a_head_that_says_that_the_abscissa_is_a_frequency() {
    let rows: String =
        (0..40).map(|i| format!("{}\t{i}.0\t{}.5\n", i + 1, i * i % 7)).collect::<Vec<_>>().concat();
    let head =
        "Function:\tAutospectrum\nX-Axis:\tFrequency [Hz]\nY-Axis:\tAcceleration [dB/1E-6 m/s²]\nData:\n";
    let Record::Spectrum(spectrum) = plain(&format!("{head}{rows}")) else { panic!() };
    assert_eq!(spectrum.axis.step(), Some(1.0));
    assert!(spectrum.meta.unit.is_level(), "{:?}", spectrum.meta);
    // A rate would turn the spectrum into a time trace.
    let rated = Reader::new().rate(Some(100.0)).from_reader("x.txt", format!("{head}{rows}").as_bytes());
    assert!(rated.unwrap_err().to_string().contains("holds a frequency"));
}

#[test]
fn two_rates_of_a_head_and_scales_of_channels_are_said() {
    let found = |head: &str| of(format!("{head}\nA (V);B (V)\n0.5;1.5\n2.5;3.5\n")).all_findings();
    for head in
        ["Sampling rate: 2000 Hz\nSample interval: 1 ms", "Sample interval: 1 ms\nSampling rate: 2000 Hz"]
    {
        assert!(has_finding(&found(head), "rates-differ", &["rate=2000", "other=1000"]), "{head}");
    }
    assert!(!has_finding(&found("Sampling rate: 3000 Hz\nSample interval: 0.33 ms"), "rates-differ", &[]));
    for head in [
        "Sensitivity Ch1: 2.25 mV/N",
        "Ch1 sensitivity (mV/g): 100",
        "Sens.: 100 mV/g",
        "Attenuation: 10x",
        "Amplifier gain: 10",
    ] {
        assert!(has_finding(&found(head), "scale-in-head", &[]), "{head}: {:?}", found(head));
    }
    assert!(!has_finding(&found("Attenuation: 1x"), "scale-in-head", &[]));
    // A stated calibration removes the finding.
    let mut answered = of("Gain: 10\ntime [s],u [V]\n0,1\n0.1,2\n");
    assert!(has_finding(&answered.findings, "scale-in-head", &[]), "{:?}", answered.findings);
    answered.take_trace(None, Some(0.1)).unwrap();
    assert!(!has_finding(&answered.findings, "scale-in-head", &[]), "{:?}", answered.findings);
}

#[test]
fn samples_that_a_counter_leaves_out_are_missed() {
    let text = |gap: usize, head: &str| {
        let row = |i: usize| format!("{},{:.4}\n", if i < 50 { i } else { i + gap }, (0.3 * i as f64).sin());
        format!("{head}\n{}", (0..100).map(row).collect::<String>())
    };
    for name in ["Packet", "Sample", "Index", "Seq"] {
        let head = format!("Sample rate: 1000 Hz\n{name},Acc (m/s²)");
        let error = Reader::new().from_reader("x.csv", text(7, &head).as_bytes()).unwrap_err().to_string();
        assert!(error.contains("goes from 49 to 57") && error.contains("7 there"), "{name}: {error}");
        assert_eq!(of(text(0, &head)).records.len(), 1, "{name}");
    }
    // A column that rises by other steps is not a sample counter.
    assert_eq!(of(text(7, "Sample rate: 1000 Hz\nPosition (mm),Acc (m/s²)")).records.len(), 2);
}

#[test]
fn decimal_commas_below_a_rate_tell_that_its_point_groups_digits() {
    let rate = |text: &str| of(text).records[0].axis().step().map(|step| (1.0 / step).round());
    assert_eq!(rate("Abtastrate: 1.000 Hz\nA (V);B (V)\n0,5;1,5\n2,5;3,5\n"), Some(1000.0));
    for head in [
        "fs=1,6 kHz; N=4096; Kanal: a1 / ms^-2",
        "fs=1,6 kHz | N=4096",
        "fs=1,6 kHz, N=4096",
        "N=4096, fs=1600 Hz",
    ] {
        assert_eq!(rate(&format!("{head}\nA (V);B (V)\n0,5;1,5\n2,5;3,5\n")), Some(1600.0), "{head}");
    }
    assert_eq!(rate("Sample rate: 1,000 Hz\nA (V);B (V)\n0.5;1.5\n2.5;3.5\n"), Some(1000.0));
    // Whole numbers do not show the decimal mark.
    let whole = of("Abtastrate: 1.000 Hz\nA (V);B (V)\n5;15\n25;35\n");
    assert!(has_finding(&whole.findings, "abscissa-unsaid", &["decimal=1", "grouped=1000"]));
    // Decimation is reported: the rate may be the one before decimation.
    let kept = of("Sampling rate: 2000 Hz, decimated by 2\nA (V);B (V)\n0.5;1.5\n2.5;3.5\n");
    assert!(has_finding(&kept.findings, "rate-decimated", &["rate=2000"]), "{:?}", kept.findings);
    for head in [
        "Sampling rate: 8 kHz, downsampled to 1 kHz",
        "Rate: 8 kHz\nEvery 8th sample stored",
        "Rate: 8 kHz\nResampled: 500 Hz",
    ] {
        let kept = of(format!("{head}\nA (V);B (V)\n0.5;1.5\n2.5;3.5\n"));
        assert!(has_finding(&kept.findings, "rate-decimated", &["rate=8000"]), "{head}: {:?}", kept.findings);
    }
}

#[test]
fn what_a_preamble_states() {
    for (head, step) in [
        ("Sample Rate;51200,0", Some(1.0 / 51_200.0)),
        ("Sample Rate;51,2;kHz", Some(1.0 / 51_200.0)),
        ("Sampling rate: 500 mHz", Some(2.0)),
        ("Sampling rate [mHz]: 500", Some(2.0)),
        ("Sampling rate: 2 MHz", Some(0.5e-6)),
        ("Start: 0\nIncrement: 0.5", Some(0.5)),
        ("Increment;0,5;ms", Some(0.5e-3)),
        // Ambiguous: 51.2 or 51 200 Hz; a step or a rate without a unit.
        ("Sample Rate: 51,200", None),
        ("Increment;100", None),
        ("Rate: 10", None),
    ] {
        let recording = of(format!("{head}\nA (V);B (V)\n0,5;1,5\n2,5;3,5\n"));
        let axis = recording.records[0].axis();
        let close = |step: f64| axis.step().is_some_and(|found| (found / step - 1.0).abs() < 1e-12);
        assert!(step.map_or(axis.kind == AxisKind::Index, close), "{head}: {axis:?}");
    }
    let one = of("Sample Interval (us),20\nCH1 (V)\n0.5\n0.25\n");
    assert_eq!(one.records[0].axis().kind, AxisKind::Time);
}

#[test]
fn an_epoch_is_taken_off_before_it_is_scaled() {
    let rows: String = (0..50).map(|i| (1_700_000_000_000_u64 + i).to_string() + ",1\n").collect();
    let recording = of("Timestamp (ms),Acc (g)\n".to_owned() + &rows);
    assert_eq!(recording.records[0].axis(), &Axis::time(0.0, 1e-3, 50));
    // A few seconds in ms are not times since 1970.
    assert_eq!(of("Time (ms),a\n5000,1\n5001,2\n5002,3\n").records[0].axis().start(), 5.0);
}

#[test]
fn two_numbers_of_a_clock_are_said_to_be_hours_and_minutes() {
    let said = |text: &str| has_finding(&of(text).all_findings(), "axis-clock-minutes", &[]);
    assert!(said("Time,a\n00:00,1\n00:01,2\n00:02,3\n"));
    assert!(!said("Time,a\n0:00:00,1\n0:00:01,2\n0:00:02,3\n"));
    assert!(!said("Time,a\n00:00.0,1\n00:00.5,2\n00:01.0,3\n"));
    assert!(!said("Time,a\n2020-01-24 00:00,1\n2020-01-24 00:01,2\n2020-01-24 00:02,3\n"));
}

#[test]
fn words_below_the_rows_are_put_behind_a_mark() {
    let error = read_with(&Reader::new(), "Time (s),a\n0,1\n1,2\nMax,2\n\n").unwrap_err().to_string();
    assert!(
        error.contains("line 4, column 1") && error.contains("put #") && !error.contains("allow"),
        "{error}"
    );
    assert_eq!(of("Time (s),a\n0,1\n1,2\n#Max,2\n\n").records[0].axis().len(), 2);
}

#[test]
fn missing_values_are_no_names() {
    for missing in ["NaN,NaN", "NaT,inf", ",NaN", "-nan,nan"] {
        let head = format!("time [s],strain\n{missing}\n{missing}\n");
        let rows = "0.0,1\n0.1,2\n0.2,4\n0.3,3\n";
        let found =
            Reader::new().from_reader("x.csv", format!("{head}{rows}{missing}\n").as_bytes()).unwrap();
        let Record::Trace(trace) = &found.records[0] else { panic!("{found:?}") };
        assert_eq!(
            (trace.meta.name.as_str(), trace.values.as_slice()),
            ("strain", &[1.0, 2.0, 4.0, 3.0][..])
        );
        assert_eq!(trace.axis, Axis::time(0.0, trace.axis.step().unwrap(), 4));
        assert!(has_finding(&found.findings, "rows-empty", &["n=3"]), "{:?}", found.findings);
    }
}

/// `ImageJ` saves a summary of its tracks above their rows; a logger may append a summary.
#[test]
fn of_two_tables_the_longer_is_read_and_the_other_counted() {
    let rows = (0..30).map(|i| format!("{i}\t{}\t50.5\n", 2 * i + i % 3)).collect::<Vec<_>>().concat();
    let summary = "\tTrack\tLength\tFrames\n1\t1\t33.5\t275\n2\t2\t44.5\t275\n";
    let names = "Frame\tX1\tY1\n";
    for text in [
        format!("{summary}Tracks 1 to 1\n{rows}"),
        format!("{summary}Tracks 1 to 1\n{names}{rows}"),
        format!("{names}{rows}\n{summary}"),
    ] {
        for name in ["x.txt", "x.csv"] {
            let found = Reader::new().from_reader(name, text.as_bytes()).unwrap();
            assert_eq!(found.records.last().unwrap().len(), 30, "{name}: {text}");
            assert!(has_finding(&found.findings, "table-left-out", &["n=2"]), "{:?}", found.findings);
        }
    }
    // Tables of similar length: the user must choose.
    let two = format!("{names}{rows}Track 2\n{names}{rows}");
    let said = Reader::new().from_reader("x.csv", two.as_bytes()).unwrap_err().to_string();
    assert!(said.contains("line 32") && said.contains("to a file of its own"), "{said}");
}

#[test]
fn rows_of_numbers_in_a_head_are_counted() {
    let rows = (0..30).map(|i| format!("{i},{},50.5\n", 2 * i + i % 3)).collect::<Vec<_>>().concat();
    let text = format!("1 1 33.5 5.2\n2 2 44.5 9.2\nFrame,X1,Y1\n{rows}");
    let found = of(text);
    assert_eq!(found.records[0].len(), 30);
    assert!(has_finding(&found.findings, "rows-in-head", &["n=2"]), "{:?}", found.findings);
}

#[test]
fn blank_lines_at_even_distances_separate_and_others_are_missing_values() {
    let blocks = |every: usize| -> String {
        (0..60).map(|i| if i % every == every - 1 { "0.5\n\n" } else { "1.5\n" }).collect()
    };
    for every in [1, 2, 10] {
        let found = read_with(&Reader::new(), blocks(every)).unwrap();
        assert_eq!((found.records[0].len(), found.records[0].axis().len()), (60, 60), "{every}");
    }
    let odd = "1.5\n2.5\n\n3.5\n\n4.5\n5.5\n6.5\n\n7.5\n";
    let why = read_with(&Reader::new(), odd).unwrap_err().to_string();
    assert!(why.contains("3 missing values"), "{why}");
    let kept = read_with(&Reader::new().allow_missing(true), odd).unwrap();
    let (values, _) = kept.records[0].numbers();
    let places: Vec<usize> = (0..values.len()).filter(|i| values[*i].is_nan()).collect();
    assert_eq!((values.len(), places), (10, vec![2, 4, 8]));
}

#[test]
fn an_unknown_unit_in_brackets_is_named_and_plain_ones_are_known() {
    let found = of("Time (s),B (µT),C (G),D (hPa),E (left)\n0,1,2,3,4\n0.1,2,3,4,5\n0.2,1,2,3,4\n");
    let unit = |i: usize| found.records[i].meta().unit.symbol().to_owned();
    assert_eq!((unit(0), unit(2)), ("T".to_owned(), "Pa".to_owned()));
    let (values, _) = found.records[2].numbers();
    assert_eq!(values, [300.0, 400.0, 300.0]);
    assert!(has_finding(&found.records[1].meta().findings, "unit-unknown", &["unit=G"]));
    assert!(has_finding(&found.records[3].meta().findings, "unit-unsaid", &[]));
}

#[test]
fn an_uneven_first_column_without_a_name_has_no_unit() {
    let row = |i: usize| format!("{} {}\n", i * i + i, i % 7);
    let rows = (0..30).map(row).collect::<Vec<String>>().concat();
    let source = Source::memory("x.txt", rows.into_bytes()).unwrap();
    let (_, headers, _) = Reader::new().headers(&source).unwrap();
    assert_eq!((headers[0].x_unit, headers[0].dx), ("", None));
}

#[test]
fn values_of_one_sign_and_an_analysers_number_are_lines_of_the_base_band() {
    let lines = |value: &dyn Fn(usize) -> f64, n| {
        let rows: Vec<String> = (0..n).map(|i| value(i).to_string()).collect();
        let reader = Reader::new().base_band(Some(400.0)).rate_of_base_band();
        read_with(&reader.unit(Unit::parse("V")), format!("{}\n", rows.join("\n"))).unwrap()
    };
    let amplitudes = lines(&|i| (i as f64).sin().abs(), 801);
    assert_eq!(amplitudes.records[0].axis(), &Axis::frequency(0.0, 0.5, 801));
    let found = amplitudes.all_findings();
    assert!(has_finding(&found, "values-are-lines", &["n=801", "band=400"]), "{found:?}");
    let levels = lines(&|i| -60.0 + (i as f64).sin(), 800);
    assert_eq!(levels.records[0].axis().kind, AxisKind::Frequency);
    // Another number of values, or values of both signs, are a time trace.
    for trace in [lines(&|i| (i as f64).sin().abs(), 1024), lines(&|i| (i as f64).sin(), 801)] {
        assert_eq!(trace.records[0].axis().step(), Some(1.0 / 1024.0));
        assert!(!has_finding(&trace.all_findings(), "values-are-lines", &[]));
    }
}

/// Times in whole ms, every 50th row lost: times with an even step of 50/49 ms would be printed equally.
#[test]
fn times_of_one_digit_may_hide_lost_rows() {
    let rows = |head: &str| {
        let kept = (0..3000).filter(|i| i % 50 != 7);
        let rows: Vec<String> = kept.map(|i| format!("{:.3},{i}.5", f64::from(i) * 1e-3)).collect();
        of(format!("{head}t [s],a [g]\n{}\n", rows.join("\n")))
    };
    let found = rows("").findings;
    assert!(has_finding(&found, "axis-rounded-or-lost", &["long=60", "n=2939"]), "{found:?}");
    // A rate in the header that agrees with the even step removes the doubt.
    let known = rows("Sampling rate: 980 Hz\n").findings;
    assert!(!has_finding(&known, "axis-rounded-or-lost", &[]), "{known:?}");
}

#[test]
fn marks_of_missing_values_and_zeros_that_fill_up_are_said() {
    let table = |value: &dyn Fn(usize) -> f64| {
        let rows: Vec<String> = (0..200).map(|i| format!("{},{}", i as f64 * 1e-3, value(i))).collect();
        of(format!("t [s],a [g]\n{}\n", rows.join("\n"))).findings
    };
    let signal = |i: usize| 2.0 * (0.37 * i as f64 + 0.1).sin();
    let marked = table(&|i| if i % 50 == 9 { -9999.0 } else { signal(i) });
    assert!(has_finding(&marked, "missing-marked", &["mark=-9999", "n=4"]), "{marked:?}");
    // Where missing values are allowed, they are taken as missing, as is a value of 1e30.
    for mark in [-9999.0, 1e30] {
        let rows: Vec<String> =
            (0..200).map(|i| format!("{i},{}", if i == 9 { mark } else { signal(i) })).collect();
        let text = format!("t [s],a [g]\n{}\n", rows.join("\n"));
        let found = read_with(&Reader::new().allow_missing(true), text).unwrap();
        assert!(has_finding(&found.all_findings(), "marks-as-missing", &["n=1"]), "{:?}", found.findings);
        let Record::Trace(trace) = &found.records[0] else { panic!("no trace") };
        let missing: Vec<usize> = (0..200).filter(|i| trace.values[*i].is_nan()).collect();
        assert_eq!(missing, [9]);
    }
    let filled = table(&|i| if i < 150 { signal(i) } else { 0.0 });
    assert!(has_finding(&filled, "filled-with-zeros", &["n=50", "end=0.15"]), "{filled:?}");
    // Values of a magnitude near the mark are measured, and a signal that rests at 0 is not padded.
    let near = table(&|i| if i % 50 == 9 { 999.0 } else { 300.0 * signal(i) });
    let rests = table(&|i| if (20..150).contains(&i) { signal(i) } else { 0.0 });
    for found in [near, rests, table(&signal)] {
        assert!(
            !found.iter().any(|f| ["missing-marked", "filled-with-zeros"].contains(&&*f.code)),
            "{found:?}"
        );
    }
}

#[test]
fn heads_against_names_and_steps_of_many_seconds_are_said() {
    let differs = of("Unit: mm/s\nt [s],v (m/s)\n0,1\n1,2\n");
    let found = differs.all_findings();
    assert!(has_finding(&found, "unit-head-differs", &["head=mm/s", "used=m/s"]), "{found:?}");
    // The same unit, or a unit of another quantity, is not a contradiction.
    for head in ["Unit: m/s", "Unit: N"] {
        let found = of(format!("{head}\nt [s],v (m/s)\n0,1\n1,2\n")).all_findings();
        assert!(!has_finding(&found, "unit-head-differs", &[]), "{found:?}");
    }
    let period = of("Sample period: 500\na;b\n1;2\n3;4\n");
    let found = period.all_findings();
    assert!(has_finding(&found, "head-step-assumed", &["key=sample period", "step=500"]), "{found:?}");
}

#[test]
fn a_number_sign_names_the_column_of_row_numbers() {
    let table = of("Sample rate: 1000 Hz\n#,Acc (m/s²)\n0,1.5\n1,2.5\n2,-1.5\n");
    assert_eq!(table.records.len(), 1);
    assert_eq!((table.records[0].meta().name.as_str(), table.records[0].axis().step()), ("Acc", Some(1e-3)));
    let lost = read_with(
        &Reader::new(),
        format!(
            "#,Acc\n{}",
            (0..20).filter(|i| *i != 7).fold(String::new(), |mut all, i| {
                let _ = writeln!(all, "{i},{}.5", i % 3);
                all
            })
        ),
    );
    assert!(lost.unwrap_err().to_string().contains("samples are missing, 1 there"));
}
