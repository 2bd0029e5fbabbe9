//! Universal files with something odd about them: what is wrong is said, what is right is still read.

use proptest::prelude::*;
use vibroimpact::read::{Header, Reader, Recording};
use vibroimpact::record::{AxisKind, Record, Scaling};
use vibroimpact::units::{Quantity, Unit};

const ENTITY: &str = "         1    0         0 Mic                7   3 NONE               0   0";
const NONE: &str = "         0    0    0    0 NONE                 NONE";
const TIME: &str = "        17    0    0    0 time                 s";
const FREQUENCY: &str = "        18    0    0    0 frequency            Hz";
const PASCAL: &str = "        15    0    0    0 pressure             Pa";

/// A data set 58 without its delimiters: function type, record 7, abscissa, ordinate, values.
struct Set {
    number: String,
    function: u8,
    form: String,
    axes: [String; 3],
    values: Vec<u8>,
}

impl Set {
    /// A pressure over time, real, single precision.
    fn trace(n: usize, values: &str) -> Set {
        Set {
            number: "    58".into(),
            function: 1,
            form: form(2, n, 1),
            axes: [TIME, PASCAL, NONE].map(str::to_owned),
            values: values.into(),
        }
    }

    /// A frequency response of two lines, with these characteristics of numerator and denominator.
    fn ratio(function: u8, above: &str, below: &str) -> Set {
        Set {
            function,
            form: form(5, 2, 1),
            axes: [FREQUENCY, above, below].map(str::to_owned),
            ..Set::trace(0, "  1.00000E+00  0.00000E+00  0.00000E+00  2.00000E+00\n")
        }
    }

    fn header(&self) -> String {
        let [abscissa, ordinate, denominator] = &self.axes;
        format!(
            "{}\nFirst\nNONE\nThird\nNONE\nNONE\n{:5}{ENTITY}\n{}\n{abscissa}\n{ordinate}\n{denominator}\n{NONE}\n",
            self.number, self.function, self.form
        )
    }

    fn body(&self) -> Vec<u8> {
        [self.header().as_bytes(), &self.values].concat()
    }

    /// With both delimiters.
    fn file(&self) -> Vec<u8> {
        [b"    -1\n", &self.body()[..], b"    -1\n"].concat()
    }
}

fn form(kind: u8, n: usize, even: u8) -> String {
    format!("{kind:10}{n:10}{even:10}  0.00000E+00  2.50000E-01  0.00000E+00")
}

fn reader() -> Reader {
    Reader::new()
}

/// Reads, and checks that the survey agrees or fails alike.
fn try_read(reader: &Reader, bytes: &[u8]) -> Result<Recording, String> {
    let read = reader.from_reader("odd.uff", bytes).map_err(|e| e.to_string());
    let file = tempfile::Builder::new().suffix(".uff").tempfile().expect("a temporary file");
    std::fs::write(file.path(), bytes).expect("room for a few kB");
    let survey = reader.survey(file.path()).map_err(|e| e.to_string());
    match (&read, survey) {
        (Ok(recording), Ok((_, headers, doubts))) => {
            assert_eq!(doubts, recording.doubts);
            assert_eq!(headers.len(), recording.records.len());
            for (record, header) in recording.records.iter().zip(headers) {
                let full = Header::of(record);
                assert_eq!((full.n, full.dx, full.unit), (header.n, header.dx, header.unit));
                assert_eq!((full.x0, full.name, full.kind), (header.x0, header.name, header.kind));
                assert_eq!(full.doubts, header.doubts);
            }
        }
        (Err(_), Err(_)) => {}
        (read, survey) => panic!("read gives {read:?}, survey {survey:?}"),
    }
    read
}

