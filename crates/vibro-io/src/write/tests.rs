use super::*;
use crate::format::Format;
use crate::reader::Reader;

#[test]
fn the_ending_chooses() {
    assert_eq!(Target::of("a/b.CSV").unwrap(), Target::Csv);
    assert_eq!(Target::of("b.unv").unwrap(), Target::Uff);
    assert_eq!(Target::of("b.npy").unwrap(), Target::Npy);
    for path in ["x", "x.xls", ".csv"] {
        assert!(Target::of(path).unwrap_err().to_string().contains(path), "{path}");
    }
}

/// Nothing is lost, except by single precision if it is requested.
#[test]
fn a_wave_file_is_as_exact_as_was_asked_for() {
    let text = "t [s],v [m/s]\n0,0.1\n0.5,-2\n";
    let records = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap().records;
    for (precision, kept) in [(Precision::Double, 0.1), (Precision::Single, f64::from(0.1f32))] {
        let mut out = Vec::new();
        Target::Wav.write(&records, Storage { binary: false, precision }, &mut out).unwrap();
        let back = Reader::new().from_reader("x.wav", out.as_slice()).unwrap();
        let [Record::Trace(trace)] = back.records.as_slice() else { panic!() };
        assert_eq!(trace.values, [kept, -2.0]);
    }
}

/// The reader detects the format that every target writes; it does not read numpy's arrays.
#[test]
fn what_is_written_is_recognised() {
    let records =
        Reader::new().from_reader("x.csv", "t [s],v [m/s]\n0,1\n0.5,2\n".as_bytes()).unwrap().records;
    for (name, format) in [
        ("x.uff", Format::Uff),
        ("x.ufb", Format::Uff),
        ("x.csv", Format::Csv),
        ("x.tsv", Format::Csv),
        ("x.wav", Format::Wav),
    ] {
        let mut out = Vec::new();
        Target::of(name).unwrap().write(&records, Storage::default(), &mut out).unwrap();
        let back = Reader::new().from_reader("unnamed", out.as_slice()).unwrap();
        assert_eq!(back.format, format, "{name}");
        let [Record::Trace(trace)] = back.records.as_slice() else { panic!("{name}") };
        assert_eq!(
            (trace.values.as_slice(), trace.meta.unit.symbol()),
            ([1.0, 2.0].as_slice(), "m/s"),
            "{name}"
        );
        assert_eq!(trace.rate(), Some(2.0), "{name}");
    }
}
