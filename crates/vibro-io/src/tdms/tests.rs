use super::*;
use crate::tests::has_finding;
use proptest::prelude::*;
use vibro_record::Trace;

/// Writes TDMS segments, in either order of bytes.
#[derive(Default)]
struct Writer {
    big: bool,
    bytes: Vec<u8>,
}

/// Raw data index of an object.
enum Raw {
    None,
    AsBefore,
    /// Type and number of values.
    Of(u32, u64),
    /// Values of a buffer; type, buffer, byte and number of each scaler; widths of the buffers.
    Daqmx(u64, Vec<[u32; 4]>, Vec<u32>),
    /// As that with bits in place of bytes.
    Digital(u64, Vec<[u32; 4]>, Vec<u32>),
}

enum Prop<'a> {
    F64(&'a str, f64),
    U32(&'a str, u32),
    Text(&'a str, &'a str),
}

const META: u32 = 2;
const NEW: u32 = 4;
const RAW: u32 = 8;
const MIXED: u32 = 32;
const BIG: u32 = 64;

impl Writer {
    fn new(big: bool) -> Writer {
        Writer { big, ..Writer::default() }
    }

    fn put<const N: usize>(&self, mut little: [u8; N]) -> [u8; N] {
        if self.big {
            little.reverse();
        }
        little
    }

    fn text(&self, to: &mut Vec<u8>, text: &str) {
        to.extend(self.put((text.len() as u32).to_le_bytes()));
        to.extend(text.as_bytes());
    }

    fn segment(&mut self, contents: u32, objects: &[(&str, Raw, &[Prop])], raw: &[u8]) -> &mut Writer {
        let mut meta = Vec::new();
        let word = |to: &mut Vec<u8>, n: u32| to.extend(self.put(n.to_le_bytes()));
        if contents & META != 0 {
            word(&mut meta, objects.len() as u32);
        }
        for (path, index, properties) in objects {
            self.text(&mut meta, path);
            match index {
                Raw::None => word(&mut meta, u32::MAX),
                Raw::AsBefore => word(&mut meta, 0),
                Raw::Of(code, n) => {
                    word(&mut meta, 20);
                    word(&mut meta, *code);
                    word(&mut meta, 1);
                    meta.extend(self.put(n.to_le_bytes()));
                }
                Raw::Daqmx(n, scalers, widths) | Raw::Digital(n, scalers, widths) => {
                    let digital = matches!(index, Raw::Digital(..));
                    word(&mut meta, if digital { 0x126a } else { 0x1269 });
                    word(&mut meta, u32::MAX);
                    word(&mut meta, 1);
                    meta.extend(self.put(n.to_le_bytes()));
                    word(&mut meta, scalers.len() as u32);
                    for [code, buffer, offset, id] in scalers {
                        word(&mut meta, *code);
                        word(&mut meta, *buffer);
                        word(&mut meta, *offset);
                        meta.extend(if digital { &[0][..] } else { &[0; 4] });
                        word(&mut meta, *id);
                    }
                    word(&mut meta, widths.len() as u32);
                    for width in widths {
                        word(&mut meta, *width);
                    }
                }
            }
            word(&mut meta, properties.len() as u32);
            for property in *properties {
                match property {
                    Prop::F64(key, value) => {
                        self.text(&mut meta, key);
                        word(&mut meta, 10);
                        meta.extend(self.put(value.to_le_bytes()));
                    }
                    Prop::U32(key, value) => {
                        self.text(&mut meta, key);
                        word(&mut meta, 7);
                        word(&mut meta, *value);
                    }
                    Prop::Text(key, value) => {
                        self.text(&mut meta, key);
                        word(&mut meta, 0x20);
                        self.text(&mut meta, value);
                    }
                }
            }
        }
        let mut bytes = b"TDSm".to_vec();
        bytes.extend((contents | if self.big { BIG } else { 0 }).to_le_bytes());
        bytes.extend(self.put(4713u32.to_le_bytes()));
        bytes.extend(self.put(((meta.len() + raw.len()) as u64).to_le_bytes()));
        bytes.extend(self.put((meta.len() as u64).to_le_bytes()));
        bytes.extend(meta);
        bytes.extend(raw);
        self.bytes.extend(bytes);
        self
    }

    fn doubles(&self, values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|v| self.put(v.to_le_bytes())).collect()
    }
}

