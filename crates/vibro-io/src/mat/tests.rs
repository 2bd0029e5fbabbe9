use super::*;
use crate::Reader;
use crate::tests::{has_finding, texts};
use num_complex::Complex64;
use proptest::prelude::*;
use std::io::Write;
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, FrfKind, Record, Values};

/// Writes elements in one byte order.
#[derive(Clone, Copy)]
struct Order {
    big: bool,
}

const LITTLE: Order = Order { big: false };

impl Order {
    fn put(self, little: &[u8]) -> Vec<u8> {
        if self.big { little.iter().rev().copied().collect() } else { little.to_vec() }
    }

    fn word(self, value: u32) -> Vec<u8> {
        self.put(&value.to_le_bytes())
    }

    /// A small element where it fits, as MATLAB writes them.
    fn element(self, kind: u32, content: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        if (1..=4).contains(&content.len()) {
            out.extend(self.word((content.len() as u32) << 16 | kind));
        } else {
            out.extend(self.word(kind));
            out.extend(self.word(content.len() as u32));
        }
        out.extend(content);
        out.extend(std::iter::repeat_n(0, (8 - out.len() % 8) % 8));
        out
    }

    fn matrix(self, class: u32, dimensions: &[u32], name: &str, parts: &[Vec<u8>]) -> Vec<u8> {
        let flags = [self.word(class), self.word(0)].concat();
        let sizes: Vec<u8> = dimensions.iter().flat_map(|d| self.word(*d)).collect();
        let mut body =
            [self.element(6, &flags), self.element(5, &sizes), self.element(1, name.as_bytes())].concat();
        body.extend(parts.concat());
        [self.word(14), self.word(body.len() as u32), body].concat()
    }

    fn doubles(self, values: &[f64]) -> Vec<u8> {
        let bytes: Vec<u8> = values.iter().flat_map(|v| self.put(&v.to_le_bytes())).collect();
        self.element(9, &bytes)
    }

    fn column(self, name: &str, values: &[f64]) -> Vec<u8> {
        self.matrix(6, &[values.len() as u32, 1], name, &[self.doubles(values)])
    }

    fn file(self, variables: &[Vec<u8>]) -> Vec<u8> {
        let mut out = vec![b' '; 124];
        out.extend(self.put(&0x0100u16.to_le_bytes()));
        out.extend(if self.big { b"MI" } else { b"IM" });
        out.extend(variables.concat());
        out
    }
}

fn packed(matrix: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(matrix).unwrap();
    let content = encoder.finish().unwrap();
    [15u32.to_le_bytes().to_vec(), (content.len() as u32).to_le_bytes().to_vec(), content].concat()
}

fn of(variables: &[Vec<u8>]) -> Result<Recording> {
    Reader::new().from_reader("x.mat", LITTLE.file(variables).as_slice())
}

fn complaint(variables: &[Vec<u8>]) -> String {
    of(variables).unwrap_err().to_string()
}

fn values(record: &Record) -> &[f64] {
    match record {
        Record::Trace(t) => &t.values,
        other => panic!("{other:?}"),
    }
}

#[test]
fn both_byte_orders_and_every_storage() {
    for order in [LITTLE, Order { big: true }] {
        let i16s: Vec<u8> = [-2i16, 300].iter().flat_map(|v| order.put(&v.to_le_bytes())).collect();
        let i64s: Vec<u8> = [-5i64, 7].iter().flat_map(|v| order.put(&v.to_le_bytes())).collect();
        let f32s: Vec<u8> = [0.1f32, -0.5].iter().flat_map(|v| order.put(&v.to_le_bytes())).collect();
        let file = order.file(&[
            order.matrix(6, &[1, 2], "as_i8", &[order.element(1, &[0xff, 3])]),
            order.matrix(6, &[1, 2], "as_u8", &[order.element(2, &[0xff, 3])]),
            order.matrix(10, &[2, 1], "as_i16", &[order.element(3, &i16s)]),
            order.matrix(14, &[2, 1], "as_i64", &[order.element(12, &i64s)]),
            order.matrix(7, &[2, 1], "as_f32", &[order.element(7, &f32s)]),
        ]);
        let recording = Reader::new().from_reader("x.mat", file.as_slice()).unwrap();
        let all: Vec<&[f64]> = recording.records.iter().map(values).collect();
        let expected: [&[f64]; 5] =
            [&[-1.0, 3.0], &[255.0, 3.0], &[-2.0, 300.0], &[-5.0, 7.0], &[f64::from(0.1f32), -0.5]];
        assert_eq!(all, expected);
        assert_eq!(recording.records[1].meta().name, "as_u8");
    }
}

