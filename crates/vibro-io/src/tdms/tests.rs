use super::*;
use crate::recording::Recording;
use crate::tests::{has_finding, read_both_ways};
use proptest::prelude::*;
use vibro_record::{AxisKind, Record, Trace};

/// Writes TDMS segments, in either byte order.
#[derive(Default)]
struct Writer {
    big: bool,
    bytes: Vec<u8>,
}

/// Raw data index of an object.
enum Raw {
    None,
    AsBefore,
    /// Type code and number of values.
    Of(u32, u64),
    /// Number of values per buffer; type, buffer, byte and number of each scaler; widths of the buffers.
    Daqmx(u64, Vec<[u32; 4]>, Vec<u32>),
    /// As `Daqmx`, with bits instead of bytes.
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
    read_both_ways(&Source::memory("x.tdms", bytes).unwrap())
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
    // Two chunks of two values each, then a segment without a description, then one with a longer list and
    // one more property.
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
            // Multiples of 2.25 s after the start of 1904.
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

/// Value of a property: a number (`Ok`) or a text (`Err`).
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
        slots: vec![description::Slot::Real],
        ..Object::default()
    };
    let values = Scales::of(&[], &object).apply(&object.slots, vec![raw.to_vec()])?;
    if let Values::Real(values) = values { Ok(values) } else { panic!() }
}

#[test]
fn scales_one_behind_the_other() {
    // y = 2x + 1, then 3 − 0.5y.
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
    // A scale whose input is itself.
    assert!(scaled(1, &linear(0, 1.0, 0.0, 0), &[0.0]).unwrap_err().contains("itself"));
    assert!(scaled(1, &[of(0, "Linear")], &[0.0]).unwrap_err().contains("without Linear_Slope"));
}

#[test]
fn a_daqmx_buffer_with_its_scaler_and_its_scale() {
    let mut writer = Writer::new(false);
    // Rows of two 16-bit channels.
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
    // A segment that was not closed extends to the end of the file.
    let mut open = writer.bytes.clone();
    open[12..20].fill(0xff);
    assert_eq!(recording(&open).unwrap().records, recording(&writer.bytes).unwrap().records);
    // A description cut short is ignored.
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

/// A file of one segment with channels of a group `g`: name, properties, values.
fn group(channels: &[(&str, &[Prop], &[f64])]) -> Vec<u8> {
    let mut writer = Writer::new(false);
    let raw: Vec<u8> = channels.iter().flat_map(|(.., values)| writer.doubles(values)).collect();
    let paths: Vec<String> = channels.iter().map(|(name, ..)| format!("/'g'/'{name}'")).collect();
    let objects: Vec<(&str, Raw, &[Prop])> = channels
        .iter()
        .zip(&paths)
        .map(|((_, properties, values), path)| (path.as_str(), Raw::Of(10, values.len() as u64), *properties))
        .collect();
    writer.segment(ALL, &objects, &raw);
    writer.bytes
}

fn every(step: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| step * i as f64).collect()
}

/// Names and steps of the records.
fn steps(bytes: &[u8]) -> Vec<(String, AxisKind, Option<f64>)> {
    let of = |r: &Record| (r.meta().name.clone(), r.axis().kind.clone(), r.axis().step());
    recording(bytes).unwrap().records.iter().map(of).collect()
}

#[test]
fn values_that_were_written_scaled_keep_their_scales_as_notes_only() {
    let status = |status| {
        [
            Prop::U32("NI_Number_Of_Scales", 1),
            Prop::Text("NI_Scaling_Status", status),
            Prop::Text("NI_Scale[0]_Scale_Type", "Linear"),
            Prop::F64("NI_Scale[0]_Linear_Slope", 2.0),
            Prop::F64("NI_Scale[0]_Linear_Y_Intercept", 1.0),
        ]
    };
    let found = traces(&group(&[("a", &status("scaled"), &[3.0]), ("b", &status("unscaled"), &[3.0])]));
    assert_eq!([found[0].values[0], found[1].values[0]], [3.0, 7.0]);
}