fn recording(bytes: &[u8]) -> Result<Recording> {
    crate::Reader::new().from_reader("x.tdms", bytes)
}

fn traces(bytes: &[u8]) -> Vec<Trace> {
    let trace = |record| if let Record::Trace(trace) = record { trace } else { panic!("{record:?}") };
    recording(bytes).unwrap().records.into_iter().map(trace).collect()
}

const ALL: u32 = META | NEW | RAW;

#[test]
fn waveforms_of_a_group_with_units_and_notes() {
    for big in [false, true] {
        let mut writer = Writer::new(big);
        let raw = [writer.doubles(&[1.0, -2.0, 3.0]), writer.doubles(&[10.0, 20.0, 30.0])].concat();
        let wave = |unit| {
            [
                Prop::F64("wf_increment", 1e-3),
                Prop::F64("wf_start_offset", 0.5),
                Prop::Text("unit_string", unit),
            ]
        };
        writer.segment(
            ALL,
            &[
                ("/", Raw::None, &[Prop::Text("Author", "A. B.")]),
                ("/'run ''1'''", Raw::None, &[]),
                ("/'run ''1'''/'force'", Raw::Of(10, 3), &wave("N")),
                ("/'run ''1'''/'v'", Raw::Of(10, 3), &wave("mm/s")),
            ],
            &raw,
        );
        let found = traces(&writer.bytes);
        assert_eq!((found[0].meta.name.as_str(), found[0].meta.unit.symbol()), ("force", "N"));
        assert_eq!((found[0].axis.start(), found[0].axis.step()), (0.5, Some(1e-3)));
        assert_eq!(found[0].values, [1.0, -2.0, 3.0]);
        assert_eq!(found[1].values, [0.01, 0.02, 0.03]);
        assert!(found[0].meta.notes.contains(&("Author".into(), "A. B.".into())));
        assert!(recording(&writer.bytes).unwrap().all_findings().is_empty());
    }
}

