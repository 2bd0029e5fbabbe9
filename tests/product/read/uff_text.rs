//! Universal text files with unusual values: faults are reported, and sound values are still read.

use super::uff_set::{ONE_TO_SEVEN, SEVEN, Set, clean, doubts, read, reader, refused, try_read, values};

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
    // Fields of fourteen columns: the first thirteen would give -1.00000E+00, with a 0 left over.
    clean(&Set::trace(2, " -1.00000E+000\n  2.50000E+001\n").file(), &[-1.0, 25.0]);
    clean(&Set::trace(2, "     0.0012345\n     0.1234567\n").file(), &[0.001_234_5, 0.123_456_7]);
}

#[test]
fn all_values_on_one_line() {
    let n = 3000;
    let line: Vec<String> = (0..n).map(|i| format!("{i}.5")).collect();
    let expected: Vec<f64> = (0..n).map(|i| i as f64 + 0.5).collect();
    clean(&Set::trace(n, &(line.join(" ") + "\n")).file(), &expected);
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
        // The rest of the first value may look like the delimiter.
        let looks_closed = set[header..end].trim_ascii() == b"-1";
        assert!(text.contains("without the closing -1") || looks_closed, "cut at byte {end}: {text}");
        if values.len() < 7 {
            assert!(
                text.contains("declares 7") && text.contains(&format!("holds {}", values.len())),
                "{text}"
            );
        }
        // A number counts from the byte that completes its field.
        let fields = (end - header).min(78) / 13 + usize::from(end - header >= 79 + 13);
        assert_eq!(values.len(), fields, "cut at byte {end}");
    }
    // Numbers separated by blanks: the last one may be cut off, so it does not count.
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
    assert!(message.contains("line 14, column 24") && message.contains("allow_missing"), "{message}");
    let recording = try_read(&reader().allow_missing(true), &bytes).unwrap();
    assert!(values(&recording)[1].is_nan() && values(&recording)[2] == 3.0);
    assert!(doubts(&recording).contains("1 value is missing"));
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
    // One -1 between two sets, three -1, and blank lines.
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