#[test]
fn a_stated_step_against_a_channel_of_times() {
    let (times, step) = (every(0.5, 4), |dt| [Prop::F64("wf_increment", dt)]);
    let differ = group(&[("Time", &[], &times), ("a", &step(1.0), &[1.0; 4])]);
    assert_eq!(steps(&differ), [("a".into(), AxisKind::Time, Some(0.5))]);
    let said = recording(&differ).unwrap().all_findings();
    assert!(has_finding(&said, "vector-against-rate", &["variable=Time", "used=vector", "rate=1"]));
    assert!(has_finding(&said, "axis-unit-assumed", &["unit=s"]));
    // A rate stated by the user overrides both.
    let stated = crate::reader::Reader::new().rate(Some(8.0)).from_reader("x.tdms", &differ[..]).unwrap();
    assert_eq!(stated.records[0].axis().step(), Some(0.125));
    let agree = group(&[("Time", &[Prop::Text("unit_string", "s")], &times), ("a", &step(0.5), &[1.0; 4])]);
    let mut agree = recording(&agree).unwrap();
    agree.records[0].meta_mut().findings.retain(|found| found.code != "unit-unsaid");
    assert!(agree.all_findings().is_empty() && agree.records[0].axis().step() == Some(0.5));
}

#[test]
fn only_a_name_makes_an_abscissa() {
    let unit = |unit| [Prop::Text("unit_string", unit)];
    let wave = |unit| [Prop::Text("unit_string", unit), Prop::F64("wf_increment", 0.1)];
    let rising = every(2.0, 4);
    let run_up =
        group(&[("speed", &unit("Hz"), &rising), ("tach", &unit("s"), &rising), ("a", &[], &[1.0; 4])]);
    assert!(steps(&run_up).iter().all(|(_, kind, _)| *kind == AxisKind::Index) && steps(&run_up).len() == 3);
    // A frequency that rises over a stated or stored time is a measured channel.
    let stated = group(&[("Frequency", &wave("Hz"), &rising), ("a", &wave("g"), &[1.0; 4])]);
    assert_eq!(
        steps(&stated).iter().filter(|(_, kind, dt)| *kind == AxisKind::Time && *dt == Some(0.1)).count(),
        2
    );
    let both =
        group(&[("Time", &unit("s"), &rising), ("Frequency", &unit("Hz"), &rising), ("a", &[], &[1.0; 4])]);
    assert_eq!(steps(&both).len(), 2);
    let lines = group(&[("Frequency", &unit("kHz"), &rising), ("A", &unit("g"), &[1.0; 4])]);
    assert_eq!(steps(&lines), [("A".into(), AxisKind::Frequency, Some(2000.0))]);
    // A time whose length no other channel has is kept as a channel.
    let short = group(&[("Time", &unit("s"), &rising), ("a", &unit("g"), &[1.0; 5])]);
    assert!(has_finding(
        &recording(&short).unwrap().findings,
        "abscissa-of-other-length",
        &["variable=Time"]
    ));
    let back = group(&[("Time", &unit("s"), &[0.0, 1.0, 0.5]), ("a", &unit("g"), &[1.0; 3])]);
    assert!(has_finding(&recording(&back).unwrap().findings, "abscissa-not-rising", &["variable=Time"]));
    assert_eq!((steps(&short).len(), steps(&back).len()), (2, 2));
}

#[test]
fn each_clock_is_of_the_channels_behind_it() {
    let s = [Prop::Text("unit_string", "s")];
    let (fast, slow, one) = (every(0.5, 4), every(5.0, 4), [1.0; 4]);
    let follow =
        group(&[("Zeit", &s, &fast), ("a", &[], &one), ("Zeit_langsam", &s, &slow), ("b", &[], &one)]);
    let time = |name: &str, dt| (name.to_owned(), AxisKind::Time, Some(dt));
    assert_eq!(steps(&follow), [time("a", 0.5), time("b", 5.0)]);
    let beside = group(&[("Zeit", &s, &fast), ("Zeit2", &s, &slow), ("a", &[], &one), ("b", &[], &one)]);
    let said = recording(&beside).unwrap_err().to_string();
    assert!(said.contains("\"Zeit\" and \"Zeit2\" run over 1.5 and 15"), "{said}");
    let same = group(&[("Time", &s, &fast), ("Time 2", &s, &fast), ("a", &[], &one)]);
    assert_eq!(steps(&same), [time("a", 0.5)]);
    let flight = [0.1, 0.2, 0.4, 0.5];
    let values = group(&[("Time", &s, &fast), ("time of flight", &s, &flight)]);
    assert_eq!(steps(&values), [time("time of flight", 0.5)]);
}