#[test]
fn sampling_from_scalars() {
    let x = LITTLE.column("x", &[1.0, 2.0, 3.0]);
    for (name, value) in [("fs", 200.0), ("Fs", 200.0), ("SampleRate", 200.0), ("dt", 0.005), ("Ts", 0.005)] {
        let recording = of(&[LITTLE.column(name, &[value]), x.clone()]).unwrap();
        assert_eq!(recording.records.len(), 1, "{name}");
        assert_eq!(recording.records[0].axis(), &Axis::time(0.0, 1.0 / 200.0, 3), "{name}");
        assert_eq!(recording.records[0].meta().notes, [(name.to_owned(), value.to_string())]);
    }
    let two = [LITTLE.column("fs", &[100.0]), LITTLE.column("dt", &[0.1]), x.clone()];
    assert!(complaint(&two).contains("\"fs\" says a sampling rate of 100 Hz, \"dt\" 10 Hz"));
    let stated = Reader::new().rate(Some(50.0)).from_reader("x.mat", LITTLE.file(&two).as_slice()).unwrap();
    assert_eq!(stated.records[0].axis(), &Axis::time(0.0, 0.02, 3));
    let zero = of(&[LITTLE.column("fs", &[0.0]), x]).unwrap();
    assert_eq!(zero.records[0].axis().kind, AxisKind::Index);
    assert!(has_finding(&zero.records[0].meta().findings, "abscissa-unsaid", &[]));
}

#[test]
fn abscissae_from_vectors() {
    // Accumulated steps, as simulation programs write them, drift by rounding and are still even.
    let times: Vec<f64> = (0..1000)
        .scan(0.0, |t, _| {
            let now = *t;
            *t += 0.001;
            Some(now)
        })
        .collect();
    let x = vec![1.0; 1000];
    let recording = of(&[LITTLE.column("t", &times), LITTLE.column("x", &x)]).unwrap();
    assert_eq!(recording.records.len(), 1);
    // A thousand sums, each rounded by at most half an ulp of 1.
    assert!((recording.records[0].axis().step().unwrap() - 0.001).abs() < 1000.0 * f64::EPSILON);
    assert_eq!(recording.findings.len(), 1, "{:?}", recording.findings);

    let uneven =
        of(&[LITTLE.column("time", &[0.0, 0.1, 0.5]), LITTLE.column("x", &[1.0, 2.0, 3.0])]).unwrap();
    assert_eq!(uneven.records[0].axis().values(), [0.0, 0.1, 0.5]);
    assert!(has_finding(
        &uneven.findings,
        "axis-uneven",
        &["column=vector \"time\"", "smallest=0.1", "largest=0.4"]
    ));

    let lines = of(&[LITTLE.column("freq", &[0.0, 2.0]), LITTLE.column("X", &[1.0, 2.0])]).unwrap();
    let Record::Spectrum(spectrum) = &lines.records[0] else { panic!() };
    assert_eq!(
        (&spectrum.axis, &spectrum.values),
        (&Axis::frequency(0.0, 2.0, 2), &Values::Real(vec![1.0, 2.0]))
    );

    // A force called f, and a torque called t, are no abscissae.
    let force = of(&[LITTLE.column("f", &[0.0, 2.0, 1.0]), LITTLE.column("x", &[1.0, 2.0, 3.0])]).unwrap();
    assert_eq!(force.records.len(), 2);
    assert!(has_finding(&force.findings, "abscissa-not-rising", &["variable=f"]));
    let alone = of(&[LITTLE.column("t", &[0.0, 2.0]), LITTLE.column("x", &[1.0, 2.0, 3.0])]).unwrap();
    assert_eq!(alone.records.len(), 2);
    assert!(has_finding(&alone.findings, "abscissa-of-other-length", &[]));
    let both =
        of(&[LITTLE.column("fs", &[5.0]), LITTLE.column("t", &[0.0, 0.1]), LITTLE.column("x", &[1.0, 2.0])]);
    let both = both.unwrap();
    assert_eq!(both.records[0].axis(), &Axis::time(0.0, 0.1, 2));
    assert!(has_finding(&both.findings, "vector-against-rate", &["rate=5", "used=vector"]));
}

