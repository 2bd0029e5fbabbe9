use super::*;
use crate::format::Format;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::tests::{has_finding, texts};
use num_complex::Complex64;
use proptest::prelude::*;
use std::io::Write;
use vibro_record::units::Quantity;
use vibro_record::units::Unit;
use vibro_record::{Axis, AxisKind, Record, Values};

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

    /// A small element if the content fits, as MATLAB writes it.
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

    fn scalar(self, name: &str, value: f64) -> Vec<u8> {
        self.column(name, &[value])
    }

    fn text(self, name: &str, text: &str) -> Vec<u8> {
        self.matrix(4, &[1, text.len() as u32], name, &[self.element(16, text.as_bytes())])
    }

    /// `members` are without names, field after field of one struct after the other.
    fn structs(self, name: &str, n: u32, fields: &[&str], members: &[Vec<u8>]) -> Vec<u8> {
        let names: Vec<u8> = fields
            .iter()
            .flat_map(|field| {
                field.bytes().chain(std::iter::repeat_n(0, 32 - field.len())).collect::<Vec<u8>>()
            })
            .collect();
        let width = self.element(5, &self.word(32));
        self.matrix(2, &[1, n], name, &[width, self.element(1, &names), members.concat()])
    }

    /// One struct with its fields, each of them written under its name.
    fn one(self, name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
        let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
        let members: Vec<Vec<u8>> = fields.iter().map(|(_, member)| member.clone()).collect();
        self.structs(name, 1, &names, &members)
    }

    fn cells(self, name: &str, members: &[Vec<u8>]) -> Vec<u8> {
        self.matrix(1, &[1, members.len() as u32], name, &[members.concat()])
    }

    /// A variable of level 4; `words` are type, rows, columns, complex (1) or not (0).
    fn of_level_4(self, words: [u32; 4], name: &str, content: &[u8]) -> Vec<u8> {
        let words: Vec<u8> =
            words.iter().chain(&[name.len() as u32 + 1]).flat_map(|w| self.word(*w)).collect();
        [&words, name.as_bytes(), &[0], content].concat()
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
    // Accumulated steps, as simulation programs write them, drift by rounding and still count as even.
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
    // Tolerance: a thousand sums, each rounded by at most half an ulp of 1.
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

    // A force called f and a torque called t are not abscissae.
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
    let values_of_two: Vec<f64> = (0..2002).map(f64::from).collect();
    let wide = of(&[LITTLE.matrix(6, &[2, 1001], "w", &[LITTLE.doubles(&values_of_two)])]).unwrap();
    assert_eq!((wide.records.len(), wide.records[1].meta().name.as_str()), (2, "w(2,:)"));
    assert!(values(&wide.records[1]).iter().enumerate().all(|(i, v)| *v == (2 * i + 1) as f64));
    assert!(has_finding(&wide.findings, "matrix-by-rows", &["variable=w", "rows=2", "columns=1001"]));
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
    assert_eq!((frf.meta.quantity, &frf.axis), (Quantity::Receptance, &Axis::frequency(10.0, 10.0, 2)));
    assert_eq!(frf.values[1], Complex64::new(2.0 * 1e-3, 0.5 * 1e-3));
}

