//! Records written as data set 58 or 58b are read back unchanged, as far as the format can hold them.

use crate::others_files;
use num_complex::Complex64;
use proptest::prelude::*;
use vibroimpact::read::Reader;
use vibroimpact::record::{
    Axis, AxisKind, Frf, Grid, Meta, Record, Scaling, Spectrum, Trace, Values, Window,
};
use vibroimpact::units::{Quantity, Unit};
use vibroimpact::write::uff58::{Precision, Storage, write_uff58};

const STORAGES: [Storage; 4] = [
    Storage { binary: false, precision: Precision::Single },
    Storage { binary: false, precision: Precision::Double },
    Storage { binary: true, precision: Precision::Single },
    Storage { binary: true, precision: Precision::Double },
];

fn write(records: &[Record], storage: Storage) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_uff58(records, &mut bytes, storage).expect("a vector takes everything");
    bytes
}

fn again(records: &[Record], storage: Storage) -> Vec<Record> {
    let recording = Reader::new().from_reader("again.uff", &write(records, storage)[..]);
    let recording = recording.unwrap_or_else(|e| panic!("{storage:?}: {e}"));
    assert_eq!(recording.findings, []);
    recording.records
}

/// Largest relative rounding error of a value in this storage.
fn rounding(storage: Storage) -> f64 {
    match (storage.binary, storage.precision) {
        // Half a unit of the last of six or thirteen digits, relative to a value whose first digit is 1.
        (false, Precision::Single) => 0.5e-5,
        (false, Precision::Double) => 0.5e-12,
        // Half a unit in the last place.
        (true, Precision::Single) => f64::from(f32::EPSILON) / 2.0,
        (true, Precision::Double) => 0.0,
    }
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    // A correctly rounded parse of the printed digits adds half a unit in the last place.
    a.to_bits() == b.to_bits() || (a - b).abs() <= (relative + f64::EPSILON) * a.abs() && relative > 0.0
}

fn numbers(record: &Record) -> Vec<Complex64> {
    let real = |values: &[f64]| values.iter().map(|v| Complex64::new(*v, 0.0)).collect();
    match record {
        Record::Trace(r) => real(&r.values),
        Record::Frf(r) => r.values.clone(),
        Record::Spectrum(r) => match &r.values {
            Values::Real(values) => real(values),
            Values::Complex(values) => values.clone(),
        },
    }
}

fn scaling(record: &Record) -> Option<(Scaling, Option<Window>, Option<f64>)> {
    if let Record::Spectrum(s) = record { Some((s.scaling, s.window, s.enbw)) } else { None }
}

/// Checks that `after` equals `before`, as far as `storage` can hold it.
fn same(before: &Record, after: &Record, storage: Storage) -> Result<(), TestCaseError> {
    prop_assert_eq!((before.kind(), before.len()), (after.kind(), after.len()));
    prop_assert_eq!(before.is_complex(), after.is_complex());
    prop_assert_eq!(&before.meta().name, &after.meta().name);
    prop_assert_eq!(before.meta().unit.dimension(), after.meta().unit.dimension());
    prop_assert_eq!(before.meta().quantity, after.meta().quantity);
    prop_assert_eq!(scaling(before), scaling(after));
    prop_assert_eq!(&before.axis().kind, &after.axis().kind);
    match (&before.axis().grid, &after.axis().grid) {
        (Grid::Even { start, step, .. }, Grid::Even { start: s, step: d, .. }) => {
            prop_assert!(near(*start, *s, 0.5e-5), "start {} became {}", start, s);
            prop_assert!(near(*step, *d, 0.5e-6), "step {} became {}", step, d);
        }
        (Grid::Uneven(a), Grid::Uneven(b)) => {
            for (a, b) in a.iter().zip(b) {
                let rounding = if storage.binary { 6e-8 } else { 0.5e-5 };
                prop_assert!(near(*a, *b, rounding), "abscissa {} became {}", a, b);
            }
        }
        (a, b) => prop_assert!(false, "{a:?} became {b:?}"),
    }
    for (a, b) in numbers(before).into_iter().zip(numbers(after)) {
        for (a, b) in [(a.re, b.re), (a.im, b.im)] {
            prop_assert!(near(a, b, rounding(storage)), "{:?}: {} became {}", storage, a, b);
        }
    }
    Ok(())
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("drill housing".to_owned()),
        Just("Körper µ #3".to_owned()),
        Just("ends in -1".to_owned()),
        "[A-Za-z][A-Za-z0-9 _+-]{0,18}[A-Za-z0-9]",
    ]
    .prop_filter("a name that stands for nothing", |name| !name.eq_ignore_ascii_case("none"))
}

/// Numbers within the range of single precision.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-1e6f64..1e6, -20i32..20).prop_map(|(m, e)| m * 10f64.powi(e)),
        1 => Just(0.0),
        1 => Just(-1.0),
    ]
}

