use super::*;
use crate::reader::Reader;
use num_complex::Complex64;
use proptest::prelude::*;
use vibro_record::units::Unit;
use vibro_record::{Frf, Meta, Spectrum, Trace, Window};

fn meta(name: &str, unit: &str) -> Meta {
    Meta::new(name, Unit::parse_or_opaque(unit).si())
}

fn trace(name: &str, axis: Axis, values: Vec<f64>) -> Record {
    Record::Trace(Trace { meta: meta(name, "m/s"), axis, values })
}

fn text(records: &[Record]) -> String {
    let mut out = Vec::new();
    write(records, ',', &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// A record without notes, findings and history, which a table cannot hold.
fn essence(record: &Record) -> Record {
    let mut record = record.clone();
    let meta = record.meta_mut();
    (meta.notes, meta.findings, meta.history) = (Vec::new(), Vec::new(), Vec::new());
    record
}

#[test]
fn a_table_as_a_spreadsheet_takes_it() {
    let axis = Axis::time(0.0, 0.5, 2);
    let records =
        [trace("a, \"b\"", axis.clone(), vec![1e-9, -0.25]), trace("#", axis, vec![1e20, f64::NAN])];
    assert_eq!(text(&records), "time [s],\"a, \"\"b\"\" [m/s]\",\"# [m/s]\"\n0,1e-9,1e20\n0.5,-0.25,NaN\n");
}

#[test]
fn remarks_carry_what_columns_cannot() {
    let axis = Axis::frequency(0.0, 1.0, 1);
    let spectrum = Record::Spectrum(Spectrum {
        meta: meta("v", "m/s"),
        axis: axis.clone(),
        values: Values::Real(vec![1.0]),
        scaling: Scaling::Rms,
        window: Some(Window::Hann),
        enbw: Some(1.5),
    });
    let frf = Record::Frf(Frf { meta: meta("T", "1"), axis, values: vec![Complex64::new(1.0, 2.0)] });
    assert_eq!(
        text(&[spectrum, frf]),
        "# scaling: rms of v\n# window: hann of v\n# enbw: 1.5 of v\n# kind: frf of T\n\
         frequency [Hz],v [m/s],T_re [1],T_im [1]\n0,1,1,2\n"
    );
}

#[test]
fn what_one_table_cannot_hold_is_refused() {
    let refused = |records: &[Record]| write(records, ',', &mut Vec::new()).unwrap_err().to_string();
    let a = trace("a", Axis::time(0.0, 0.5, 1), vec![1.0]);
    let b = trace("b", Axis::time(0.0, 0.4, 1), vec![1.0]);
    assert!(refused(&[a, b]).contains("\"a\" and the trace \"b\" have different abscissae"));
    assert!(refused(&[trace("a", Axis::index(0), vec![])]).contains("no values"));
    assert!(refused(&[]).contains("no record"));
}

#[test]
fn an_uneven_abscissa_with_few_digits_stays_uneven() {
    let axis = Axis::from_values(AxisKind::Time, vec![0.0, 0.1, 0.2, 0.4], 0.0);
    let records = [trace("a", axis, vec![1.0, 2.0, 3.0, 4.0])];
    let back = Reader::new().from_reader("x.csv", text(&records).as_bytes()).unwrap();
    assert_eq!(back.records[0].axis().values(), [0.0, 0.1, 0.2, 0.4]);
}

fn values(n: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL, n)
}

fn named() -> impl Strategy<Value = Meta> {
    let units =
        prop::sample::select(vec!["m/s", "m/s²", "N", "1", "m", "Pa", "m/N", "g²/Hz", "m/s/√Hz", "EU", ""]);
    // The prefix prevents empty names and names of an abscissa or a counter.
    ("[A-Za-z0-9µ ,;:\"'\\[\\]()#%=._/-]{0,12}", units)
        .prop_map(|(name, unit)| meta(format!("ch{name}").trim(), unit))
}

proptest! {
    #[test]
    fn traces_read_back(
        (metas, columns) in (1usize..5, 2usize..20).prop_flat_map(|(k, n)| (prop::collection::vec(named(), k), prop::collection::vec(values(n), k))),
        start in -10.0..10.0, step in 1e-6..10.0, kind in 0..3, separator in prop::sample::select(vec![',', ';', '\t']),
    ) {
        let n = columns[0].len();
        let axis = match kind {
            0 => Axis::time(start, step, n),
            1 => Axis::index(n),
            // Exponential steps: no even axis has these values.
            _ => Axis { kind: AxisKind::Time, grid: Grid::Uneven((0..n).map(|i| start + step * (1.5 * i as f64).exp2()).collect()) },
        };
        let records: Vec<Record> = metas.into_iter().zip(columns)
            .map(|(meta, values)| Record::Trace(Trace { meta, axis: axis.clone(), values })).collect();
        let mut out = Vec::new();
        write(&records, separator, &mut out).unwrap();
        let back = Reader::new().from_reader("x.csv", out.as_slice()).unwrap();
        prop_assert_eq!(back.records.len(), records.len(), "{}", String::from_utf8_lossy(&out));
        for (was, is) in records.iter().zip(&back.records) {
            let (Record::Trace(was), Record::Trace(is)) = (was, is) else { panic!("{is:?}") };
            prop_assert_eq!(&was.values, &is.values);
            prop_assert_eq!(&was.meta.name, &is.meta.name);
            prop_assert_eq!(&was.meta.unit, &is.meta.unit);
            prop_assert_eq!(&was.axis.kind, &is.axis.kind);
            // Each printed time is the nearest double to start + i·step: half an ulp of at most 10 + 20·10
            // = 210 s.
            for i in 0..n {
                prop_assert!((was.axis.at(i) - is.axis.at(i)).abs() <= 4.0 * f64::EPSILON * 210.0);
            }
            if n > 2 {
                prop_assert_eq!(was.axis.step().is_some(), is.axis.step().is_some());
            }
        }
    }

    #[test]
    fn spectra_and_frequency_responses_read_back(
        re in values(3), im in values(3), frf_unit in prop::sample::select(vec!["m/N", "(m/s)/N", "1", "EU"]),
        window in prop::sample::select(Window::ALL.to_vec()), enbw in prop::option::of(1.0..4.0),
        scaling in prop::sample::select(vec![Scaling::Peak, Scaling::Rms, Scaling::Psd, Scaling::Coherence, Scaling::Unknown]),
    ) {
        let axis = Axis::frequency(0.0, 0.25, 3);
        let complex: Vec<Complex64> = re.iter().zip(&im).map(|(re, im)| Complex64::new(*re, *im)).collect();
        let m = meta("H 1", frf_unit);
        let spectrum = |meta, values, window, enbw| {
            Record::Spectrum(Spectrum { meta, axis: axis.clone(), values, scaling, window, enbw })
        };
        let records = [
            spectrum(meta("v", "m/s"), Values::Real(re), Some(window), enbw),
            spectrum(meta("u of v", "m"), Values::Real(im), None, None),
            spectrum(meta("X", "m/N"), Values::Complex(complex.clone()), None, None),
            Record::Frf(Frf { meta: m, axis: axis.clone(), values: complex }),
        ];
        let back = Reader::new().from_reader("x.csv", text(&records).as_bytes()).unwrap();
        let was: Vec<Record> = records.iter().map(essence).collect();
        let is: Vec<Record> = back.records.iter().map(essence).collect();
        prop_assert_eq!(was, is);
    }
}
