use super::*;
use crate::reader::Reader;
use proptest::prelude::*;
use vibro_record::units::Unit;
use vibro_record::{Axis, Frf, Meta};

fn trace(name: &str, unit: &str, axis: Axis, values: Vec<f64>) -> Record {
    Record::Trace(Trace { meta: Meta::new(name, Unit::parse_or_opaque(unit).si()), axis, values })
}

fn bytes(records: &[Record], sample: Precision) -> Vec<u8> {
    let mut out = Vec::new();
    write(records, sample, &mut out).unwrap();
    out
}

fn back(bytes: &[u8]) -> Vec<Trace> {
    let recording = Reader::new().from_reader("x.wav", bytes).unwrap();
    assert!(recording.findings.is_empty(), "{:?}", recording.findings);
    let traces = recording.records.into_iter().map(|r| match r {
        Record::Trace(t) => t,
        other => panic!("{other:?}"),
    });
    traces.collect()
}

#[test]
fn another_reader_finds_values_within_full_scale() {
    let axis = Axis::time(0.0, 1.0 / 8000.0, 3);
    let records = [
        trace("v", "m/s", axis.clone(), vec![0.0, -12.0, 3.0]),
        trace("x", "m", axis, vec![1e-6, 0.0, -0.5e-6]),
    ];
    let file = bytes(&records, Precision::Single);
    let mut reader = hound::WavReader::new(file.as_slice()).unwrap();
    let spec = reader.spec();
    assert_eq!((spec.channels, spec.sample_rate, spec.bits_per_sample), (2, 8000, 32));
    let samples: Vec<f32> = reader.samples::<f32>().map(|s| s.unwrap()).collect();
    // 12 is divided by 16, and 1e-6 by 2⁻¹⁹ = 1/524 288.
    let small = 1e-6 * 524_288.0;
    assert_eq!(samples, [0.0, small as f32, -0.75, 0.0, 0.1875, (-0.5 * small) as f32]);
}

#[test]
fn the_comment_undoes_the_scaling_with_a_doubt() {
    let file = bytes(&[trace("v", "m/s", Axis::time(0.5, 0.001, 2), vec![3.0, -1.0])], Precision::Single);
    let traces = back(&file);
    assert_eq!((traces[0].values.as_slice(), traces[0].meta.unit.symbol()), ([3.0, -1.0].as_slice(), "m/s"));
    assert_eq!((traces[0].meta.name.as_str(), traces[0].axis.start()), ("v", 0.5));
    assert!(
        crate::tests::has_finding(
            &traces[0].meta.findings,
            "full-scale-by-comment",
            &["factor=4", "unit=m/s"]
        ),
        "{:?}",
        traces[0].meta.findings
    );
    // Values without a calibration are still uncalibrated after reading back.
    let file = bytes(&[trace("v", "FS", Axis::time(0.0, 0.001, 1), vec![3.0])], Precision::Single);
    assert_eq!(
        (back(&file)[0].values[0], back(&file)[0].meta.findings.clone()),
        (3.0, vec![vibro_record::Finding::caution("uncalibrated")])
    );
}

#[test]
fn what_a_wave_file_cannot_hold_is_refused_with_the_reason() {
    let refused = |records: &[Record]| {
        let mut out = Vec::new();
        let error = write(records, Precision::Single, &mut out).unwrap_err();
        assert!(out.is_empty() && error.exit_code() == 1);
        error.to_string()
    };
    let even = |step| Axis::time(0.0, step, 2);
    let values = vec![1.0, 2.0];
    let uneven = Axis::from_values(AxisKind::Time, vec![0.0, 0.3, 0.4], 0.0);
    assert!(refused(&[trace("a", "m", uneven, vec![1.0, 2.0, 3.0])]).contains("not evenly sampled"));
    assert!(refused(&[trace("a", "m", Axis::index(2), values.clone())]).contains("no time axis"));
    assert!(refused(&[trace("a", "m", even(0.1), vec![1.0, f64::NAN])]).contains("misses its value 2"));
    assert!(refused(&[trace("a", "m", even(10.0), values.clone())]).contains("not 0.1 Hz"));
    assert!(refused(&[trace("a", "m", even(1e-10), values.clone())]).contains("4.29 GHz"));
    assert!(refused(&[trace("a", "m", Axis::time(0.0, 0.1, 0), vec![])]).contains("no samples"));
    let two = [trace("a", "m", even(0.1), values.clone()), trace("b", "m", even(0.2), values)];
    assert!(refused(&two).contains("\"a\" and the trace \"b\" have different time axes"));
    let (meta, axis) = (Meta::new("H", Unit::none()), Axis::frequency(0.0, 1.0, 0));
    let frf = Record::Frf(Frf { meta, axis, values: vec![] });
    assert!(refused(&[frf]).contains("the frf \"H\" is not over time"));
    assert!(refused(&[]).contains("no record"));
}

