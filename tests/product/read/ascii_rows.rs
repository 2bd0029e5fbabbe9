//! Analyser text in every encoding and layout that instruments write, and damaged in every way.

use super::sentences;
use vibroimpact::read::{Format, Reader, Recording};
use vibroimpact::record::{AxisKind, Record, Values};
use vibroimpact::units::Unit;

pub fn read(bytes: &[u8]) -> Recording {
    Reader::new().from_reader("x.txt", bytes).unwrap_or_else(|e| panic!("{e}"))
}

pub fn complaint(bytes: &[u8]) -> String {
    Reader::new().from_reader("x.txt", bytes).expect_err("must be refused").to_string()
}

pub fn values(recording: &Recording) -> Vec<f64> {
    match &recording.records[0] {
        Record::Trace(t) => t.values.clone(),
        Record::Spectrum(s) => match &s.values {
            Values::Real(v) => v.clone(),
            Values::Complex(_) => panic!("complex"),
        },
        Record::Frf(_) => panic!("an frf"),
    }
}

#[test]
fn the_same_numbers_in_every_encoding() {
    let text = "µ-Meter: no. 7\nunit: m/s²\n1.5\n-2.5e-1\n3\n";
    let crlf = text.replace('\n', "\r\n");
    let cr = text.replace('\n', "\r");
    let utf16 = |big: bool| -> Vec<u8> {
        let mark = std::iter::once(0xfeff);
        mark.chain(text.encode_utf16())
            .flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() })
            .collect()
    };
    let latin1: Vec<u8> = text.chars().map(|c| u8::try_from(c as u32).unwrap()).collect();
    let dresses: [Vec<u8>; 8] = [
        text.into(),
        crlf.into(),
        cr.into(),
        format!("\u{feff}{text}").into(),
        utf16(false),
        utf16(true),
        latin1,
        text.trim_end().into(), // no last newline
    ];
    for (i, bytes) in dresses.iter().enumerate() {
        let recording = read(bytes);
        assert_eq!(recording.format, Format::Ascii, "dress {i}");
        assert_eq!(values(&recording), [1.5, -0.25, 3.0], "dress {i}");
        assert_eq!(recording.records[0].meta().unit.symbol(), "m/s²", "dress {i}");
    }
}

#[test]
fn columns_and_separators() {
    for text in [
        "1 2\n3 4\n5 7\n",
        "1\t2\n3\t4\n5\t7\n",
        "1;2\n3;4\n5;7\n",
        "1, 2\n3, 4\n5, 7\n",
        "1.0,2\n3.0,4\n5.0,7\n",
    ] {
        // The first column rises evenly, so it is an abscissa with a step of 2.
        let recording = read(text.as_bytes());
        assert_eq!(recording.records.len(), 1, "{text:?}");
        assert_eq!(recording.records[0].axis().step(), Some(2.0), "{text:?}");
        assert_eq!(values(&recording), [2.0, 4.0, 7.0], "{text:?}");
    }
    let channels = read(b"5 1\n3 2\n9 1\n");
    assert_eq!(channels.records.len(), 2);
    assert!(sentences(&channels.all_findings()).iter().any(|d| d.contains("--complex")));
}

#[test]
fn decimal_commas() {
    assert_eq!(values(&read(b"3,0517\n-0,25\n")), [3.0517, -0.25]);
    assert_eq!(values(&read(b"1,5E-03\n2,5E-03\n")), [1.5e-3, 2.5e-3]);
    let error = complaint(b"1,5\n2,5\n");
    assert!(error.contains("x.txt, line 1") && error.contains("(decimal)"), "{error}");
    let told = Reader::new().decimal_comma(Some(true)).from_reader("x.txt", &b"1,5\n2,5\n"[..]).unwrap();
    assert_eq!(values(&told), [1.5, 2.5]);
}

#[test]
fn numbers_as_fortran_prints_them() {
    assert_eq!(values(&read(b" 1.0D+03\n 1.234-101\n 5.E+002\n")), [1e3, 1.234e-101, 500.0]);
}