#[test]
fn matrices_column_by_column() {
    let m = LITTLE.matrix(6, &[3, 2], "m", &[LITTLE.doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])]);
    let upright = of(std::slice::from_ref(&m)).unwrap();
    assert_eq!(upright.records[1].meta().name, "m(:,2)");
    assert_eq!(values(&upright.records[1]), [4.0, 5.0, 6.0]);
    let lying = of(&[m.clone(), LITTLE.column("t", &[0.0, 1.0])]).unwrap();
    assert_eq!(lying.records.len(), 3);
    assert_eq!(lying.records[2].meta().name, "m(3,:)");
    assert_eq!(values(&lying.records[2]), [3.0, 6.0]);
    let parts = [LITTLE.doubles(&[1.0, 2.0, 3.0, 4.0]), LITTLE.doubles(&[5.0, 6.0, 7.0, 8.0])];
    let complex = of(&[LITTLE.matrix(6 | 0x800, &[2, 2], "H", &parts)]).unwrap();
    let Record::Spectrum(second) = &complex.records[1] else { panic!() };
    assert_eq!(second.values, Values::Complex(vec![Complex64::new(3.0, 7.0), Complex64::new(4.0, 8.0)]));
    let wide = LITTLE.matrix(6, &[2, 1001], "w", &[LITTLE.doubles(&vec![0.0; 2002])]);
    assert!(complaint(&[wide]).contains("try: transpose it and save it again: w = w.';"));
}

#[test]
fn complex_values_are_spectra() {
    let parts = [LITTLE.doubles(&[1.0, 2.0]), LITTLE.doubles(&[-1.0, 0.5])];
    let h = LITTLE.matrix(6 | 0x800, &[2, 1], "H", &parts);
    let bare = of(&[LITTLE.column("fs", &[5.0]), h.clone()]).unwrap();
    let Record::Spectrum(spectrum) = &bare.records[0] else { panic!() };
    assert_eq!(spectrum.values, Values::Complex(vec![Complex64::new(1.0, -1.0), Complex64::new(2.0, 0.5)]));
    assert_eq!(spectrum.axis.kind, AxisKind::Index);
    let file = LITTLE.file(&[LITTLE.column("f", &[10.0, 20.0]), h]);
    let frf = Reader::new().unit(Unit::parse("mm/N")).from_reader("x.mat", file.as_slice()).unwrap();
    let Record::Frf(frf) = &frf.records[0] else { panic!() };
    assert_eq!((frf.kind, &frf.axis), (FrfKind::Receptance, &Axis::frequency(10.0, 10.0, 2)));
    assert_eq!(frf.values[1], Complex64::new(2.0 * 1e-3, 0.5 * 1e-3));
}

