//! Damaged universal files, and files in other formats: nothing panics.

use super::uff_set::{FREQUENCY, NONE, PASCAL, SEVEN, Set, binary, f32s, form, read, reader};
use proptest::prelude::*;
use vibroimpact::read::Reader;

#[test]
fn other_files_are_not_taken_for_this_format() {
    for text in ["-1\n-2\n-3\n", "-1\n58\n15\n", "    -1\n     0.5\n", "1 2\n3 4\n", "    58\n    -1\n"] {
        let recording = Reader::new().rate(Some(1.0)).from_reader("x.txt", text.as_bytes()).unwrap();
        assert_eq!(recording.format.name(), "ascii", "{text:?}");
    }
    let set = Set::trace(7, SEVEN).file();
    let recording = Reader::new().from_reader("x.txt", &[b"\n \r\n", &set[..]].concat()[..]).unwrap();
    assert_eq!(recording.format.name(), "uff");
    // With the usual file extension, text may precede the first data set.
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