#[test]
fn complex_values() {
    let recording = read(b"(1-2j)\n(3.5+4e-1j)\n");
    let Record::Spectrum(s) = &recording.records[0] else { panic!("{recording:?}") };
    let Values::Complex(v) = &s.values else { panic!("real") };
    assert_eq!((v[0].re, v[0].im, v[1].im), (1.0, -2.0, 0.4));
    let told = Reader::new()
        .complex(true)
        .base_band(Some(10.0))
        .unit(Unit::parse("m/N"))
        .from_reader("x.txt", &b"5 1\n3 2\n9 1\n"[..])
        .unwrap();
    assert_eq!(told.records[0].kind(), "frf");
    assert_eq!(told.records[0].axis().step(), Some(5.0));
    let named = read(b"freq [Hz] real imag\n1 5 6\n2 7 8\n3 9 1\n");
    assert!(named.records[0].is_complex());
    assert_eq!(named.records[0].axis().kind, AxisKind::Frequency);
}

#[test]
fn headers_state_axis_and_unit() {
    let recording = read(b"Lines: 4\nBase band: 20 Hz\nWindow: Hanning\nUnit: mm/s\n\n1\n2\n3\n4\n5\n");
    let Record::Spectrum(s) = &recording.records[0] else { panic!("{recording:?}") };
    assert_eq!(s.axis.step(), Some(5.0));
    assert_eq!(s.window.map(vibroimpact::record::Window::name), Some("hann"));
    assert_eq!(values(&recording)[4], 5e-3);
    assert!(s.meta.history.iter().any(|h| h.name == "to_si"));
    let short = read(b"Lines: 400\nBase band: 20 Hz\n1\n2\n");
    assert_eq!(short.records[0].meta().declared_n, Some(401));
    assert!(
        sentences(&short.all_findings()).iter().any(|d| d.contains("401") && d.contains("holds 2")),
        "{:?}",
        sentences(&short.all_findings())
    );
    let trace = read(b"Sampling rate: 128 Hz\nunit: apples\n1\n2\n");
    assert_eq!(trace.records[0].axis().step(), Some(1.0 / 128.0));
    assert!(sentences(&trace.all_findings()).iter().any(|d| d.contains("apples")));
}

#[test]
fn missing_values_are_refused_with_their_lines() {
    let text = b"1\nNaN\n3\n\n-inf\n6\n";
    let error = complaint(text);
    assert!(error.contains("line 2, 4, 5") && error.contains("allow_missing"), "{error}");
    let kept = Reader::new().allow_missing(true).from_reader("x.txt", &text[..]).unwrap();
    let kept_values = values(&kept);
    assert_eq!(kept_values.len(), 6);
    assert_eq!(kept_values.iter().filter(|v| v.is_nan()).count(), 3);
    assert!(sentences(&kept.all_findings()).iter().any(|d| d.starts_with("3 values are missing")));
    // Blank lines at the end are not values.
    assert_eq!(values(&read(b"1\n2\n\n\n")), [1.0, 2.0]);
    let fields = complaint(b"1;2\n3;\n;4\n");
    assert!(fields.contains("line 2"), "{fields}");
}

#[test]
fn every_complaint_has_a_place_and_a_way_on() {
    for (bytes, place, found) in [
        (&b"1\n2\nthree\n4\n"[..], "line 3, column 1", "three"),
        (b"1 2\n3 4\n5\n", "line 3", "1 field in this row"),
        (b"1 2\n3 4\n5 x\n", "line 3, column 3", "\"x\""),
        (b"1.5\n2.5\n3,5\n", "line 3", "2 fields in this row"),
        (b"no numbers here\n", "x.txt", "no table of numbers"),
        (b"1\n2\n1e999\n", "line 3", "1e999"),
    ] {
        let error = complaint(bytes);
        assert!(error.contains(place) && error.contains(found) && error.contains("try:"), "{error}");
    }
    assert!(complaint(b"").contains("empty"));
    assert!(complaint(&[0, 1, 2, 3, 255, 254, 0, 0, 9]).contains("not a format"));
}

#[test]
fn a_folder_and_a_missing_file_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = Reader::new().from_path(folder.path()).unwrap_err().to_string();
    assert!(error.contains("folder"), "{error}");
    let names: Vec<_> = ["a", "b", "c"].iter().map(|n| folder.path().join(n)).collect();
    std::fs::write(&names[1], "1\n2\n").unwrap();
    let error = Reader::new().from_paths(&names).unwrap_err().to_string();
    assert!(error.contains("cannot open") && error.contains("no such file"), "{error}");
}