#[test]
fn chunks_segments_and_the_index_of_before() {
    let mut writer = Writer::new(false);
    // Two chunks of two values each, then a segment without a description, then one with a longer list and one more property.
    let chunk = |from: f64| [from, from + 1.0, 100.0 + from, 101.0 + from];
    let first = writer.doubles(&[chunk(0.0), chunk(2.0)].concat());
    writer.segment(ALL, &[("/'g'/'a'", Raw::Of(10, 2), &[]), ("/'g'/'b'", Raw::Of(10, 2), &[])], &first);
    let second = writer.doubles(&chunk(4.0));
    writer.segment(RAW, &[], &second);
    let third = writer.doubles(&[6.0, 7.0, 106.0, 107.0, 1.0]);
    let step = [Prop::F64("wf_increment", 0.1)];
    writer.segment(
        META | RAW,
        &[("/'g'/'a'", Raw::AsBefore, &step), ("/'g'/'c'", Raw::Of(10, 1), &[])],
        &third,
    );
    let found = traces(&writer.bytes);
    assert_eq!(found[0].values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(found[1].values, [100.0, 101.0, 102.0, 103.0, 104.0, 105.0, 106.0, 107.0]);
    assert_eq!((found[2].values.as_slice(), found[0].axis.step()), (&[1.0][..], Some(0.1)));
}

#[test]
fn interleaved_values_of_every_type() {
    for big in [false, true] {
        let mut writer = Writer::new(big);
        let mut raw = Vec::new();
        for k in [-3i8, 5] {
            raw.extend(k.to_le_bytes());
            raw.extend(writer.put((-300i16 * i16::from(k)).to_le_bytes()));
            raw.extend(writer.put((70_000i32 * i32::from(k)).to_le_bytes()));
            raw.extend(writer.put((1i64 << 40).to_le_bytes()));
            raw.extend(writer.put(0.5f32.to_le_bytes()));
            raw.extend((200u8).to_le_bytes());
            raw.extend(writer.put(60_000u16.to_le_bytes()));
            raw.extend(writer.put(4_000_000_000u32.to_le_bytes()));
            raw.extend(writer.put((1u64 << 50).to_le_bytes()));
            // 2 s and a quarter behind the beginning of 1904.
            raw.extend(
                writer.put((((2i128 << 64) | (1i128 << 62)) * i128::from(k.unsigned_abs())).to_le_bytes()),
            );
            raw.push(u8::from(k > 0));
        }
        let names = ["i8", "i16", "i32", "i64", "f32", "u8", "u16", "u32", "u64", "when", "on"];
        let codes = [1, 2, 3, 4, 9, 5, 6, 7, 8, 0x44, 0x21];
        let paths: Vec<String> = names.iter().map(|n| format!("/'g'/'{n}'")).collect();
        let objects: Vec<(&str, Raw, &[Prop])> =
            paths.iter().zip(codes).map(|(path, code)| (path.as_str(), Raw::Of(code, 2), &[][..])).collect();
        writer.segment(ALL | MIXED, &objects, &raw);
        let found = traces(&writer.bytes);
        let expected = [
            [-3.0, 5.0],
            [900.0, -1500.0],
            [-210_000.0, 350_000.0],
            [2f64.powi(40); 2],
            [0.5; 2],
            [200.0; 2],
            [60_000.0; 2],
            [4e9; 2],
            [2f64.powi(50); 2],
            [6.75, 11.25],
            [0.0, 1.0],
        ];
        for (trace, expected) in found.iter().zip(expected) {
            assert_eq!(trace.values, expected, "{} {big}", trace.meta.name);
        }
    }
}

/// A number or a text.
type Said = std::result::Result<f64, &'static str>;

/// Properties of scale `i`.
fn linear(i: usize, slope: f64, intercept: f64, source: u32) -> Vec<(String, Said)> {
    vec![
        (format!("NI_Scale[{i}]_Scale_Type"), Err("Linear")),
        (format!("NI_Scale[{i}]_Linear_Slope"), Ok(slope)),
        (format!("NI_Scale[{i}]_Linear_Y_Intercept"), Ok(intercept)),
        (format!("NI_Scale[{i}]_Linear_Input_Source"), Ok(f64::from(source))),
    ]
}

fn scaled(n: u32, properties: &[(String, Said)], raw: &[f64]) -> std::result::Result<Vec<f64>, String> {
    let properties = properties
        .iter()
        .map(|(key, value)| (key.clone(), value.map_or_else(|text| Value::Text(text.into()), Value::Number)));
    let count = [("NI_Number_Of_Scales".to_owned(), Value::Number(f64::from(n)))];
    let object = Object {
        path: vec!["g".into(), "a".into()],
        properties: count.into_iter().chain(properties).collect(),
        slots: vec![segment::Slot::Real],
        ..Object::default()
    };
    let values = Scales::of(&[], &object).apply(&object.slots, vec![raw.to_vec()])?;
    if let Values::Real(values) = values { Ok(values) } else { panic!() }
}

#[test]
fn scales_one_behind_the_other() {
    // 2x + 1, and 3 − 0.5y of that.
    let chain = [linear(0, 2.0, 1.0, u32::MAX), linear(1, -0.5, 3.0, 0)].concat();
    assert_eq!(scaled(2, &chain, &[0.0, 4.0]).unwrap(), [2.5, -1.5]);
    let of = |i: usize, kind: &'static str| (format!("NI_Scale[{i}]_Scale_Type"), Err(kind));
    let number = |key: &str, value: f64| (format!("NI_Scale[0]_{key}"), Ok(value));
    let mut polynomial = vec![of(0, "Polynomial"), number("Polynomial_Coefficients_Size", 3.0)];
    polynomial.extend(
        [1.0, 0.0, 2.0].iter().enumerate().map(|(j, c)| number(&format!("Polynomial_Coefficients[{j}]"), *c)),
    );
    assert_eq!(scaled(1, &polynomial, &[0.0, 3.0]).unwrap(), [1.0, 19.0]);
    let mut table = vec![
        of(0, "Table"),
        number("Table_Scaled_Values_Size", 3.0),
        number("Table_Pre_Scaled_Values_Size", 3.0),
    ];
    for (j, (pre, scaled)) in [(0.0, 4.0), (10.0, 2.0), (40.0, 1.0)].into_iter().enumerate() {
        table.extend([
            number(&format!("Table_Scaled_Values[{j}]"), scaled),
            number(&format!("Table_Pre_Scaled_Values[{j}]"), pre),
        ]);
    }
    assert_eq!(scaled(1, &table, &[-3.0, 0.0, 5.0, 25.0, 99.0]).unwrap(), [4.0, 4.0, 3.0, 1.5, 1.0]);
    assert_eq!(scaled(1, &[of(0, "Thermocouple")], &[0.0]), Err("Thermocouple".into()));
    // A scale that feeds itself.
    assert!(scaled(1, &linear(0, 1.0, 0.0, 0), &[0.0]).unwrap_err().contains("itself"));
    assert!(scaled(1, &[of(0, "Linear")], &[0.0]).unwrap_err().contains("without Linear_Slope"));
}

#[test]
fn a_daqmx_buffer_with_its_scaler_and_its_scale() {
    let mut writer = Writer::new(false);
    // Rows of two channels of 16 bits.
    let raw: Vec<u8> =
        [[100i16, -7], [200, -8], [-300, 9]].iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let scale = |slope| {
        [
            Prop::U32("NI_Number_Of_Scales", 2),
            Prop::Text("NI_Scale[1]_Scale_Type", "Linear"),
            Prop::F64("NI_Scale[1]_Linear_Slope", slope),
            Prop::F64("NI_Scale[1]_Linear_Y_Intercept", 0.5),
            Prop::U32("NI_Scale[1]_Linear_Input_Source", 0),
            Prop::Text("NI_UnitDescription", "V"),
        ]
    };
    writer.segment(
        ALL,
        &[
            ("/'g'/'a'", Raw::Daqmx(3, vec![[3, 0, 0, 0]], vec![4]), &scale(0.01)),
            ("/'g'/'b'", Raw::Daqmx(3, vec![[3, 0, 2, 0]], vec![4]), &scale(1.0)),
        ],
        &raw,
    );
    let found = traces(&writer.bytes);
    assert_eq!(found[0].values, [1.5, 2.5, -2.5]);
    assert_eq!((found[1].values.as_slice(), found[1].meta.unit.symbol()), (&[-6.5, -7.5, 9.5][..], "V"));
    // A line of a digital port is one bit.
    let mut digital = Writer::new(false);
    let line = |bit: u32| Raw::Digital(3, vec![[0, 0, bit, 0]], vec![1]);
    digital.segment(ALL, &[("/'g'/'0'", line(0), &[]), ("/'g'/'2'", line(2), &[])], &[0b101, 0b100, 0b001]);
    let found = traces(&digital.bytes);
    assert_eq!([&found[0].values, &found[1].values], [&[1.0, 0.0, 1.0], &[1.0, 1.0, 0.0]]);
}

#[test]
fn an_unknown_scale_leaves_its_channel_out() {
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[1.0, 2.0]);
    let scale = [Prop::U32("NI_Number_Of_Scales", 1), Prop::Text("NI_Scale[0]_Scale_Type", "RTD")];
    writer.segment(ALL, &[("/'g'/'t'", Raw::Of(10, 1), &scale), ("/'g'/'v'", Raw::Of(10, 1), &[])], &raw);
    let found = recording(&writer.bytes).unwrap();
    assert_eq!(found.records.len(), 1);
    assert!(has_finding(&found.findings, "scale-unknown", &["variable=t", "scale=RTD"]));
}