#[test]
fn texts_are_notes_and_the_rest_is_named() {
    let utf16: Vec<u8> = "µm".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let recording = of(&[
        LITTLE.matrix(4, &[1, 2], "unit", &[LITTLE.element(4, &utf16)]),
        LITTLE.matrix(4, &[1, 3], "rig", &[LITTLE.element(16, b"two")]),
        LITTLE.matrix(4, &[2, 3], "lines", &[LITTLE.element(16, b"twotwo")]),
        LITTLE.one(
            "setup",
            &[("thin", LITTLE.matrix(5, &[1, 1], "", &[])), ("none", vec![14, 0, 0, 0, 0, 0, 0, 0])],
        ),
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
        "variable-passed-over variable=setup.thin class=sparse matrix",
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

/// Names of the records, with the sampling rate of traces.
fn rates(recording: &Recording) -> Vec<(&str, Option<f64>)> {
    let of = |record: &'_ Record| match record {
        Record::Trace(trace) => trace.rate(),
        _ => None,
    };
    recording.records.iter().map(|record| (record.meta().name.as_str(), of(record))).collect()
}

const SOME: [f64; 4] = [1.0, -2.0, 5.0, 3.0];

#[test]
fn structs_and_cells_are_walked_and_say_their_own_rates() {
    let x = || LITTLE.column("", &SOME);
    let runs = [LITTLE.scalar("", 100.0), x(), LITTLE.scalar("", 200.0), x()];
    let deep = LITTLE.one("", &[("y", x()), ("more", LITTLE.cells("", &[LITTLE.text("", "a"), x()]))]);
    let recording = of(&[
        LITTLE.structs("run", 2, &["fs", "v"], &runs),
        LITTLE
            .cells("data", &[LITTLE.one("", &[("x", x()), ("t", LITTLE.column("", &[0.0, 0.5, 1.0, 1.5]))])]),
        LITTLE.one("rig", &[("fs", LITTLE.scalar("", 10.0)), ("deep", deep)]),
        LITTLE.column("bare", &SOME),
    ]);
    let recording = recording.unwrap();
    let expected = [
        ("run(1).v", Some(100.0)),
        ("run(2).v", Some(200.0)),
        ("data{1}.x", Some(2.0)),
        ("rig.deep.y", Some(10.0)),
        ("rig.deep.more{2}", Some(10.0)),
        ("bare", None),
    ];
    assert_eq!(rates(&recording), expected);
    assert!(recording.records.iter().all(|record| values(record) == SOME));
    let fs = ("rig.fs".to_owned(), "10".to_owned());
    assert!(recording.records[3].meta().notes.contains(&fs) && recording.records[5].meta().notes.is_empty());
    assert!(has_finding(&recording.records[5].meta().findings, "abscissa-unsaid", &[]));
}

#[test]
fn the_nearest_of_several_sayings_holds() {
    let column = |values: &[f64]| LITTLE.column("", values);
    let (t, shifted) = ([0.0, 0.5, 1.0, 1.5], [1.0, 1.5, 2.0, 2.5]);
    let inner = LITTLE.one("a", &[("fs", LITTLE.scalar("", 8.0)), ("time_signal", column(&SOME))]);
    let file = [
        LITTLE.column("t", &t),
        LITTLE.column("x", &SOME),
        inner,
        LITTLE.one("b", &[("fs", LITTLE.scalar("", 16.0)), ("time_signal", column(&SOME))]),
        LITTLE.one("c", &[("t", column(&t)), ("time", column(&shifted)), ("x", column(&SOME))]),
    ];
    let recording = of(&file).unwrap();
    let expected = [("x", 2.0), ("a.time_signal", 8.0), ("b.time_signal", 16.0), ("c.x", 2.0)];
    assert_eq!(rates(&recording), expected.map(|(name, rate)| (name, Some(rate))));
    assert_eq!(recording.records[3].axis().start(), 0.0);
    assert!(has_finding(
        &recording.findings,
        "time-or-frequency",
        &["variable=c.x", "used=c.t", "other=c.time"]
    ));
    let stated = Reader::new().rate(Some(4.0)).from_reader("x.mat", LITTLE.file(&file).as_slice()).unwrap();
    assert_eq!(stated.records[1].axis(), &Axis::time(0.0, 0.25, 4));
    assert!(has_finding(
        &stated.records[1].meta().findings,
        "rate-overrides-step",
        &["step=0.125", "rate=4"]
    ));
}

#[test]
fn a_sampling_rate_and_the_rate_of_a_shaft() {
    let bearing = |sr: &[(&str, Vec<u8>)], rate: f64| {
        let gs = [
            ("rate", LITTLE.scalar("", rate)),
            ("gs", LITTLE.column("", &SOME)),
            ("load", LITTLE.scalar("", 270.0)),
        ];
        of(&[LITTLE.one("bearing", &[sr, &gs].concat())]).unwrap()
    };
    let sr = [("sr", LITTLE.scalar("", 97656.0))];
    let both = bearing(&sr, 25.0);
    let close =
        |recording: &Recording, rate: f64| (rates(recording)[0].1.unwrap() / rate - 1.0).abs() < 1e-12;
    assert!(close(&both, 97656.0) && rates(&both)[0].0 == "bearing.gs");
    let said = &both.records[0].meta().findings;
    assert!(has_finding(said, "step-by-name", &["variable=bearing.sr", "rate=97656", "other=bearing.rate"]));
    // Without another statement, a rate below 1 kHz may be that of the shaft.
    let shaft = bearing(&[], 25.0);
    assert_eq!(rates(&shaft), [("bearing.gs", None)]);
    assert!(has_finding(
        &shaft.records[0].meta().findings,
        "abscissa-unsaid",
        &["variable=bearing.rate", "rate=25"]
    ));
    let alone = bearing(&[], 48000.0);
    assert!(close(&alone, 48000.0));
    assert!(has_finding(&alone.records[0].meta().findings, "step-by-name", &["variable=bearing.rate"]));
}

#[test]
fn names_that_end_in_time_are_no_times() {
    let recording = of(&[
        LITTLE.column("X097_DE_time", &[1.0, 2.0, 5.0, 7.0]),
        LITTLE.column("X097_FE_time", &SOME),
        LITTLE.scalar("X097RPM", 1796.0),
    ]);
    let recording = recording.unwrap();
    assert_eq!(rates(&recording), [("X097_DE_time", None), ("X097_FE_time", None)]);
    assert_eq!(recording.records[0].axis().kind, AxisKind::Index);
    assert_eq!(texts(&recording.records[0].meta().findings), ["abscissa-unsaid "]);
}

#[test]
fn start_and_interval_of_an_oscilloscope() {
    let scalars = [("Tstart", -0.5), ("Tinterval", 0.25), ("Length", 4.0)];
    let mut variables: Vec<Vec<u8>> = scalars.map(|(name, value)| LITTLE.scalar(name, value)).into();
    variables.extend(["A", "B"].map(|name| LITTLE.column(name, &SOME)));
    let recording = of(&variables).unwrap();
    for (record, name) in recording.records.iter().zip(["A", "B"]) {
        assert_eq!((record.meta().name.as_str(), record.axis()), (name, &Axis::time(-0.5, 0.25, 4)));
        assert!(record.meta().findings.is_empty());
    }
}

#[test]
fn step_and_label_beside_the_values() {
    let axis = |start: f64, step: f64, unit: &str| {
        let quantity = LITTLE.one("", &[("label", LITTLE.text("", unit))]);
        let (start, step) = (LITTLE.scalar("", start), LITTLE.scalar("", step));
        ("x_values", LITTLE.one("", &[("start_value", start), ("increment", step), ("quantity", quantity)]))
    };
    let signal = |axis, values: Vec<u8>| {
        let of = of(&[LITTLE.one("Signal", &[axis, ("y_values", LITTLE.one("", &[("values", values)]))])])
            .unwrap();
        (of.records[0].axis().clone(), of.records[0].kind(), of.records[0].meta().findings.clone())
    };
    let parts = [LITTLE.doubles(&SOME), LITTLE.doubles(&SOME)];
    let complex = || LITTLE.matrix(6 | 0x800, &[4, 1], "", &parts);
    let (time, kind, said) = signal(axis(1.0, 0.5, "s"), LITTLE.column("", &SOME));
    assert_eq!((time, kind, said.len()), (Axis::time(1.0, 0.5, 4), "trace", 0));
    assert_eq!(signal(axis(10.0, 500.0, "ms"), LITTLE.column("", &SOME)).0, Axis::time(0.01, 0.5, 4));
    for values in [complex(), LITTLE.column("", &SOME)] {
        assert_eq!(signal(axis(2.0, 0.5, "Hz"), values).0, Axis::frequency(2.0, 0.5, 4));
    }
    let (bare, _, said) = signal(axis(0.0, 0.5, "?"), complex());
    assert_eq!(bare, Axis::frequency(0.0, 0.5, 4));
    assert!(has_finding(&said, "step-by-name", &["variable=Signal.x_values.increment", "step=0.5"]));
    // An increment in rpm is neither a time nor a frequency step.
    assert_eq!(signal(axis(0.0, 0.5, "rpm"), LITTLE.column("", &SOME)).0.kind, AxisKind::Index);
}

#[test]
fn a_header_speaks_of_the_vectors_beside_it() {
    for (written, rate, certain) in [("65536", 65536.0, true), ("32768,0000", 32768.0, false)] {
        let recording = of(&[
            LITTLE.one("File_Header", &[("SampleFrequency", LITTLE.text("", written))]),
            LITTLE.one("Channel_1_Header", &[("Unit", LITTLE.text("", "Pa"))]),
            LITTLE.column("Channel_1_Data", &SOME),
        ]);
        let recording = recording.unwrap();
        assert_eq!(rates(&recording), [("Channel_1_Data", Some(rate))]);
        assert_eq!(recording.records[0].meta().has("step-by-name"), !certain, "{written}");
        let notes = &recording.records[0].meta().notes;
        assert!(notes.contains(&("Channel_1_Header.Unit".to_owned(), "Pa".to_owned())));
    }
}

#[test]
fn x_and_y_of_a_control_system() {
    let half: Vec<f64> = (0..4).map(|i| 847.0 + 0.5 * f64::from(i)).collect();
    let long = [1.0, 2.0, 0.0, 1.0, 5.0];
    let data = |values: &[f64], unit: &str| [LITTLE.column("", values), LITTLE.text("", unit)];
    let recorder = |unit: &str| {
        let x = [data(&half, unit), data(&[0.0, 1.0, 2.0, 3.0, 4.0], unit)].concat();
        let y = [data(&SOME, "mm/s"), data(&long, "no unit")].concat();
        let fields = ["Data", "Unit"];
        of(&[LITTLE.one(
            "N15",
            &[("X", LITTLE.structs("", 2, &fields, &x)), ("Y", LITTLE.structs("", 2, &fields, &y))],
        )])
    };
    let recording = recorder("s").unwrap();
    assert_eq!(rates(&recording), [("N15.Y(1).Data", Some(2.0)), ("N15.Y(2).Data", Some(1.0))]);
    assert_eq!(recording.records[0].axis().start(), 847.0);
    assert_eq!((values(&recording.records[0])[1], recording.records[0].meta().unit.symbol()), (-2e-3, "m/s"));
    assert_eq!(values(&recording.records[1]), long);
    assert!(!has_finding(&recording.findings, "axis-by-name", &[]));
    assert!(has_finding(&recording.findings, "format-without-units", &[]));
    let bare = recorder("").unwrap();
    assert_eq!(rates(&bare)[0].1, Some(2.0));
    assert!(has_finding(&bare.findings, "axis-by-name", &["variable=N15.X(1).Data"]));
    assert_eq!(rates(&recorder("mm").unwrap()).len(), 4);
}

#[test]
fn a_unit_in_a_struct_is_that_of_its_only_vector() {
    let unit = || ("unit", LITTLE.text("", "mm"));
    let x = || LITTLE.column("", &SOME);
    let recording = of(&[
        LITTLE.one("a", &[unit(), ("t", LITTLE.column("", &[0.0, 0.5, 1.0, 1.5])), ("x", x())]),
        LITTLE.one("b", &[unit(), ("x", x()), ("y", x())]),
        LITTLE.text("unit", "mm"),
        LITTLE.column("c", &SOME),
    ]);
    let recording = recording.unwrap();
    assert_eq!(values(&recording.records[0]), SOME.map(|v| v * 1e-3));
    assert!(recording.records[1..].iter().all(|record| values(record) == SOME));
    assert!(has_finding(&recording.findings, "format-without-units", &[]));
    let stated = Reader::new()
        .unit(Unit::parse("m"))
        .from_reader("x.mat", LITTLE.file(&[LITTLE.one("a", &[unit(), ("x", x())])]).as_slice());
    let stated = stated.unwrap();
    assert_eq!(values(&stated.records[0]), SOME);
    assert!(has_finding(&stated.records[0].meta().findings, "unit-overrides-file", &["file=mm", "used=m"]));
}

#[test]
fn notes_do_not_fill_the_memory() {
    let texts: Vec<Vec<u8>> = (0..1000).map(|i| LITTLE.text("", &i.to_string())).collect();
    let recording = of(&[LITTLE.cells("c", &texts), LITTLE.column("x", &SOME)]).unwrap();
    let notes = &recording.records[0].meta().notes;
    assert_eq!((notes.len(), &notes[199]), (200, &("c{200}".to_owned(), "199".to_owned())));
}

#[test]
fn what_may_be_a_rate_is_offered() {
    let recording = of(&[
        LITTLE.scalar("carrier_freq", 40.0),
        LITTLE.scalar("sampled_at", 512.0),
        LITTLE.column("ramp", &[0.0, 0.25, 0.5, 0.75]),
        LITTLE.column("number", &[1.0, 2.0, 3.0, 4.0]),
        LITTLE.column("x", &SOME),
    ]);
    let found = recording.unwrap().records[2].meta().findings.clone();
    assert_eq!(texts(&found), ["abscissa-unsaid variable=sampled_at rate=512 vector=ramp rises=4"]);
}

#[test]
fn two_columns_are_complex_where_it_is_stated() {
    let two = LITTLE.matrix(6, &[2, 2], "H", &[LITTLE.doubles(&[1.0, 2.0, -3.0, -4.0])]);
    let file = LITTLE.file(&[two, LITTLE.column("f", &[5.0, 10.0])]);
    let reader = Reader::new().complex(true);
    let recording = reader.from_reader("x.mat", file.as_slice()).unwrap();
    let [Record::Spectrum(spectrum)] = &recording.records[..] else { panic!() };
    assert_eq!(spectrum.values, Values::Complex(vec![Complex64::new(1.0, -3.0), Complex64::new(2.0, -4.0)]));
    assert_eq!((spectrum.meta.name.as_str(), &spectrum.axis), ("H", &Axis::frequency(5.0, 5.0, 2)));
    assert_eq!(Reader::new().from_reader("x.mat", file.as_slice()).unwrap().records.len(), 2);
    let single = LITTLE.file(&[LITTLE.column("x", &SOME)]);
    let error = reader.from_reader("x.mat", single.as_slice()).unwrap_err().to_string();
    assert!(error.contains("try: leave out that values are complex"), "{error}");
}

#[test]
fn any_damage_to_what_is_packed_is_found() {
    let matrix = LITTLE.one("s", &[("x", LITTLE.column("", &SOME)), ("fs", LITTLE.scalar("", 5.0))]);
    let rest = LITTLE.column("y", &SOME);
    let packed = packed(&matrix);
    let whole = of(&[packed.clone(), rest.clone()]).unwrap();
    assert_eq!(whole.records.len(), 2);
    let mut unused = 0;
    for bit in 0..packed.len() * 8 {
        let mut damaged = packed.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        match of(&[damaged, rest.clone()]) {
            Err(error) => assert!(error.to_string().contains("x.mat, byte 128"), "bit {bit}: {error}"),
            Ok(read) => {
                assert_eq!(read, whole);
                unused += 1;
            }
        }
    }
    // A few bits pad the last byte or belong to codes that no value uses.
    assert!(unused < packed.len() * 8 / 20, "{unused}");
    // Cut short, with the size in the tag adjusted.
    for n in 8..packed.len() {
        let mut cut = packed[..n].to_vec();
        cut[4..8].copy_from_slice(&(n as u32 - 8).to_le_bytes());
        assert!(
            of(&[cut, rest.clone()]).unwrap_err().to_string().contains("byte 128: a packed variable"),
            "{n}"
        );
    }
}

#[test]
fn memory_follows_what_is_there() {
    // A packed variable that declares eight bytes and unpacks to 100 MB.
    let mut bomb = vec![0; 100 << 20];
    bomb[..8].copy_from_slice(&[14, 0, 0, 0, 8, 0, 0, 0]);
    assert!(complaint(&[packed(&bomb)]).contains("late: 16 of 8 bytes"));
    let width = |n: u32| LITTLE.element(5, &LITTLE.word(n));
    let names = LITTLE.element(1, &[b'a'; 32]);
    let huge = |parts: &[Vec<u8>]| LITTLE.matrix(2, &[u32::MAX, u32::MAX >> 1], "s", parts);
    assert!(complaint(&[huge(&[width(32), names.clone()])]).contains("ends early, without its s(1).aaaa"));
    let of_nothing = of(&[huge(&[width(32), LITTLE.element(1, &[])]), LITTLE.column("x", &SOME)]);
    assert_eq!(of_nothing.unwrap().records.len(), 1);
    assert!(
        complaint(&[LITTLE.matrix(1, &[u32::MAX, 2], "c", &[])]).contains("ends early, without its c{1}")
    );
    for of in [0, 513] {
        assert!(
            complaint(&[huge(&[width(of), names.clone()])]).contains(&format!("field names of {of} bytes"))
        );
    }
    let nested =
        |depth: usize| (1..depth).fold(LITTLE.column("", &SOME), |inner, _| LITTLE.cells("", &[inner]));
    let deep = of(&[LITTLE.cells("c", &[nested(32)]), LITTLE.cells("d", &[nested(5000)])]).unwrap();
    assert_eq!(deep.records.len(), 1);
    assert_eq!(deep.records[0].meta().name, format!("c{}", "{1}".repeat(32)));
    let passed = format!("variable=d{}", "{1}".repeat(32));
    assert!(has_finding(&deep.findings, "variable-passed-over", &[&passed, "struct or cell array too deep"]));
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
    assert!(error.contains("2 values NaN or infinite: 2 of \"x\", 3 of \"x\""), "{error}");
    let kept = Reader::new().allow_missing(true).from_reader("x.mat", file.as_slice()).unwrap();
    assert!(values(&kept.records[0])[2].is_nan());
}

#[test]
fn other_levels_are_refused_by_name() {
    let reader = Reader::new();
    let mut hdf5 = vec![b' '; 512];
    hdf5[124..128].copy_from_slice(b"\0\x02IM");
    // Next comes the HDF5 signature; with the feature `hdf5`, zeros instead, since the file would be read
    // as HDF5.
    hdf5.extend(if cfg!(feature = "hdf5") { b"\0\0\0\0\0\0\0\0" } else { HDF5 });
    let error = reader.from_reader("x.mat", hdf5.as_slice()).unwrap_err().to_string();
    assert!(error.contains("version 7.3, which is HDF5") && error.contains("-v7"), "{error}");
    let vax = LITTLE.of_level_4([2000, 2, 1, 0], "x", &[0; 16]);
    let error = reader.from_reader("x.mat", vax.as_slice()).unwrap_err().to_string();
    assert!(error.contains("byte 0: numbers of a VAX") && error.contains("-v7"), "{error}");
    // Text that `save -ascii` wrote is read as text.
    assert_eq!(
        reader.from_reader("x.mat", b" 1.0e+00\n 2.0e+00\n".as_slice()).unwrap().format,
        Format::Ascii
    );
}

#[test]
fn level_4_in_both_byte_orders_and_every_storage() {
    for (order, machine) in [(LITTLE, 0), (Order { big: true }, 1000)] {
        let doubles =
            |values: &[f64]| -> Vec<u8> { values.iter().flat_map(|v| order.put(&v.to_le_bytes())).collect() };
        let singles = [0.1f32, -0.5].iter().flat_map(|v| order.put(&v.to_le_bytes()));
        let i32s = [-70_000i32, 7].iter().flat_map(|v| order.put(&v.to_le_bytes()));
        let i16s = [-2i16, 300].iter().flat_map(|v| order.put(&v.to_le_bytes()));
        let u16s = [65_535u16, 3].iter().flat_map(|v| order.put(&v.to_le_bytes()));
        let of = |kind: u32, rows, columns, parts, name, content: &[u8]| {
            order.of_level_4([machine + kind, rows, columns, parts], name, content)
        };
        let variables = [
            of(0, 1, 1, 0, "Tinterval", &doubles(&[0.25])),
            of(0, 1, 1, 0, "Tstart", &doubles(&[-0.5])),
            of(1, 1, 3, 0, "rig", &doubles(&[116.0, 119.0, 111.0])),
            of(51, 1, 2, 0, "unit", b"mm"),
            of(51, 2, 1, 0, "lines", b"ab"),
            of(2, 2, 3, 0, "thin", &doubles(&[1.0; 6])),
            of(10, 2, 1, 0, "as_f32", &singles.collect::<Vec<u8>>()),
            of(20, 2, 1, 0, "as_i32", &i32s.collect::<Vec<u8>>()),
            of(30, 1, 2, 0, "as_i16", &i16s.collect::<Vec<u8>>()),
            of(40, 1, 2, 0, "as_u16", &u16s.collect::<Vec<u8>>()),
            of(50, 1, 2, 0, "as_u8", &[255, 3]),
            of(0, 2, 2, 0, "m", &doubles(&[1.0, 2.0, 3.0, 4.0])),
            of(0, 1, 2, 1, "H", &doubles(&[1.0, 2.0, -3.0, -4.0])),
        ];
        let recording = Reader::new().from_reader("x.mat", variables.concat().as_slice()).unwrap();
        let all: Vec<&[f64]> = recording.records[..7].iter().map(values).collect();
        let expected: [&[f64]; 7] = [
            &[f64::from(0.1f32), -0.5],
            &[-70_000.0, 7.0],
            &[-2.0, 300.0],
            &[65_535.0, 3.0],
            &[255.0, 3.0],
            &[1.0, 2.0],
            &[3.0, 4.0],
        ];
        assert_eq!(all, expected);
        assert_eq!(recording.records[6].meta().name, "m(:,2)");
        assert!(recording.records[..7].iter().all(|record| record.axis() == &Axis::time(-0.5, 0.25, 2)));
        let Record::Spectrum(h) = &recording.records[7] else { panic!() };
        assert_eq!(h.values, Values::Complex(vec![Complex64::new(1.0, -3.0), Complex64::new(2.0, -4.0)]));
        for (name, text) in [("rig", "two"), ("unit", "mm")] {
            assert!(h.meta.notes.contains(&(name.to_owned(), text.to_owned())));
        }
        for (name, class) in [("lines", "char array of several rows"), ("thin", "sparse matrix")] {
            assert!(has_finding(&recording.findings, "variable-passed-over", &[name, class]));
        }
        let forced = Reader::new().format(Some(Format::Mat)).from_reader("x", variables.concat().as_slice());
        assert_eq!(forced.unwrap().records.len(), 8);
        // The last variable has 54 bytes: five words, "H" with its zero, and four doubles.
        let start = variables.concat().len() - 54;
        for end in start + 1..start + 54 {
            let error =
                Reader::new().from_reader("x.mat", &variables.concat()[..end]).unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("x.mat, byte {start}: a variable that ends early")),
                "{error}"
            );
        }
    }
    let huge = LITTLE.of_level_4([0, u32::MAX, u32::MAX, 1], "x", &[0; 16]);
    let error = Reader::new().from_reader("x.mat", huge.as_slice()).unwrap_err().to_string();
    assert!(error.contains("ends early"), "{error}");
}