/// Abscissa whose steps are 2 and 1 times `first` in turn: few enough digits for text and single precision.
fn uneven(first: u32, n: usize) -> Vec<f64> {
    (0..n).map(|i| f64::from(first) * (i + i.div_ceil(2)) as f64).collect()
}

fn axis(kind: AxisKind, n: usize) -> impl Strategy<Value = Axis> {
    // A start with few digits: others cannot be stored beside a small step and are refused.
    let even = (-9999i32..9999, 1e-6f64..1e3).prop_map(move |(start, step)| Grid::Even {
        start: f64::from(start) / 1e4,
        step,
        n,
    });
    let uneven = (1u32..100).prop_map(move |first| Grid::Uneven(uneven(first, n)));
    prop_oneof![even, uneven].prop_map(move |grid| Axis { kind: kind.clone(), grid })
}

fn trace() -> impl Strategy<Value = Record> {
    let units = proptest::sample::select(vec!["m/s²", "m", "N", "V", "Pa", "N s", "m^3*kg"]);
    (name(), units, 3usize..40).prop_flat_map(|(name, unit, n)| {
        (proptest::collection::vec(number(), n), axis(AxisKind::Time, n)).prop_map(move |(values, axis)| {
            let meta = Meta::new(name.clone(), Unit::parse(unit).expect("a unit"));
            Record::Trace(Trace { meta, axis, values })
        })
    })
}

fn complex(n: usize) -> impl Strategy<Value = Vec<Complex64>> {
    proptest::collection::vec((number(), number()).prop_map(|(re, im)| Complex64::new(re, im)), n)
}

fn frf() -> impl Strategy<Value = Record> {
    let quantities = proptest::sample::select(vec![
        Quantity::Receptance,
        Quantity::Mobility,
        Quantity::Accelerance,
        Quantity::Ratio,
    ]);
    (name(), quantities, 3usize..40).prop_flat_map(|(name, quantity, n)| {
        (complex(n), axis(AxisKind::Frequency, n)).prop_map(move |(values, axis)| {
            let meta = Meta::new(name.clone(), Unit::of(quantity));
            Record::Frf(Frf { meta, axis, values })
        })
    })
}

fn spectrum() -> impl Strategy<Value = Record> {
    let scalings = proptest::sample::select(vec![
        (Scaling::Peak, "m/s²"),
        (Scaling::Rms, "m"),
        (Scaling::Power, "m^2/s^4"),
        (Scaling::Psd, "m^2/s^3"),
        (Scaling::Energy, "m^2/s^2"),
        (Scaling::Coherence, "1"),
        (Scaling::Unknown, "N"),
    ]);
    let windows = proptest::sample::select(vec![None, Some(Window::Hann), Some(Window::BlackmanHarris)]);
    (name(), scalings, windows, any::<bool>(), 3usize..40).prop_flat_map(
        |(name, (scaling, unit), window, is_complex, n)| {
            (complex(n), axis(AxisKind::Frequency, n)).prop_map(move |(values, axis)| {
                let values = if is_complex {
                    Values::Complex(values)
                } else {
                    Values::Real(values.iter().map(|v| v.re).collect())
                };
                let meta = Meta::new(name.clone(), Unit::parse(unit).expect("a unit"));
                let enbw = window.map(|_| 1.5);
                Record::Spectrum(Spectrum { meta, axis, values, scaling, window, enbw })
            })
        },
    )
}

proptest! {
    #[test]
    fn every_record_is_read_as_it_was_written(record in prop_oneof![trace(), frf(), spectrum()]) {
        for storage in STORAGES {
            let after = again(std::slice::from_ref(&record), storage);
            prop_assert_eq!(after.len(), 1);
            same(&record, &after[0], storage)?;
        }
    }

    #[test]
    fn several_records_keep_their_order(records in proptest::collection::vec(prop_oneof![trace(), frf()], 1..5)) {
        for storage in STORAGES {
            let after = again(&records, storage);
            prop_assert_eq!(records.len(), after.len());
            for (a, b) in records.iter().zip(&after) {
                // Reading numbers the channels that have the same name.
                let mut b = b.clone();
                b.meta_mut().name.clone_from(&a.meta().name);
                same(a, &b, storage)?;
            }
        }
    }

    /// Any text as a name: it may be shortened, but never breaks the file.
    #[test]
    fn no_name_breaks_the_file(name in any::<String>(), unit in any::<String>()) {
        // No unit begins with `?`. Values in a known unit would be converted when read.
        let meta = Meta { unit: Unit::opaque(&format!("?{unit}")), ..Meta::new(name, Unit::none()) };
        let record = Record::Trace(Trace { meta, axis: Axis::time(0.0, 0.5, 2), values: vec![-1.0, 2.0] });
        for storage in STORAGES {
            let after = again(std::slice::from_ref(&record), storage);
            prop_assert_eq!(numbers(&after[0]), numbers(&record));
        }
    }
}