#[test]
fn texts_are_notes_and_the_rest_is_named() {
    let utf16: Vec<u8> = "µm".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let recording = of(&[
        LITTLE.matrix(4, &[1, 2], "unit", &[LITTLE.element(4, &utf16)]),
        LITTLE.matrix(4, &[1, 3], "rig", &[LITTLE.element(16, b"two")]),
        LITTLE.matrix(4, &[2, 3], "lines", &[LITTLE.element(16, b"twotwo")]),
        LITTLE.matrix(2, &[1, 1], "setup", &[]),
        LITTLE.matrix(9 | 0x200, &[1, 1], "flag", &[LITTLE.element(2, &[1])]),
        LITTLE.matrix(5, &[1, 1], "thin", &[]),
        LITTLE.matrix(17, &[], "", &[]),
        LITTLE.matrix(6, &[0, 0], "none", &[LITTLE.element(9, &[])]),
        LITTLE.matrix(6, &[2, 2, 2], "cube", &[LITTLE.doubles(&[0.0; 8])]),
        LITTLE.column("x", &[1.0, 2.0]),
    ]);
    let recording = recording.unwrap();
    assert_eq!(recording.records.len(), 1);
    let notes = &recording.records[0].meta().notes;
    assert_eq!(*notes, [("unit".to_owned(), "µm".to_owned()), ("rig".to_owned(), "two".to_owned())]);
    for expected in [
        "variable-passed-over variable=lines class=char array of several rows or more than 4096 characters",
        "variable-passed-over variable=setup class=struct",
        "variable-passed-over variable=flag class=logical array",
        "variable-passed-over variable=thin class=sparse matrix",
        "variable-passed-over class=object",
        "variable-empty variable=none",
        "variable-many-dimensions variable=cube dimensions=3",
    ] {
        let found = texts(&recording.findings);
        assert!(found.iter().any(|t| t == expected), "{expected}: {found:?}");
    }
}

#[test]
fn values_that_leave_the_range_of_numbers_are_refused() {
    let file = LITTLE.file(&[LITTLE.column("x", &[1.0, 1e308])]);
    let error = Reader::new().unit(Unit::parse("km")).from_reader("x.mat", file.as_slice()).unwrap_err();
    assert!(error.to_string().contains("x.mat: the value 1e308"), "{error}");
}

#[test]
fn missing_values_are_refused_or_kept() {
    let file = LITTLE.file(&[LITTLE.column("x", &[1.0, f64::NAN, f64::INFINITY])]);
    let error = Reader::new().from_reader("x.mat", file.as_slice()).unwrap_err().to_string();
    assert!(error.contains("2 value(s) are NaN or infinite: 2 of \"x\", 3 of \"x\""), "{error}");
    let kept = Reader::new().allow_missing(true).from_reader("x.mat", file.as_slice()).unwrap();
    assert!(values(&kept.records[0])[2].is_nan());
}

#[test]
fn other_levels_are_refused_by_name() {
    let reader = Reader::new();
    let mut hdf5 = vec![b' '; 512];
    hdf5[124..128].copy_from_slice(b"\0\x02IM");
    // Behind it would be the signature of HDF5.
    hdf5.extend(if cfg!(feature = "hdf5") { b"\0\0\0\0\0\0\0\0" } else { HDF5 });
    let error = reader.from_reader("x.mat", hdf5.as_slice()).unwrap_err().to_string();
    assert!(error.contains("version 7.3, which is HDF5") && error.contains("-v7"), "{error}");
    let four: Vec<u8> = [0u32, 2, 1, 0, 2].iter().flat_map(|w| w.to_le_bytes()).chain(*b"x\0").collect();
    let error = reader.from_reader("x.mat", four.as_slice()).unwrap_err().to_string();
    assert!(error.contains("version 4"), "{error}");
    // Text that `save -ascii` wrote is left to the reader of text.
    assert_eq!(
        reader.from_reader("x.mat", b" 1.0e+00\n 2.0e+00\n".as_slice()).unwrap().format,
        Format::Ascii
    );
}

#[test]
fn a_file_that_is_cut_off_is_refused_with_the_byte() {
    let rate = LITTLE.matrix(6, &[1, 1], "fs", &[LITTLE.doubles(&[100.0])]);
    let mut file = LITTLE.file(&[rate.clone(), LITTLE.column("x", &[1.0, 2.0, 3.0])]);
    // 128 bytes of header.
    let start = 128 + rate.len();
    file.truncate(file.len() - 10);
    let error = Reader::new().from_reader("x.mat", file.as_slice()).unwrap_err().to_string();
    assert!(error.starts_with(&format!("x.mat, byte {start}: a variable that ends early")), "{error}");
    assert!(error.contains("62 of 72 bytes are there"), "{error}");
    file.truncate(start + 4);
    let error = Reader::new().from_reader("x.mat", file.as_slice()).unwrap_err().to_string();
    assert!(error.contains(&format!("byte {start}")) && error.contains("4 of 8 bytes are there"), "{error}");
}