#[test]
fn a_channel_of_times_is_the_abscissa_of_its_group() {
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[0.0, 250.0, 500.0, 1.0, 2.0, 3.0]);
    let ms = [Prop::Text("unit_string", "ms")];
    writer.segment(ALL, &[("/'g'/'Time'", Raw::Of(10, 3), &ms), ("/'g'/'v'", Raw::Of(10, 3), &[])], &raw);
    let found = traces(&writer.bytes);
    assert_eq!((found.len(), found[0].axis.step()), (1, Some(0.25)));
}

#[test]
fn a_file_that_ends_early_says_how_much_is_missing() {
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[1.0, 2.0, 3.0, 4.0]);
    writer.segment(ALL, &[("/'g'/'a'", Raw::Of(10, 2), &[]), ("/'g'/'b'", Raw::Of(10, 2), &[])], &raw);
    let cut = recording(&writer.bytes[..writer.bytes.len() - 5]).unwrap();
    let n: Vec<(usize, Option<usize>)> = cut.records.iter().map(|r| (r.len(), r.meta().declared_n)).collect();
    assert_eq!(n, [(2, None), (1, Some(2))]);
    assert!(has_finding(&cut.records[1].meta().findings, "fewer-values", &["declared=2", "n=1"]));
    // A segment that was never closed goes to the end of the file.
    let mut open = writer.bytes.clone();
    open[12..20].fill(0xff);
    assert_eq!(recording(&open).unwrap().records, recording(&writer.bytes).unwrap().records);
    // Half of a description is nothing.
    let mut two = Writer { big: false, bytes: writer.bytes.clone() };
    two.segment(META, &[("/'g'/'a'", Raw::AsBefore, &[Prop::F64("later", 1.0)])], &[]);
    let found = recording(&two.bytes[..two.bytes.len() - 4]).unwrap();
    assert!(has_finding(&found.findings, "segment-cut", &[]) && found.records.len() == 2);
}