#[test]
fn a_file_that_is_cut_off_is_refused_with_the_byte() {
    let rate = LITTLE.matrix(6, &[1, 1], "fs", &[LITTLE.doubles(&[100.0])]);
    let mut file = LITTLE.file(&[rate.clone(), LITTLE.column("x", &[1.0, 2.0, 3.0])]);
    // The header has 128 bytes.
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
    // The first variable takes 8 + 64 bytes after the header of 128 bytes.
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
    fn never_panics_on_changed_bytes_of_level_4(
        changes in prop::collection::vec((0usize..22, any::<u8>()), 1..4), class in 0u32..3, kind in 0u32..6,
    ) {
        let mut bytes = LITTLE.of_level_4([10 * kind + class, 2, 1, 1], "x", &[1; 32]);
        for (at, value) in changes {
            bytes[at] = value;
        }
        let _ = Reader::new().format(Some(Format::Mat)).from_reader("x.mat", bytes.as_slice());
    }

    #[test]
    fn never_panics_on_changed_bytes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in any::<prop::sample::Index>(),
    ) {
        let complex = LITTLE.matrix(6 | 0x800, &[2, 1], "H", &[LITTLE.doubles(&[1.0, 2.0]), LITTLE.doubles(&[3.0, 4.0])]);
        let text = LITTLE.matrix(4, &[1, 3], "rig", &[LITTLE.element(16, b"two")]);
        let members = [LITTLE.scalar("", 5.0), LITTLE.cells("", &[LITTLE.column("", &SOME)])];
        let structs = LITTLE.structs("s", 1, &["fs", "c"], &members);
        let whole = LITTLE.file(&[LITTLE.column("t", &[0.0, 0.1]), complex.clone(), packed(&complex), text, structs.clone()]);
        let mut inner = [complex, structs].concat();
        for (index, value) in &changes {
            let at = index.index(inner.len());
            inner[at] = *value;
        }
        let _ = of(&[packed(&inner)]);
        let mut bytes = whole;
        for (index, value) in &changes {
            // The header is not changed: without it nothing is read.
            let at = 128 + index.index(bytes.len() - 128);
            bytes[at] = *value;
        }
        let _ = Reader::new().from_reader("x.mat", bytes.as_slice());
        bytes.truncate(cut.index(bytes.len()).max(1));
        let _ = Reader::new().from_reader("x.mat", bytes.as_slice());
    }
}

#[test]
fn a_packed_variable_is_refused_by_what_it_unpacks_to() {
    // 1000 zeros take 8000 bytes, of which two copies are in memory during reading.
    let file = LITTLE.file(&[packed(&LITTLE.column("x", &[0.0; 1000]))]);
    let read =
        |limit| Reader::new().max_memory(crate::limit::Limit(limit)).from_reader("x.mat", file.as_slice());
    assert!(file.len() < 1000 && read(20_000.0).is_ok());
    let said = read(12_000.0).unwrap_err().to_string();
    assert!(said.contains("x.mat: it needs 16 kB"), "{said}");
}