/// Binary storage in double precision keeps every bit.
#[test]
fn extreme_doubles_keep_their_bits() {
    let values = vec![f64::MIN_POSITIVE, f64::MAX, -0.0, 5e-324, 1.0 + f64::EPSILON, 0.1];
    let meta = Meta::new("x", Unit::of(Quantity::Force));
    let axis = Axis::time(0.0, 1.0, values.len());
    let record = Record::Trace(Trace { meta, axis, values: values.clone() });
    let after = again(std::slice::from_ref(&record), STORAGES[3]);
    let bits = |values: Vec<Complex64>| values.iter().map(|v| v.re.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(numbers(&after[0])), bits(numbers(&record)));
    // As text, thirteen digits are kept even with exponents of three digits.
    for (a, b) in numbers(&record).iter().zip(numbers(&again(std::slice::from_ref(&record), STORAGES[1])[0]))
    {
        assert!(near(a.re, b.re, 0.5e-12) || a.re < 1e-300, "{a} became {b}");
    }
}

/// Numbers and lines that cross the end of the reader's buffer.
#[test]
fn long_records_are_read_across_buffers() {
    let n = 60_000;
    let values = (0..n).map(|i| Complex64::new(f64::from(i), -0.5 * f64::from(i))).collect();
    let axis = Axis { kind: AxisKind::Frequency, grid: Grid::Uneven(uneven(3, n as usize)) };
    let meta = Meta::new("long", Unit::of(Quantity::Receptance));
    let record = Record::Frf(Frf { meta, axis, values });
    for storage in STORAGES {
        let after = again(&[record.clone(), record.clone()], storage);
        for (i, mut after) in after.into_iter().enumerate() {
            "long".clone_into(&mut after.meta_mut().name);
            same(&record, &after, storage).unwrap_or_else(|e| panic!("record {i}: {e}"));
        }
    }
}

#[test]
fn nothing_is_not_written() {
    assert!(write_uff58(&[], &mut Vec::new(), Storage::default()).is_err());
}

#[test]
fn missing_values_stay_missing() {
    let meta = Meta::new("x", Unit::of(Quantity::Force));
    let values = vec![1.0, f64::NAN, 3.0];
    let record = Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0, 3), values });
    for storage in STORAGES {
        let bytes = write(std::slice::from_ref(&record), storage);
        let refused = Reader::new().from_reader("x.uff", &bytes[..]).unwrap_err().to_string();
        assert!(refused.contains("allow_missing"), "{refused}");
        let kept = Reader::new().allow_missing(true).from_reader("x.uff", &bytes[..]).unwrap();
        let kept = numbers(&kept.records[0]);
        assert!(kept[1].re.is_nan() && kept[2].re == 3.0, "{storage:?}: {kept:?}");
    }
}

#[test]
fn the_layout_is_that_of_the_standard() {
    let meta = Meta::new("drill", Unit::of(Quantity::Acceleration));
    let axis = Axis::time(0.0, 1.0 / 44_100.0, 7);
    let values = (0..7).map(f64::from).collect();
    let text = write(
        &[Record::Trace(Trace { meta, axis, values })],
        Storage { precision: Precision::Single, ..Storage::default() },
    );
    let text = String::from_utf8(text).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[..13].iter().all(|line| line.len() == 80), "{text}");
    let trimmed: Vec<&str> = lines.iter().map(|line| line.trim_end()).collect();
    assert_eq!(
        trimmed,
        [
            "    -1",
            "    58",
            "drill",
            "NONE",
            "NONE",
            "NONE",
            "NONE",
            "    1         0    0         0 NONE               0   0 NONE               0   0",
            "         2         7         1 0.000000E+00 2.267574E-05 0.000000E+00",
            "        17    0    0    0 time                 s",
            "        12    0    0    0 acceleration         m/s^2",
            "         0    0    0    0 NONE                 NONE",
            "         0    0    0    0 NONE                 NONE",
            "  0.00000E+00  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00",
            "  6.00000E+00",
            "    -1",
        ]
    );
}

#[test]
fn files_of_instruments_survive_a_second_writing() {
    let Some(folder) = others_files::folder("uff") else { return };
    let (mut records, mut refused) = (0, 0);
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if !path.extension().is_some_and(|e| ["uff", "unv", "ufb"].iter().any(|k| e == *k)) {
            continue;
        }
        let before = Reader::new().from_path(&path).unwrap().records;
        if before.is_empty() {
            continue; // nodes and trace lines only
        }
        for storage in STORAGES {
            // An uneven abscissa may need more digits than the format has.
            if let Err(error) = write_uff58(&before, &mut Vec::new(), storage) {
                assert!(error.to_string().contains("has too few digits"), "{error}");
                refused += 1;
                continue;
            }
            let after = again(&before, storage);
            assert_eq!(before.len(), after.len());
            for (a, b) in before.iter().zip(&after) {
                same(a, b, storage).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                assert_eq!(a.meta().notes, b.meta().notes, "{}", path.display());
                records += 1;
            }
        }
    }
    eprintln!("{records} records survived, {refused} files were refused");
    assert!(records >= 4 * 30, "only {records} records: is ../shared/data whole?");
}