#[test]
fn what_is_no_measurement_is_refused() {
    let said = |bytes: &[u8]| recording(bytes).unwrap_err().to_string();
    let index = said(b"TDSh\x0e\0\0\0");
    assert!(index.contains("without `_index`"), "{index}");
    let mut writer = Writer::new(false);
    writer.segment(META | NEW, &[("/", Raw::None, &[])], &[]);
    assert!(said(&writer.bytes).contains("no channel with numbers"));
    let mut junk = writer.bytes.clone();
    junk.extend([b'x'; 64]);
    assert!(said(&junk).contains("begin no segment"));
    writer.segment(ALL, &[("/'g'/'a'", Raw::Of(0x1b, 2), &[])], &[0; 16]);
    assert!(said(&writer.bytes).contains("type 0x1b"));
}

fn small() -> Vec<u8> {
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[1.0, 2.0, 3.0, 4.0]);
    let step = [Prop::F64("wf_increment", 0.1), Prop::Text("unit_string", "V")];
    writer.segment(
        ALL,
        &[("/", Raw::None, &[]), ("/'g'/'a'", Raw::Of(10, 2), &step), ("/'g'/'b'", Raw::Of(10, 2), &[])],
        &raw,
    );
    writer.segment(ALL, &[("/'g'/'c'", Raw::Daqmx(2, vec![[3, 0, 0, 0]], vec![2]), &[])], &[1, 0, 2, 0]);
    writer.bytes
}

proptest! {
    /// Whatever a header declares: no panic, and no more memory than the file gives reason for.
    #[test]
    fn damaged_files_never_panic(at in 0usize..400, byte: u8, end in 0usize..400) {
        let mut bytes = small();
        let n = bytes.len();
        bytes[at % n] = byte;
        if let Ok(found) = recording(&bytes[..n - end % n]) {
            prop_assert!(found.records.iter().all(|r| r.len() <= n));
        }
    }
}