#[test]
fn times_of_other_units_and_digits() {
    let of = |times: &[f64], unit| {
        let unit = [Prop::Text("unit_string", unit)];
        let bytes = group(&[("Time", &unit, times), ("a", &[], &vec![1.0; times.len()])]);
        let found = recording(&bytes).unwrap();
        (found.records[0].axis().clone(), found.findings)
    };
    // Nanoseconds since 1970, 1 ms apart.
    let (axis, found) = of(&every(1e6, 5).iter().map(|t| t + 1.7e18).collect::<Vec<_>>(), "");
    assert!(has_finding(&found, "axis-epoch", &["unit=ns"]) && axis.start() == 0.0);
    // Doubles near 1.7e18 are 256 ns apart.
    assert!((axis.step().unwrap() - 1e-3).abs() < 256e-9);
    let (axis, found) = of(&every(1.0, 5), "h");
    assert_eq!((axis.step(), found.len()), (Some(3600.0), 0));
    let (_, found) = of(&every(1.0, 5), "hh:mm");
    assert!(has_finding(&found, "axis-unit-unknown", &["said=hh:mm", "unit=s"]));
    // Steps of 1 ms from 100 s on in single precision, whose numbers near 100 are 8 µs apart.
    let single: Vec<f64> = (0..50).map(|i| f64::from((100.0 + f64::from(i) * 1e-3) as f32)).collect();
    let (axis, found) = of(&single, "s");
    assert!((axis.step().unwrap() - 1e-3).abs() < 8e-6 / 49.0);
    assert!(has_finding(&found, "axis-rounded", &[]) && found.len() == 1);
    // An uneven clock gives one finding.
    let (_, found) = of(&[0.0, 1.0, 5.0], "s");
    assert_eq!(found.iter().map(|found| found.code.as_ref()).collect::<Vec<_>>(), ["axis-uneven"]);
}

#[test]
fn the_unit_of_the_abscissa() {
    let of = |unit: &str, name: &str| {
        let wave = [
            Prop::F64("wf_increment", 0.5),
            Prop::Text("wf_xunit_string", unit),
            Prop::Text("wf_xname", name),
        ];
        let found = recording(&group(&[("a", &wave, &[1.0, 2.0])])).unwrap();
        let axis = found.records[0].axis();
        (axis.kind.clone(), axis.step(), found.all_findings())
    };
    assert_eq!(of("ms", "").1, Some(0.5e-3));
    assert_eq!((of("kHz", "").0, of("kHz", "").1), (AxisKind::Frequency, Some(500.0)));
    assert_eq!((of("", "Frequency").0, of("hz", "").0), (AxisKind::Frequency, AxisKind::Frequency));
    assert_eq!(
        (of("mm", "Position").0, of("mm", "").1),
        (AxisKind::Other("Position [mm]".into()), Some(0.5))
    );
    assert!(has_finding(&of("ticks", "").2, "axis-unit-unknown", &["said=ticks", "unit=s"]));
}

#[test]
fn what_changes_between_values() {
    let two = |first: &[Prop], second: &[Prop], more: bool| {
        let mut writer = Writer::new(false);
        let raw = writer.doubles(&[1.0, 2.0]);
        writer.segment(ALL, &[("/'g'/'a'", Raw::Of(10, 2), first), ("/'g'/'b'", Raw::Of(10, 0), &[])], &raw);
        let (contents, index) = if more { (META | RAW, Raw::AsBefore) } else { (META, Raw::None) };
        writer.segment(contents, &[("/'g'/'a'", index, second)], if more { &raw } else { &[] });
        recording(&writer.bytes)
    };
    let unit = |unit| [Prop::Text("unit_string", unit)];
    let said = two(&unit("V"), &unit("mV"), true).unwrap_err().to_string();
    assert!(said.contains("unit_string changes from V to mV behind value 2"), "{said}");
    // A unit that changes after all values applies to all of them, and so does a unit first stated after
    // some of them.
    let late = |first: &str| two(&[Prop::Text("unit_string", first)], &unit("mV"), first.is_empty()).unwrap();
    assert_eq!(
        [late("V"), late("")].map(|found| found.records[0].extremes().largest().unwrap().1),
        [2e-3; 2]
    );
    let start = |dt, at| [Prop::F64("wf_increment", dt), Prop::F64("wf_start_time", at)];
    let of = |first: &[Prop], second: &[Prop]| two(first, second, true).unwrap().all_findings();
    let found = of(&start(0.5, 0.0), &start(0.25, 1.0));
    assert!(has_finding(&found, "step-changed", &["before=0.5", "step=0.25", "n=2"]));
    assert!(has_finding(&of(&start(0.5, 0.0), &start(0.5, 61.0)), "start-changed", &["gap=60", "n=2"]));
    // Two values 0.5 s apart: a second segment that starts at 1 s leaves no gap.
    assert!(!has_finding(&of(&start(0.5, 0.0), &start(0.5, 1.0)), "start-changed", &[]));
}