#[test]
fn a_declared_count_allocates_nothing() {
    // The header declares 10¹⁰ lines, the file has five values.
    let recording = read(b"Lines: 10000000000\nBase band: 20 Hz\n1\n2\n3\n4\n5\n");
    assert_eq!(recording.records[0].len(), 5);
}

#[test]
fn a_large_file_read_in_pieces_is_the_same() {
    // Long enough for several pieces: lines of different length, blank lines at the end.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.txt");
    let numbers: Vec<f64> = (0..400_000).map(|i| f64::from(i) * 1.37 - 5e4).collect();
    let text: String = numbers.iter().map(f64::to_string).collect::<Vec<_>>().join("\n") + "\n\n\n";
    std::fs::write(&path, &text).unwrap();
    let recording = Reader::new().from_path(&path).unwrap();
    assert!(values(&recording) == numbers);
    let (format, headers, _) = Reader::new().survey(&path).unwrap();
    assert_eq!((format, headers[0].n), (Format::Ascii, numbers.len()));
    assert_eq!(headers[0].max_abs, recording.records[0].extremes().largest().map(|m| m.1));
    // A word far inside the file is reported with its line.
    std::fs::write(&path, text.replacen("-49999.94", "oops", 0) + "x\n").unwrap();
    let error = Reader::new().from_path(&path).unwrap_err().to_string();
    assert!(error.contains("line 400003"), "{error}");
}

#[test]
fn a_byte_order_mark_is_no_part_of_the_first_number() {
    assert_eq!(values(&read(b"\xef\xbb\xbf1.5\n2.5\n")), [1.5, 2.5]);
    assert_eq!(values(&read(b"\xef\xbb\xbf1.500e+00\n2.500e+00\n3.500e+00\n")), [1.5, 2.5, 3.5]);
}

#[test]
fn line_ends_and_end_marks_of_every_kind() {
    for text in [
        "1.5\n2.5\n3.5\n\x1a",
        "1.5\r\n2.5\r\n3.5\x1a",
        "1.5\n2.5\r3.5\n",
        "1.5\r\r\n2.5\r\r\n3.5\r\r\n",
        "1.5\r2.5\r3.5",
    ] {
        assert_eq!(values(&read(text.as_bytes())), [1.5, 2.5, 3.5], "{text:?}");
    }
    // A lone CR far from the beginning of the file.
    let long = format!("{}8 9\r1 2\n", "5 6\n7 1\n".repeat(10_000));
    let recording = read(long.as_bytes());
    assert_eq!((recording.records.len(), recording.records[0].len()), (2, 20_002));
    // An end mark inside the text is an error.
    assert!(complaint(b"1.5\n\x1a\n2.5\n").contains("line 2"));
}

#[test]
fn blank_lines_claim_no_room_for_many_columns() {
    // 30 000 columns times a million blank lines would take 240 GB.
    let row = "1 ".repeat(30_000);
    let text = format!("{row}\n{}{row}\n", "\n".repeat(1_000_000));
    for allow in [false, true] {
        let reader = Reader::new().allow_missing(allow);
        let error = reader.from_reader("x.txt", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("line 2: a blank line between rows"), "{error}");
    }
    let tail = format!("{row}\n{}", "\n".repeat(1_000_000));
    assert!(complaint(tail.as_bytes()).contains("one series row after row"));
    let channels = Reader::new().wrapped(Some(false)).from_reader("x.txt", tail.as_bytes()).unwrap();
    assert_eq!(channels.records.len(), 30_000);
}

#[test]
fn words_behind_the_values_are_refused_with_their_line() {
    for text in [
        "1\n2\n3\n4\nEnd of data\n",
        "1\n2\n3\n4\n1.096639e",
        "1 2\n3 5\n5 6\n7 9\nOVL 2\n",
        "1\n2\n3\n4\nOverload\n",
    ] {
        assert!(complaint(text.as_bytes()).contains("line 5"), "{text}");
    }
    // A hand-over file and a list are not taken for a measurement followed by words.
    for text in [
        "2\n400\n20\n5.0\n5.2\nRUP0001.DATRUP0002.DAT",
        "2\n400\n20\nFUP0001.DAT\nFUP0002.DAT\nRUP0001.DAT\nRUP0002.DAT\n",
    ] {
        assert!(complaint(text.as_bytes()).contains("list of a sweep"), "{text}");
    }
}