#[test]
fn damage_is_named_with_its_byte() {
    let short = LITTLE.matrix(6, &[3, 1], "x", &[LITTLE.doubles(&[1.0, 2.0])]);
    let error = complaint(&[LITTLE.column("a", &[1.0, 2.0]), short]);
    // The first variable takes 8 + 64 bytes behind the header of 128.
    assert!(error.starts_with("x.mat, byte 200: a variable that declares 3 values and holds 2"), "{error}");
    assert!(complaint(&[LITTLE.matrix(6, &[2, 1], "x", &[])]).contains("ends early"));
    assert!(complaint(&[LITTLE.matrix(99, &[1, 1], "x", &[])]).contains("class 99"));
    assert!(complaint(&[]).contains("no numeric vector"));
    let mut broken = packed(&LITTLE.column("x", &[1.0; 50]));
    broken[20] ^= 0xff;
    assert!(complaint(&[broken]).contains("try:"));
}

#[test]
fn packed_variables_hold_what_they_declare() {
    let of_size =
        |rows: u32, columns: u32| LITTLE.matrix(6, &[rows, columns], "x", &[LITTLE.doubles(&[0.0; 1000])]);
    for declared in [(10, 10), (30_000, 30_000), (u32::MAX, u32::MAX)] {
        assert!(complaint(&[packed(&of_size(declared.0, declared.1))]).contains("and holds 1000"));
    }
    assert_eq!(of(&[packed(&LITTLE.column("x", &vec![0.0; 100_000]))]).unwrap().records[0].len(), 100_000);
    let mut lying = LITTLE.column("x", &[0.0; 1000]);
    lying[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(complaint(&[packed(&lying)]).contains("ends early"));
}

proptest! {
    #[test]
    fn what_is_packed_or_not_is_read_to_the_bit(
        x in prop::collection::vec(prop::num::f64::NORMAL, 2..60), big in any::<bool>(), pack in any::<bool>(), name in "[a-z]{2,20}",
    ) {
        let order = Order { big: big && !pack };
        let matrix = order.column(&name, &x);
        let file = order.file(&[if pack { packed(&matrix) } else { matrix }]);
        let recording = Reader::new().from_reader("x.mat", file.as_slice()).unwrap();
        prop_assert_eq!(&recording.records[0].meta().name, &name);
        prop_assert_eq!(values(&recording.records[0]), x.as_slice());
    }

    #[test]
    fn never_panics_on_random_bytes(tail in prop::collection::vec(any::<u8>(), 0..200), big in any::<bool>()) {
        let order = Order { big };
        let _ = Reader::new().from_reader("x.mat", order.file(std::slice::from_ref(&tail)).as_slice());
        let matrix = [order.word(14), order.word(tail.len() as u32), tail].concat();
        let _ = Reader::new().from_reader("x.mat", order.file(&[matrix]).as_slice());
    }

    #[test]
    fn never_panics_on_changed_bytes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in any::<prop::sample::Index>(),
    ) {
        let complex = LITTLE.matrix(6 | 0x800, &[2, 1], "H", &[LITTLE.doubles(&[1.0, 2.0]), LITTLE.doubles(&[3.0, 4.0])]);
        let text = LITTLE.matrix(4, &[1, 3], "rig", &[LITTLE.element(16, b"two")]);
        let whole = LITTLE.file(&[LITTLE.column("t", &[0.0, 0.1]), complex.clone(), packed(&complex), text]);
        let mut inner = complex;
        for (index, value) in &changes {
            let at = index.index(inner.len());
            inner[at] = *value;
        }
        let _ = of(&[packed(&inner)]);
        let mut bytes = whole;
        for (index, value) in &changes {
            // Leave the header: without it nothing is read.
            let at = 128 + index.index(bytes.len() - 128);
            bytes[at] = *value;
        }
        let _ = Reader::new().from_reader("x.mat", bytes.as_slice());
        bytes.truncate(cut.index(bytes.len()).max(1));
        let _ = Reader::new().from_reader("x.mat", bytes.as_slice());
    }
}