#[test]
fn many_segments_scales_and_channels_cost_what_is_there() {
    // 28 sums in a chain, each adding the previous scale to itself: 2²⁸ times the value.
    let sum = |i: usize| {
        let side =
            |side: &str| (format!("NI_Scale[{i}]_Add_{side}_Operand_Input_Source"), Ok(i as f64 - 1.0));
        [(format!("NI_Scale[{i}]_Scale_Type"), Err("Add")), side("Left"), side("Right")]
    };
    let chain: Vec<_> = linear(0, 1.0, 0.0, u32::MAX).into_iter().chain((1..29).flat_map(sum)).collect();
    assert_eq!(scaled(29, &chain, &[1.0]).unwrap(), [2f64.powi(28)]);
    // Segments without a description share the parts of the last one described. Empty segments add no
    // layout.
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[1.0, 2.0]);
    writer.segment(ALL, &[("/'g'/'a'", Raw::Of(10, 1), &[]), ("/'g'/'b'", Raw::Of(10, 1), &[])], &raw);
    for _ in 0..3 {
        writer.segment(RAW, &[], &[]).segment(RAW, &[], &raw);
    }
    let n = writer.bytes.len() as u64;
    let (_, layouts, _) = segment::all(&mut BufReader::new(std::io::Cursor::new(&writer.bytes)), n).unwrap();
    assert_eq!(layouts.len(), 4);
    assert!(layouts.iter().all(|layout| Arc::ptr_eq(&layout.parts, &layouts[0].parts)));
    assert_eq!(traces(&writer.bytes)[1].values, [2.0; 4]);
}

#[test]
fn complaints_name_the_file_and_the_scale() {
    let scale = [Prop::U32("NI_Number_Of_Scales", 1), Prop::Text("NI_Scale[0]_Scale_Type", "RTD")];
    let said = recording(&group(&[("temp", &scale, &[1.0])])).unwrap_err().to_string();
    assert!(said.contains("\"temp\"") && said.contains("RTD"), "{said}");
    let mut bytes = group(&[("a", &[], &[1.0])]);
    bytes.extend([b'x'; 64]);
    assert!(recording(&bytes).unwrap_err().to_string().contains("x.tdms, byte"));
    let units = [Prop::Text("unit_string", ""), Prop::Text("NI_UnitDescription", "V")];
    assert_eq!(traces(&group(&[("a", &units, &[1.0])]))[0].meta.unit.symbol(), "V");
    // A property of extended precision: type 0x0b and 16 bytes instead of type 10 and 8 bytes.
    let bytes = group(&[("a", &[Prop::F64("cal", 1.0)], &[5.0])]);
    let at = bytes.windows(3).position(|word| word == b"cal").unwrap() + 3;
    let mut extended = [&bytes[..at], &[0x0b, 0, 0, 0], &[0; 16], &bytes[at + 12..]].concat();
    for length in [12, 20] {
        extended[length] += 8;
    }
    assert_eq!(traces(&extended)[0].values, [5.0]);
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
    /// A damaged header causes no panic, and no record with more values than the file has bytes.
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

#[test]
fn values_beyond_the_limit_are_refused_before_they_are_read() {
    let mut writer = Writer::new(false);
    let raw = writer.doubles(&[0.0; 100]);
    // Five chunks of two channels of ten values.
    let channel = |name| (name, Raw::Of(10, 10), [].as_slice());
    writer.segment(ALL, &[channel("/'g'/'a'"), channel("/'g'/'b'")], &raw);
    let read = |bytes: f64| {
        let reader = crate::reader::Reader::new().max_memory(crate::limit::Limit(bytes));
        reader.from_reader("x.tdms", writer.bytes.as_slice())
    };
    assert_eq!(read(800.0).unwrap().records[0].len(), 50);
    assert!(read(799.0).unwrap_err().to_string().contains("it needs 0.80 kB"), "100 values of 8 bytes");
}