fn read(bytes: &[u8]) -> Recording {
    try_read(&reader(), bytes).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(bytes: &[u8]) -> String {
    try_read(&reader(), bytes).expect_err("this should be refused")
}

fn values(recording: &Recording) -> Vec<f64> {
    match &recording.records[0] {
        Record::Trace(trace) => trace.values.clone(),
        Record::Spectrum(spectrum) => spectrum.values.magnitudes(),
        Record::Frf(frf) => frf.values.iter().map(|v| v.norm()).collect(),
    }
}

fn doubts(recording: &Recording) -> String {
    recording.all_doubts().join(" ")
}

/// Checks values and that there is no doubt.
fn clean(bytes: &[u8], expected: &[f64]) {
    let recording = read(bytes);
    assert_eq!(values(&recording), expected);
    assert_eq!(recording.all_doubts(), Vec::<String>::new());
}

const SEVEN: &str =
    " -1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\n  7.00000E+00\n";
const ONE_TO_SEVEN: [f64; 7] = [-1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

#[test]
fn values_in_any_layout() {
    for text in [
        SEVEN,
        " -1.00000D+00  2.00000D+00  3.00000D+00  4.00000D+00  5.00000D+00  6.00000D+00\n  7.00000D+00\n",
        " -1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\r\n  7.00000E+00\r\n",
        "-1.0 2 3.0 4 5e0 .6E1\n7\n",
        "-1.00000E+0002.000000E+0003.000000E+0004.000000E+0005.000000E+0006.000000E+000\n7.000000E+000\n",
        "           -1            2            3            4            5            6\n            7\n",
        "-1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00  \n7.00000E+00  \n",
        "  -1.00000E+000   2.00000E+000   3.00000E+000\n   4.00000E+000   5.00000E+000\n   6.00000E+000\n   7.00000E+000\n",
    ] {
        clean(&Set::trace(7, text).file(), &ONE_TO_SEVEN);
    }
}

#[test]
fn a_number_wider_than_its_field_is_not_cut_in_two() {
    // Fourteen columns: thirteen of them would be -1.00000E+00 and a rest of 0.
    clean(&Set::trace(2, " -1.00000E+000\n  2.50000E+001\n").file(), &[-1.0, 25.0]);
    clean(&Set::trace(2, "     0.0012345\n     0.1234567\n").file(), &[0.001_234_5, 0.123_456_7]);
}

#[test]
fn all_values_on_one_line() {
    let n = 3000;
    let line: Vec<String> = (0..n).map(|i| format!("{i}.5")).collect();
    let expected: Vec<f64> = (0..n).map(|i| i as f64 + 0.5).collect();
    clean(&Set::trace(n, &(line.join(" ") + "\n")).file(), &expected);
    // A line of more than 2²⁰ bytes is not kept whole, so it is refused rather than cut.
    let message = refused(&Set::trace(n * 200, &(line.join(" ").repeat(200) + "\n")).file());
    assert!(message.contains("line 14") && message.contains("more than a million"), "{message}");
}

#[test]
fn a_value_of_minus_one_is_not_the_end() {
    clean(&Set::trace(3, "           -1\n           -1\n           -1\n").file(), &[-1.0; 3]);
}

#[test]
fn padding_is_not_data() {
    let padded = SEVEN.replace("  7.00000E+00\n", "  7.00000E+00  0.00000E+00  0.00000E+00\n");
    clean(&Set::trace(7, &padded).file(), &ONE_TO_SEVEN);
    let recording = read(&Set::trace(7, &format!("{padded}  0.00000E+00\n  0.00000E+00\n")).file());
    assert_eq!(values(&recording), ONE_TO_SEVEN);
    assert!(doubts(&recording).contains("7 declared values stand 2 more lines"), "{}", doubts(&recording));
}

#[test]
fn fewer_values_than_declared_are_read_with_both_numbers() {
    let recording = read(&Set::trace(2_000_000_000, SEVEN).file());
    assert_eq!(values(&recording), ONE_TO_SEVEN);
    assert_eq!(recording.records[0].meta().declared_n, Some(2_000_000_000));
    let doubts = doubts(&recording);
    assert!(doubts.contains("2000000000") && doubts.contains("holds 7"), "{doubts}");
}

#[test]
fn a_file_cut_anywhere_gives_no_wrong_value() {
    let set = Set::trace(7, SEVEN).file();
    let header = Set::trace(7, "").file().len() - "    -1\n".len();
    for end in header..set.len() - "   -1\n".len() {
        let recording = read(&set[..end]);
        let values = values(&recording);
        assert_eq!(values, ONE_TO_SEVEN[..values.len()], "cut at byte {end}");
        let text = doubts(&recording);
        // What is left of the first value may look like the delimiter.
        let looks_closed = set[header..end].trim_ascii() == b"-1";
        assert!(text.contains("without the closing -1") || looks_closed, "cut at byte {end}: {text}");
        if values.len() < 7 {
            assert!(
                text.contains("declares 7") && text.contains(&format!("holds {}", values.len())),
                "{text}"
            );
        }
        // A number counts when its field is whole, and not a byte later.
        let fields = (end - header).min(78) / 13 + usize::from(end - header >= 79 + 13);
        assert_eq!(values.len(), fields, "cut at byte {end}");
    }
    // Numbers between blanks: the last one may be half of one.
    let recording = read(&[b"    -1\n", &Set::trace(7, "1.5 2.5 3.25").body()[..]].concat());
    assert_eq!(values(&recording), [1.5, 2.5]);
    let recording = read(&[b"    -1\n", &Set::trace(3, "1.5 2.5 3.25E-").body()[..]].concat());
    assert_eq!(values(&recording), [1.5, 2.5]);
    let recording = read(&[b"    -1\n", &Set::trace(3, "     0.0012345     0.123").body()[..]].concat());
    assert_eq!(values(&recording), [0.001_234_5]);
}

#[test]
fn a_header_cut_short() {
    let good = Set::trace(7, SEVEN).file();
    let cut: String = Set::trace(7, SEVEN).header().split_inclusive('\n').take(5).collect();
    let cut = [b"    -1\n", cut.as_bytes(), b"    -1\n"].concat();
    let message = refused(&cut);
    assert!(message.contains("line 2") && message.contains("4 of its 11"), "{message}");
    let recording = read(&[&cut[..], &good].concat());
    assert_eq!(values(&recording), ONE_TO_SEVEN);
    assert!(doubts(&recording).contains("after 4 of its 11 header lines"));
}

#[test]
fn garbage_where_numbers_should_be() {
    let message = refused(&Set::trace(7, " -1.00000E+00  2.00000E+00  three\n").file());
    assert!(message.contains("line 14, column 29") && message.contains("three"), "{message}");
    let message =
        refused(&Set { form: "         2    garbage         1".into(), ..Set::trace(1, "") }.file());
    assert!(message.contains("line 9") && message.contains("garbage"), "{message}");
}

#[test]
fn missing_values_are_refused_or_kept() {
    let bytes = Set::trace(3, "  1.00000E+00          NaN  3.00000E+00\n").file();
    let message = refused(&bytes);
    assert!(message.contains("line 14, column 24") && message.contains("--allow-missing"), "{message}");
    let recording = try_read(&reader().allow_missing(true), &bytes).unwrap();
    assert!(values(&recording)[1].is_nan() && values(&recording)[2] == 3.0);
    assert!(doubts(&recording).contains("1 numbers are missing"));
}

#[test]
fn empty_sets() {
    let recording = read(&Set::trace(0, "").file());
    assert_eq!(recording.records[0].len(), 0);
    assert!(doubts(&recording).contains("declares no values"));
    let recording = read(&Set::trace(5, "").file());
    assert_eq!(recording.records[0].len(), 0);
    assert!(doubts(&recording).contains("declares 5 values; the file holds 0"));
    assert!(refused(b"    -1\n    58\n    -1\n").contains("0 of its 11"));
}

#[test]
fn delimiters_out_of_step() {
    let body = Set::trace(7, SEVEN).body();
    let bytes = |parts: &[&[u8]]| {
        let recording = read(&parts.concat());
        assert!(recording.records.iter().all(|r| r.len() == 7));
        (recording.records.len(), doubts(&recording))
    };
    let (d, other): (&[u8], &[u8]) = (b"    -1\n", b"    -1\n    15\n         1\n    -1\n");
    assert_eq!(bytes(&[d, &body, d, d, &body, d]), (2, String::new()));
    // One -1 between two sets, three of them, blank lines.
    assert_eq!(bytes(&[d, &body, d, &body, d]).0, 2);
    assert_eq!(bytes(&[b"\n\n", d, &body, d, d, d, b"\n \n", d, &body, d]), (2, String::new()));
    let (n, text) = bytes(&[d, &body]);
    assert!(
        n == 1 && text.contains("without the closing -1 of the data set that begins at line 2"),
        "{text}"
    );
    let (n, text) = bytes(&[d, &body, d, b"some words\nmore\n", other, d, &body, d]);
    assert!(n == 2 && text.contains("2 lines outside any data set") && text.contains("line 17"), "{text}");
    assert!(text.contains("15 nodes"), "{text}");
}

#[test]
fn two_channels_of_one_name_are_numbered() {
    let set = Set::trace(7, SEVEN).file();
    let recording = read(&[&set[..], &set, &set].concat());
    let names: Vec<&str> = recording.records.iter().map(|r| r.meta().name.as_str()).collect();
    assert_eq!(names, ["Mic 7+Z", "Mic 7+Z #2", "Mic 7+Z #3"]);
}

#[test]
fn line_ends_and_byte_order_mark() {
    let unix = String::from_utf8(Set::trace(7, SEVEN).file()).unwrap();
    clean(unix.replace('\n', "\r\n").as_bytes(), &ONE_TO_SEVEN);
    clean(format!("\u{feff}{unix}").as_bytes(), &ONE_TO_SEVEN);
    clean(unix.trim_end().as_bytes(), &ONE_TO_SEVEN);
}

// Binary: every case, both byte orders.

fn binary(kind: u8, n: usize, even: u8, noted: usize, values: &[u8]) -> Set {
    let big = 1 + u8::from(noted & 1 == 1); // an odd note would be no whole number of values: here it says the byte order
    Set {
        number: format!(
            "    58b{big:6}     2          11{:12}     0     0           0           0",
            noted & !1
        ),
        function: if kind > 4 { 4 } else { 1 },
        form: form(kind, n, even),
        axes: [if kind > 4 { FREQUENCY } else { TIME }, PASCAL, NONE].map(str::to_owned),
        values: values.to_vec(),
    }
}

fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn big_endian_values() {
    let values: Vec<u8> = [1.5f32, -2.5, 1e-30].iter().flat_map(|v| v.to_be_bytes()).collect();
    clean(&binary(2, 3, 1, 13, &values).file(), &[1.5, -2.5, f64::from(1e-30f32)]);
}

#[test]
fn sizes_come_from_record_7() {
    let values = f32s(&[1.5, -2.5, 3.5]);
    for noted in [0, 4, 12, 400, 1_000_000] {
        clean(&binary(2, 3, 1, noted, &values).file(), &[1.5, -2.5, 3.5]);
    }
}

#[test]
fn a_record_7_that_the_closing_delimiter_contradicts() {
    let values = f32s(&[1.5, -2.5, 3.5]);
    for declared in [2, 5, 2_000_000_000] {
        let set = binary(2, declared, 1, 12, &values).file();
        let recording = read(&[&set[..], &Set::trace(7, SEVEN).file()].concat());
        assert_eq!(recording.records.len(), 2);
        assert_eq!(values_of(&recording), [1.5, -2.5, 3.5][..declared.min(3)]);
        assert!(doubts(&recording).contains(&declared.to_string()), "{}", doubts(&recording));
    }
    // Nothing to decide by: all bytes to the end of the file, but not its last delimiter.
    let recording = read(&binary(2, 2_000_000_000, 1, 0, &values).file());
    assert_eq!(values_of(&recording), [1.5, -2.5, 3.5]);
}

fn values_of(recording: &Recording) -> Vec<f64> {
    values(recording)
}

#[test]
fn binary_values_cut_in_the_middle_of_one() {
    let set = binary(2, 3, 1, 12, &f32s(&[1.5, -2.5, 3.5]));
    let bytes = [b"    -1\n", &set.body()[..]].concat();
    for lost in 1..12 {
        let recording = read(&bytes[..bytes.len() - lost]);
        let values = values(&recording);
        assert_eq!(values, [1.5, -2.5, 3.5][..(12 - lost) / 4]);
        let text = doubts(&recording);
        assert!(text.contains("declares 3") && text.contains(&format!("holds {}", values.len())), "{text}");
    }
}

#[test]
fn binary_values_that_look_like_delimiters() {
    let mut values = Vec::new();
    for _ in 0..4 {
        values.extend_from_slice(b"\n    -1\n    58\n\n");
    }
    let n = values.len() / 4;
    let expected: Vec<f64> =
        values.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect();
    clean(&binary(2, n, 1, values.len(), &values).file(), &expected);
}

#[test]
fn an_abscissa_in_double_precision() {
    let wide: Vec<u8> = [0.0f64, 1.5, 0.1, 2.5, 0.5, 3.5].iter().flat_map(|v| v.to_le_bytes()).collect();
    let recording = read(&binary(4, 3, 0, 48, &wide).file());
    assert_eq!(values(&recording), [1.5, 2.5, 3.5]);
    assert_eq!(recording.records[0].axis().values(), [0.0, 0.1, 0.5]);
    assert!(doubts(&recording).contains("stored in double precision"));
    // And as the standard has it.
    let mut narrow = Vec::new();
    for (x, y) in [(0.0f32, 1.5f64), (0.25, 2.5), (0.5, 3.5)] {
        narrow.extend_from_slice(&x.to_le_bytes());
        narrow.extend_from_slice(&y.to_le_bytes());
    }
    clean(&binary(4, 3, 0, 36, &narrow).file(), &[1.5, 2.5, 3.5]);
}

#[test]
fn number_formats_of_old_machines_are_refused_by_name() {
    for (format, name) in [("1", "DEC VMS"), ("3", "IBM 5/370")] {
        let number = format!("    58b     1     {format}          11          12");
        let message = refused(&Set { number, ..binary(2, 3, 1, 12, &f32s(&[1.0; 3])) }.file());
        assert!(message.contains(name) && message.contains("line 2"), "{message}");
    }
    for number in ["    58b", "    58b     7     2", "    58b     1     9"] {
        refused(&Set { number: number.into(), ..binary(2, 3, 1, 12, &f32s(&[1.0; 3])) }.file());
    }
}

#[test]
fn a_binary_value_that_is_not_finite_is_named_by_its_byte() {
    let set = binary(2, 3, 1, 12, &f32s(&[1.0, f32::INFINITY, 3.0]));
    let byte = "    -1\n".len() + set.header().len() + 4;
    let message = refused(&set.file());
    assert!(message.contains(&format!("byte {byte}:")), "{message}");
    let recording = try_read(&reader().allow_missing(true), &set.file()).unwrap();
    assert!(values(&recording)[1].is_nan());
}

// What the header means.

fn axis(code: u8, label: &str, unit: &str) -> String {
    format!("{code:10}    0    0    0 {label:20} {unit:20}")
}

/// Unit and factor that a ratio gets: its first value is 1 in the file.
fn unit(set: &Set) -> (String, f64, String) {
    let recording = read(&set.file());
    (recording.records[0].meta().unit.symbol().to_owned(), values(&recording)[0], doubts(&recording))
}

#[test]
fn numerator_and_denominator_share_the_unit() {
    let none = axis(0, "NONE", "NONE");
    let force = axis(13, "Force", "N");
    for (above, below, symbol, factor) in [
        (axis(12, "Acceleration", "m/s2"), &force, "(m/s²)/N", 1.0),
        (axis(12, "Acceleration", "g"), &force, "(m/s²)/N", 9.806_65),
        (axis(12, "Acceleration", "g"), &axis(13, "Force", "kN"), "(m/s²)/N", 9.806_65e-3),
        // The whole ratio in the numerator, with and without a denominator that repeats itself.
        (axis(12, "Acceleration", "(m/s²)/N"), &force, "(m/s²)/N", 1.0),
        (axis(0, "NONE", "mm/s/N"), &force, "(m/s)/N", 1e-3),
        (axis(0, "NONE", "µm/N"), &none, "m/N", 1e-6),
        (axis(8, "NONE", "mm"), &axis(0, "NONE", "kN"), "m/N", 1e-6),
    ] {
        let (found, value, doubts) = unit(&Set::ratio(4, &above, below));
        assert_eq!(found, symbol, "{above} over {below}");
        assert!((value / factor - 1.0).abs() < 1e-14, "{above} over {below}: {value}");
        assert_eq!(doubts, "");
    }
}

#[test]
fn units_without_text() {
    let (symbol, value, text) = unit(&Set::ratio(4, &axis(12, "NONE", "NONE"), &axis(13, "NONE", "NONE")));
    assert_eq!((symbol.as_str(), value), ("(m/s²)/N", 1.0));
    assert!(
        text.contains("acceleration over excitation force") && text.contains("SI units are assumed"),
        "{text}"
    );
    // Millimetre and newton: a displacement of 1 is 1 mm.
    let system = b"    -1\n   164\n        10mm (newton)                  2\n  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00\n  2.73149999999999977D+02\n    -1\n";
    let set = Set::ratio(4, &axis(8, "NONE", "NONE"), &axis(13, "NONE", "NONE")).file();
    let recording = read(&[&system[..], &set].concat());
    assert_eq!(recording.records[0].meta().unit.symbol(), "m/N");
    assert_eq!(values(&recording)[0], 1e-3);
    // A text goes before the system, with a doubt where the two disagree.
    let set = Set::ratio(4, &axis(8, "NONE", "m"), &axis(13, "NONE", "N")).file();
    let recording = read(&[&system[..], &set].concat());
    assert_eq!(values(&recording)[0], 1.0);
    assert!(doubts(&recording).contains("data set 164"), "{}", doubts(&recording));
    // A rotation has another unit.
    let mut set = Set::trace(1, "  1.00000E+00\n");
    set.axes[1] = axis(12, "NONE", "NONE");
    let rotation = String::from_utf8(set.file()).unwrap().replace("   7   3 NONE", "   7   6 NONE");
    let recording = read(rotation.as_bytes());
    assert_eq!(recording.records[0].meta().unit.dimension(), Unit::parse("rad/s²").unwrap().dimension());
    assert_eq!(recording.records[0].meta().name, "Mic 7+RZ");
    for (ordinate, said) in [(axis(11, "NONE", "NONE"), 1), (axis(11, "Velocity", "rad/s"), 0)] {
        set.axes[1] = ordinate;
        let rotation = String::from_utf8(set.file()).unwrap().replace("   7   3 NONE", "   7   6 NONE");
        let recording = read(rotation.as_bytes());
        let meta = recording.records[0].meta();
        assert_eq!((meta.quantity, meta.unit.symbol()), (Quantity::AngularVelocity, "rad/s"));
        assert_eq!(meta.doubts.len(), said, "{:?}", meta.doubts);
    }
}

#[test]
fn units_that_are_not_understood_or_contradict() {
    let none = axis(0, "NONE", "NONE");
    for (function, above, symbol, word) in [
        (4, axis(0, "NONE", "EU"), "EU", "\"EU\" is not understood"),
        (4, none.clone(), "", "neither unit nor quantity"),
        (4, axis(0, "Receptance", "(m/s)/N"), "(m/s)/N", "labelled \"Receptance\""),
        (4, axis(12, "NONE", "m/s"), "m/s", "data type of the ordinate is acceleration"),
        (12, axis(12, "Velocity", "m/s²"), "m/s²", "labelled \"Velocity\""),
        (9, axis(12, "NONE", "g"), "g", "which is squared"),
    ] {
        let (found, value, text) = unit(&Set::ratio(function, &above, &none));
        assert_eq!((found.as_str(), value), (symbol, 1.0), "{above}");
        assert!(text.contains(word), "{text}");
    }
    let (symbol, value, text) = unit(&Set::ratio(9, &axis(12, "NONE", "g^2/Hz"), &none));
    assert!(
        symbol == "m^2·s^-3" && (value / 9.806_65f64.powi(2) - 1.0).abs() < 1e-14 && text.is_empty(),
        "{text}"
    );
    let (symbol, ..) = unit(&Set::ratio(9, &axis(12, "NONE", "NONE"), &none));
    assert_eq!(
        Unit::parse(&symbol.replace('·', "*")).unwrap().dimension(),
        Unit::parse("m^2/s^3").unwrap().dimension()
    );
    let (symbol, ..) = unit(&Set::ratio(6, &axis(12, "NONE", "NONE"), &axis(13, "NONE", "NONE")));
    assert_eq!(symbol, "1");
}

#[test]
fn function_types_and_abscissa_decide_the_record() {
    let pressure = axis(15, "NONE", "Pa");
    let squared = axis(0, "NONE", "Pa^2");
    for (function, above, scaling, word) in [
        (2, &squared, Scaling::Unknown, "squared RMS or squared peak"),
        (3, &squared, Scaling::Unknown, "squared RMS or squared peak"),
        (6, &axis(0, "NONE", "1"), Scaling::Coherence, ""),
        (9, &axis(0, "NONE", "Pa^2/Hz"), Scaling::Psd, ""),
        (10, &axis(0, "NONE", "Pa^2 s/Hz"), Scaling::Energy, ""),
        (12, &pressure, Scaling::Unknown, "peak or RMS"),
        (0, &pressure, Scaling::Unknown, "general function"),
        (1, &pressure, Scaling::Unknown, "time response"),
        (24, &pressure, Scaling::Unknown, "shock response spectrum"),
    ] {
        let recording = read(&Set::ratio(function, above, NONE).file());
        let Record::Spectrum(spectrum) = &recording.records[0] else {
            panic!("type {function} is no spectrum")
        };
        assert_eq!(spectrum.scaling, scaling, "type {function}");
        let text = doubts(&recording);
        assert!(text.contains(word) && text.is_empty() == word.is_empty(), "type {function}: {text}");
    }
    for (function, word) in
        [(0, ""), (1, ""), (4, "abscissa is time"), (7, "auto correlation"), (11, "probability")]
    {
        let recording = read(&Set { function, ..Set::trace(7, SEVEN) }.file());
        assert_eq!(recording.records[0].kind(), "trace", "type {function}");
        let text = doubts(&recording);
        assert!(text.contains(word) && text.is_empty() == word.is_empty(), "type {function}: {text}");
    }
    let message = refused(&Set { form: form(5, 2, 1), ..Set::trace(0, "1 0 0 1\n") }.file());
    assert!(message.contains("complex values over time") && message.contains("line 9"), "{message}");
}

#[test]
fn the_abscissa_is_time_frequency_or_something_else() {
    let kind = |function, abscissa: &str| {
        let mut set = Set { function, ..Set::trace(7, SEVEN) };
        abscissa.clone_into(&mut set.axes[0]);
        let recording = read(&set.file());
        let axis = recording.records[0].axis().clone();
        (axis.kind.clone(), axis.step().unwrap(), doubts(&recording))
    };
    assert_eq!(kind(1, &axis(17, "time", "ms")), (AxisKind::Time, 0.25e-3, String::new()));
    assert_eq!(kind(1, &axis(17, "NONE", "NONE")), (AxisKind::Time, 0.25, String::new()));
    let (found, step, text) = kind(1, &axis(17, "NONE", "Hz"));
    assert!(found == AxisKind::Frequency && step == 0.25 && text.contains("the unit is believed"), "{text}");
    let (found, _, text) = kind(1, &axis(0, "NONE", "NONE"));
    assert!(found == AxisKind::Time && text.contains("is assumed"), "{text}");
    let (found, _, text) = kind(0, &axis(0, "NONE", "NONE"));
    assert!(found == AxisKind::Index && text.contains("does not say"), "{text}");
    let (found, _, text) = kind(1, &axis(17, "NONE", "fortnight"));
    assert!(found == AxisKind::Time && text.contains("fortnight"), "{text}");
    // 2π rad are one turn.
    for (code, unit) in [(18, "rad/s"), (0, "rad/s"), (1, "1/s*rad")] {
        let (found, step, text) = kind(12, &axis(code, "omega", unit));
        assert!(found == AxisKind::Frequency && text.contains("divided by 2π"), "{unit}: {text}");
        // One product and one quotient, each rounded by half an ulp.
        assert!((step * 2.0 * std::f64::consts::PI / 0.25 - 1.0).abs() < 4.0 * f64::EPSILON, "{step}");
    }
    assert_eq!(kind(0, &axis(19, "speed", "rpm")).0, AxisKind::Other("speed [rpm]".into()));
    assert_eq!(kind(0, &axis(5, "NONE", "K")).0, AxisKind::Other("temperature [K]".into()));
}

#[test]
fn values_that_leave_the_range_of_numbers_are_refused() {
    let mut set = Set::trace(2, "  1.00000E+00  1.00000+308\n");
    set.axes[1] = axis(8, "NONE", "km");
    let error = refused(&set.file());
    assert!(error.contains("odd.uff: the value 1e308"), "{error}");
    set.axes[1] = axis(8, "NONE", "m");
    assert_eq!(values(&read(&set.file())), [1.0, 1e308]);
}

#[test]
fn what_a_person_states_wins() {
    let bytes = Set::trace(7, SEVEN).file();
    let recording = try_read(&reader().rate(Some(8.0)).unit(Unit::parse("kPa")), &bytes).unwrap();
    assert_eq!(recording.records[0].axis().step(), Some(0.125));
    assert_eq!(values(&recording)[1], 2000.0);
    let text = doubts(&recording);
    assert!(text.contains("0.25") && text.contains("8 Hz") && text.contains("kPa"), "{text}");
    let agreed = try_read(&reader().rate(Some(4.0)).unit(Unit::parse("Pa")), &bytes).unwrap();
    assert_eq!(doubts(&agreed), "");
    let spectrum = Set::ratio(9, &axis(0, "NONE", "Pa^2/Hz"), NONE).file();
    let recording = try_read(&reader().base_band(Some(20.0)), &spectrum).unwrap();
    assert!(doubts(&recording).contains("base band"));
}

#[test]
fn a_step_that_is_no_step() {
    let zero = String::from_utf8(Set::trace(7, SEVEN).file()).unwrap().replace("2.50000E-01", "0.00000E+00");
    let recording = read(zero.as_bytes());
    assert_eq!(recording.records[0].axis().kind, AxisKind::Index);
    assert!(doubts(&recording).contains("increment of 0"));
    let recording = try_read(&reader().rate(Some(4.0)), zero.as_bytes()).unwrap();
    assert_eq!(recording.records[0].axis().step(), Some(0.25));
}

#[test]
fn instants_that_are_stored_and_even_give_a_rate() {
    let pairs: Vec<String> =
        (0..9).map(|i| format!("{:13.5e}{:13.5e}\n", f64::from(i) / 3.0, f64::from(i))).collect();
    let mut set = Set::trace(0, &pairs.concat());
    set.form = form(2, 9, 0);
    let recording = read(&set.file());
    let step = recording.records[0].axis().step().expect("an even axis");
    // 8/3 is printed as 2.66667, so the step is off by half a unit over eight steps.
    assert!((step - 1.0 / 3.0).abs() <= 0.5e-5 / 8.0);
}

#[test]
fn a_lost_sample_leaves_no_rate() {
    let pairs: Vec<String> =
        (0..9).filter(|i| *i != 4).map(|i| format!("{:13.5e}{i:13}\n", f64::from(i) / 3.0)).collect();
    let set = Set { form: form(2, 8, 0), ..Set::trace(0, &pairs.concat()) };
    let recording = read(&set.file());
    assert_eq!(recording.records[0].axis().step(), None);
    assert!(doubts(&recording).contains("uneven: there is no sampling rate"));
    let stated = try_read(&reader().rate(Some(3.0)), &set.file()).unwrap();
    assert_eq!(stated.records[0].axis().step(), Some(1.0 / 3.0));
    assert!(doubts(&stated).contains("its own instants"));
}

#[test]
fn other_files_are_not_taken_for_this_format() {
    for text in ["-1\n-2\n-3\n", "-1\n58\n15\n", "    -1\n     0.5\n", "1 2\n3 4\n", "    58\n    -1\n"] {
        let recording = Reader::new().rate(Some(1.0)).from_reader("x.txt", text.as_bytes()).unwrap();
        assert_eq!(recording.format.name(), "ascii", "{text:?}");
    }
    let set = Set::trace(7, SEVEN).file();
    let recording = Reader::new().from_reader("x.txt", &[b"\n \r\n", &set[..]].concat()[..]).unwrap();
    assert_eq!(recording.format.name(), "uff");
    // Under the usual ending words may come first.
    let words = [b"exported by hand\n", &set[..]].concat();
    assert_eq!(read(&words).format.name(), "uff");
}

fn survives(bytes: &[u8]) {
    for reader in [reader(), reader().allow_missing(true)] {
        let reader = reader.format(Some(vibroimpact::read::Format::Uff));
        if let Ok(recording) = reader.from_reader("x.uff", bytes) {
            for record in &recording.records {
                assert!(record.len() <= bytes.len());
            }
        }
    }
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 1..400)) {
        survives(&bytes);
    }

    #[test]
    fn random_lines_never_panic(lines in proptest::collection::vec(
        prop_oneof![Just("    -1".to_owned()), Just("    58".to_owned()), Just("    58b     1     2".to_owned()),
            Just("   164".to_owned()), Just(form(2, 3, 1)), Just(form(6, 3, 0)), Just(NONE.to_owned()), "[ -9.E]{0,30}"],
        1..40,
    )) {
        survives(lines.join("\n").as_bytes());
    }

    #[test]
    fn damaged_sets_never_panic(
        kind in proptest::sample::select(vec![2u8, 4, 5, 6]),
        even in 0u8..2,
        is_binary in any::<bool>(),
        damage in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 0..6),
        end in any::<proptest::sample::Index>(),
        cut in any::<bool>(),
    ) {
        let set = if is_binary {
            binary(kind, 4, even, 0, &f32s(&[1.0; 24]))
        } else {
            Set { form: form(kind, 7, even), axes: [FREQUENCY, PASCAL, NONE].map(str::to_owned), ..Set::trace(0, SEVEN) }
        };
        let mut bytes = set.file();
        for (at, with) in damage {
            let at = at.index(bytes.len());
            bytes[at] = with;
        }
        if cut {
            bytes.truncate(end.index(bytes.len()) + 1);
        }
        survives(&bytes);
    }
}