#[test]
fn a_size_beyond_four_gigabytes_is_refused() {
    let channels = vec![Scale { factor: 1.0, unit: "m".into(), name: "a".into() }; 2];
    let scales = Scales { rate: 1.0, start: 0.0, channels };
    assert!(head(&scales, 1, 500_000_000, Precision::Single).is_ok());
    for frames in [600_000_000, usize::MAX] {
        let error = head(&scales, 1, frames, Precision::Single).unwrap_err().to_string();
        assert!(error.contains("4 GiB"), "{error}");
    }
}

#[test]
fn full_scale_is_the_next_power_of_two() {
    let of = |v: f64| {
        scale(&Trace { meta: Meta::new("", Unit::none()), axis: Axis::index(1), values: vec![v] }).factor
    };
    for (value, factor) in [
        (0.0, 1.0),
        (1.0, 1.0),
        (-1.000_000_1, 2.0),
        (0.3, 0.5),
        (f64::MAX, 2f64.powi(1023)),
        (5e-324, f64::MIN_POSITIVE),
    ] {
        assert_eq!(of(value), factor, "{value}");
    }
}

proptest! {
    #[test]
    fn traces_read_back(
        columns in (1usize..4, 1usize..40).prop_flat_map(|(k, n)| prop::collection::vec(prop::collection::vec(
            prop::num::f64::POSITIVE | prop::num::f64::NEGATIVE | prop::num::f64::NORMAL | prop::num::f64::ZERO, n), k)),
        rate in 1.0f64..1e6, start in -5.0..5.0, name in "[ -~]{1,20}",
    ) {
        let axis = Axis::time(start, 1.0 / rate, columns[0].len());
        let records: Vec<Record> = columns.into_iter().map(|v| trace(name.trim(), "m/s²", axis.clone(), v)).collect();
        for sample in [Precision::Single, Precision::Double] {
            let traces = back(&bytes(&records, sample));
            prop_assert_eq!(traces.len(), records.len());
            for (record, is) in records.iter().zip(&traces) {
                let Record::Trace(was) = record else { unreachable!() };
                prop_assert_eq!(&was.meta.unit, &is.meta.unit);
                if !name.trim().is_empty() {
                    prop_assert_eq!(&was.meta.name, &is.meta.name);
                }
                prop_assert_eq!(is.axis.start(), start);
                // Writing and reading take one reciprocal each, rounded by half an ulp.
                let dt: f64 = is.axis.step().unwrap();
                prop_assert!((dt * rate - 1.0).abs() < 4.0 * f64::EPSILON);
                let factor = scale(was).factor;
                for (a, b) in was.values.iter().zip(&is.values) {
                    // Single: half an ulp of the value, or half the smallest float times full scale.
                    // Double: the smallest double times full scale, as only underflow loses digits.
                    let bound = match sample {
                        Precision::Single => a.abs() * 2f64.powi(-24) + factor * 2f64.powi(-150),
                        Precision::Double if factor > 1.0 => factor * 5e-324,
                        Precision::Double => 0.0,
                    };
                    prop_assert!((a - b).abs() <= bound, "{a} {b} {factor}");
                }
            }
        }
    }
}
