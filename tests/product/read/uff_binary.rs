//! Binary values of universal files: every case, both byte orders, and contradictory sizes.

use super::uff_set::{SEVEN, Set, binary, clean, doubts, f32s, read, reader, refused, try_read, values};

#[test]
fn big_endian_values() {
    let bytes: Vec<u8> = [1.5f32, -2.5, 1e-30].iter().flat_map(|v| v.to_be_bytes()).collect();
    clean(&binary(2, 3, 1, 13, &bytes).file(), &[1.5, -2.5, f64::from(1e-30f32)]);
}

#[test]
fn sizes_come_from_record_7() {
    let bytes = f32s(&[1.5, -2.5, 3.5]);
    for noted in [0, 4, 12, 400, 1_000_000] {
        clean(&binary(2, 3, 1, noted, &bytes).file(), &[1.5, -2.5, 3.5]);
    }
}

#[test]
fn a_record_7_that_the_closing_delimiter_contradicts() {
    let bytes = f32s(&[1.5, -2.5, 3.5]);
    for declared in [2, 5, 2_000_000_000] {
        let set = binary(2, declared, 1, 12, &bytes).file();
        let recording = read(&[&set[..], &Set::trace(7, SEVEN).file()].concat());
        assert_eq!(recording.records.len(), 2);
        assert_eq!(values(&recording), [1.5, -2.5, 3.5][..declared.min(3)]);
        assert!(doubts(&recording).contains(&declared.to_string()), "{}", doubts(&recording));
    }
    // Without a stated size, the values extend to the last delimiter of the file.
    let recording = read(&binary(2, 2_000_000_000, 1, 0, &bytes).file());
    assert_eq!(values(&recording), [1.5, -2.5, 3.5]);
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
    assert!(doubts(&recording).contains("has double precision"));
    // As in the standard, with a single-precision abscissa.
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
